#include "gliss/walk/fidelity.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "gliss/base/median.h"
#include "gliss/mesh/sectors.h"
#include "gliss/query/contact_tracker.h"

namespace gliss {
namespace {

bool is_bent(const PatchCache& cache, std::uint32_t face) {
  return cache.kind[cache.first_patch(face)] == PatchKind::kBent;
}

constexpr double kCrease = 0.866;  // cosine of the least turn at a crease that a path goes round
constexpr double kLeastDepth = 0.9, kMostDepth = 1.1;  // of a contact on a path, of its depth

// HIPs about `step` apart, beneath a surface or, where that does not do, as high above it. A hand
// that follows them without settling feels no contact that is deeper.
class SlidingPath {
 public:
  SlidingPath(const PatchCache& cache, double depth, double step, const Poll& poll)
      : cache_(cache), depth_(depth), step_(step), poll_(poll), hand_(cache, leaping()) {}

  // Goes on to beneath a point of the surface, or above it. False, and nothing changes, where a
  // hand can be in neither place.
  bool add(const SurfacePoint& on) {
    if (!is_beside_crease(on) && go(on, false)) return true;
    return go(on, true);
  }
  const std::vector<Vec3>& hips() const { return hips_; }

  // A place that a path has come to, and can go back to.
  struct Place {
    std::size_t ticks;
    SurfacePoint on;
    bool outside;
    ContactTracker hand;
  };
  Place place() const { return {hips_.size(), last_, was_outside_, hand_}; }
  void go_back(const Place& place) {
    hips_.resize(place.ticks);
    last_ = place.on;
    was_outside_ = place.outside;
    hand_ = place.hand;
  }

 private:
  static QueryOptions leaping() {
    QueryOptions options;
    options.settle = 0;
    return options;
  }
  // True if the surface nearest to the HIP beneath is another side of an edge, and not the far side
  // of a thin part.
  bool is_beside_crease(const SurfacePoint& on) const {
    const Contact contact = nearest(cache_, on.position - depth_ * on.normal);
    const double cosine = contact.normal.dot(on.normal);
    return contact.distance > -kLeastDepth * depth_ && cosine < kCrease && cosine > -0.5;
  }
  Vec3 above(const SurfacePoint& on) const { return on.position + depth_ * on.normal; }

  bool go(const SurfacePoint& on, bool outside) {
    const Place from = place();
    const Vec3 hip = outside ? above(on) : on.position - depth_ * on.normal;
    bool goes = true;
    if (!hips_.empty() && (outside || was_outside_)) {
      const Vec3 over = last_.normal + on.normal;
      if (!was_outside_) goes = press_to(above(last_));
      if (last_.normal.dot(on.normal) < kCrease)
        goes = goes && lead_to(on.position + depth_ * over.stableNormalized());
      goes = goes && lead_to(above(on));
      if (!outside) goes = goes && press_to(hip);
    } else if (!hips_.empty() && (hip - hips_.back()).norm() > 2 * step_) {
      goes = lead_to(hip);
    } else if (goes = tick(hip); hips_.size() == 1 && !outside && !is_as_deep()) {
      go_back(from);  // nearer to the other side of a thin part: comes in from here
      tick(above(on));
      goes = press_to(hip);
    }
    if (!goes || hand_.touching() == outside) {
      go_back(from);
      return false;
    }
    last_ = on;
    was_outside_ = outside;
    return true;
  }
  // False where the contact is too deep.
  bool tick(const Vec3& hip) {
    poll_();
    hips_.push_back(hip);
    felt_depth_ = -hand_.tick(hip).distance;
    return !(felt_depth_ > kMostDepth * depth_);
  }
  bool is_as_deep() const { return felt_depth_ > kLeastDepth * depth_; }
  bool lead_to(const Vec3& place) { return go_straight(place, step_); }
  // Pressing in and letting go is no jump.
  bool press_to(const Vec3& place) { return go_straight(place, std::min(step_, depth_ / 10)); }
  bool go_straight(const Vec3& place, double step) {
    const Vec3 from = hips_.back();
    const double ticks = std::max(1.0, std::ceil((place - from).norm() / step));
    for (double i = 1; i <= ticks; ++i) {
      if (!tick(from + i / ticks * (place - from))) return false;
    }
    return true;
  }

  const PatchCache& cache_;
  const double depth_, step_;
  const Poll& poll_;
  ContactTracker hand_;
  double felt_depth_ = 0;  // of the hand's last tick
  std::vector<Vec3> hips_;
  SurfacePoint last_{};
  bool was_outside_ = false;
};

// A way over a face: in by a side and out by one, at `t` of them.
struct WayOver {
  std::uint32_t face, enter, leave;
  double t_in, t_out;
};

// Goes over a face, up to `count` HIPs in all. False, and nothing changes, where a hand cannot.
bool go_over(const PatchCache& cache, const WayOver& way, double depth, double step,
             std::size_t count, SlidingPath& path) {
  const std::uint32_t n = cache.face_valence[way.face];
  const DomainPoint a = on_side(way.face, n, way.enter, way.t_in),
                    b = on_side(way.face, n, way.leave, way.t_out);
  // Through the centre where it leaves by the side that it came in by.
  const Eigen::Vector2d from(a.xi, a.eta), to(b.xi, b.eta),
      bow = way.leave == way.enter ? Eigen::Vector2d(-0.5 * (from + to)) : Eigen::Vector2d::Zero();
  const auto on = [&](double s) {
    const Eigen::Vector2d x = (1 - s) * from + s * to + 2 * s * (1 - s) * bow;
    return evaluate(cache, {way.face, x.x(), x.y()});
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
  const SlidingPath::Place begin = path.place();
  for (std::size_t i = 0; i < ticks && path.hips().size() < count; ++i) {
    if (path.add(on(static_cast<double>(i) / static_cast<double>(ticks)))) continue;
    path.go_back(begin);
    return false;
  }
  return true;
}

// Goes to the end of a path and back again, until there are `count` HIPs.
std::vector<Vec3> to_and_fro(const std::vector<Vec3>& path, std::size_t count) {
  std::vector<Vec3> hips;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t last = path.size() - 1, at = last == 0 ? 0 : i % (2 * last);
    hips.push_back(path[std::min(at, 2 * last - at)]);
  }
  return hips;
}

}  // namespace

std::vector<Vec3> path_over(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                            double depth, double step, std::size_t count, const Poll& poll) {
  constexpr int kMostTries = 64;          // faces that a path may begin on
  constexpr std::uint32_t kMostWays = 8;  // out of a face, the way back not counted
  std::mt19937 random(1);  // whose numbers the standard fixes; its distributions are not
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  const auto part = [&] { return 0.2 + 0.6 * (random() / 4294967296.0); };
  SlidingPath path(cache, depth, step, poll);
  WayOver way{below(static_cast<std::uint32_t>(mesh.face_count())), 0, 0, 0.5, 0};
  for (int stuck = 0; path.hips().size() < count && stuck < kMostTries;) {
    const std::uint32_t n = mesh.valence(way.face), first = mesh.face_begin[way.face];
    // Opposite, now and then any other; the way back where no hand gets by any other.
    const std::uint32_t wish = below(6) == 0 ? 1 + below(n - 1) : n / 2 + (n % 2) * below(2);
    const auto leads_on = [&](std::uint32_t k) { return topology.side_twin[first + k] != kNone; };
    std::vector<std::uint32_t> ways;
    for (std::uint32_t i = 0; i < n && ways.size() < kMostWays; ++i) {
      const std::uint32_t k = (way.enter + wish + i) % n;
      if (k != way.enter && leads_on(k)) ways.push_back(k);
    }
    if (leads_on(way.enter)) ways.push_back(way.enter);
    if (!ways.empty()) way.t_out = part();
    const bool goes = std::any_of(ways.begin(), ways.end(), [&](std::uint32_t k) {
      way.leave = k;
      return go_over(cache, way, depth, step, count, path);
    });
    if (!goes) {
      if (!path.hips().empty()) break;
      way.face = below(static_cast<std::uint32_t>(mesh.face_count()));
      ++stuck;
      continue;
    }
    const std::uint32_t twin = topology.side_twin[first + way.leave];
    way.face = topology.side_face[twin];
    way.enter = twin - mesh.face_begin[way.face];
    way.t_in = 1 - way.t_out;
  }
  if (path.hips().empty())
    throw std::invalid_argument(
        "no path: every edge of the mesh is a border, or no hand gets so deep");
  return to_and_fro(path.hips(), count);
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
  result.median_tick = median(std::move(ticks));
  return result;
}

}  // namespace gliss
