// A small mesh of any doubles at any level: a MeshError, or a cache whose every number is sound and
// whose points and contacts are finite.
#include <fmt/format.h>

#include "gliss/build/build_cache.h"
#include "gliss/files/cache_check.h"
#include "gliss/query/contact_tracker.h"
#include "tests/fuzz/mesh_target.h"

namespace gliss::fuzz {
namespace {

constexpr double kFarthest = 1e6;  // HIP from the mesh, in sizes of it
// The reach of patches and of their mesh, at most. As they come, patches may go anywhere, up to
// 1e35 times its size, and what queries find of them is not finite.
constexpr double kReach = 16;

Vec3 vector(Input& input) {
  Vec3 v;
  for (double& x : v) x = input.number<double>();
  return v;
}

Mesh any_mesh(Input& input) {
  Mesh mesh;
  mesh.source = "fuzz";
  const unsigned vertices = 3 + input.choice(14), faces = 1 + input.choice(8);
  const bool normals = input.choice(4) == 3;
  for (unsigned v = 0; v < vertices; ++v) mesh.positions.push_back(vector(input));
  if (normals) {
    for (unsigned v = 0; v < vertices; ++v) mesh.normals.push_back(vector(input));
  }
  for (unsigned f = 0; f < faces; ++f) {
    for (unsigned sides = 3 + input.choice(6); sides > 0; --sides)
      mesh.corner_vertex.push_back(input.choice(vertices));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  if (normals) mesh.corner_normal = mesh.corner_vertex;
  return mesh;
}

BuildOptions any_options(Input& input) {
  BuildOptions options;
  options.level.kind = static_cast<Level::Kind>(input.choice(4));
  options.level.construction = static_cast<Construction>(input.choice(2));
  if (options.level.kind == Level::kTable) options.level.cells = 1 + input.choice(4);
  options.precision = input.flag() ? Precision::kFloat : Precision::kDouble;
  options.tame = input.choice(4) != 3;
  return options;
}

std::string text(const Vec3& v) { return fmt::format("({}, {}, {})", v.x(), v.y(), v.z()); }

void require_finite(const SurfacePoint& point, const DomainPoint& at) {
  const auto promise = [&](const char* what) {
    return fmt::format("{} at ({}, {}) of face {}: G {}, G_xi {}, G_eta {}, normal {}", what, at.xi,
                       at.eta, at.face, text(point.position), text(point.d_xi), text(point.d_eta),
                       text(point.normal));
  };
  require(point.position.allFinite() && point.d_xi.allFinite() && point.d_eta.allFinite(),
          promise("a finite point"));
  require(std::abs(point.normal.norm() - 1) < 1e-5, promise("a unit normal"));
}

void require_finite(const Contact& contact, const Vec3& hip) {
  require(contact.scp.allFinite() && contact.normal.allFinite() && contact.push.allFinite() &&
              std::isfinite(contact.distance) && std::isfinite(contact.residual_angle),
          fmt::format("a finite contact of the HIP {}: SCP {}, normal {}, push {}, distance {}, "
                      "angle {}, face {}, flags {}",
                      text(hip), text(contact.scp), text(contact.normal), text(contact.push),
                      contact.distance, contact.residual_angle, contact.at.face, contact.flags));
}

void evaluate_all(const PatchCache& cache) {
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
    const std::uint32_t n = cache.face_valence[face];
    std::vector<DomainPoint> points{{face, 0, 0}};
    for (std::uint32_t k = 0; k < n; ++k) {
      const DomainPoint corner = on_side(face, n, k, 0), side = on_side(face, n, k, 0.4);
      points.insert(points.end(), {corner, side, {face, 0.7 * side.xi, 0.7 * side.eta}});
    }
    std::vector<SurfacePoint> together(points.size());
    evaluate(cache, points, together);
    for (std::size_t i = 0; i < points.size(); ++i) {
      require_finite(evaluate(cache, points[i]), points[i]);
      require_finite(together[i], points[i]);
    }
  }
}

double size_of(const Box& box) { return (box.high - box.low).norm(); }

// Near HIPs, of which contacts must be finite, and any.
void track_all(const PatchCache& cache, const Mesh& mesh, bool tame, Input& input) {
  QueryOptions options;
  options.method = static_cast<Method>(input.choice(kMethods));
  options.solver = static_cast<Solver>(input.choice(3));
  const Box box = box_of(mesh);
  const double size = size_of(box);
  const bool wild = !(size_of(cache.bounds()) <= kReach * size);
  require(!wild || !tame, "patches near their faces");
  ContactTracker tracker(cache, options);
  for (unsigned left = 2 + input.choice(6); left > 0; --left) {
    const Vec3 at = vector(input);
    const bool near = !wild && at.allFinite() && at.norm() <= kFarthest;
    const Vec3 hip = near ? Vec3(box.low + size * at) : at;
    const Contact found = nearest(cache, hip, options), tracked = tracker.tick(hip);
    if (near) require_finite(found, hip), require_finite(tracked, hip);
  }
  if (wild) return;
  const Vec3 middle = (box.low + box.high) / 2;
  require_finite(tracker.track(middle, {cache.patch_face[0], 0.1, 0.1}), middle);
}

}  // namespace
}  // namespace gliss::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  fuzz::Input input(data, size);
  const BuildOptions options = fuzz::any_options(input);
  Mesh mesh = fuzz::any_mesh(input);
  Report report(mesh, nullptr, nullptr);
  if (!fuzz::validated(mesh, {.strict = input.flag()}, report)) return 0;
  try {
    const PatchCache cache = build_cache(mesh, options);
    check_cache(cache, "built");
    fuzz::evaluate_all(cache);
    fuzz::track_all(cache, mesh, options.tame, input);
  } catch (const MeshError&) {
  }
  return 0;
}
