// JSON whose keys keep their order.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace gliss {

using Json = nlohmann::ordered_json;

// Null where the number is not finite.
inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

}  // namespace gliss
