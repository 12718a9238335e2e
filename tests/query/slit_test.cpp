// Edges whose two faces have normals of their own there, and that are no creases: each face has a
// boundary curve of its own, and between the two there is a slit.
#include "gliss/generate/generate.h"
#include "gliss/surface/names.h"
#include "tests/support/open_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

// Some faces get corner normals that are tilted against those of the faces around.
Mesh with_own_normals(Mesh mesh, double tilt) {
  oracle::Rng rng(5);
  for (std::size_t face = 0; face < mesh.face_count(); face += 5) {
    const Vec3 way = tilt * oracle::random_unit(rng);
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      mesh.normals.push_back((mesh.normals[mesh.corner_normal[c]] + way).normalized());
      mesh.corner_normal[c] = static_cast<std::uint32_t>(mesh.normals.size() - 1);
    }
  }
  return mesh;
}

class Slits : public ::testing::TestWithParam<std::tuple<Precision, Construction>> {};

// The distance to a minimum on an edge with two normals falls on neither side of it: a descent has
// come to its end there, and its flags say so.
TEST_P(Slits, let_searches_and_tracks_converge) {
  const auto& [precision, construction] = GetParam();
  oracle::Rng rng(7);
  for (const Mesh& mesh : {with_own_normals(irregular(torus(24, 12), 3).mesh, 0.3),
                           with_own_normals(test::with_normals(goldberg(4).mesh), 0.2),
                           with_own_normals(torus().mesh, 0.3), cylinder().mesh}) {
    const PatchCache cache = test::cache_of(mesh, precision, true, nullptr, construction);
    std::vector<Vec3> hips;
    std::vector<DomainPoint> starts;
    for (int i = 0; i < 3000; ++i) {
      const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
      const std::uint32_t n = mesh.valence(face);
      const DomainPoint side =
          on_side(face, n, static_cast<std::uint32_t>(rng() % n), oracle::uniform(rng, 0, 1));
      const Vec3 aside = oracle::uniform(rng, 0, 2) * oracle::random_unit(rng);
      hips.push_back(evaluate(cache, side).position + aside);
      starts.push_back({face, 0, 0});
    }
    std::vector<Contact> found(hips.size()), tracked(hips.size());
    const Method method = Method::kGregory;
    nearest(cache, hips, {&method, 1}, {}, found);
    track(cache, hips, starts, {}, tracked);
    const auto count = [](const std::vector<Contact>& contacts, std::uint32_t flags) {
      return std::count_if(contacts.begin(), contacts.end(), [&](const Contact& c) {
        return (c.flags & (kConverged | kOnCrease)) == flags;
      });
    };
    for (const auto* contacts : {&found, &tracked}) {
      EXPECT_EQ(count(*contacts, 0) + count(*contacts, kOnCrease), 0);
      EXPECT_GT(count(*contacts, kConverged | kOnCrease), 30);
    }
    test::record(mesh.source, "on edges {} of {} found and {} tracked, not converged {}, {}",
                 count(found, kConverged | kOnCrease), hips.size(),
                 count(tracked, kConverged | kOnCrease), count(found, 0) + count(found, kOnCrease),
                 count(tracked, 0) + count(tracked, kOnCrease));
  }
}

INSTANTIATE_TEST_SUITE_P(
    , Slits,
    ::testing::Combine(::testing::Values(Precision::kDouble, Precision::kFloat),
                       ::testing::Values(Construction::kFair, Construction::kPaper)),
    [](const auto& info) {
      return std::string(construction_name(std::get<1>(info.param))) + "_" +
             precision_name(std::get<0>(info.param));
    });

}  // namespace
}  // namespace gliss
