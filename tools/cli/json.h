// JSON whose keys keep their order.
#pragma once

#include <nlohmann/json.hpp>

namespace gliss::tools {

using Json = nlohmann::ordered_json;

}  // namespace gliss::tools
