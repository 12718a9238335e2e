// The same work done by other libraries, where they are installed: on our quads, at our points, in
// float.
#pragma once

#include <vector>

#include "bench/samples.h"
#include "bench/work.h"
#include "gliss/mesh/mesh.h"

namespace gliss::bench {

#ifdef GLISS_WITH_OPENSUBDIV
inline constexpr bool kOpenSubdiv = true;
#else
inline constexpr bool kOpenSubdiv = false;
#endif
#ifdef GLISS_WITH_EMBREE
inline constexpr bool kEmbree = true;
#else
inline constexpr bool kEmbree = false;
#endif

// Positions and both derivatives of the Catmull-Clark surface of a mesh of quads, at the points of
// a call (samples.h). Its patches are Gregory's where a corner is not of four faces: Osd's
// CpuEvaluator without subdivision. It finds the patches of the points in each call, as we do.
Work opensubdiv_evaluate(const Mesh& quads, Order order);
// The same by rtcInterpolateN, its irregular patches in a cache that holds them all.
Work embree_evaluate(const Mesh& quads, Order order);
// The nearest point of triangles to each HIP, by rtcPointQuery.
Work embree_nearest(const Mesh& triangles, const std::vector<Vec3>& hips);

}  // namespace gliss::bench
