// The pages that gliss report fills in and gliss view serves; made by tools/report/page/build.mjs
// where the build has npm.
#pragma once

namespace gliss {

extern const char* const kReportPage;
extern const char* const kViewPage;  // of gliss view

}  // namespace gliss
