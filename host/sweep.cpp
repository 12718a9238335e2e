#include "host/sweep.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <numbers>

namespace gliss {
namespace {

constexpr std::uint64_t kChunkPoints =
    4096;                                    // a chunk is whole faces, or some rings of a large one
constexpr std::size_t kChunksPerThread = 4;  // of a window

// Ring r = 1 ... rings of a face has r points in each sector, at (r - 1/2) / rings of the way to
// the side; so a side and its twin have the same number of points beside them, in opposite order.
struct Points {
  std::vector<double> xi, eta;
  std::vector<SurfacePoint> surface;
};

void add_sector(std::uint32_t n, std::uint32_t rings, std::uint32_t r, std::uint32_t k,
                Points& points) {
  const double radius = (r - 0.5) / rings;
  const double a = 2 * std::numbers::pi * k / n, b = 2 * std::numbers::pi * (k + 1) / n;
  for (std::uint32_t i = 0; i < r; ++i) {
    const double t = (i + 0.5) / r;
    points.xi.push_back(radius * ((1 - t) * std::cos(a) + t * std::cos(b)));
    points.eta.push_back(radius * ((1 - t) * std::sin(a) + t * std::sin(b)));
  }
}

// Points in rings 1 to r.
std::uint64_t grid_size(std::uint32_t n, std::uint64_t r) { return n * r * (r + 1) / 2; }

// Faces [begin, end) of the list, their rings [first, last).
struct Chunk {
  std::size_t begin, end;
  std::uint32_t first, last;
};

// Sides of whole faces: the outer sides of their patches.
struct FaceSide {
  std::uint32_t face = kNone, side = 0;
};

class Sweeper {
 public:
  Sweeper(const PatchCache& cache, const Engine& engine, const SweepOptions& options)
      : cache_(cache), engine_(engine), options_(options) {
    for (std::uint32_t f = 0; f < cache.mesh_face_count; ++f) {
      if (cache.face_patch[f] != kNone) faces_.push_back(f);
    }
    cut_chunks();
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
    const std::size_t chunks = chunks_.size();
    const std::size_t window = kChunksPerThread * static_cast<std::size_t>(engine_.threads());
    const std::uint64_t total = sample_count(cache_, options_.rings) * options_.depths.size();
    std::uint64_t done = 0;
    std::future<void> writing;  // the last window goes out while the next is computed
    for (std::size_t first = 0; first < chunks; first += window) {
      auto pieces = std::make_shared<std::vector<Piece>>(std::min(window, chunks - first));
      engine_.for_each(pieces->size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          compute(chunks_[first + i], sink != nullptr, (*pieces)[i]);
      });
      for (const Piece& piece : *pieces) {
        for (std::size_t i = 0; i < piece.statistics.size(); ++i)
          merge(piece.statistics[i], result.statistics[i]);
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

  // As many faces as fit into a chunk, or as many rings of one face.
  void cut_chunks() {
    const std::uint32_t all = options_.rings + 1;
    std::uint64_t points = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const std::uint32_t n = cache_.face_valence[faces_[i]];
      const std::uint64_t size = grid_size(n, options_.rings);
      if (size > kChunkPoints) {
        for (std::uint32_t first = 1; first < all;) {
          std::uint32_t last = first + 1;
          while (last < all && grid_size(n, last) - grid_size(n, first - 1) <= kChunkPoints) ++last;
          chunks_.push_back({i, i + 1, first, last});
          first = last;
        }
        points = kChunkPoints;
      } else if (chunks_.empty() || points + size > kChunkPoints) {
        chunks_.push_back({i, i + 1, 1, all});
        points = size;
      } else {
        chunks_.back().end = i + 1;
        points += size;
      }
    }
  }

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
            if (face == other && s.valence(s.side_patch[side]) != cache_.face_valence[face])
              continue;
            twin_[side_begin_[face] + cache_.corner_of_face[side]] = {other,
                                                                      cache_.corner_of_face[twin]};
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

  void count_step(const Felt& felt, const Felt& other, Histogram SweepStatistics::*step,
                  std::span<SweepStatistics> statistics) const {
    for (std::size_t m = 0; m < statistics.size(); ++m) {
      const Vec3 &a = felt.force[m], &b = other.force[m];
      (statistics[m].*step).add((a - b).norm());
      if (a.squaredNorm() > 0 && b.squaredNorm() > 0)
        statistics[m].angle.add(std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }

  void compute(const Chunk& chunk, bool keep, Piece& piece) const {
    const std::size_t methods = options_.methods.size(), kinds = options_.depths.size() * methods;
    piece.statistics.resize(kinds);
    if (keep) {
      piece.blocks.resize(kinds);
      for (std::size_t i = 0; i < kinds; ++i) {
        piece.blocks[i].depth_index = i / methods;
        piece.blocks[i].method_index = i % methods;
      }
    }
    for (std::size_t i = chunk.begin; i < chunk.end; ++i) compute_face(faces_[i], chunk, piece);
  }

  // Ring by ring; one more than the chunk's own, for the steps outward to it.
  void compute_face(std::uint32_t face, const Chunk& chunk, Piece& piece) const {
    const std::uint32_t n = cache_.face_valence[face];
    const std::size_t depths = options_.depths.size(), methods = options_.methods.size();
    std::vector<std::vector<Felt>> inner(depths), ring(depths);
    for (std::uint32_t r = chunk.first; r <= std::min(chunk.last, options_.rings); ++r) {
      Points points;
      for (std::uint32_t k = 0; k < n; ++k) add_sector(n, options_.rings, r, k, points);
      place(face, points);
      const bool own = r < chunk.last;
      if (own) piece.points += points.surface.size();
      for (std::size_t d = 0; d < depths; ++d) {
        const std::span<SweepStatistics> statistics(&piece.statistics[d * methods], methods);
        ring[d].clear();
        for (std::size_t p = 0; p < points.surface.size(); ++p) {
          const Vec3 hip = hip_of(points.surface[p], d);
          ring[d].push_back(feel(hip));
          if (!own) continue;
          const Vec3 exact = options_.stiffness * options_.depths[d] * points.surface[p].normal;
          for (std::size_t m = 0; m < methods; ++m) {
            const Contact& contact = ring[d][p].contact[m];
            const Vec3& force = ring[d][p].force[m];
            count_sample(contact, (force - exact).norm(), statistics[m]);
            if (!piece.blocks.empty()) {
              append(piece.blocks[d * methods + m], face, points.xi[p], points.eta[p], hip, contact,
                     force);
            }
          }
        }
        if (r > chunk.first) count_outward(r, inner[d], ring[d], statistics);
        if (own) count_along(ring[d], statistics);
        if (own && r == options_.rings) count_across(face, ring[d], d, statistics);
      }
      std::swap(inner, ring);
    }
  }

  void place(std::uint32_t face, Points& points) const {
    points.surface.resize(points.xi.size());
    evaluate(cache_, face, points.xi, points.eta, points.surface);
  }

  Vec3 hip_of(const SurfacePoint& point, std::size_t depth) const {
    return point.position - options_.depths[depth] / cache_.unit * point.normal;
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

  void count_along(const std::vector<Felt>& ring, std::span<SweepStatistics> statistics) const {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      count_step(ring[i], ring[(i + 1) % ring.size()], &SweepStatistics::step, statistics);
    }
  }

  // From each point of ring r - 1 to the one of ring r nearest to it in its sector.
  void count_outward(std::uint32_t r, const std::vector<Felt>& inner, const std::vector<Felt>& ring,
                     std::span<SweepStatistics> statistics) const {
    for (std::size_t i = 0; i < inner.size(); ++i) {
      const std::size_t sector = i / (r - 1), at = i % (r - 1);
      const std::size_t outward = sector * r + (2 * at + 1) * r / (2 * (r - 1));
      count_step(inner[i], ring[outward], &SweepStatistics::step, statistics);
    }
  }

  // To the last ring of each neighbour with a higher number.
  void count_across(std::uint32_t face, const std::vector<Felt>& ring, std::size_t depth,
                    std::span<SweepStatistics> statistics) const {
    const std::uint32_t rings = options_.rings;
    for (std::uint32_t k = 0; k < cache_.face_valence[face]; ++k) {
      const FaceSide twin = twin_[side_begin_[face] + k];
      if (twin.face == kNone || twin.face <= face) continue;
      Points theirs;
      add_sector(cache_.face_valence[twin.face], rings, rings, twin.side, theirs);
      place(twin.face, theirs);
      for (std::uint32_t i = 0; i < rings; ++i) {
        count_step(ring[std::size_t{k} * rings + i],
                   feel(hip_of(theirs.surface[rings - 1 - i], depth)), &SweepStatistics::edge_step,
                   statistics);
      }
    }
  }

  static void append(SweepBlock& block, std::uint32_t face, double xi, double eta, const Vec3& hip,
                     const Contact& contact, const Vec3& force) {
    const auto byte = [](std::uint32_t count) {
      return static_cast<std::uint8_t>(std::min(count, 255u));
    };
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
  std::vector<std::uint32_t> faces_;
  std::vector<Chunk> chunks_;
  std::vector<std::size_t> side_begin_;  // [face + 1]
  std::vector<FaceSide> twin_;           // [face side]
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

SweepResult sweep(const PatchCache& cache, const Engine& engine, const SweepOptions& options,
                  const SweepSink& sink, const SweepProgress& progress) {
  return Sweeper(cache, engine, options).run(sink, progress);
}

const char* method_name(Method method) {
  return method == Method::kGregory ? "gregory" : method == Method::kShaded ? "shaded" : "flat";
}

}  // namespace gliss
