// How far the corners of a polygon can move before it meets itself. Private to host/.
#pragma once

#include <span>

#include "gliss/base/vector.h"

namespace gliss {

// The least t > 0 at which a corner of the polygon, whose corners are those plus t times their
// steps, lies on one of its sides, but for corners that were at one place; infinite where there is
// none. The polygon is seen along `normal`, of any length. Takes the square of the number of
// corners if any moves.
double room_of(std::span<const Vec3> corners, std::span<const Vec3> steps, const Vec3& normal);

}  // namespace gliss
