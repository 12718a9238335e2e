// A HIP that stands still, or trembles, where two or more patches are equally right: the contact
// comes to rest, and the force moves no more than the hand.
#include <mutex>

#include "gliss/engine/engine.h"
#include "gliss/query/contact_tracker.h"
#include "tests/extremes/extreme_hips.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Extreme;

const std::vector<const char*> kPingpongMeshes{"knot",  "torus", "goldberg", "banana",
                                               "plate", "fin",   "sphere",   "fans"};

struct Place {
  SurfacePoint point;
  DomainPoint at;
};

// Exactly on an edge, or its first vertex; seen from a face on any side of it.
Place place_on(Rng& rng, const Extreme& e, bool vertex) {
  const std::uint32_t side = test::random_side(rng, e), face = e.topology.side_face[side];
  const double t = vertex ? 0 : uniform(rng, 0, 1);
  const DomainPoint at = on_side(face, e.mesh.valence(face), side - e.mesh.face_begin[face], t);
  return {evaluate(e.cache, at), at};
}

double random_depth(Rng& rng, const Extreme& e) {
  const double depths[] = {0, 1e-12 * e.size, 0.01 * e.rho, 0.1 * e.rho, 0.25 * e.rho};
  return depths[rng() % std::size(depths)];
}

struct Unrest {
  double force_step = 0;  // largest, of k times the HIP's step
  double drift = 0;       // of the contact point while the HIP stands still, of size
  int crossings = 0;      // most in a tick
  std::uint64_t flagged = 0, restless = 0, places = 0;
  std::string worst;

  void add(const Unrest& other) {
    if (!(other.force_step <= force_step)) worst = other.worst;
    force_step = std::max(force_step, other.force_step), drift = std::max(drift, other.drift);
    crossings = std::max(crossings, other.crossings);
    flagged += other.flagged, restless += other.restless, places += other.places;
  }
};

// The face may change while the contact settles, not after.
void stand_still(ContactTracker& tracker, const Vec3& hip, const Extreme& e, Unrest& unrest) {
  constexpr int kTicks = 24;
  Contact last = tracker.tick(hip);
  int changes = 0;
  for (int i = 1; i < kTicks; ++i) {
    const Contact contact = tracker.tick(hip);
    unrest.flagged += !(contact.flags & kConverged);
    unrest.crossings = std::max(unrest.crossings, contact.crossings);
    if (i > kTicks / 2) {
      changes += contact.at.face != last.at.face;
      unrest.drift = std::max(unrest.drift, (contact.scp - last.scp).norm() / e.size);
    }
    last = contact;
  }
  unrest.restless += changes > 0;
}

void tremble(ContactTracker& tracker, Rng& rng, const Place& place, const Vec3& hip,
             const Extreme& e, Unrest& unrest) {
  constexpr int kTicks = 24;
  const Vec3 across = place.point.normal.cross(oracle::random_unit(rng)).normalized();
  const double size = 1e-9 * e.size;
  Contact last = tracker.tick(hip + size * across);
  for (int i = 1; i < kTicks; ++i) {
    const Contact contact = tracker.tick(hip + (i % 2 ? -size : size) * across);
    unrest.flagged += !(contact.flags & kConverged);
    unrest.crossings = std::max(unrest.crossings, contact.crossings);
    const double step = (contact.push - last.push).norm() / (2 * size);
    if (i > 1 && !(step <= unrest.force_step)) {
      unrest.force_step = step;
      unrest.worst = fmt::format("{}: ({:.17g}, {:.17g}, {:.17g}) from face {}", e.name, hip.x(),
                                 hip.y(), hip.z(), place.at.face);
    }
    last = contact;
  }
}

struct Over {
  const char* name;
  bool vertex;
  const std::vector<const char*>& meshes;
  double flagged = 0;  // what is reached where that is more than the goal, a place
};

void PrintTo(const Over& over, std::ostream* out) { *out << over.name; }

class ExtremePingPong : public ::testing::TestWithParam<Over> {};

TEST_P(ExtremePingPong, over_comes_to_rest) {
  constexpr std::size_t kBlock = 250;
  const auto& [over_name, vertex, meshes, flagged] = GetParam();
  const auto engine = make_tbb_engine();
  const std::uint64_t each = test::samples(4'000, 1'000'000) / meshes.size();
  Unrest still, trembling;
  for (const char* name : meshes) {
    const Extreme& e = test::extreme(name);
    Unrest s_mesh, t_mesh;
    std::mutex mutex;
    engine->for_each(each, kBlock, [&, vertex = vertex](std::size_t begin, std::size_t end) {
      Rng rng(5000 + begin);
      Unrest s, t;
      for (std::size_t i = begin; i < end; ++i) {
        const Place place = place_on(rng, e, vertex);
        const Vec3 hip = place.point.position - random_depth(rng, e) * place.point.normal;
        ContactTracker tracker(e.cache, test::leaping());
        tracker.track(hip, place.at);
        stand_still(tracker, hip, e, s);
        tremble(tracker, rng, place, hip, e, t);
        ++s.places, ++t.places;
      }
      const std::lock_guard lock(mutex);
      s_mesh.add(s), t_mesh.add(t);
    });
    test::record(
        name,
        "still: {} restless, drift {:.2g}, {} crossings, {} flagged; trembling: force {:.3g}"
        " of the step, {} crossings, {} flagged; worst at {}",
        s_mesh.restless, s_mesh.drift, s_mesh.crossings, s_mesh.flagged, t_mesh.force_step,
        t_mesh.crossings, t_mesh.flagged, t_mesh.worst);
    still.add(s_mesh), trembling.add(t_mesh);
  }
  const std::string over = std::string("over ") + over_name + ": ";
  test::hold({"Tracking", "still " + over + "places where the face goes on changing", 0},
             static_cast<double>(still.restless), still.places);
  test::hold({"Tracking", "still " + over + "drift of the contact point a tick, of size", 1e-12},
             still.drift, still.places);
  test::hold(
      {"Tracking", "trembling " + over + "force step, of k times the HIP's step", 1.5, 4,
       "a contact may stay on its edge for a tick and catch up in the next, or be held at the "
       "crease of two faces that fold"},
      trembling.force_step, trembling.places);
  test::hold({"Tracking", "trembling " + over + "crossings in a tick", vertex ? 12.0 : 4.0, 16,
              "the far side of a pole of valence 24 is 12 away, and one more by a rounding"},
             std::max(still.crossings, trembling.crossings), trembling.places);
  test::hold({"Tracking", over + "ticks that did not converge", 0,
              flagged * static_cast<double>(still.places),
              "at the crease of two faces that fold, a contact is held that crossed no surface"},
             static_cast<double>(still.flagged + trembling.flagged), still.places);
}

INSTANTIATE_TEST_SUITE_P(
    , ExtremePingPong,
    ::testing::Values(Over{"an edge", false, kPingpongMeshes},
                      Over{"a vertex", true, kPingpongMeshes},
                      Over{"an edge of open parts", false, test::kOpenExtremes},
                      Over{"a vertex of open parts", true, test::kOpenExtremes},
                      Over{"an edge of fair parts", false, test::kFairExtremes, 0.05},
                      Over{"a vertex of fair parts", true, test::kFairExtremes}),
    test::kNameOf);

}  // namespace
}  // namespace gliss
