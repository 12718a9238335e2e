// Points of patches, many at once. Those of one patch fill lanes; where they come in another order
// they are sorted by patch, or, where patches have too few points for that, go a patch a lane.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/frames.h"
#include "gliss/query/placed_points.h"

namespace gliss {
namespace {

constexpr std::size_t kPiece = 4096;  // points that are put in order at once
constexpr std::size_t kRows = 256;    // points whose rows stay in the nearest cache
constexpr std::size_t kStride = row_stride(kRows);

template <class Real>
void evaluate_patch(const Surface<Real>& s, std::uint32_t patch, const Real* xi, const Real* eta,
                    std::size_t count, std::size_t stride, Real* rows) {
  const std::uint32_t n = s.valence(patch);
  kernels<Real>().evaluate(&s.domain[s.domain_begin[n]],
                           &s.control[3 * std::size_t{s.control_begin[patch]}], s.form[patch], n,
                           xi, eta, count, stride, rows);
}

template <class Real>
struct Piece {
  PlacedPoints<Real> points;
  PatchOrder order;
  std::vector<Real> xi, eta;  // sorted
  std::vector<Real> rows = std::vector<Real>(9 * kStride);
};

// Points of one patch.
template <class Real>
struct RunOfPoints {
  std::uint32_t patch;
  const Real *xi, *eta;
  std::size_t count, first;  // as EvaluatedPoints has them
  const std::uint32_t* at = nullptr;
};

template <class Real, class T>
void evaluate_run(const PatchCache& cache, const Surface<Real>& s, const RunOfPoints<Real>& run,
                  const SurfaceArrays<T>& out, std::vector<Real>& rows) {
  EvaluatedPoints<Real> points{rows.data(), kStride, 0, &run.patch, 0, run.first, run.at};
  for (std::size_t i = 0; i < run.count; i += points.count) {
    points.move_target(points.count);
    points.count = std::min(kRows, run.count - i);
    evaluate_patch(s, run.patch, run.xi + i, run.eta + i, points.count, kStride, rows.data());
    place_points(cache, s, points, out);
  }
}

template <class Real, class T>
void evaluate_piece(const PatchCache& cache, const Surface<Real>& s, const PointArrays<T>& points,
                    std::size_t begin, std::size_t count, Piece<Real>& piece,
                    const SurfaceArrays<T>& out) {
  PatchOrder& order = piece.order;
  piece.points.take(cache, s, points, begin, count);
  const Real *xi = piece.points.xi.data(), *eta = piece.points.eta.data();
  switch (order.judge(piece.points.runs, static_cast<std::size_t>(kernels<Real>().lanes))) {
    case PatchOrder::kInRuns:
      for (const PatchRun& run : piece.points.runs)
        evaluate_run<Real>(
            cache, s,
            {run.patch, xi + run.begin, eta + run.begin, run.end - run.begin, begin + run.begin},
            out, piece.rows);
      break;
    case PatchOrder::kByPatch:
      order.sort();
      piece.xi.resize(count), piece.eta.resize(count);
      for (std::size_t i = 0; i < count; ++i) {
        piece.xi[i] = xi[order.order[i]];
        piece.eta[i] = eta[order.order[i]];
      }
      for (const PatchRun& run : order.runs)
        evaluate_run<Real>(cache, s,
                           {run.patch, &piece.xi[run.begin], &piece.eta[run.begin],
                            run.end - run.begin, begin, &order.order[run.begin]},
                           out, piece.rows);
      break;
    case PatchOrder::kSparse:
      for (std::size_t i = 0; i < count; i += kRows) {
        const std::size_t many = std::min(kRows, count - i);
        kernels<Real>().evaluate_each(s, &order.patch[i], xi + i, eta + i, many, kStride,
                                      piece.rows.data());
        place_points<Real>(cache, s,
                           {piece.rows.data(), kStride, many, &order.patch[i], 1, begin + i}, out);
      }
  }
}

template <class Real>
Piece<Real>& own_piece() {
  thread_local Piece<Real> piece;
  return piece;
}

template <class T>
void evaluate_points(const PatchCache& cache, const PointArrays<T>& points,
                     const SurfaceArrays<T>& out) {
  require_patches(cache);
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    for (std::size_t begin = 0; begin < points.count; begin += kPiece)
      evaluate_piece(cache, s, points, begin, std::min(kPiece, points.count - begin),
                     own_piece<Real>(), out);
  });
}

template <class T>
void evaluate_grid_points(const PatchCache& cache, std::span<const std::uint32_t> faces,
                          std::span<const T> xi, std::span<const T> eta,
                          const SurfaceArrays<T>& out) {
  require_patches(cache);
  if (xi.size() != eta.size()) {
    throw std::invalid_argument("a grid of " + std::to_string(xi.size()) + " xi and " +
                                std::to_string(eta.size()) + " eta");
  }
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    const std::vector<Real> xis(xi.begin(), xi.end()), etas(eta.begin(), eta.end());
    Piece<Real>& piece = own_piece<Real>();
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const std::uint32_t patch = cache.first_patch(faces[i]);
      const SurfaceArrays<T> there = out.from(i * xi.size());
      if (is_piece_of_face(cache, patch)) {
        PointArrays<T> points{xi.size(), {&faces[i], 0}, {xi.data()}, {eta.data()}};
        evaluate_points(cache, points, there);
        continue;
      }
      evaluate_run<Real>(cache, s, {patch, xis.data(), etas.data(), xis.size(), 0}, there,
                         piece.rows);
    }
  });
}

}  // namespace

SurfacePoint evaluate(const PatchCache& cache, const DomainPoint& point) {
  require_patches(cache);
  const PlainArithmetic plain;
  SurfacePoint found;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    const PatchPlace place = place_of(cache, s, point);
    const auto xi = static_cast<Real>(place.xi), eta = static_cast<Real>(place.eta);
    Real rows[9];
    evaluate_patch(s, place.patch, &xi, &eta, 1, 1, rows);
    place_points<Real>(cache, s, {rows, 1, 1, &place.patch, 0, 0}, arrays_of(std::span(&found, 1)));
  });
  return found;
}

void evaluate(const PatchCache& cache, const PointArrays<double>& points,
              const SurfaceArrays<double>& out) {
  evaluate_points(cache, points, out);
}
void evaluate(const PatchCache& cache, const PointArrays<float>& points,
              const SurfaceArrays<float>& out) {
  evaluate_points(cache, points, out);
}
void evaluate(const PatchCache& cache, std::span<const DomainPoint> points,
              std::span<SurfacePoint> out) {
  require_room(out.size(), points.size());
  evaluate_points(cache, arrays_of(points), arrays_of(out));
}
void evaluate_grid(const PatchCache& cache, std::span<const std::uint32_t> faces,
                   std::span<const double> xi, std::span<const double> eta,
                   const SurfaceArrays<double>& out) {
  evaluate_grid_points(cache, faces, xi, eta, out);
}
void evaluate_grid(const PatchCache& cache, std::span<const std::uint32_t> faces,
                   std::span<const float> xi, std::span<const float> eta,
                   const SurfaceArrays<float>& out) {
  evaluate_grid_points(cache, faces, xi, eta, out);
}

PointArrays<double> arrays_of(std::span<const DomainPoint> points) {
  const DomainPoint* p = points.data();
  if (p == nullptr) return {};
  return {points.size(), {&p->face, sizeof *p}, {&p->xi, sizeof *p}, {&p->eta, sizeof *p}};
}

SurfaceArrays<double> arrays_of(std::span<SurfacePoint> points) {
  SurfacePoint* p = points.data();
  if (p == nullptr) return {};
  return {strided_vectors(p->position.data(), sizeof *p),
          strided_vectors(p->d_xi.data(), sizeof *p), strided_vectors(p->d_eta.data(), sizeof *p),
          strided_vectors(p->normal.data(), sizeof *p)};
}

}  // namespace gliss
