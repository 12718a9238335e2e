// Gliss's patches beside surfaces that others make from the same corners and normals, on shapes
// that are known exactly: tables of Markdown. --check tests the others instead.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gliss/build/build_cache.h"
#include "gliss/engine/engine.h"
#include "gliss/query/force_statistics.h"
#include "gliss/walk/random_places.h"
#include "gliss/walk/walk.h"
#include "rival_patches.h"
#include "shapes.h"

namespace {

using namespace gliss;
using namespace gliss::rivals;

constexpr const char* kWhat =
    R"(Smaller is better everywhere. A cell has a figure with exact normals / with Gliss's own (`NormalWeights::kSmooth`) / with
means of the faces' normals weighted by angle; polygons have none. Left for {0} faces, right for {1}, as near as a shape comes.
PN triangles and Phong take polygons cut into triangles, Nagata those of more than four sides; his sides are straight where
their normals are within 0.1 degrees.

- *rms*, *most*: the distance of points of the surface from the true shape, root of the mean square by area and largest, over
  the diagonal of the bounding box.
- *normals*: the angle to the true normal at the nearest point of the true shape, rms by area, degrees.
- *jumps*: ticks whose force changes by more than 20 % of k d, per 100,000 in contact, and *step*: the largest change from a
  tick to the next, in % of k d; of the globally nearest point, beneath {2} walks of {3} ticks that go on by 1 % of d a
  tick, d = 0.5 % of the diagonal deep (seed {4}, also of random triangles). All surfaces of a mesh get the same
  walks, and nothing settles. Gliss may find a HIP outside; for the others it is inside, whatever a patch that folds says.
)";

constexpr std::array kKinds{std::pair{Kind::kTriangles, "triangles"},
                            std::pair{Kind::kRandomTriangles, "random triangles"},
                            std::pair{Kind::kQuads, "quads"}, std::pair{Kind::kPolygons, "n-gons"}};

constexpr std::array kSurfaces{"**fair**", "paper's", "PN triangles",
                               "Nagata",   "Phong",   "polygons"};
constexpr std::array kRivals{Rival::kPn, Rival::kNagata, Rival::kPhong, Rival::kFlat};  // the last
constexpr std::size_t kPolygons = kSurfaces.size() - 1, kNormals = 3;

Mesh with_normals(Mesh mesh, std::size_t normals) {
  if (normals == 1) mesh.normals = vertex_normals(mesh, NormalWeights::kSmooth);
  if (normals == 2) mesh.normals = vertex_normals(mesh, NormalWeights::kAngle);
  return mesh;
}

struct Sample {
  Vec3 point, normal;
  double area;  // that it stands for
};
struct Surface {
  std::vector<Sample> samples;
  // From each HIP to the nearest point of all the surface. Walks are beneath it; Gliss says
  // (0, 0, 0) where it finds them outside, others are not asked.
  std::function<std::vector<Vec3>(std::span<const Vec3> hips)> pushes;
};

// So many rows that a surface of such patches has some 15,000 samples.
int rows_of(std::size_t patches) {
  return std::max(2, static_cast<int>(std::sqrt(15000.0 / static_cast<double>(patches))));
}

// The domain of a face is cut into triangles round its middle.
Surface gliss_surface(const Mesh& mesh, Construction construction) {
  BuildOptions options;
  options.level.construction = construction;
  const auto cache = std::make_shared<const PatchCache>(build_cache(mesh, options));
  std::vector<Sample> samples;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    for (std::uint32_t k = 0, n = mesh.valence(face); k < n; ++k) {
      const DomainPoint a = on_side(face, n, k, 0), b = on_side(face, n, k, 1);
      const Eigen::Matrix2d domain{{a.xi, b.xi}, {a.eta, b.eta}};
      for (const Piece& piece : pieces(rows_of(mesh.corner_vertex.size()), false)) {
        const Vec2 x = domain * piece.middle;
        const SurfacePoint p = evaluate(*cache, {face, x[0], x[1]});
        const double area = piece.area * domain.determinant() * p.d_xi.cross(p.d_eta).norm();
        samples.push_back({p.position, p.normal, area});
      }
    }
  }
  const auto pushes = [cache](std::span<const Vec3> hips) {
    const Method method = Method::kGregory;
    std::vector<Contact> contacts(hips.size());
    nearest(*cache, hips, {&method, 1}, {}, contacts);
    std::vector<Vec3> found;
    for (const Contact& contact : contacts) found.push_back(contact.push);
    return found;
  };
  return {std::move(samples), pushes};
}

Surface rival_surface(const Mesh& mesh, Rival rival) {
  const auto surface = std::make_shared<const RivalSurface>(rival, mesh);
  std::vector<Sample> samples;
  for (const RivalPatch& patch : surface->patches()) {
    for (const Piece& piece : pieces(rows_of(surface->patches().size()), patch.is_square)) {
      const RivalPatch::Jet jet = patch.jet(piece.middle);
      samples.push_back({jet.at, jet.normal(), piece.area * jet.u.cross(jet.v).norm()});
    }
  }
  const auto pushes = [surface](std::span<const Vec3> hips) {
    std::vector<Vec3> found;
    for (const RivalFoot& foot : surface->nearest(hips))
      found.push_back(foot.point - hips[found.size()]);
    return found;
  };
  return {std::move(samples), pushes};
}

Surface surface_of(const Mesh& mesh, std::size_t surface) {
  if (surface > 1) return rival_surface(mesh, kRivals[surface - 2]);
  return gliss_surface(mesh, surface == 0 ? Construction::kFair : Construction::kPaper);
}

struct Figures {
  double rms = 0, most = 0;    // of the diagonal
  double normals = 0;          // degrees
  double jumps = 0, step = 0;  // per 100,000 ticks; % of k d
};

Figures measure(const Surface& surface, const Generated& given, std::span<const Walk> walks) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double diagonal = BoxMeasure(given.mesh).diagonal, depth = walk_depth(given.mesh);
  Figures figures;
  double area = 0, squares = 0, angles = 0;
  for (const Sample& sample : surface.samples) {
    const ExactSurface::Point truth = given.exact->nearest(sample.point);
    const double angle =
        std::atan2(sample.normal.cross(truth.normal).norm(), sample.normal.dot(truth.normal));
    area += sample.area;
    squares += sample.area * truth.distance * truth.distance;
    angles += sample.area * angle * angle;
    figures.most = std::max(figures.most, std::abs(truth.distance) / diagonal);
  }
  figures.rms = std::sqrt(squares / area) / diagonal;
  figures.normals = kDegrees * std::sqrt(angles / area);
  ForceStatistics felt(depth);
  for (const Walk& walk : walks) {
    ForceStatistics of_walk(depth);
    const std::span<const Vec3> hips = std::span(walk.hips).subspan(Walk::kEntry - 1);
    for (const Vec3& push : surface.pushes(hips)) of_walk.add(!push.isZero(0), push);
    felt.merge(of_walk);
  }
  figures.jumps = felt.jumps_per_100k();
  figures.step = 100 * felt.largest_step / depth;
  return figures;
}

struct Options {
  std::array<int, 2> faces{320, 1280};
  std::size_t walkers = 60, ticks = 500;
  std::uint64_t seed = 1;
};

using Row = std::array<Figures, kNormals>;
using Rows = std::array<Row, kSurfaces.size()>;

Rows measure_all(const Generated& given, const Options& options, const Engine& engine) {
  const ParallelFor parallel = [&](std::size_t count, std::size_t grain, const auto& body) {
    engine.for_each(count, grain, body);
  };
  const std::vector<Walk> walks = walk_paths(
      given.mesh, build_topology(given.mesh),
      {walk_depth(given.mesh), 0.01, options.walkers, options.ticks, options.seed}, parallel);
  Rows rows;
  parallel(kSurfaces.size() * kNormals, 1, [&](std::size_t i, std::size_t) {
    const std::size_t surface = i / kNormals, normals = i % kNormals;
    if (surface == kPolygons && normals > 0) return;
    rows[surface][normals] =
        measure(surface_of(with_normals(given.mesh, normals), surface), given, walks);
  });
  return rows;
}

// Geometric means of errors, the mean of jumps, and the largest step.
Rows mean_of(const std::vector<Rows>& all) {
  Rows means;
  for (std::size_t i = 0; i < kSurfaces.size() * kNormals; ++i) {
    Figures& mean = means[i / kNormals][i % kNormals];
    for (const Rows& rows : all) {
      const Figures& figures = rows[i / kNormals][i % kNormals];
      mean.rms += std::log(figures.rms) / static_cast<double>(all.size());
      mean.most += std::log(figures.most) / static_cast<double>(all.size());
      mean.normals += std::log(figures.normals) / static_cast<double>(all.size());
      mean.jumps += figures.jumps / static_cast<double>(all.size());
      mean.step = std::max(mean.step, figures.step);
    }
    for (double* const log : {&mean.rms, &mean.most, &mean.normals}) *log = std::exp(*log);
  }
  return means;
}

std::string small(double x) {  // 3.4e-5
  std::string text = fmt::format("{:.1e}", x);
  if (text[text.size() - 2] == '0') text.erase(text.size() - 2, 1);
  return text;
}
std::string rounded(double x) {
  return fmt::format("{:.{}f}", x, x < 0.095 ? 3 : x < 0.95 ? 2 : x < 9.5 ? 1 : 0);
}

void print(const std::string& mesh, const Rows& left, const Rows& right) {
  for (std::size_t s = 0; s < kSurfaces.size(); ++s) {
    std::string line = fmt::format("| {} | {} |", mesh, kSurfaces[s]);
    for (const Row* const row : {&left[s], &right[s]}) {
      const auto add = [&](double Figures::*figure, auto tell) {
        std::string cell;
        for (std::size_t n = 0; n < (s == kPolygons ? 1 : kNormals); ++n)
          cell += (n > 0 ? " / " : "") + tell((*row)[n].*figure);
        line += " " + cell + " |";
      };
      add(&Figures::rms, small);
      add(&Figures::most, small);
      add(&Figures::normals, rounded);
      add(&Figures::jumps, [](double x) { return fmt::format("{:.0f}", x); });
      add(&Figures::step, rounded);
    }
    fmt::print("{}\n", line);
  }
  std::fflush(stdout);
}

// On how many meshes a surface has the least rms, by normals.
std::string wins(const std::vector<Rows>& all, std::size_t surface) {
  std::string cell;
  for (std::size_t n = 0; n < kNormals; ++n) {
    const auto wins = std::count_if(all.begin(), all.end(), [&](const Rows& rows) {
      return std::none_of(rows.begin(), rows.end() - 1,
                          [&](const Row& row) { return row[n].rms < rows[surface][n].rms; });
    });
    cell += (n > 0 ? " / " : "") + std::to_string(wins);
  }
  return cell;
}

void print_table(const Options& options) {
  const auto engine = make_tbb_engine();
  fmt::print(fmt::runtime(kWhat), options.faces[0], options.faces[1], options.walkers,
             options.ticks, options.seed);
  fmt::print("\n| mesh | surface |");
  for (const int faces : options.faces)
    fmt::print(" {}: rms | most | normals | jumps | step |", faces);
  fmt::print("\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<Rows> left, right;
  for (const Shape& shape : shapes()) {
    for (const auto& [kind, name] : kKinds) {
      for (std::vector<Rows>* const side : {&left, &right}) {
        const int faces = options.faces[side == &left ? 0 : 1];
        side->push_back(measure_all(made(shape, kind, faces, options.seed), options, *engine));
      }
      print(fmt::format("{}, {}", shape.name, name), left.back(), right.back());
    }
  }
  print("*all: geometric means, mean jumps, largest step*", mean_of(left), mean_of(right));
  fmt::print("\n| nearest of all by rms, of {} meshes | {} | {} |\n|---|---|---|\n", left.size(),
             options.faces[0], options.faces[1]);
  for (std::size_t s = 0; s < kPolygons; ++s) {
    fmt::print("| {} | {} | {} |\n", kSurfaces[s], wins(left, s), wins(right, s));
  }
}

// By which power of the length of a side fair patches with exact normals come nearer from one size
// to the next.
void print_orders(std::uint64_t seed) {
  constexpr std::array kFaces{320, 1280, 5120};
  fmt::print(
      "\n| fair, exact normals | order of distance, {0} to {1} | {1} to {2} "
      "| of normals, {0} to {1} | {1} to {2} |\n|---|---|---|---|---|\n",
      kFaces[0], kFaces[1], kFaces[2]);
  for (const Shape& shape : shapes()) {
    for (const auto& [kind, name] : kKinds) {
      std::string distance, normals;
      double faces = 0;
      Figures last;
      for (const int wanted : kFaces) {
        const Generated given = made(shape, kind, wanted, seed);
        const auto now = static_cast<double>(given.mesh.face_count());
        const Figures figures = measure(surface_of(given.mesh, 0), given, {});
        const auto order = [&](double from, double to) {
          return fmt::format(" {:.1f} |", std::log(from / to) / std::log(std::sqrt(now / faces)));
        };
        if (faces > 0) {
          distance += order(last.rms, figures.rms);
          normals += order(last.normals, figures.normals);
        }
        faces = now;
        last = figures;
      }
      fmt::print("| {}, {} |{}{}\n", shape.name, name, distance, normals);
      std::fflush(stdout);
    }
  }
}

// Tests of the rivals.

bool expect(bool holds, const std::string& what) {
  fmt::print("{} {}\n", holds ? "ok    " : "WRONG:", what);
  return holds;
}

// True if, on a sphere with exact normals, the distance falls with the power of the length of a
// side that is known.
bool check_order(std::size_t surface) {
  const auto rms = [&](int faces) {
    const Generated given = made(shapes().front(), Kind::kTriangles, faces, 1);
    return measure(surface_of(given.mesh, surface), given, {}).rms;
  };
  const double coarse = rms(320), fine = rms(1280), order = std::log2(coarse / fine);
  const int expected = surface == 1 || surface > 3 ? 2 : 4;
  return expect(std::abs(order - expected) < 0.6,
                fmt::format("{}: {} and {} off a sphere of 320 and 1280 triangles, order {:.1f}",
                            kSurfaces[surface], small(coarse), small(fine), order));
}

// Corners lie where the mesh has them, with its normals or, in a fold, their opposites if they are
// PN triangles' or Nagata's. No sample is nearer than the nearest point, and that of polygons is
// Gliss's.
bool check_patches(Rival rival, Kind kind) {
  const Generated given = made(shapes().back(), kind, 320, 1);
  const RivalSurface surface(rival, given.mesh);
  const PatchCache base = build_base(given.mesh, build_topology(given.mesh), Precision::kDouble);
  QueryOptions flat;
  flat.method = Method::kFlat;
  double off = 0, turned = 0, nearer = 0, other = 0;
  std::vector<Vec3> samples;
  for (const RivalPatch& patch : surface.patches()) {
    for (const Piece& piece : pieces(1, patch.is_square)) {
      for (const Vec2& corner : piece.corners) {
        const RivalPatch::Jet jet = patch.jet(corner);
        const ExactSurface::Point truth = given.exact->nearest(jet.at);
        off = std::max(off, std::abs(truth.distance));
        turned = std::max(turned, jet.normal().cross(truth.normal).norm());
      }
    }
    for (const Piece& piece : pieces(20, patch.is_square))
      samples.push_back(patch.at(piece.middle));
  }
  Random random(1, 0);
  for (int i = 0; i < 300; ++i) {
    const Vec3 hip =
        given.mesh.positions[static_cast<std::size_t>(i) % given.mesh.positions.size()] +
        5 * random.vector();
    const double distance = surface.nearest({&hip, 1})[0].distance;
    for (const Vec3& sample : samples) nearer = std::max(nearer, distance - (sample - hip).norm());
    other = std::max(other, std::abs(distance - std::abs(nearest(base, hip, flat).distance)));
  }
  const double most_turn = rival == Rival::kPn || rival == Rival::kNagata ? 1e-9 : 2;
  return expect(
      off < 1e-9 && turned < most_turn && nearer < 1e-9 && (rival != Rival::kFlat || other < 1e-9),
      fmt::format("knot, surface {}, kind {}: corners off by {:.0e} mm, normals by "
                  "{:.0e}; samples nearer by {:.0e} mm",
                  static_cast<int>(rival), static_cast<int>(kind), off, turned, nearer));
}

bool check() {
  bool holds = true;
  for (std::size_t s = 0; s < kSurfaces.size(); ++s) holds &= check_order(s);
  for (const Rival rival : kRivals) {
    for (const auto& [kind, name] : kKinds) holds &= check_patches(rival, kind);
  }
  return holds;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  bool is_check = false;
  CLI::App app("Gliss's patches beside those of others");
  app.add_flag("--check", is_check, "Test the others instead");
  app.add_option("--faces", options.faces, "Two numbers")->delimiter(',');
  app.add_option("--walkers", options.walkers);
  app.add_option("--ticks", options.ticks, "Of each");
  app.add_option("--seed", options.seed);
  CLI11_PARSE(app, argc, argv);
  if (is_check) return check() ? 0 : 1;
  print_table(options);
  print_orders(options.seed);
}
