#include "gliss/walk/leaving_walk.h"

#include <algorithm>
#include <cmath>

#include "gliss/build/build_cache.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/walk/random_places.h"

namespace gliss {
namespace {

// Lengths are shares of the diagonal.
constexpr double kHandAbove = 0.02;                   // where a hand begins
constexpr double kSlowest = 5e-5, kLeast = 5e-4;      // a tick; deep
constexpr double kOctaves = 8.64;                     // from these to 400 times as much
constexpr double kLeastClear = 1e-4, kClears = 9.97;  // octaves: 1,000 times
constexpr double kSlides = 5.32, kLongestSlide = 0.5;
constexpr double kLeastSlide = 10, kMostTicks = 3000;
constexpr double kAslant = 2;                           // tangent of an angle
constexpr double kTurnKept = 0.98, kTurnChange = 0.01;  // of the turn a tick, and its change, rad
constexpr double kMarch = 1e-3;                         // step of a search for the open
constexpr int kMarches = 64;

class Hand {
 public:
  Hand(const PatchCache& base, const Mesh& mesh, const Places& places, const BoxMeasure& box,
       Random random)
      : base_(base), mesh_(mesh), places_(places), box_(box), random_(random) {}

  std::vector<Vec3> path(std::size_t rest) {
    aim();
    const double deep = depth();
    hips_.push_back(place_ - kHandAbove * box_.diagonal * press_);
    go_to(place_ + deep * press_, speed());
    // Exactly central ones go straight, half of them.
    if (!(is_central_ && random_.uniform() < 0.5) && random_.uniform() < 0.8) slide(speed());
    leave(speed());
    hips_.insert(hips_.end(), rest, Vec3(hips_.back()));
    return std::move(hips_);
  }

 private:
  // Chooses the place on the surface and the direction of the press.
  void aim() {
    const double kind = random_.uniform();
    is_central_ = kind < 0.3;
    const bool at_vertex = kind >= 0.075 && kind < 0.225;
    place_ = places_.choose(random_);
    const auto vertex =
        static_cast<std::size_t>(random_.uniform() * static_cast<double>(mesh_.positions.size()));
    if (at_vertex) place_ = mesh_.positions[vertex];
    const Vec3 normal = nearest(base_, place_, kShaded).normal;
    const double aslant = random_.uniform() < 0.5 ? 0 : kAslant * random_.uniform();
    const Vec3 across = random_.vector().cross(normal).normalized();
    if (kind < 0.15) {
      press_ = (box_.middle - place_).normalized();
    } else if (kind < 0.225) {
      press_ = -normal_at(vertex);
    } else if (kind < 0.3) {
      press_ = (random_.uniform() < 0.5 ? 1 : -1) *
               Vec3::Unit(static_cast<Eigen::Index>(3 * random_.uniform()));
      place_ = box_.middle + way_out(box_.middle, -press_, 0) * -press_;
    } else {
      press_ = (aslant * across - normal).normalized();
    }
    if (!press_.allFinite()) press_ = Vec3::UnitX();
  }

  // The mean of a vertex's normals: along one of them a hand would go within the plane of a face,
  // neither inside nor outside.
  Vec3 normal_at(std::size_t vertex) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < mesh_.corner_vertex.size(); ++c) {
      if (mesh_.corner_vertex[c] == vertex) sum += mesh_.normals[mesh_.corner_normal[c]];
    }
    return sum.normalized();
  }

  double depth() {
    const double kind = random_.uniform(), share = random_.uniform(),
                 deep = random_.size(kLeast, kOctaves) * box_.diagonal;
    if (kind < 0.75) return deep;
    const double through = way_out(place_ + kLeast * box_.diagonal * press_, press_, 0);
    return (kind < 0.875 ? share : 1) * through + kLeast * box_.diagonal;
  }

  void slide(double speed) {
    const double most = kLongestSlide * box_.diagonal / speed;
    const double ticks = std::min(most, random_.size(kLeastSlide, kSlides));
    Vec3 along = random_.vector();
    double turn = 0;
    for (int tick = 0; tick < ticks; ++tick) {
      turn = kTurnKept * turn + kTurnChange * random_.normal();
      along = turned(along, press_, turn);
      hips_.emplace_back(hips_.back() + speed * along);
    }
  }

  void leave(double speed) {
    const double kind = random_.uniform();
    const Vec3 any = random_.vector().normalized(), from = hips_.back();
    const Vec3 out = kind < 0.35 ? Vec3(-press_) : kind < 0.7 ? press_ : any;
    const double clear = random_.size(kLeastClear, kClears) * box_.diagonal;
    go_to(from + way_out(from, out, clear) * out, speed);
  }

  // How far it is to where the base mesh is `clear` away, or the whole box.
  double way_out(const Vec3& from, const Vec3& direction, double clear) const {
    const double most = (from - box_.middle).norm() + box_.diagonal / 2 + clear;
    double at = 0;
    for (int i = 0; i < kMarches && at < most; ++i) {
      const Contact found = nearest(base_, from + at * direction, kFlat);
      if (found.distance >= clear) return at;
      at += std::max(kMarch * box_.diagonal, std::abs(found.distance));
    }
    return most;
  }

  double speed() { return random_.size(kSlowest, kOctaves) * box_.diagonal; }

  void go_to(const Vec3& to, double speed) {
    const Vec3 from = hips_.back(), way = to - from;
    const double ticks = std::clamp(std::ceil(way.norm() / speed), 1.0, kMostTicks);
    for (double tick = 1; tick <= ticks; ++tick)
      hips_.emplace_back(tick < ticks ? Vec3(from + tick / ticks * way) : to);
  }

  static constexpr QueryOptions kShaded{{}, Method::kShaded}, kFlat{{}, Method::kFlat};

  const PatchCache& base_;
  const Mesh& mesh_;
  const Places& places_;
  const BoxMeasure& box_;
  Random random_;
  Vec3 place_ = Vec3::Zero(), press_ = Vec3::Zero();
  bool is_central_ = false;
  std::vector<Vec3> hips_;
};

// Other numbers than those of the walks with the same seed.
constexpr std::uint64_t kHands = std::uint64_t{1} << 40;

}  // namespace

std::vector<std::vector<Vec3>> leaving_paths(const Mesh& mesh, const Topology& topology,
                                             const LeavingOptions& options,
                                             const ParallelFor& parallel) {
  if (options.hands == 0) return {};
  const PatchCache base = build_base(mesh, topology, Precision::kDouble);
  const Places places(mesh);
  const BoxMeasure box(mesh);
  std::vector<std::vector<Vec3>> hands(options.hands);
  parallel(options.hands, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      hands[i] = Hand(base, mesh, places, box, Random(options.seed, kHands + i)).path(options.rest);
  });
  return hands;
}

HeldContacts feel_leaving(const PatchCache& cache, const QueryOptions& options,
                          std::span<const std::vector<Vec3>> hands, const ParallelFor& parallel) {
  std::vector<HeldContacts> of_hand(hands.size());
  parallel(hands.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      QueryOptions leaping = options;
      leaping.settle = 0;
      ContactTracker tracker(cache, options), beneath(cache, leaping);
      HeldOutsideCounter counter(cache, options);
      for (const Vec3& hip : hands[i]) counter.add(hip, tracker.tick(hip), beneath.tick(hip));
      of_hand[i] = counter.count();
    }
  });
  HeldContacts all;
  for (const HeldContacts& one : of_hand) all.merge(one);
  return all;
}

}  // namespace gliss
