// G1 across edges of random pairs of polygons whose normals lie within 60 degrees of their faces.
#include "gliss/build/build_cache.h"
#include "tests/extremes/extreme_judge.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::hold, test::name_of, test::Polygon, test::WorstPlace;

constexpr double kMostTilt = 60 * oracle::kDegree;

bool within(const Polygon& polygon, double tilt) {
  const Vec3 up = oracle::face_normal(polygon);
  return std::all_of(polygon.normals.begin(), polygon.normals.end(),
                     [&](const Vec3& n) { return oracle::angle<double>(n, up) <= tilt; });
}

// Many pairs in one mesh, so that they share the tables of a build.
Mesh random_pairs(Rng& rng, int count) {
  Mesh mesh;
  while (count > 0) {
    const auto sides = [&] { return 3 + static_cast<int>(rng() % 10); };
    const int n = sides(), m = sides(), k = static_cast<int>(rng() % static_cast<unsigned>(n));
    const Polygon left = oracle::with_unit_normals(
        oracle::random_polygon(rng, n, oracle::uniform(rng, 0, kMostTilt)));
    const Polygon right =
        oracle::with_unit_normals(oracle::random_neighbour(rng, left, k, m, kMostTilt));
    if (!within(left, kMostTilt) || !within(right, kMostTilt)) continue;
    test::add_pair(mesh, left, k, right);
    --count;
  }
  return mesh;
}

// The worst of edges, by what a build made of their faces.
struct Crossing {
  WorstPlace gap, sound, tamed;
  WorstPlace reversed;     // 1 where the normal of a face that is not flagged turns over
  std::uint64_t bent = 0;  // these keep their curve and give up their normals
};

void cross(const Mesh& mesh, Precision precision, Construction construction,
           const std::string& name, Crossing& found) {
  BuildReport report;
  const PatchCache cache = test::cache_of(mesh, precision, true, &report, construction);
  const Topology topology = build_topology(mesh);
  const auto flagged = [&](std::uint32_t face) {
    return std::binary_search(report.flagged_faces.begin(), report.flagged_faces.end(), face);
  };
  const auto is_bent = [&](std::uint32_t face) {
    return test::kind_of(cache, face) == PatchKind::kBent;
  };
  const std::vector<double> forward{0, 0.01, 0.2, 0.45, 0.5, 0.7, 0.9, 0.999, 1};
  std::vector<double> backward;
  for (const double t : forward) backward.push_back(1 - t);
  test::for_each_inner_edge(topology, [&](std::uint32_t side, std::uint32_t twin) {
    const std::uint32_t face = topology.side_face[side], other = topology.side_face[twin];
    const auto a = test::along_side(cache, mesh, topology, side, forward);
    const auto b = test::along_side(cache, mesh, topology, twin, backward);
    const double size = oracle::size_of(test::polygon_of(mesh, face));
    const bool bent = is_bent(face) || is_bent(other);
    found.bent += bent;
    const bool sound = !flagged(face) && !flagged(other);
    WorstPlace& angle = sound ? found.sound : found.tamed;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto where = [&] {
        return fmt::format("{}, faces {} and {} of {} and {} sides, t {}", name, face, other,
                           mesh.valence(face), mesh.valence(other), forward[i]);
      };
      found.gap.add((a[i].position - b[i].position).norm() / size, where);
      if (bent) continue;
      const double turn = oracle::angle<double>(a[i].normal, b[i].normal);
      const bool reversed = turn > std::numbers::pi / 2;
      if (sound) found.reversed.add(reversed, where);
      if (!sound || !reversed) angle.add(turn, where);
    }
  });
}

TEST(ExtremeContinuity, of_normals_across_random_edges) {
  const int edges = static_cast<int>(test::samples(4'000, 1'000'000)), each = 1000;
  for (const Precision precision : test::kPrecisions) {
    const bool is_float = precision == Precision::kFloat;
    Crossing found;
    for (int i = 0; i < edges / each; ++i) {
      Rng rng(static_cast<std::uint64_t>(1200 + i));
      const Construction made = i % 2 == 0 ? Construction::kFair : Construction::kPaper;
      cross(random_pairs(rng, each), precision, made, fmt::format("seed {}", 1200 + i), found);
    }
    const auto row = [&](const char* what, double goal, const WorstPlace& worst, double limit = 0,
                         const char* why =
                             "slopes in float, where a ribbon or a corner leaves its edge at a "
                             "small angle") {
      hold({"Numbers: continuity",
            fmt::format("{}, normals within 60 degrees, {}", what, name_of(precision)), goal,
            std::max(goal, limit), why},
           worst);
    };
    row("G1 across edges of sound faces, rad", is_float ? 1e-5 : 1e-9, found.sound,
        is_float ? 3e-3 : 0);
    row("a normal of a face not flagged turns over", 0, found.reversed);
    row("G1 across edges of tamed faces, rad", is_float ? 1e-5 : 1e-9, found.tamed);
    row("gap across edges, of size", is_float ? 1e-6 : 1e-14, found.gap);
    test::record(name_of(precision), "{} edges by bent faces", found.bent);
  }
}

}  // namespace
}  // namespace gliss
