// Tracking along paths whose contact is known at every tick: how far it is off with four steps of
// Newton's method, and that a closed path gives its force back.
#include <array>

#include "gliss/engine/engine.h"
#include "gliss/mesh/regions.h"
#include "gliss/query/contact_tracker.h"
#include "tests/extremes/surface_walk.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Extreme, test::Legs;

using Names = std::vector<const char*>;
const Names kRoundNames{"knot", "torus", "goldberg", "banana", "sphere"},
    kSharpNames{"fin", "fans"};

const char* const kStops =
    "where the second derivatives jump, at sides and corners, the solver's last step is not small";

struct Loop {
  const char* name;
  Legs (*legs)(Rng&, const Extreme&);
  // Values that are reached where they are more than the goal.
  double after_four = 1e-6, back = 1e-9, back_sharp = 1e-9, error = 1e-9, back_open = 1e-9;
  double after_four_fair = 1e-6, back_fair = 1e-9, error_fair = 1e-9;
  const char* why = kStops;
};

std::uint32_t any_side(Rng& rng, const Extreme& e) {
  return static_cast<std::uint32_t>(rng() % e.mesh.corner_vertex.size());
}
Legs over_faces(Rng& rng, const Extreme& e) { return test::wander(rng, e, 12); }
Legs round_a_vertex(Rng& rng, const Extreme& e) {
  const double part = std::pow(10, uniform(rng, -3, -0.3));
  return test::round_vertex(e, any_side(rng, e), part);
}
Legs through_a_vertex(Rng& rng, const Extreme& e) {
  return test::through_vertex(e, any_side(rng, e));
}
Legs along_edges(Rng& rng, const Extreme& e) {
  return test::round_face(e, e.topology.side_face[any_side(rng, e)]);
}

// The faces that a loop touches: at an edge or a corner its contacts are theirs as well.
std::vector<std::uint32_t> faces_at(const Extreme& e, const Legs& legs) {
  std::vector<std::uint32_t> on;
  for (const test::Leg& leg : legs) on.push_back(leg.face);
  return faces_touching(e.mesh, e.topology, on);
}

// The least radius of curvature of their patches.
double rho_of(const Extreme& e, const Legs& legs) {
  double rho = std::numeric_limits<double>::infinity();
  for (const std::uint32_t face : faces_at(e, legs)) rho = std::min(rho, e.rho_of(face));
  return rho;
}

// True if a loop touches a face that gave up its normals: at its creases no contact is known.
bool touches_bent(const Extreme& e, const Legs& legs) {
  const std::vector<std::uint32_t> faces = faces_at(e, legs);
  return std::any_of(faces.begin(), faces.end(), [&](std::uint32_t face) {
    return test::kind_of(e.cache, face) == PatchKind::kBent;
  });
}

struct Tracked {
  std::vector<float> errors;  // of size
  double back = 0;            // force at the end from that at the start, of k depth
  std::uint64_t flagged = 0, loops = 0;
  std::string worst;  // the loop of `back`

  void add(const Tracked& other) {
    errors.insert(errors.end(), other.errors.begin(), other.errors.end());
    if (!(other.back <= back)) back = other.back, worst = other.worst;
    flagged += other.flagged, loops += other.loops;
  }
  double share(double of) const {
    return static_cast<double>(errors[std::min(
        errors.size() - 1, static_cast<std::size_t>(of * static_cast<double>(errors.size())))]);
  }
};

Tracked follow(const Extreme& e, const Loop& loop, const QueryOptions& options,
               std::uint64_t seed) {
  Rng rng(seed);
  Legs legs = loop.legs(rng, e);
  while (touches_bent(e, legs)) legs = loop.legs(rng, e);
  const double depth = uniform(rng, 0.02, 0.25) * rho_of(e, legs);
  const std::vector<SurfacePoint> feet = test::points_along(e, legs, 0.0012 * e.size);
  ContactTracker tracker(e.cache, options);
  if (e.topology.border_side_count == 0) {
    tracker.tick(feet[0].position + 0.1 * depth * feet[0].normal);
  } else {  // in contact already: through the very rim a HIP may come in or pass behind
    tracker.track(feet[0].position - depth * feet[0].normal,
                  {legs[0].face, legs[0].from.x(), legs[0].from.y()});
  }
  Tracked tracked;
  Vec3 first = Vec3::Zero(), last = Vec3::Zero();
  for (const SurfacePoint& foot : feet) {
    const Contact contact = tracker.tick(foot.position - depth * foot.normal);
    tracked.errors.push_back(static_cast<float>((contact.scp - foot.position).norm() / e.size));
    tracked.flagged += !(contact.flags & kConverged);
    if (&foot == &feet[0]) first = contact.push;
    last = contact.push;
  }
  tracked.back = (last - first).norm() / depth;
  tracked.loops = 1;
  tracked.worst = fmt::format("{}, seed {}, {} ticks", e.name, seed, feet.size());
  return tracked;
}

// Loops on some meshes until they have so many ticks.
Tracked follow_loops(const Loop& loop, const Names& meshes, const QueryOptions& options,
                     std::uint64_t ticks) {
  constexpr std::size_t kAtOnce = 16;
  const auto engine = make_tbb_engine();
  Tracked all;
  for (const char* name : meshes) {
    const Extreme& e = test::extreme(name);
    Tracked of_mesh;
    for (std::uint64_t seed = 1; of_mesh.errors.size() < ticks / meshes.size(); seed += kAtOnce) {
      std::array<Tracked, kAtOnce> some;
      engine->for_each(kAtOnce, 1, [&](std::size_t i, std::size_t) {
        some[i] = follow(e, loop, options, seed + i);
      });
      for (const Tracked& one : some) of_mesh.add(one);
    }
    std::sort(of_mesh.errors.begin(), of_mesh.errors.end());
    test::record(std::string(loop.name) + " " + name,
                 "{} ticks, {} loops, error p99.9 {:.2g}, worst {:.2g} of size; force back to "
                 "{:.2g} ({}); {} flagged",
                 of_mesh.errors.size(), of_mesh.loops, of_mesh.share(0.999), of_mesh.errors.back(),
                 of_mesh.back, of_mesh.worst, of_mesh.flagged);
    all.add(of_mesh);
  }
  std::sort(all.errors.begin(), all.errors.end());
  return all;
}

void PrintTo(const Loop& loop, std::ostream* out) { *out << loop.name; }

class ExtremeTracking : public ::testing::TestWithParam<Loop> {};

TEST_P(ExtremeTracking, follows_with_four_steps_of_newton) {
  QueryOptions options;
  options.max_iterations = 4;
  Names paper = kRoundNames;
  paper.insert(paper.end(), kSharpNames.begin(), kSharpNames.end());
  const Loop& loop = GetParam();
  const struct {
    const char* name;
    const Names& meshes;
    double reached;
    std::uint64_t few;
  } parts[] = {{"", paper, loop.after_four, 30'000},
               {", fair parts", test::kFairExtremes, loop.after_four_fair, 15'000}};
  for (const auto& [name, meshes, reached, few] : parts) {
    const Tracked found = follow_loops(loop, meshes, options, test::samples(few, 1'000'000));
    test::hold({"Tracking",
                fmt::format("4 Newton steps, 0.12 % of size a tick, {}{}: p99.9 of the contact "
                            "point's error, of size",
                            loop.name, name),
                1e-6, reached, "the steps go to one patch and the next in turn"},
               found.share(0.999), found.errors.size());
  }
}

TEST_P(ExtremeTracking, gives_the_force_back_on_closed_paths) {
  const Loop& loop = GetParam();
  const struct {
    const char* name;
    const Names& meshes;
    double back, error;
  } parts[] = {{"", kRoundNames, loop.back, loop.error},
               {", sharp parts", kSharpNames, loop.back_sharp, loop.error},
               {", open parts", test::kOpenExtremes, loop.back_open, loop.error},
               {", fair parts", test::kFairExtremes, loop.back_fair, loop.error_fair}};
  for (const auto& [name, meshes, back, error] : parts) {
    const Tracked found = follow_loops(loop, meshes, {}, test::samples(15'000, 1'000'000));
    const std::string loops = std::string("loops ") + loop.name + name;
    test::hold({"Tracking", loops + ": force at the end from that at the start, of k depth", 1e-9,
                back, loop.why},
               found.back, found.loops);
    test::hold({"Tracking", loops + ": the contact point's error, of size", 1e-9, error, loop.why},
               static_cast<double>(found.errors.back()), found.errors.size());
    test::hold({"Tracking", loops + ": share of ticks that did not converge", 0},
               static_cast<double>(found.flagged) / static_cast<double>(found.errors.size()),
               found.errors.size());
  }
}

INSTANTIATE_TEST_SUITE_P(
    , ExtremeTracking,
    ::testing::Values(
        Loop{"over faces", over_faces, 1e-6, 1e-6, 1e-5, 2e-8, 1e-7, 1e-6, 1e-6, 2e-7},
        Loop{"round a vertex", round_a_vertex, 2e-6, 1e-6, 1e-4, 1e-8, 1e-6, 1e-6, 1e-6, 1e-7},
        Loop{"through a vertex", through_a_vertex, 1e-6, 1e-6, 1e-5, 1e-8, 1e-9, 1e-6, 1e-6, 1e-7},
        Loop{"along edges", along_edges, 1e-6, 1e-6, 1e-5, 5e-7, 1e-9, 1e-6, 1e-6, 2e-6}),
    test::kNameOf);

}  // namespace
}  // namespace gliss
