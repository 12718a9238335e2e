// How far the surface over a triangle is from its plane. Private to host/.
#pragma once

#include "gliss/base/vector.h"

namespace gliss {

// The part that a corner with this unit normal has in it: a point of the plane is `from` that
// corner, and has that share of it. All three parts are subtracted from the point. So it is as far
// from the plane as an arc with these normals: by half of its projections to the tangent planes
// (Boubekeur and Alexa 2008, Phong tessellation).
inline Vec3 phong_step(const Vec3& from, const Vec3& normal, double share) {
  return 0.5 * share * normal * normal.dot(from);
}

}  // namespace gliss
