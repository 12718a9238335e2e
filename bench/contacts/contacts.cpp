// Nearest points a second on any meshes: gliss_contacts COUNT MESH... ("knot": the generated one;
// MESH:paper: the paper's patches). A row for HIPs 0.5 % and 2 % of the box's diagonal beneath the
// surface, and anywhere in the box.
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <random>
#include <stdexcept>

#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/mesh/mesh.h"
#include "gliss/query/query.h"

namespace {

using namespace gliss;

enum class Kind { kShallow, kDeep, kBox };

std::vector<Vec3> hips_of(const PatchCache& cache, Kind kind, std::size_t count) {
  const Box box = cache.bounds();
  const Vec3 size = box.high - box.low;
  const double depth = (kind == Kind::kShallow ? 0.005 : 0.02) * size.norm();
  std::mt19937_64 random(7);
  const auto uniform = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };
  std::vector<Vec3> hips;
  for (std::size_t i = 0; i < count; ++i) {
    if (kind == Kind::kBox) {
      const double x = uniform(), y = uniform(), z = uniform();
      hips.push_back(box.low + Vec3(x, y, z).cwiseProduct(size));
      continue;
    }
    const auto face = static_cast<std::uint32_t>(i * cache.mesh_face_count / count);
    const std::uint32_t n = cache.face_valence[face];
    DomainPoint at = on_side(face, n, static_cast<std::uint32_t>(uniform() * n), uniform());
    const double part = std::sqrt(uniform());
    at.xi *= part, at.eta *= part;
    const SurfacePoint p = evaluate(cache, at);
    hips.push_back(p.position - depth * p.normal);
  }
  return hips;
}

void measure(const std::string& name, std::size_t count) {
  const std::string paper = ":paper";
  const bool is_paper = name.ends_with(paper);
  const std::string file = name.substr(0, name.size() - (is_paper ? paper.size() : 0));
  Mesh mesh = file == "knot" ? torus_knot(60, 24).mesh : load_mesh(file);
  BuildOptions options;
  if (is_paper) options.level.construction = Construction::kPaper;
  const PatchCache cache = build_cache(mesh, options);
  const Method methods[] = {Method::kGregory};
  for (const auto& [kind, what] :
       {std::pair{Kind::kShallow, "0.5%"}, {Kind::kDeep, "2%"}, {Kind::kBox, "box"}}) {
    const std::vector<Vec3> hips = hips_of(cache, kind, count);
    std::vector<Contact> contacts(count);
    const std::clock_t start = std::clock();
    nearest(cache, hips, methods, {}, contacts);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    double iterations = 0;
    for (const Contact& c : contacts) iterations += c.iterations;
    const auto contacts_count = static_cast<double>(count);
    fmt::print("{}\t{}\t{:.0f} /s\t{:.1f} iterations\t{:.0f} bytes a patch\n", name, what,
               contacts_count / seconds, iterations / contacts_count,
               static_cast<double>(cache.bytes()) / cache.patch_count());
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 2; i < argc; ++i) {
    try {
      measure(argv[i], std::stoul(argv[1]));
    } catch (const std::exception& e) {
      fmt::print(stderr, "{}\n", e.what());
    }
  }
}
