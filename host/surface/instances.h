// The kernels as functions over arrays, compiled for several instruction sets; the machine's best
// is picked once. Private to host/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/surface/arrays.h"
#include "gliss/surface/contact.h"
#include "gliss/surface/surface.h"

namespace gliss {

template <class Real>
struct TrackOptions {
  Solver solver = Solver::kNewton;
  int max_iterations = 0;
  // Length of the last step relative to the size of the patch (paper: residual angle).
  Real tolerance = 0;
  int budget = 0;  // evaluations after which a search begins no further descent; 0: no limit
};

// A HIP of the mesh frame as high and low part: their sum.
template <class Real>
struct RawHip {
  Real parts[6];
};

// An edge from a vertex, as the fair construction sees it (kernels/fair.h): that and its far end
// (position, unit normal), tangents at both ends of a crease or zeros, and if other tangents have
// an arc's length.
template <class Real>
struct FairEdge {
  Real start[6] = {}, end[6] = {};
  Real tangents[6] = {};
  Real by_arc = {};  // 0 or 1
};

// The shape operator of a vertex: xx, xy and yy in two unit tangents; and the length of the
// shortest side that it was fit to.
template <class Real>
struct FairVertex {
  Real x[3] = {}, y[3] = {}, shape[3] = {}, reach = {};
};

// A side of a face, and the vertices of its ends. These bend it (`bends` is 1 and not 0), or tell
// how its normal turns (`turns`), as between two quads, and no more.
template <class Real>
struct FairSide {
  FairEdge<Real> edge;
  FairVertex<Real> from, to;
  Real bends = {}, has_mid_normal = {};
  Real twist_share = {};  // of the most that its normals may turn for them, 0 to 1
};

// Where the mesh frame lies in the mesh: PatchCache's origin, and 1 / its scale.
struct MeshPlacement {
  double origin[3];
  double per;
};

// The nine rows of points that evaluation gave, `stride` numbers apart, the patch of each, and
// where in columns they go.
template <class Real>
struct EvaluatedPoints {
  const Real* rows;
  std::size_t stride, count;
  const std::uint32_t* patch;         // of point i: patch[i * patch_step]
  std::size_t patch_step;             // 0: all are of one
  std::size_t first;                  // point i goes to first + i,
  const std::uint32_t* at = nullptr;  // or first + at[i]

  const Real* row(std::size_t r) const { return rows + r * stride; }
  std::uint32_t patch_of(std::size_t i) const { return patch[i * patch_step]; }
  std::size_t target(std::size_t i) const { return first + (at == nullptr ? i : at[i]); }
  // Takes the targets of the points behind the next `many`.
  void move_target(std::size_t many) {
    if (at == nullptr)
      first += many;
    else
      at += many;
  }
  EvaluatedPoints from(std::size_t begin, std::size_t many) const {
    EvaluatedPoints some = *this;
    some.rows += begin;
    some.count = many;
    some.patch += begin * patch_step;
    some.move_target(begin);
    return some;
  }
};

template <class Real>
struct Kernels {
  const char* isa;
  int lanes;
  // Numbers of the table of a valence, written at `table` (domain_reals(n) of them).
  std::size_t (*domain_reals)(std::uint32_t n);
  void (*fill_domain)(std::uint32_t n, Real* table);
  // Where patches of a valence are examined: rings from the centre to the sides, `probe_levels` of
  // them. The table has `probe_reals` numbers for `probe_count` points. The first `probe_coarse`,
  // or none, are enough for a gentle patch. Point i of ring 1 and on stands at `probe_place`.
  std::uint32_t (*probe_levels)(std::uint32_t n);
  std::uint32_t (*probe_coarse)(std::uint32_t n);
  std::uint32_t (*probe_place)(std::uint32_t n, std::uint32_t ring, std::uint32_t i);
  std::uint32_t (*probe_count)(std::uint32_t n);
  std::size_t (*probe_reals)(std::uint32_t n);
  void (*fill_probes)(std::uint32_t n, const Real* domain, Real* table);
  // The numbers of a table from which second derivatives at the probes are made, in the forms that
  // have them; 0: none. fill_second makes it.
  std::size_t (*second_reals)(std::uint32_t form, std::uint32_t n);
  void (*fill_second)(const Real* domain, std::uint32_t form, std::uint32_t n, const Real* probes,
                      Real* table);
  // Control data [count][n][kSideReals] of polygons from their corners [count][n][2][3] (position,
  // unit normal); the soundness [count] of their weakest ribbons: 0 where an edge is parallel to a
  // normal, 1 at right angles.
  void (*build_patches)(const Real* corners, std::uint32_t n, std::size_t count, Real* control,
                        Real* soundness);
  // The same of one polygon beside creases, whose sides may have tangents [n][2][3] of their own:
  // C'(0) and C'(1), or zeros. Returns its soundness.
  Real (*build_sharp_patch)(const Real* corners, const Real* tangents, std::uint32_t n,
                            Real* control);
  // Shortens the cross tangents to (1 - ease) of their length at mid-side.
  void (*ease_patch)(Real* control, std::uint32_t n, Real ease);
  // Turns the cross tangents into the plane across `normal` (unit, 3 numbers).
  void (*flatten_tangents)(Real* control, std::uint32_t n, const Real* normal);
  // Numbers of a patch's control data in a form, and these from those of another one: ribbon and
  // bezier (of 3 and 4 sides) from the exact ones; of a table one corner's part, from any.
  std::size_t (*control_reals)(std::uint32_t form, std::uint32_t n);
  void (*to_form)(const Real* corners, const Real* control, std::uint32_t form, std::uint32_t n,
                  Real* out);
  void (*to_table)(const Real* domain, const Real* control, std::uint32_t from, std::uint32_t form,
                   std::uint32_t n, std::uint32_t corner, Real* out);
  // The fair construction, in any frame, in double only. The shape operators of vertices from the
  // edges that leave them, two at least each: those of vertex i are edges[begin[i]] to
  // edges[begin[i + 1] - 1].
  void (*fair_vertices)(const FairEdge<Real>* edges, const std::uint32_t* begin, std::size_t count,
                        FairVertex<Real>* out);
  // Sides, [count][kFairReals].
  void (*fair_sides)(const FairSide<Real>* sides, std::size_t count, Real* out);
  // Control data from the sides [count][n][kFairReals] of triangles (FORM_SEXTIC), quads
  // (FORM_BEZIER) or other polygons (FORM_CURVED). `inward_share` [count]: the least share of a
  // cross tangent that points into the face, 0 or less where the patch doubles back. `flat`, of
  // triangles and quads: null, or a unit normal that the cross tangents shall lie across, `length`
  // times as long.
  void (*fair_controls)(const Real* sides, std::size_t count, std::uint32_t n, const Real* flat,
                        Real length, Real* control, Real* inward_share);
  // G, G_xi, G_eta as nine rows of `stride` numbers, at `count` points of one patch.
  void (*evaluate)(const Real* domain, const Real* control, std::uint32_t form, std::uint32_t n,
                   const Real* xi, const Real* eta, std::size_t count, std::size_t stride,
                   Real* out);
  // The same at a point of each of `patch`[count], patch by patch: out[row * stride + i].
  void (*evaluate_each)(const Surface<Real>&, const std::uint32_t* patch, const Real* xi,
                        const Real* eta, std::size_t count, std::size_t stride, Real* out);
  // Such rows as points in the mesh's unit.
  void (*place_double)(const Surface<Real>&, const MeshPlacement&, const EvaluatedPoints<Real>&,
                       const SurfaceArrays<double>& out);
  void (*place_float)(const Surface<Real>&, const MeshPlacement&, const EvaluatedPoints<Real>&,
                      const SurfaceArrays<float>& out);
  // Samples a patch and gives its shape, kShapeReals numbers, from its base polygon's corners and
  // triangles, its frame (unit normal and tangent) and its control data; `count` probes, or none
  // for the base polygon alone. `coarse`: how many are enough for a gentle patch, or 0. `table`:
  // null, or that of the form's second derivatives. `rows`: null, or room for samples as `sample`
  // makes them of the probes.
  void (*examine)(const Real* domain, const Real* probes, std::uint32_t coarse, std::uint32_t count,
                  const Real* control, std::uint32_t form, const Real* corners,
                  const std::uint32_t* triangles, const Real* frame, std::uint32_t n,
                  const Real* table, Real* rows, Real* shape);
  // In double only, null else: a patch is cut into tiles (kernels/cut.h) from samples at `count`
  // points along its frame: rows [kCutRows][count]. Counts of samples and tiles are multiples of
  // kCutPad. Returns the largest squared length of G_xi and G_eta.
  Real (*sample)(const Real* domain, const Real* control, std::uint32_t form, const Real* frame,
                 std::uint32_t n, const Real* xi, const Real* eta, std::uint32_t count, Real* rows);
  // The least cosine between a normal of a tile and their mean; index [points][tiles]: samples.
  Real (*least_cosine)(const Real* rows, std::uint32_t stride, const std::uint32_t* index,
                       std::uint32_t points, std::uint32_t tiles);
  // Tiles, from samples [points][tiles], kCutRings or kCutFewRings of them to a side: rows
  // [kCutOutRows][tiles], the first kTileUints of them their words. `transforms` [8][tiles]; box:
  // low and high. Returns the largest curvature, `curvature` at least; relative to one, add_curves
  // then completes the words.
  Real (*cut)(const Real* rows, std::uint32_t stride, const std::uint32_t* index,
              std::uint32_t rings, const Real* transforms, std::uint32_t tiles, const Real* box,
              Real stretch2, Real curvature, Real* out);
  void (*add_curves)(Real* out, std::uint32_t tiles, Real curvature);
  // Surface normal (not unit) along side data at t: n_c of eq. 10.
  void (*side_normal)(const Real* side, Real t, Real* out);
  // Global: the nearest point of each of `count` HIPs for each of the methods, which share the
  // search of the base polygons: out[hip][method].
  void (*nearest)(const Surface<Real>&, const Method* methods, std::size_t method_count,
                  const TrackOptions<Real>&, const RawHip<Real>* hips, std::size_t count,
                  RawContact<Real>* out);
  // Local: what each state became after its HIP moved; tick is Algorithm 1, track follows whatever
  // the state.
  void (*track)(const Surface<Real>&, Method, const TrackOptions<Real>&, const RawHip<Real>* hips,
                std::size_t count, RawContact<Real>* states);
  void (*tick)(const Surface<Real>&, Method, const TrackOptions<Real>&, const RawHip<Real>& hip,
               RawContact<Real>* state);
};

// The kernels for the machine's best instruction set, or for the one that the environment variable
// GLISS_ISA names (baseline, v3, v4). Throws std::invalid_argument where that names none of them.
template <class Real>
const Kernels<Real>& kernels();
template <>
GLISS_EXPORT const Kernels<float>& kernels<float>();
template <>
GLISS_EXPORT const Kernels<double>& kernels<double>();

// Adds the table of a valence to those in `domain`.
template <class Real>
void append_domain(std::uint32_t n, std::vector<Real>& domain, std::vector<std::uint32_t>& begin) {
  begin[n] = static_cast<std::uint32_t>(domain.size());
  domain.resize(domain.size() + kernels<Real>().domain_reals(n));
  kernels<Real>().fill_domain(n, &domain[begin[n]]);
}

}  // namespace gliss
