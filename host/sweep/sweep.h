// The force over a whole offset surface: for every patch a grid of points, for every
// depth d the HIP G - d n, for every method its contact; and how much the force differs between
// neighbouring samples (Figures 12 and 13).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/engine/engine.h"

namespace gliss {

struct SweepOptions : SolverOptions {
  std::vector<double> depths;  // m, below the patches' surface
  std::vector<Method> methods{Method::kGregory, Method::kShaded, Method::kFlat};
  std::uint32_t rings = 8;  // of the grid: n rings (rings + 1) / 2 points on an n-sided patch
  double stiffness = 500;   // N/m
  // Contacts of a part, about: what is lost at most when the sweep is stopped. Sums are rounded
  // part by part.
  std::uint64_t part_contacts = 1 << 19;
};

// Rings that give at least `samples` points over all faces of the cache.
GLISS_EXPORT std::uint32_t rings_for(const PatchCache& cache, std::uint64_t samples);
GLISS_EXPORT std::uint64_t sample_count(const PatchCache& cache,
                                        std::uint32_t rings);  // points of the grid, one depth

// A distribution over logarithmic bins: counts are integers, so that merging in any order gives the
// same. A value that is not finite is unsound: it is in no bin, ranks above all others, makes max()
// infinite, and is left out of mean().
class GLISS_EXPORT Histogram {
 public:
  static constexpr int kPerDecade = 20, kDecades = 16, kBins = kPerDecade * kDecades;
  static constexpr double kLowest = 1e-12;  // values below count in bin 0
  void add(double value);
  void merge(const Histogram& other);
  bool is_consistent() const;  // true if it can have been added up so; false: read from damage
  std::uint64_t count() const { return count_; }  // with the unsound ones
  std::uint64_t unsound() const { return unsound_; }
  double mean() const {
    return count_ == unsound_ ? 0 : sum_ / static_cast<double>(count_ - unsound_);
  }
  double max() const { return max_; }
  // Interpolated within the bin that holds it, which is 12 % wide; never above max().
  double quantile(double q) const;
  const std::array<std::uint64_t, kBins>& bins() const { return bins_; }
  static double bin_edge(int bin);  // upper edge

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0, unsound_ = 0;
  double sum_ = 0, max_ = 0;
};

// Figures of one depth and method.
struct SweepStatistics {
  double depth = 0;  // m
  Method method = Method::kGregory;
  Histogram step;       // |F_i - F_j| of neighbours within a patch, N; a free one's force is zero
  Histogram edge_step;  // ... of neighbours across an edge, N
  Histogram angle;      // between the forces of neighbours (both kinds), rad
  Histogram error;      // |F - k d n|: the exact force of the patches' own surface, N
  Histogram residual;   // angle between SCP - HIP and the normal, rad
  std::uint64_t samples = 0, touching = 0, unconverged = 0, iterations = 0, crossings = 0;
  // Counts pairs of neighbours of both kinds. felt_pairs: one or both are in contact. jumps: the
  // step is above 20 % of k d, or not finite. lost: the jumps of which one is free and the other is
  // in contact. leaps: those jumps that are also of more than 2 k |dx|, dx being from HIP to HIP:
  // the nearest point is elsewhere, not only farther round a bend between two samples (settle,
  // query.h, has this measure). A sweep has no time: its steps are from place to place.
  std::uint64_t felt_pairs = 0, jumps = 0, lost = 0, leaps = 0;

  // Per 100,000 pairs of neighbours in contact; 0 where there are none.
  double jumps_per_100k() const { return per_100k(jumps); }
  double lost_per_100k() const { return per_100k(lost); }
  double leaps_per_100k() const { return per_100k(leaps); }
  // The jumps that are no leaps: where there are many, samples may be too far apart to count any.
  double bends_per_100k() const { return per_100k(jumps - leaps); }
  bool may_be_sparse() const { return bends_per_100k() > leaps_per_100k() + 1; }
  double per_100k(std::uint64_t count) const {
    return felt_pairs == 0 ? 0 : 1e5 * static_cast<double>(count) / static_cast<double>(felt_pairs);
  }
};

// Samples of one chunk, depth and method, in the order of the grid. HIP and SCP in the mesh's unit,
// the force in N, the residual angle in rad.
struct SweepBlock {
  std::size_t depth_index = 0, method_index = 0;
  std::uint64_t row = 0;  // of its first sample, among all of this depth and method
  std::vector<std::uint32_t> face;
  std::vector<double> xi, eta;
  std::vector<Vec3> hip, scp, force;
  std::vector<float> residual_angle;
  std::vector<std::uint32_t> iterations, crossings;
  std::vector<std::uint8_t> flags;
};

// Blocks arrive in order (chunk, depth, method), always from one thread at a time; null: only
// statistics are kept.
using SweepSink = std::function<void(const SweepBlock&)>;
// Told after each window of chunks, and several times a second where one takes long, how many of
// all samples are done. What it throws ends the sweep.
using SweepProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

struct SweepResult {
  std::vector<SweepStatistics> statistics;  // [depth][method]
  std::uint64_t computed = 0;               // contacts, without those of parts that were there
};

class SweepParts;

// Memory is bounded by the part under way, whatever the number of samples; the result is the same
// at any thread count. With `parts` (in files, as gliss sweep keeps them, made of the same cache
// and options), those that are there already are taken from there, unless a few contacts that are
// done again differ, and others kept there; the result is the same.
GLISS_EXPORT SweepResult sweep(const PatchCache& cache, const Engine& engine,
                               const SweepOptions& options, const SweepSink& sink = nullptr,
                               const SweepProgress& progress = nullptr,
                               SweepParts* parts = nullptr);

}  // namespace gliss
