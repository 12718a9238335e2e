// Torus, banana, prism, cylinder, cube, plate and fin; the knot and the Goldberg sphere have files
// of their own.
#include "gliss/generate/generate.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "gliss/base/message.h"
#include "gliss/generate/generate_exact.h"
#include "gliss/generate/generate_parts.h"

namespace gliss {
namespace {

// A ring of `around` vertices about `centre`, anticlockwise from e1 to e2.
void add_ring(Mesh& mesh, int around, const Vec3& centre, const Vec3& e1, const Vec3& e2,
              double radius, bool with_normals) {
  for (int k = 0; k < around; ++k) {
    const double angle = kTurn * k / around;
    const Vec3 normal = std::cos(angle) * e1 + std::sin(angle) * e2;
    mesh.positions.push_back(centre + radius * normal);
    if (with_normals) mesh.normals.push_back(normal.normalized());
  }
}

}  // namespace

Generated torus(int along, int around, double R, double r) {
  require(along >= 3 && around >= 3, "torus: at least 3 x 3 faces");
  require(R > r && r > 0, "torus: needs R > r > 0");
  Mesh mesh = make_mesh(detail::message("torus(", along, ", ", around, ")"));
  for (int i = 0; i < along; ++i) {
    const double angle = kTurn * i / along;
    const Vec3 radial(std::cos(angle), std::sin(angle), 0);
    add_ring(mesh, around, R * radial, radial, -Vec3::UnitZ(), r, true);
  }
  add_tube(mesh, along, around, true);
  share_normals(mesh);
  return {std::move(mesh), std::make_shared<Torus>(R, r)};
}

Generated banana(int along, int around) {
  require(along >= 1 && around >= 3, "banana: at least 1 x 3 faces");
  constexpr double kBend = 90;         // mm, radius of the centre line
  constexpr double kHalfAngle = 1.05;  // rad
  constexpr double kThickness = 18;    // mm, radius at the middle
  constexpr double kTaper = 0.9;       // 1 would end in points
  Mesh mesh = make_mesh(detail::message("banana(", along, ", ", around, ")"));
  for (int i = 0; i <= along; ++i) {
    const double u = 2.0 * i / along - 1;
    const double angle = kHalfAngle * u;
    const Vec3 radial(std::cos(angle), std::sin(angle), 0);
    const double radius = kThickness * std::sqrt(1 - kTaper * u * u);
    add_ring(mesh, around, kBend * (radial - Vec3::UnitX()), radial, -Vec3::UnitZ(), radius, false);
  }
  add_tube(mesh, along + 1, around, false);
  return {std::move(mesh), nullptr};
}

Generated prism(int sides, double radius, double height) {
  require(sides >= 3 && sides <= static_cast<int>(kMaxValence), "prism: 3 to 1000 sides");
  require(radius > 0 && height > 0, "prism: needs a size");
  Mesh mesh = make_mesh(detail::message("prism(", sides, ")"));
  for (const double z : {-height / 2, height / 2}) {
    add_ring(mesh, sides, {0, 0, z}, Vec3::UnitX(), Vec3::UnitY(), radius, false);
  }
  add_tube(mesh, 2, sides, false);
  return {std::move(mesh), nullptr};
}

Generated cylinder(int around, int along, double radius, double height) {
  require(around >= 3 && around <= static_cast<int>(kMaxValence), "cylinder: 3 to 1000 around");
  require(along >= 1, "cylinder: at least 1 face along");
  require(radius > 0 && height > 0, "cylinder: needs a size");
  Mesh mesh = make_mesh(detail::message("cylinder(", around, ", ", along, ")"));
  for (int i = 0; i <= along; ++i) {
    const Vec3 centre(0, 0, height * (1.0 * i / along - 0.5));
    add_ring(mesh, around, centre, Vec3::UnitX(), Vec3::UnitY(), radius, true);
  }
  add_tube(mesh, static_cast<std::uint32_t>(along) + 1, static_cast<std::uint32_t>(around), false);
  share_normals(mesh);
  for (const std::size_t cap : {mesh.face_count() - 2, mesh.face_count() - 1}) {
    for (std::uint32_t c = mesh.face_begin[cap]; c < mesh.face_begin[cap + 1]; ++c)
      mesh.corner_normal[c] = static_cast<std::uint32_t>(mesh.normals.size());
    mesh.normals.push_back(cap + 1 == mesh.face_count() ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ()));
  }
  return {std::move(mesh), std::make_shared<ExactCylinder>(radius, height / 2)};
}

Generated cube(int cells, double size) {
  require(cells >= 1 && cells <= 1000, "cube: 1 to 1000 squares along an edge");
  require(size > 0, "cube: needs a size");
  Mesh mesh = make_mesh(detail::message("cube(", cells, ")"));
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [known, is_new] =
        numbers.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new)
      mesh.positions.push_back(size * (Vec3(at[0], at[1], at[2]) / cells - Vec3::Constant(0.5)));
    return known->second;
  };
  for (int face = 0; face < 6; ++face) {
    const bool is_high = face % 2 == 1;
    const int axis = face / 2;
    const auto at = [&](int i, int j) {
      std::array<int, 3> place{};
      place[static_cast<std::size_t>(axis)] = is_high ? cells : 0;
      place[static_cast<std::size_t>((axis + 1) % 3)] = is_high ? i : j;
      place[static_cast<std::size_t>((axis + 2) % 3)] = is_high ? j : i;
      return vertex(place);
    };
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i)
        add_face(mesh, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    Vec3 normal = Vec3::Zero();
    normal[axis] = is_high ? 1 : -1;
    mesh.normals.push_back(normal);
    mesh.corner_normal.resize(mesh.corner_vertex.size(), static_cast<std::uint32_t>(face));
  }
  return {std::move(mesh), std::make_shared<ExactBox>(Vec3::Constant(size / 2))};
}

Generated thin_plate(int nx, int ny, double width, double thickness) {
  require(nx >= 1 && ny >= 1, "thin_plate: at least 1 x 1 faces");
  require(width > 0 && thickness > 0, "thin_plate: needs a size");
  Mesh mesh = make_mesh(detail::message("thin_plate(", nx, ", ", ny, ")"));
  for (const double z : {-thickness / 2, thickness / 2}) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        mesh.positions.emplace_back(width * (1.0 * i / nx - 0.5), width * (1.0 * j / ny - 0.5), z);
      }
    }
  }
  const std::uint32_t top = (nx + 1) * (ny + 1);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (nx + 1) + i); };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      add_face(mesh, {top + a, top + b, top + c, top + d});
      add_face(mesh, {d, c, b, a});
    }
  }
  const auto add_rim = [&](std::uint32_t from, std::uint32_t to) {
    add_face(mesh, {from, to, top + to, top + from});
  };
  for (int i = 0; i < nx; ++i) {
    add_rim(at(i, 0), at(i + 1, 0));
    add_rim(at(i + 1, ny), at(i, ny));
  }
  for (int j = 0; j < ny; ++j) {
    add_rim(at(nx, j), at(nx, j + 1));
    add_rim(at(0, j + 1), at(0, j));
  }
  return {std::move(mesh), std::make_shared<ExactBox>(Vec3(width, width, thickness) / 2)};
}

Generated fin(int along, double height, double base, double length) {
  require(along >= 1, "fin: at least 1 face along");
  require(height > 0 && base > 0 && length > 0, "fin: needs a size");
  Mesh mesh = make_mesh(detail::message("fin(", along, ")"));
  for (int i = 0; i <= along; ++i) {
    const double y = length * (1.0 * i / along - 0.5);
    mesh.positions.emplace_back(0, y, height);
    mesh.positions.emplace_back(base / 2, y, 0);
    mesh.positions.emplace_back(-base / 2, y, 0);
  }
  add_tube(mesh, along + 1, 3, false);
  return {std::move(mesh), nullptr};
}

}  // namespace gliss
