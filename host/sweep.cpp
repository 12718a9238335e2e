#include "host/sweep.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <numbers>

namespace gliss {
namespace {

constexpr std::uint64_t kChunkPoints = 4096;  // a chunk is whole faces, at least one
constexpr std::size_t kChunksPerThread = 4;   // of a window

// Ring r = 1 ... rings of a face has r points in each sector, at (r - 1/2) / rings of the way to the side; so a side and
// its twin have the same number of points beside them, in opposite order.
struct Grid {
  std::vector<double> xi, eta;
};

std::size_t grid_index(std::uint32_t n, std::uint32_t r, std::uint32_t sector, std::uint32_t i) {
  return std::size_t{n} * r * (r - 1) / 2 + std::size_t{sector} * r + i;
}

std::size_t grid_size(std::uint32_t n, std::uint32_t rings) { return grid_index(n, rings + 1, 0, 0); }

Grid make_grid(std::uint32_t n, std::uint32_t rings) {
  Grid g;
  for (std::uint32_t r = 1; r <= rings; ++r) {
    const double radius = (r - 0.5) / rings;
    for (std::uint32_t k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * k / n, b = 2 * std::numbers::pi * (k + 1) / n;
      for (std::uint32_t i = 0; i < r; ++i) {
        const double t = (i + 0.5) / r;
        g.xi.push_back(radius * ((1 - t) * std::cos(a) + t * std::cos(b)));
        g.eta.push_back(radius * ((1 - t) * std::sin(a) + t * std::sin(b)));
      }
    }
  }
  return g;
}

// Sides of whole faces: the outer sides of their patches.
struct FaceSide {
  std::uint32_t face = kNone, side = 0;
};

class Sweeper {
 public:
  Sweeper(const PatchCache& cache, const Engine& engine, const SweepOptions& options)
      : cache_(cache), engine_(engine), options_(options) {
    for (std::uint32_t f = 0; f < cache.mesh_face_count; ++f) {
      if (cache.face_patch[f] == kNone) continue;
      const std::uint32_t n = cache.face_valence[f];
      if (!grids_.contains(n)) grids_.emplace(n, make_grid(n, options.rings));
      if (chunk_begin_.empty() || chunk_points_ + grid_size(n, options.rings) > kChunkPoints) {
        chunk_begin_.push_back(faces_.size());
        chunk_points_ = 0;
      }
      chunk_points_ += grid_size(n, options.rings);
      faces_.push_back(f);
    }
    chunk_begin_.push_back(faces_.size());
    find_twins();
  }

  SweepResult run(const SweepSink& sink, const SweepProgress& progress) {
    SweepResult result;
    for (const double depth : options_.depths) {
      for (const Method method : options_.methods) {
        result.statistics.emplace_back();
        result.statistics.back().depth = depth;
        result.statistics.back().method = method;
      }
    }
    const std::size_t chunks = chunk_begin_.size() - 1;
    const std::size_t window = kChunksPerThread * static_cast<std::size_t>(engine_.threads());
    const std::uint64_t total = sample_count(cache_, options_.rings) * options_.depths.size();
    std::uint64_t done = 0;
    std::future<void> writing;  // the last window goes out while the next is computed
    for (std::size_t first = 0; first < chunks; first += window) {
      auto pieces = std::make_shared<std::vector<Piece>>(std::min(window, chunks - first));
      engine_.for_each(pieces->size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) compute(first + i, sink != nullptr, (*pieces)[i]);
      });
      for (const Piece& piece : *pieces) {
        for (std::size_t i = 0; i < piece.statistics.size(); ++i) merge(piece.statistics[i], result.statistics[i]);
        done += piece.points * options_.depths.size();
      }
      if (writing.valid()) writing.get();
      if (sink) {
        writing = std::async(std::launch::async, [&sink, pieces] {
          for (const Piece& piece : *pieces) {
            for (const SweepBlock& block : piece.blocks) sink(block);
          }
        });
      }
      if (progress && !progress(done, total)) {
        result.complete = false;
        break;
      }
    }
    if (writing.valid()) writing.get();
    return result;
  }

 private:
  struct Piece {
    std::vector<SweepStatistics> statistics;  // [depth][method]
    std::vector<SweepBlock> blocks;
    std::uint64_t points = 0;
  };

  // Contacts and forces of one HIP, by method.
  struct Felt {
    std::array<Contact, kMethods> contact;
    std::array<Vec3, kMethods> force;
  };

  void find_twins() {
    side_begin_.assign(cache_.mesh_face_count + 1, 0);
    for (std::uint32_t f = 0; f < cache_.mesh_face_count; ++f) {
      side_begin_[f + 1] = side_begin_[f] + cache_.face_valence[f];
    }
    twin_.resize(side_begin_.back());
    std::visit(
        [&](const auto& s) {
          for (std::uint32_t side = 0; side < s.side_patch.size(); ++side) {
            const std::uint32_t twin = s.side_twin[side];
            if (twin == kNone) continue;
            const std::uint32_t face = cache_.patch_face[s.side_patch[side]];
            const std::uint32_t other = cache_.patch_face[s.side_patch[twin]];
            // Not the cuts inside one face.
            if (face == other && s.valence(s.side_patch[side]) != cache_.face_valence[face]) continue;
            twin_[side_begin_[face] + cache_.corner_of_face[side]] = {other, cache_.corner_of_face[twin]};
          }
        },
        cache_.surface);
  }

  Felt feel(const Vec3& hip) const {
    QueryOptions query;
    query.solver = options_.solver;
    Felt felt;
    nearest(cache_, hip, options_.methods, query, felt.contact);
    for (std::size_t m = 0; m < options_.methods.size(); ++m) {
      felt.force[m] = force(cache_, felt.contact[m], options_.stiffness);
    }
    return felt;
  }

  void count_step(const Felt& felt, const Felt& other, Histogram SweepStatistics::* step,
                  std::span<SweepStatistics> statistics) const {
    for (std::size_t m = 0; m < statistics.size(); ++m) {
      const Vec3 &a = felt.force[m], &b = other.force[m];
      (statistics[m].*step).add((a - b).norm());
      if (a.squaredNorm() > 0 && b.squaredNorm() > 0) statistics[m].angle.add(std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }

  void compute(std::size_t chunk, bool keep, Piece& piece) const {
    const std::size_t methods = options_.methods.size(), kinds = options_.depths.size() * methods;
    piece.statistics.resize(kinds);
    if (keep) {
      piece.blocks.resize(kinds);
      for (std::size_t i = 0; i < kinds; ++i) {
        piece.blocks[i].depth_index = i / methods;
        piece.blocks[i].method_index = i % methods;
      }
    }
    std::vector<SurfacePoint> points;
    std::vector<Felt> felt;
    for (std::size_t i = chunk_begin_[chunk]; i < chunk_begin_[chunk + 1]; ++i) {
      const std::uint32_t face = faces_[i], n = cache_.face_valence[face];
      const Grid& grid = grids_.at(n);
      points.resize(grid.xi.size());
      felt.resize(grid.xi.size());
      evaluate(cache_, face, grid.xi, grid.eta, points);
      piece.points += points.size();
      for (std::size_t d = 0; d < options_.depths.size(); ++d) {
        const double depth = options_.depths[d] / cache_.unit;
        const std::span<SweepStatistics> statistics(&piece.statistics[d * methods], methods);
        for (std::size_t p = 0; p < points.size(); ++p) {
          const Vec3 hip = points[p].position - depth * points[p].normal;
          felt[p] = feel(hip);
          const Vec3 exact = options_.stiffness * cache_.unit * depth * points[p].normal;
          for (std::size_t m = 0; m < methods; ++m) {
            count_sample(felt[p].contact[m], (felt[p].force[m] - exact).norm(), statistics[m]);
            if (keep) {
              append(piece.blocks[d * methods + m], face, grid.xi[p], grid.eta[p], hip, felt[p].contact[m],
                     felt[p].force[m]);
            }
          }
        }
        count_steps(face, n, depth, felt, statistics);
      }
    }
  }

  static void count_sample(const Contact& contact, double error, SweepStatistics& s) {
    ++s.samples;
    s.touching += contact.touching;
    s.unconverged += (contact.flags & kConverged) == 0;
    s.iterations += static_cast<std::uint64_t>(contact.iterations);
    s.crossings += static_cast<std::uint64_t>(contact.crossings);
    s.error.add(error);
    s.residual.add(contact.residual_angle);
  }

  // Neighbours along the rings, from ring to ring, and across the edges to faces of a higher number.
  void count_steps(std::uint32_t face, std::uint32_t n, double depth, const std::vector<Felt>& felt,
                   std::span<SweepStatistics> statistics) const {
    const std::uint32_t rings = options_.rings;
    for (std::uint32_t r = 1; r <= rings; ++r) {
      const std::size_t first = grid_index(n, r, 0, 0), count = std::size_t{n} * r;
      for (std::size_t i = 0; i < count; ++i) {
        count_step(felt[first + i], felt[first + (i + 1) % count], &SweepStatistics::step, statistics);
        if (r == rings) continue;
        const auto sector = static_cast<std::uint32_t>(i / r), at = static_cast<std::uint32_t>(i % r);
        const std::size_t outward = grid_index(n, r + 1, sector, (2 * at + 1) * (r + 1) / (2 * r));
        count_step(felt[first + i], felt[outward], &SweepStatistics::step, statistics);
      }
    }
    for (std::uint32_t k = 0; k < n; ++k) {
      const FaceSide twin = twin_[side_begin_[face] + k];
      if (twin.face == kNone || twin.face <= face) continue;
      const std::uint32_t m = cache_.face_valence[twin.face];
      const Grid& grid = grids_.at(m);
      const std::size_t theirs = grid_index(m, rings, twin.side, 0);
      std::vector<SurfacePoint> points(rings);
      evaluate(cache_, twin.face, std::span(grid.xi).subspan(theirs, rings), std::span(grid.eta).subspan(theirs, rings),
               points);
      for (std::uint32_t i = 0; i < rings; ++i) {
        const SurfacePoint& p = points[rings - 1 - i];
        count_step(felt[grid_index(n, rings, k, i)], feel(p.position - depth * p.normal), &SweepStatistics::edge_step,
                   statistics);
      }
    }
  }

  static void append(SweepBlock& block, std::uint32_t face, double xi, double eta, const Vec3& hip, const Contact& contact,
                     const Vec3& force) {
    const auto byte = [](std::uint32_t count) { return static_cast<std::uint8_t>(std::min(count, 255u)); };
    block.face.push_back(face);
    block.xi.push_back(xi);
    block.eta.push_back(eta);
    block.hip.push_back(hip);
    block.scp.push_back(contact.scp);
    block.force.push_back(force);
    block.residual_angle.push_back(static_cast<float>(contact.residual_angle));
    block.iterations.push_back(byte(static_cast<std::uint32_t>(contact.iterations)));
    block.crossings.push_back(byte(static_cast<std::uint32_t>(contact.crossings)));
    block.flags.push_back(byte(contact.flags));
  }

  static void merge(const SweepStatistics& from, SweepStatistics& to) {
    to.step.merge(from.step);
    to.edge_step.merge(from.edge_step);
    to.angle.merge(from.angle);
    to.error.merge(from.error);
    to.residual.merge(from.residual);
    to.samples += from.samples;
    to.touching += from.touching;
    to.unconverged += from.unconverged;
    to.iterations += from.iterations;
    to.crossings += from.crossings;
  }

  const PatchCache& cache_;
  const Engine& engine_;
  const SweepOptions& options_;
  std::map<std::uint32_t, Grid> grids_;  // [valence]
  std::vector<std::uint32_t> faces_;
  std::vector<std::size_t> chunk_begin_;  // of faces_
  std::uint64_t chunk_points_ = 0;
  std::vector<std::size_t> side_begin_;   // [face + 1]
  std::vector<FaceSide> twin_;            // [face side]
};

}  // namespace

std::uint64_t sample_count(const PatchCache& cache, std::uint32_t rings) {
  std::uint64_t count = 0;
  for (std::uint32_t f = 0; f < cache.mesh_face_count; ++f) {
    if (cache.face_patch[f] != kNone) count += grid_size(cache.face_valence[f], rings);
  }
  return count;
}

std::uint32_t rings_for(const PatchCache& cache, std::uint64_t samples) {
  std::uint32_t rings = 1;
  while (sample_count(cache, rings) < samples) ++rings;
  return rings;
}

SweepResult sweep(const PatchCache& cache, const Engine& engine, const SweepOptions& options, const SweepSink& sink,
                  const SweepProgress& progress) {
  return Sweeper(cache, engine, options).run(sink, progress);
}

const char* method_name(Method method) {
  return method == Method::kGregory ? "gregory" : method == Method::kShaded ? "shaded" : "flat";
}

}  // namespace gliss
