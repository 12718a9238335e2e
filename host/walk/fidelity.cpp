#include "gliss/walk/fidelity.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "gliss/mesh/sectors.h"
#include "gliss/query/contact_tracker.h"

namespace gliss {
namespace {

bool is_bent(const PatchCache& cache, std::uint32_t face) {
  return cache.kind[cache.first_patch(face)] == PatchKind::kBent;
}

constexpr double kCrease = 0.866;  // cosine of the least cosine at a crease that a path goes round

// HIPs about `step` apart, beneath a surface or, where that does not do, as high above it.
class SlidingPath {
 public:
  SlidingPath(const PatchCache& cache, bool has_creases, double depth, double step)
      : cache_(cache), has_creases_(has_creases), depth_(depth), step_(step) {}

  void add(const SurfacePoint& on) {
    const bool is_outside = has_creases_ && is_beside_crease(on);
    const Vec3 hip = on.position + (is_outside ? depth_ : -depth_) * on.normal;
    if (!hips_.empty() && (is_outside || was_outside_)) {
      const Vec3 over = last_.normal + on.normal;
      if (!was_outside_) lead_to(last_.position + depth_ * last_.normal);
      if (last_.normal.dot(on.normal) < kCrease)
        lead_to(on.position + depth_ * over.stableNormalized());
      if (!is_outside) lead_to(on.position + depth_ * on.normal);
      lead_to(hip);
    } else {
      hips_.push_back(hip);
    }
    last_ = on;
    was_outside_ = is_outside;
  }
  const std::vector<Vec3>& hips() const { return hips_; }

 private:
  // True if the surface nearest to the HIP beneath is another side, up to that across a thin part.
  bool is_beside_crease(const SurfacePoint& on) const {
    const Contact contact = nearest(cache_, on.position - depth_ * on.normal);
    const double cosine = contact.normal.dot(on.normal);
    return contact.distance > -0.9 * depth_ && cosine < kCrease && cosine > -0.5;
  }
  void lead_to(const Vec3& place) {
    const Vec3 from = hips_.back();
    const double step = std::min(step_, depth_ / 10);  // pressing in is no jump
    const auto ticks = static_cast<int>(std::max(1.0, std::ceil((place - from).norm() / step)));
    for (int i = 1; i <= ticks; ++i) hips_.push_back(from + i / double(ticks) * (place - from));
  }

  const PatchCache& cache_;
  const bool has_creases_;
  const double depth_, step_;
  std::vector<Vec3> hips_;
  SurfacePoint last_{};
  bool was_outside_ = false;
};

}  // namespace

std::vector<Vec3> path_over(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                            double depth, double step, std::size_t count) {
  std::mt19937 random(1);  // whose numbers the standard fixes; its distributions are not
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  const auto part = [&] { return 0.2 + 0.6 * (random() / 4294967296.0); };
  SlidingPath path(cache, !mesh.sharp.empty(), depth, step);
  std::uint32_t face = below(static_cast<std::uint32_t>(mesh.face_count())), enter = 0;
  double t = 0.5;
  for (int stuck = 0; path.hips().size() < count && stuck < 64;) {
    const std::uint32_t n = mesh.valence(face), first = mesh.face_begin[face];
    // Opposite, now and then any other; the way back where all others are borders.
    std::uint32_t leave = enter;
    const std::uint32_t wish = below(6) == 0 ? 1 + below(n - 1) : n / 2 + (n % 2) * below(2);
    for (std::uint32_t i = 0; i < n && leave == enter; ++i) {
      const std::uint32_t k = (enter + wish + i) % n;
      if (k != enter && topology.side_twin[first + k] != kNone) leave = k;
    }
    if (topology.side_twin[first + leave] == kNone) {  // a face by itself: another one
      face = below(static_cast<std::uint32_t>(mesh.face_count()));
      ++stuck;
      continue;
    }
    const double t_out = part();
    const DomainPoint a = on_side(face, n, enter, t), b = on_side(face, n, leave, t_out);
    // Through the centre where it leaves by the side that it came in by.
    const Eigen::Vector2d from(a.xi, a.eta), to(b.xi, b.eta),
        bow = leave == enter ? Eigen::Vector2d(-0.5 * (from + to)) : Eigen::Vector2d::Zero();
    const auto on = [&](double s) {
      const Eigen::Vector2d x = (1 - s) * from + s * to + 2 * s * (1 - s) * bow;
      return evaluate(cache, {face, x.x(), x.y()});
    };
    const auto at = [&](double s) {
      const SurfacePoint p = on(s);
      return Vec3(p.position - depth * p.normal);
    };
    double length = 0;
    constexpr int kPieces = 8;
    for (int i = 0; i < kPieces; ++i)
      length += (at((i + 1.0) / kPieces) - at(i / double{kPieces})).norm();
    const auto ticks = static_cast<std::size_t>(std::max(1.0, std::ceil(length / step)));
    for (std::size_t i = 0; i < ticks && path.hips().size() < count; ++i)
      path.add(on(static_cast<double>(i) / static_cast<double>(ticks)));
    const std::uint32_t twin = topology.side_twin[first + leave];
    face = topology.side_face[twin];
    enter = twin - mesh.face_begin[face];
    t = 1 - t_out;
  }
  std::vector<Vec3> hips = path.hips();
  hips.resize(std::min(hips.size(), count));
  return hips;
}

std::vector<DomainPoint> spread_points(const PatchCache& cache, std::size_t count) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < cache.mesh_face_count; ++f) {
    if (cache.first_patch(f) != kNone) faces.push_back(f);
  }
  const std::size_t each = std::max<std::size_t>(1, count / faces.size());
  std::mt19937 random(2);
  std::vector<DomainPoint> points;
  for (const std::uint32_t face : faces) {
    const std::uint32_t n = cache.face_valence[face];
    for (std::size_t i = 0; i < each; ++i) {
      const double r = std::sqrt(random() / 4294967296.0), t = random() / 4294967296.0;
      const DomainPoint edge = on_side(face, n, static_cast<std::uint32_t>(i % n), t);
      points.push_back({face, r * edge.xi, r * edge.eta});
    }
  }
  return points;
}

Distances distances_of(std::vector<double> d) {
  if (d.empty()) return {};
  for (double& value : d) {
    if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
  }
  const auto at = d.begin() + static_cast<std::ptrdiff_t>((d.size() - 1) * 99 / 100);
  std::nth_element(d.begin(), at, d.end());
  return {*std::max_element(at, d.end()), *at};
}

std::vector<VertexPair> rough_edges(const Mesh& mesh, const Topology& topology,
                                    const PatchCache& cache) {
  std::vector<VertexPair> edges;
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin == kNone || twin < side || mesh.is_crease(side)) continue;
    if (shares_normals(mesh, topology, side) && !is_bent(cache, topology.side_face[side]) &&
        !is_bent(cache, topology.side_face[twin]))
      continue;
    edges.push_back({mesh.corner_vertex[side], mesh.corner_vertex[twin]});
  }
  return edges;
}

Distances normal_gaps(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                      Method method) {
  constexpr int kPoints = 17;
  std::vector<double> gaps;
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin == kNone || twin < side) continue;
    const std::uint32_t f = topology.side_face[side], g = topology.side_face[twin];
    if (method == Method::kFlat) {
      gaps.push_back(angle_between(newell_normal(mesh, f), newell_normal(mesh, g)));
      continue;
    }
    if (!shares_normals(mesh, topology, side)) continue;
    // What is blended along the edge is the same on both sides: nothing jumps.
    if (method == Method::kShaded) {
      gaps.push_back(0);
      continue;
    }
    if (is_bent(cache, f) || is_bent(cache, g)) continue;
    std::vector<DomainPoint> at;
    for (int i = 0; i < kPoints; ++i) {
      const double t = i / (kPoints - 1.0);
      at.push_back(on_side(f, mesh.valence(f), side - mesh.face_begin[f], t));
      at.push_back(on_side(g, mesh.valence(g), twin - mesh.face_begin[g], 1 - t));
    }
    std::vector<SurfacePoint> points(at.size());
    evaluate(cache, at, points);
    for (std::size_t i = 0; i < points.size(); i += 2)
      gaps.push_back(angle_between(points[i].normal, points[i + 1].normal));
  }
  return distances_of(std::move(gaps));
}

FeltPath feel_path(const PatchCache& cache, const QueryOptions& options, std::span<const Vec3> path,
                   double depth, std::span<const Vec3> reference, const Poll& poll) {
  using Clock = std::chrono::steady_clock;
  FeltPath result;
  result.force = ForceStatistics(depth);
  std::vector<double> steps, errors;
  ContactTracker tracker(cache, options);
  std::vector<double> ticks;
  ticks.reserve(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (poll && i % 256 == 0) poll();
    const auto start = Clock::now();
    const Contact contact = tracker.tick(path[i]);
    ticks.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    const double step =
        result.force.add(contact.touching, contact.push, is_settling(contact.flags));
    if (!std::isnan(step)) steps.push_back(step);
    result.push.push_back(contact.push);
    if (!reference.empty()) errors.push_back((contact.push - reference[i]).norm());
  }
  result.p99_step = distances_of(std::move(steps)).p99;
  result.error = distances_of(std::move(errors));
  if (ticks.empty()) return result;
  const auto middle = ticks.begin() + static_cast<std::ptrdiff_t>(ticks.size() / 2);
  std::nth_element(ticks.begin(), middle, ticks.end());
  result.median_tick = *middle;
  return result;
}

}  // namespace gliss
