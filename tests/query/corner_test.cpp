// A contact at a corner goes on where its way leads: into a patch, or along an edge between two.
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/surface/names.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

// True if a patch is as its construction makes it, at every face round the vertex where `side`
// starts.
bool is_plain_round(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                    std::uint32_t side) {
  std::uint32_t at = side;
  do {
    if (test::kind_of(cache, topology.side_face[at]) != PatchKind::kPlain) return false;
    at = next_around(mesh, topology, at);
  } while (at != side);
  return true;
}

// Some patches are eight times as long as wide: their short slopes have the rounding of the long.
TEST(Corner, leads_on_along_every_edge_from_every_face) {
  const Mesh mesh = test::with_normals(fin().mesh);
  const Topology topology = build_topology(mesh);
  for (const char* name : {"exact", "ribbon", "bezier", "fair"}) {
    BuildOptions options;
    options.level = find_surface(name).value();
    const PatchCache cache = test::unlimited_cache(mesh, options);
    int asked = 0;
    double worst = 0;
    for (std::uint32_t side = 0; side < mesh.corner_vertex.size(); ++side) {
      if (!is_plain_round(mesh, topology, cache, side)) continue;
      const auto at_start_of = [&](std::uint32_t s, double t) {
        const std::uint32_t face = topology.side_face[s];
        return on_side(face, mesh.valence(face), s - mesh.face_begin[face], t);
      };
      const SurfacePoint foot = evaluate(cache, at_start_of(side, 0.003));
      const Vec3 hip = foot.position - 0.1 * foot.normal;
      std::uint32_t from = side;
      do {
        ContactTracker tracker(cache, {});
        const Contact contact = tracker.track(hip, at_start_of(from, 0));
        worst = std::max(worst, (contact.scp - foot.position).norm());
        ++asked;
        from = next_around(mesh, topology, from);
      } while (from != side);
    }
    EXPECT_GT(asked, 300) << name;
    EXPECT_LE(worst, 1e-6) << name;
    test::record(name, "{} ways, error at most {:.2g} mm", asked, worst);
  }
}

// From a hair's breadth beside a corner the way may lead over an edge to it, and from there round
// it.
TEST(Corner, leads_round_it_from_very_near) {
  const Mesh mesh = test::with_normals(irregular(ellipsoid(2), 1).mesh);
  const Topology topology = build_topology(mesh);
  const PatchCache cache = test::cache_of(mesh);
  int asked = 0, lost = 0;
  for (std::uint32_t side = 0; side < mesh.corner_vertex.size(); ++side) {
    if (!is_plain_round(mesh, topology, cache, side)) continue;
    const std::uint32_t face = topology.side_face[side];
    const auto k = static_cast<int>(side - mesh.face_begin[face]);
    const oracle::Vec2<double> corner = oracle::domain_corner(3, k);
    const SurfacePoint foot = test::at(cache, face, 0.99 * corner);
    const Vec3 hip = foot.position - 0.2 * cache.rho_min[cache.first_patch(face)] * foot.normal;
    for (std::uint32_t from = next_around(mesh, topology, side); from != side;
         from = next_around(mesh, topology, from)) {
      const std::uint32_t start = topology.side_face[from];
      const auto i = static_cast<int>(from - mesh.face_begin[start]);
      for (const double t : {1e-15, 1e-14, 1e-13, 1e-12}) {
        for (const bool along_last : {false, true}) {
          const auto on = along_last ? oracle::on_side<double>(3, (i + 2) % 3, 1 - t)
                                     : oracle::on_side<double>(3, i, t);
          ContactTracker tracker(cache, {});
          const Contact contact = tracker.track(hip, {start, on.x(), on.y()});
          lost += (contact.scp - foot.position).norm() > 1e-6;
          ++asked;
        }
      }
    }
  }
  EXPECT_GT(asked, 3000);
  EXPECT_EQ(lost, 0);
  test::record("very near", "{} lost of {}", lost, asked);
}

}  // namespace
}  // namespace gliss
