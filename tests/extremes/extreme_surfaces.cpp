#include "tests/extremes/extreme_surfaces.h"

namespace gliss::test {

Mesh lat_long_sphere(int segments, int rings, double radius) {
  Mesh mesh;
  mesh.unit = 1e-3;
  mesh.source = "lat-long sphere";
  const auto add = [&](double z, double x, double y) {
    mesh.normals.emplace_back(Vec3(x, y, z).normalized());
    mesh.positions.push_back(radius * mesh.normals.back());
  };
  const auto face = [&](std::initializer_list<int> vertices) {
    for (const int v : vertices) mesh.corner_vertex.push_back(static_cast<std::uint32_t>(v));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  };
  for (int i = 1; i < rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    for (int k = 0; k < segments; ++k) {
      const double angle = 2 * std::numbers::pi * k / segments;
      add(std::cos(polar), std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle));
    }
  }
  const int top = segments * (rings - 1), bottom = top + 1;
  add(1, 0, 0), add(-1, 0, 0);
  for (int k = 0; k < segments; ++k) {
    const int next = (k + 1) % segments, last = top - segments;
    face({top, k, next});
    for (int row = 0; row < last; row += segments)
      face({row + k, row + segments + k, row + segments + next, row + next});
    face({bottom, last + next, last + k});
  }
  mesh.corner_normal = mesh.corner_vertex;
  return mesh;
}

Mesh two_fans(int segments, double radius, double height) {
  Mesh mesh;
  mesh.unit = 1e-3;
  mesh.source = "two fans";
  for (int k = 0; k < segments; ++k) {
    const double angle = 2 * std::numbers::pi * k / segments;
    mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  mesh.positions.emplace_back(0, 0, height);
  mesh.positions.emplace_back(0, 0, -height);
  const auto top = static_cast<std::uint32_t>(segments);
  for (std::uint32_t k = 0; k < top; ++k) {
    const std::uint32_t next = (k + 1) % top;
    for (const std::uint32_t v : {k, next, top, next, k, top + 1}) mesh.corner_vertex.push_back(v);
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size() - 3));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  return with_normals(mesh);
}

Mesh crumpled(double tilt) {
  Mesh mesh = goldberg(3).mesh;
  mesh.source = "crumpled";
  oracle::Rng rng(77);
  for (Vec3& n : mesh.normals) n = oracle::random_tilt(rng, n, tilt);
  return mesh;
}

Mesh first_faces(Mesh mesh, std::uint32_t count) {
  mesh.face_begin.resize(count + 1);
  mesh.corner_vertex.resize(mesh.face_begin.back());
  mesh.corner_normal.resize(mesh.face_begin.back());
  return mesh;
}

PatchCache region_of(const Mesh& whole, std::uint32_t count, Precision precision,
                     BuildReport* report) {
  BuildOptions options;
  options.precision = precision;
  options.level.construction = Construction::kPaper;
  options.faces.resize(count);
  std::iota(options.faces.begin(), options.faces.end(), 0u);
  return unlimited_cache(whole, options, report);
}

namespace {

Mesh mesh_named(const std::string& name) {
  if (name == "knot") return torus_knot(60, 8).mesh;
  if (name == "torus") return torus().mesh;
  if (name == "goldberg") return goldberg().mesh;
  if (name == "banana") return banana().mesh;
  if (name == "plate") return thin_plate().mesh;
  if (name == "fin") return fin().mesh;
  if (name == "irregular") return irregular(ellipsoid(3), 1).mesh;
  if (name == "sphere") return lat_long_sphere();
  if (name == "fans") return two_fans();
  if (name == "crumpled") return crumpled();
  if (name == "open strip") return open_strip();
  if (name == "open fan") return fan_of_five();
  if (name == "half torus") return half_torus();
  if (name == "triangle") return lone_triangle();
  return load_shared("meshes/" + name);
}

}  // namespace

const Extreme& extreme(const std::string& name) {
  static std::map<std::string, Extreme> made;
  if (const auto found = made.find(name); found != made.end()) return found->second;
  // Five and a half rings round the tube of a torus: borders at both ends, one with a notch.
  if (name == "region") return made.try_emplace(name, name, torus().mesh, 66u).first->second;
  const std::string fair = "fair ";
  const bool is_fair = name.starts_with(fair);
  const Construction construction = is_fair ? Construction::kFair : Construction::kPaper;
  Mesh mesh = mesh_named(is_fair ? name.substr(fair.size()) : name);
  add_vertex_normals(mesh, normal_weights(construction));
  return made.try_emplace(name, name, std::move(mesh), construction).first->second;
}

}  // namespace gliss::test
