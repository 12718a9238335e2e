// The page that gliss report fills in; made by tools/report/page/build.mjs where the build has npm.
#pragma once

namespace gliss {

extern const char* const kReportPage;

}  // namespace gliss
