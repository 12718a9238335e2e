#include "gliss/sweep/surface_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gliss/query/query.h"
#include "gliss/sweep/sweep.h"
#include "gliss/sweep/sweep_grid.h"

namespace gliss {
namespace {

// At most `most` points of the grid, spread evenly over it.
std::vector<DomainPoint> grid_points(const PatchCache& cache, std::uint32_t rings,
                                     std::uint64_t most) {
  const SweepGrid grid(cache, rings);
  std::vector<DomainPoint> points, kept;
  const std::uint64_t all = sample_count(cache, rings), wanted = std::min(all, most);
  std::uint64_t seen = 0;
  for (std::size_t chunk = 0; chunk < grid.chunk_count(); ++chunk) {
    points.clear();
    grid.add_own_points(grid.chunk(chunk), points);
    for (const DomainPoint& point : points) {
      const std::uint64_t before = seen++ * wanted / all;
      if (seen * wanted / all != before) kept.push_back(point);
    }
  }
  return kept;
}

// The diameter of a spot where each stands for `thinning` points of the grid: about as wide as what
// is stretched most there. A whole grid of few rings leaves more between its points and the
// corners.
double spot_at(const SurfacePoint& p, std::uint32_t n, std::uint32_t rings, double thinning) {
  const double a = p.d_xi.squaredNorm(), b = p.d_xi.dot(p.d_eta), c = p.d_eta.squaredNorm();
  const double stretch = std::sqrt((a + c) / 2 + std::hypot((a - c) / 2, b));
  // The domain's area is n/2 sin(2 pi/n), and it has n/2 rings (rings + 1) points.
  const double area = std::sin(2 * std::numbers::pi / n) / (rings * (rings + 1.0));
  return (1.3 + 1.5 / (rings * std::sqrt(thinning))) * stretch * std::sqrt(area * thinning);
}

void add(std::vector<float>& to, const Vec3& vector) {
  for (const double x : vector) to.push_back(static_cast<float>(x));
}

}  // namespace

std::vector<double> face_curvatures(const PatchCache& cache) {
  std::vector<double> curvature(cache.mesh_face_count, std::nan(""));
  for (std::size_t patch = 0; patch < cache.patch_face.size(); ++patch) {
    double& of_face = curvature[cache.patch_face[patch]];
    of_face = std::fmax(of_face, 1 / cache.rho_min[patch]);
  }
  return curvature;
}

SurfacePicture picture_of(const PatchCache& cache, std::size_t most_points) {
  std::uint32_t rings = 1;
  while (sample_count(cache, rings + 1) <= most_points) ++rings;
  const std::vector<DomainPoint> places = grid_points(cache, rings, most_points);
  const double thinning =
      static_cast<double>(sample_count(cache, rings)) / static_cast<double>(places.size());
  std::vector<SurfacePoint> points(places.size());
  evaluate(cache, places, points);

  std::vector<Vec3> positions;
  for (const SurfacePoint& point : points) positions.push_back(point.position);
  std::vector<Contact> flat(points.size());
  constexpr Method kFlat = Method::kFlat;
  nearest(cache, positions, {&kFlat, 1}, {}, flat);

  std::vector<double> curvature = face_curvatures(cache);
  SurfacePicture picture;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t face = places[i].face;
    picture.face.push_back(face);
    add(picture.position, points[i].position);
    add(picture.normal, points[i].normal);
    picture.spot.push_back(
        static_cast<float>(spot_at(points[i], cache.face_valence[face], rings, thinning)));
    picture.curvature.push_back(static_cast<float>(curvature[face]));
    picture.departure.push_back(static_cast<float>(std::abs(flat[i].distance)));
  }
  std::erase_if(curvature, [](double of_face) { return std::isnan(of_face); });
  std::sort(curvature.begin(), curvature.end());
  picture.p50 = curvature[curvature.size() / 2];
  picture.p99 = curvature[curvature.size() * 99 / 100];
  picture.largest = curvature.back();
  return picture;
}

}  // namespace gliss
