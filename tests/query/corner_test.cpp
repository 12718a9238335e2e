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

// Of patches eight times as long as wide as well, whose short slopes have the rounding of the long.
TEST(Corner, leads_on_along_every_edge_from_every_face) {
  const Mesh mesh = test::with_normals(fin().mesh);
  const Topology topology = build_topology(mesh);
  for (const char* name : {"exact", "ribbon", "bezier", "fair"}) {
    BuildOptions options;
    options.level = find_surface(name).value();
    const PatchCache cache = build_cache(mesh, options);
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

}  // namespace
}  // namespace gliss
