#include "bench/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>

#include "gliss/build/build_cache.h"
#include "gliss/compare/tessellate.h"
#include "gliss/surface/names.h"

namespace gliss::bench {
namespace {

// The value of `key`, made the first time.
template <class Key, class Value, class Make>
const Value& once(std::map<Key, std::unique_ptr<Value>>& made, const Key& key, Make make) {
  std::unique_ptr<Value>& value = made[key];
  if (value == nullptr) value = make();
  return *value;
}

Mesh knot(std::size_t faces) {
  const KnotGrid grid = knot_grid(faces);
  return torus_knot(grid.along, grid.around).mesh;
}

// Each quad as two triangles, each triangle as three quads of a corner, two middles of sides and
// the centre: corners of six faces, middles of four, centres of three.
Mesh irregular_quads(const Mesh& quads) {
  Mesh mesh;
  mesh.unit = quads.unit;
  mesh.source = quads.source + ", cut into irregular quads";
  mesh.positions = quads.positions;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto vertex = [&](const Vec3& at) {
    mesh.positions.push_back(at);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), 0u);
    if (is_new) at->second = vertex(0.5 * (mesh.positions[a] + mesh.positions[b]));
    return at->second;
  };
  for (std::size_t f = 0; f < quads.face_count(); ++f) {
    const std::uint32_t* q = &quads.corner_vertex[quads.face_begin[f]];
    for (const auto& t : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
      const Vec3 sum = mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]];
      const std::uint32_t centre = vertex(sum / 3);
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t here = t[k], next = t[(k + 1) % 3], before = t[(k + 2) % 3];
        const std::uint32_t quad[] = {here, middle(here, next), centre, middle(before, here)};
        mesh.corner_vertex.insert(mesh.corner_vertex.end(), std::begin(quad), std::end(quad));
        mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
      }
    }
  }
  add_vertex_normals(mesh);
  return mesh;
}

Mesh triangles_of(const Mesh& quads, std::uint32_t cells) {
  return tessellate(quads, build_cache(quads), cells);
}

Mesh make_mesh(Shape shape) {
  switch (shape) {
    case Shape::kKnot:
      return knot(mesh_faces);
    case Shape::kIrregular:
      return irregular_quads(knot(mesh_faces / 6));
    case Shape::kTriangles:  // eight for a quad
      return triangles_of(knot(mesh_faces / 8), 1);
    case Shape::kRandom: {
      const KnotGrid grid = knot_grid(mesh_faces / 2);
      return irregular(torus_knot(grid.along, grid.around), 1).mesh;
    }
    case Shape::kPolygons:
      return goldberg(
                 static_cast<int>(std::lround(std::sqrt(0.1 * static_cast<double>(mesh_faces)))))
          .mesh;
    case Shape::kDense:
      break;
  }
  return triangles_of(torus_knot().mesh, 2);
}

}  // namespace

KnotGrid knot_grid(std::size_t faces) {
  const int around =
      std::max(6, static_cast<int>(std::lround(std::sqrt(0.1 * static_cast<double>(faces)))));
  return {std::max(30, static_cast<int>(faces) / around), around};
}

const Mesh& mesh_of(Shape shape) {
  static std::map<Shape, std::unique_ptr<Mesh>> made;
  return once(made, shape, [&] { return std::make_unique<Mesh>(make_mesh(shape)); });
}

Shape shape_of(std::uint32_t n) {
  return n == 3 ? Shape::kTriangles : n == 4 ? Shape::kKnot : Shape::kPolygons;
}

const PatchCache& cache_of(Shape shape, Precision precision, const Level& level) {
  using Key = std::tuple<Shape, Precision, std::string>;
  static std::map<Key, std::unique_ptr<PatchCache>> made;
  return once(made, Key{shape, precision, surface_name(level)}, [&] {
    BuildOptions options;
    options.precision = precision;
    options.level = level;
    return std::make_unique<PatchCache>(engine_of(0).build(mesh_of(shape), options));
  });
}

const Engine& engine_of(int threads) {
  static std::map<int, std::unique_ptr<Engine>> made;
  return once(made, threads, [&] { return make_tbb_engine(threads); });
}

double size_of(const PatchCache& cache) {
  const Box box = cache.bounds();
  return (box.high - box.low).maxCoeff();
}

std::string work_name(const std::string& path, const Level& level, Precision precision,
                      std::uint32_t n, int threads) {
  return path + "/" + surface_name(level) + "/" + precision_name(precision) + "/" +
         std::to_string(n) + "/tbb/" + std::to_string(threads);
}

}  // namespace gliss::bench
