#include "gliss/walk/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/build/build_cache.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/walk/fidelity.h"
#include "gliss/walk/random_places.h"

namespace gliss {
namespace {

constexpr double kAbove = 0.02;           // of the diagonal: where a walk begins
constexpr double kRise = 0.2;             // of a step: at most so far towards the depth
constexpr double kKeep = 0.98;            // of the turn a tick, ...
constexpr double kWander = 0.002;         // ... and its change, rad
constexpr double kDeepest = 3;            // depths: deeper, it is through a thin part
constexpr int kTries = 1000;              // to find a start
constexpr std::size_t kMostWalks = 1000;  // a walker
constexpr int kRound = 4000;              // ticks of a closed loop

class Walker {
 public:
  Walker(const PatchCache& base, const Places& places, double diagonal, const WalkOptions& options,
         std::size_t number)
      : base_(base),
        places_(places),
        diagonal_(diagonal),
        options_(options),
        random_(options.seed, number) {}

  std::vector<Walk> walk() {
    std::vector<Walk> walks;
    for (std::size_t ticks = options_.ticks; ticks > 0 && walks.size() < kMostWalks;) {
      ContactTracker guide(base_, kGuide);
      Walk walk;
      Contact contact;
      if (!enter(guide, walk, contact)) break;
      ticks -= slide(guide, contact, ticks, walk);
      walks.push_back(std::move(walk));
    }
    return walks;
  }

 private:
  static constexpr QueryOptions kGuide{{}, Method::kShaded, QueryOptions{}.budget, 0};

  // True if a start was found from which the guide, in the open at first, gets into contact.
  bool enter(ContactTracker& guide, Walk& walk, Contact& contact) {
    for (int i = 0; i < kTries; ++i) {
      const Vec3 place = places_.choose(random_), normal = nearest(base_, place, kGuide).normal;
      walk.hips.clear();
      guide = ContactTracker(base_, kGuide);
      bool free = true;
      for (std::size_t tick = 0; tick < Walk::kEntry && free; ++tick) {
        const double down = static_cast<double>(tick) / (Walk::kEntry - 1.0);
        const double height = kAbove * diagonal_ - down * (kAbove * diagonal_ + options_.depth);
        walk.hips.push_back(place + height * normal);
        contact = guide.tick(walk.hips.back());
        free = !contact.touching || height <= 0;
      }
      if (free && contact.touching) return true;
    }
    return false;
  }

  // Ticks that it took, until the guide loses contact, or the depth, or there are enough.
  std::size_t slide(ContactTracker& guide, Contact contact, std::size_t ticks, Walk& walk) {
    const double step = options_.step * options_.depth;
    Vec3 direction = random_.vector();
    double turn = 0;
    std::size_t taken = 0;
    while (taken < ticks && contact.touching && -contact.distance < kDeepest * options_.depth) {
      turn = kKeep * turn + kWander * random_.normal();
      direction = turned(direction, contact.normal, turn);
      if (!direction.allFinite()) break;
      const double rise =
          std::clamp(-contact.distance - options_.depth, -kRise * step, kRise * step);
      walk.hips.push_back(walk.hips.back() + step * direction + rise * contact.normal);
      contact = guide.tick(walk.hips.back());
      ++taken;
    }
    return taken;
  }

  const PatchCache& base_;
  const Places& places_;
  const double diagonal_;
  const WalkOptions& options_;
  Random random_;
};

}  // namespace

double walk_depth(const Mesh& mesh) { return 0.005 * BoxMeasure(mesh).diagonal; }

std::vector<Walk> walk_paths(const Mesh& mesh, const Topology& topology, const WalkOptions& options,
                             const ParallelFor& parallel) {
  const PlainArithmetic plain;
  const PatchCache base = build_base(mesh, topology, Precision::kDouble);
  const Places places(mesh);
  const double diagonal = BoxMeasure(mesh).diagonal;
  std::vector<std::vector<Walk>> by_walker(options.walkers);
  parallel(options.walkers, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      by_walker[i] = Walker(base, places, diagonal, options, i).walk();
  });
  std::vector<Walk> walks;
  for (std::vector<Walk>& of_walker : by_walker)
    std::move(of_walker.begin(), of_walker.end(), std::back_inserter(walks));
  return walks;
}

FeltWalks feel_walks(const PatchCache& cache, const QueryOptions& options,
                     std::span<const Walk> walks, double depth, const ParallelFor& parallel,
                     std::vector<WalkJump>* jumps) {
  std::vector<FeltWalks> felt(walks.size(), FeltWalks{ForceStatistics(depth)});
  std::vector<std::vector<double>> steps(walks.size());
  std::vector<std::vector<WalkJump>> jumps_of(jumps != nullptr ? walks.size() : 0);
  parallel(walks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ContactTracker tracker(cache, options);
      Contact before;
      for (std::size_t tick = 0; tick < walks[i].hips.size(); ++tick) {
        const Contact contact = tracker.tick(walks[i].hips[tick]);
        if (tick + 1 < Walk::kEntry) continue;
        const double step = felt[i].add(contact.touching, contact.push, is_settling(contact.flags));
        if (!std::isnan(step)) {
          steps[i].push_back(step);
          felt[i].add_beyond(step - 2 * (walks[i].hips[tick] - walks[i].hips[tick - 1]).norm());
        }
        if (jumps != nullptr && step > ForceStatistics::kJump * depth && std::isfinite(step)) {
          const Contact& at = before.touching ? before : contact;
          jumps_of[i].push_back({at.scp, at.at.face, step / depth, !contact.touching});
        }
        before = contact;
      }
    }
  });
  FeltWalks all{ForceStatistics(depth)};
  for (const FeltWalks& of_walk : felt) all.merge(of_walk);
  for (const auto& of_walk : jumps_of) jumps->insert(jumps->end(), of_walk.begin(), of_walk.end());
  std::vector<double> every;
  for (const std::vector<double>& of_walk : steps)
    every.insert(every.end(), of_walk.begin(), of_walk.end());
  all.p99_step = distances_of(std::move(every)).p99;
  return all;
}

std::vector<std::vector<Vec3>> loop_paths(const Mesh& mesh, const Topology& topology, double depth,
                                          std::size_t count, std::uint64_t seed) {
  const PatchCache base = build_base(mesh, topology, Precision::kDouble);
  const Places places(mesh);
  Random random(seed, count);
  const double width = std::sqrt(places.area() / static_cast<double>(mesh.face_count()));
  std::vector<std::vector<Vec3>> loops(count);
  for (std::size_t i = 0; i < count; ++i) {
    QueryOptions shaded;
    shaded.method = Method::kShaded;
    const Vec3 place = places.choose(random), normal = nearest(base, place, shaded).normal;
    const Vec3 across = width / 2 * normal.unitOrthogonal(), along = normal.cross(across);
    const Vec3 centre = place - depth * normal;
    for (int tick = 0; tick <= 2 * kRound; ++tick) {
      const double angle = (i % 2 == 0 ? 2 : -2) * std::numbers::pi * tick / kRound;
      loops[i].push_back(centre + std::cos(angle) * across + std::sin(angle) * along);
    }
  }
  return loops;
}

LoopGain loop_gain(const PatchCache& cache, const QueryOptions& options,
                   std::span<const std::vector<Vec3>> loops, const Poll& poll) {
  const PathLoop second{kRound, 2 * kRound};
  LoopGain largest;
  for (const std::vector<Vec3>& loop : loops) {
    poll();
    LoopMeter meter({&second, 1}, 1);
    ContactTracker tracker(cache, options);
    bool in_contact = true;
    for (const Vec3& hip : loop) {
      const Contact contact = tracker.tick(hip);
      in_contact = in_contact && contact.touching;
      meter.add(hip, contact.push);
    }
    if (in_contact && !(meter.largest().excess() <= largest.excess())) largest = meter.largest();
  }
  return largest;
}

}  // namespace gliss
