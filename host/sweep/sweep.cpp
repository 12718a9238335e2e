#include "gliss/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "gliss/base/pace.h"
#include "gliss/base/plain_arithmetic.h"
#include "gliss/base/require.h"
#include "gliss/base/stopwatch.h"
#include "gliss/query/force_statistics.h"
#include "gliss/sweep/sweep_grid.h"
#include "gliss/sweep/sweep_parts.h"

namespace gliss {
namespace {

constexpr double kAskEvery = 0.1;    // s
constexpr int kSpotChecks = 4;       // of a block that is read
constexpr double kRounding = 1e-9;   // of a point of a domain
constexpr double kAgreement = 1e-3;  // of a depth, and of the force there

// A contact, as far as a sweep needs it.
struct Touch {
  bool touching;
  Vec3 scp, force;  // N
  double residual_angle;
  int iterations, crossings;
  std::uint32_t flags;
};

// Their pushes come where their forces are to be.
ContactArrays<double> touch_arrays(std::span<Touch> touches) {
  Touch& t = touches.front();
  constexpr std::ptrdiff_t kStride = sizeof t;
  return {.touching = {&t.touching, kStride},
          .scp = strided_vectors(t.scp.data(), kStride),
          .push = strided_vectors(t.force.data(), kStride),
          .residual_angle = {&t.residual_angle, kStride},
          .iterations = {&t.iterations, kStride},
          .crossings = {&t.crossings, kStride},
          .flags = {&t.flags, kStride}};
}

// A chunk under way.
struct Piece {
  SweepChunk chunk;
  std::uint64_t row;                        // of its first sample
  std::size_t begin, end;                   // of its points in the window
  std::vector<SweepStatistics> statistics;  // [depth][method]
  std::vector<SweepBlock> blocks;           // [depth][method]; empty: not kept
};

// Chunks that are computed together: as many as keep the engine busy. Its memory is used again: new
// pages cost as much as what is computed in them.
struct Window {
  std::vector<Piece> pieces;
  std::vector<DomainPoint> points;
  std::vector<Vec3> positions, normals;  // [point]
  std::vector<Vec3> hips;                // [depth][point]
  std::vector<Touch> touches;            // [method][depth][point]

  void resize(std::size_t methods) { touches.resize(methods * hips.size()); }
  Touch& touch(std::size_t method, std::size_t hip) { return touches[method * hips.size() + hip]; }
};

// The parts of a sweep, which are the same whatever computes them: which is why they end where they
// are full, and not where an engine's batch does. Few of their beginnings are kept, however many
// there are.
class PartBounds {
 public:
  PartBounds(const SweepGrid& grid, const SweepOptions& options)
      : grid_(grid),
        contacts_a_point_(options.depths.size() * options.methods.size()),
        contacts_(options.part_contacts) {
    for (std::size_t chunk = 0; chunk < grid.chunk_count(); ++count_) {
      if (count_ % stride_ == 0) keep(chunk);
      chunk = end_of(chunk);
    }
  }

  std::size_t count() const { return count_; }
  // The first chunk of a part; that behind the last one for count().
  std::size_t begin(std::size_t part) const {
    if (part == count_) return grid_.chunk_count();
    std::size_t chunk = kept_[part / stride_];
    for (std::size_t i = 0; i < part % stride_; ++i) chunk = end_of(chunk);
    return chunk;
  }

 private:
  static constexpr std::size_t kMost = 4096;

  void keep(std::size_t chunk) {
    kept_.push_back(chunk);
    if (kept_.size() < kMost) return;
    for (std::size_t i = 0; 2 * i < kMost; ++i) kept_[i] = kept_[2 * i];
    kept_.resize(kMost / 2);
    stride_ *= 2;
  }
  // The end of the part that begins with a chunk.
  std::size_t end_of(std::size_t chunk) const {
    const std::uint64_t before = grid_.points_before(chunk);
    while (chunk < grid_.chunk_count() &&
           (grid_.points_before(chunk) - before) * contacts_a_point_ < contacts_) {
      ++chunk;
    }
    return chunk;
  }

  const SweepGrid& grid_;
  const std::uint64_t contacts_a_point_, contacts_;
  std::size_t count_ = 0, stride_ = 1;
  std::vector<std::size_t> kept_;  // the first chunk of every stride_-th part
};

// [depth][method]
std::vector<SweepStatistics> no_statistics(const SweepOptions& options) {
  std::vector<SweepStatistics> all;
  for (const double depth : options.depths) {
    for (const Method method : options.methods) {
      all.emplace_back();
      all.back().depth = depth;
      all.back().method = method;
    }
  }
  return all;
}

void merge(const SweepStatistics& from, SweepStatistics& to) {
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
  to.felt_pairs += from.felt_pairs;
  to.jumps += from.jumps;
  to.lost += from.lost;
  to.leaps += from.leaps;
}

void merge(const std::vector<SweepStatistics>& from, std::vector<SweepStatistics>& to) {
  for (std::size_t i = 0; i < from.size(); ++i) merge(from[i], to[i]);
}

class Sweeper {
 public:
  Sweeper(const PatchCache& cache, const Engine& engine, const SweepOptions& options)
      : cache_(cache),
        engine_(engine),
        options_(options),
        grid_(cache, options.rings),
        parts_(grid_, options),
        surface_(engine.reside(cache)) {
    require(is_stiffness(options.stiffness), "SweepOptions has a stiffness that is not 0 or more");
  }

  // `keeps_last`: also the part that ends the sweep is saved.
  SweepResult run(const PartSource& source, const SweepSink& sink, const SweepProgress& progress,
                  SweepParts* parts, bool keeps_last) {
    const std::uint64_t total = samples_before(grid_.chunk_count());
    const bool keeps_samples = sink || (parts != nullptr && parts->keeps_samples());
    const bool overlaps = engine_.threads() > 1;
    SweepResult result;
    result.statistics = no_statistics(options_);
    const std::size_t part_count = parts_.count();
    auto of_part = no_statistics(options_);
    Window windows[2];  // where threads allow, the last one is counted while the next is computed
    std::size_t turn = 0;
    std::future<void> counting;
    const auto finish = [&] {
      if (counting.valid()) counting.get();
    };
    while (true) {
      if (parts != nullptr) finish();
      const std::size_t part = source();
      if (part >= part_count) break;
      std::size_t first = parts_.begin(part);
      const std::size_t part_end = parts_.begin(part + 1);
      if (const auto kept = load(parts, part, first, part_end, keeps_samples)) {
        if (sink) {
          for (const SweepBlock& block : kept->blocks) sink(block);
        }
        merge(kept->statistics, result.statistics);
        if (progress) progress(samples_before(part_end), total);
        continue;
      }
      std::uint64_t done = samples_before(first);
      while (first < part_end) {
        Window& window = windows[overlaps ? turn++ % 2 : 0];
        collect(first, part_end, enough(), window);
        place(window);
        const std::size_t next = first + window.pieces.size();
        const std::uint64_t samples = samples_before(next) - done;
        feel(window, [&](std::size_t felt) {
          if (progress) progress(done + samples * felt / window.hips.size(), total);
        });
        finish();
        const bool saves = parts != nullptr && (keeps_last || part + 1 < part_count);
        const auto count_window = [=, this, &window, &sink, &result, &of_part] {
          count(window, keeps_samples);
          for (const Piece& piece : window.pieces) {
            merge(piece.statistics, of_part);
            for (const SweepBlock& block : piece.blocks) {
              if (parts != nullptr) parts->add(block);
              if (sink) sink(block);
            }
          }
          if (next < part_end) return;
          if (saves) parts->save(part, of_part);
          merge(of_part, result.statistics);
          of_part = no_statistics(options_);
        };
        if (overlaps)
          counting = std::async(std::launch::async, count_window);
        else
          count_window();
        done += samples;
        result.computed += samples * options_.methods.size();
        first = next;
        if (progress) progress(done, total);
      }
    }
    finish();
    merge(of_part, result.statistics);
    return result;
  }

 private:
  // Over all depths, before a chunk.
  std::uint64_t samples_before(std::size_t chunk) const {
    return grid_.points_before(chunk) * options_.depths.size();
  }

  // The part of these chunks, with the rows of its blocks, if it is kept. Removes what holds
  // something else.
  std::optional<SweepPart> load(SweepParts* parts, std::size_t part, std::size_t first,
                                std::size_t last, bool samples) const {
    auto kept = parts == nullptr ? std::nullopt : parts->load(part);
    if (!kept) return {};
    if (!holds(*kept, first, last, samples)) {
      parts->discard(part);
      return {};
    }
    const std::size_t kinds = kept->statistics.size();
    for (std::size_t b = 0; b < kept->blocks.size(); ++b)
      kept->blocks[b].row = grid_.points_before(first + b / kinds);
    return kept;
  }

  // True if a part from a file is that of these chunks: its points are theirs, and some contacts,
  // done again, are the same. Another engine may round otherwise.
  bool holds(const SweepPart& part, std::size_t first, std::size_t last, bool samples) const {
    const std::size_t methods = options_.methods.size(), kinds = options_.depths.size() * methods;
    const std::uint64_t points = grid_.points_before(last) - grid_.points_before(first);
    for (const SweepStatistics& s : part.statistics) {
      if (s.samples != points) return false;
    }
    if (part.blocks.size() != (samples ? (last - first) * kinds : 0)) return false;
    std::vector<DomainPoint> own;
    for (std::size_t b = 0; b < part.blocks.size(); ++b) {
      const SweepBlock& block = part.blocks[b];
      if (b % kinds == 0) {
        own.clear();
        grid_.add_own_points(grid_.chunk(first + b / kinds), own);
      }
      if (block.depth_index != b % kinds / methods || block.method_index != b % methods ||
          block.face.size() != own.size()) {
        return false;
      }
      for (std::size_t i = 0; i < own.size(); ++i) {
        if (block.face[i] != own[i].face || !(std::abs(block.xi[i] - own[i].xi) < kRounding) ||
            !(std::abs(block.eta[i] - own[i].eta) < kRounding)) {
          return false;
        }
      }
    }
    for (std::size_t method = 0; method < methods; ++method) {
      if (!agrees(part.blocks, method)) return false;
    }
    return true;
  }
  // Does some contacts of each block of a method again, others each time, and all that are not
  // finite: these are the surface's fault or the file's.
  bool agrees(const std::vector<SweepBlock>& blocks, std::size_t method) const {
    std::minstd_rand dice(std::random_device{}());
    std::vector<std::pair<const SweepBlock*, std::size_t>> chosen;  // block, row
    std::vector<DomainPoint> points;
    for (const SweepBlock& block : blocks) {
      if (block.method_index != method) continue;
      for (std::size_t row = 0; row < block.face.size(); ++row) {
        if (!is_finite(block, row)) chosen.emplace_back(&block, row);
      }
      for (int i = 0; i < kSpotChecks; ++i) chosen.emplace_back(&block, dice() % block.face.size());
    }
    for (const auto& [block, row] : chosen)
      points.push_back({block->face[row], block->xi[row], block->eta[row]});
    std::vector<SurfacePoint> surface(points.size());
    surface_->evaluate(points, surface);
    std::vector<Vec3> hips;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double depth = options_.depths[chosen[i].first->depth_index];
      hips.push_back(surface[i].position - depth / cache_.unit * surface[i].normal);
    }
    std::vector<Contact> contacts(points.size());
    QueryOptions query{options_};
    query.method = options_.methods[method];
    surface_->project(hips, query, contacts);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [block, row] = chosen[i];
      const double depth = options_.depths[block->depth_index];
      const Vec3 force = felt_at(hips[i], contacts[i].push);
      if (!agree(block->hip[row], hips[i], depth / cache_.unit) ||
          !agree(block->scp[row], contacts[i].scp, depth / cache_.unit) ||
          !agree(block->force[row], force, depth * options_.stiffness) ||
          std::isfinite(block->residual_angle[row]) !=
              std::isfinite(static_cast<float>(contacts[i].residual_angle))) {
        return false;
      }
    }
    return true;
  }

  // The force at a HIP; that at none, beneath a surface at fault, is no number.
  Vec3 felt_at(const Vec3& hip, const Vec3& push) const {
    if (!hip.allFinite()) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    return push_force(cache_, push, options_.stiffness);
  }
  static bool is_finite(const SweepBlock& block, std::size_t row) {
    return block.hip[row].allFinite() && block.scp[row].allFinite() &&
           block.force[row].allFinite() && std::isfinite(block.residual_angle[row]);
  }
  // True if they are as near as other engines round, or neither is finite.
  static bool agree(const Vec3& a, const Vec3& b, double size) {
    if (!a.allFinite() || !b.allFinite()) return a.allFinite() == b.allFinite();
    return (a - b).norm() <= kAgreement * size;
  }

  // Points that keep the engine busy.
  std::size_t enough() const {
    return std::max<std::size_t>(engine_.batch() / options_.depths.size(), 1);
  }

  // Takes chunks [first, last) up to `enough` points.
  void collect(std::size_t first, std::size_t last, std::size_t enough, Window& window) const {
    window.pieces.clear();
    window.points.clear();
    for (std::size_t c = first; c < last && window.points.size() < enough; ++c) {
      const SweepChunk chunk = grid_.chunk(c);
      const std::size_t begin = window.points.size();
      grid_.add_points(chunk, window.points);
      window.pieces.push_back({chunk, grid_.points_before(c), begin, window.points.size(), {}, {}});
    }
  }

  // Finds the HIPs of a window.
  void place(Window& window) const {
    const std::size_t points = window.points.size(), depths = options_.depths.size();
    window.positions.resize(points);
    window.normals.resize(points);
    surface_->evaluate(arrays_of(window.points),
                       {.position = strided_vectors(window.positions.front().data()),
                        .normal = strided_vectors(window.normals.front().data())});
    window.hips.clear();
    window.hips.reserve(depths * points);
    for (const double depth : options_.depths) {
      for (std::size_t p = 0; p < points; ++p)
        window.hips.push_back(window.positions[p] - depth / cache_.unit * window.normals[p]);
    }
    window.resize(options_.methods.size());
  }

  // Finds the contacts of a window's HIPs. Where that takes long, calls reach(HIPs that are done)
  // several times a second.
  void feel(Window& window, const std::function<void(std::size_t)>& reach) {
    const std::size_t methods = options_.methods.size();
    Stopwatch asked;
    pace_.for_pieces(window.hips.size(), [&](std::size_t begin, std::size_t end) {
      const std::size_t count = end - begin;
      std::vector<ContactArrays<double>> out;
      for (std::size_t m = 0; m < methods; ++m)
        out.push_back(touch_arrays({&window.touch(m, begin), count}));
      surface_->nearest(arrays_of(std::span(window.hips).subspan(begin, count)), options_.methods,
                        QueryOptions{options_}, out);
      if (end == window.hips.size() || asked.seconds() < kAskEvery) return;
      reach(end);
      asked = {};
    });
  }

  void count(Window& window, bool keep) const {
    const std::size_t methods = options_.methods.size(), kinds = options_.depths.size() * methods;
    for (Piece& piece : window.pieces) {
      piece.statistics.resize(kinds);
      piece.blocks.resize(keep ? kinds : 0);
    }
    engine_.for_each(window.pieces.size() * kinds, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t kind = i % kinds;
        Piece& piece = window.pieces[i / kinds];
        if (keep) {
          piece.blocks[kind].depth_index = kind / methods;
          piece.blocks[kind].method_index = kind % methods;
          piece.blocks[kind].row = piece.row;
        }
        count_kind(feel_piece(window, piece, kind / methods, kind % methods), piece, kind);
      }
    });
  }

  // The contacts of a window's points at one depth with one method.
  struct Felt {
    const DomainPoint* points;
    const Vec3 *normals, *hips;
    const Touch* touches;
    double full_force;
    double stiffness;  // N per unit of the mesh
  };

  // Turns the pushes of a piece's contacts into forces.
  Felt feel_piece(Window& window, const Piece& piece, std::size_t depth, std::size_t method) const {
    const std::size_t points = window.points.size(), depths = options_.depths.size();
    const Vec3* hips = &window.hips[depth * points];
    Touch* touches = &window.touches[(method * depths + depth) * points];
    for (std::size_t p = piece.begin; p < piece.end; ++p)
      touches[p].force = felt_at(hips[p], touches[p].force);
    return {window.points.data(),
            window.normals.data(),
            hips,
            touches,
            options_.stiffness * options_.depths[depth],
            options_.stiffness * cache_.unit};
  }

  // Ring by ring, in the order of the grid.
  void count_kind(const Felt& felt, Piece& piece, std::size_t kind) const {
    SweepStatistics& statistics = piece.statistics[kind];
    SweepBlock* block = piece.blocks.empty() ? nullptr : &piece.blocks[kind];
    const SweepChunk& chunk = piece.chunk;
    std::size_t ring = piece.begin;
    for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
      const std::uint32_t face = grid_.face(i), n = grid_.valence(face);
      std::size_t inner = ring;
      for (std::uint32_t r = chunk.first; r <= grid_.last_ring(chunk); ++r) {
        const std::size_t end = ring + std::size_t{n} * r;
        if (r > chunk.first) count_outward(felt, n, r, inner, ring, statistics);
        for (std::size_t p = ring; r < chunk.last && p < end; ++p) {
          const Vec3 exact = felt.full_force * felt.normals[p];
          count_sample(felt.touches[p], (felt.touches[p].force - exact).norm(), statistics);
          count_step(felt, p, p + 1 < end ? p + 1 : ring, statistics.step, statistics);
          if (block != nullptr) append(*block, felt, p);
        }
        inner = ring;
        ring = end;
      }
      if (!grid_.has_neighbours(chunk)) continue;
      const std::size_t rings = grid_.rings();
      grid_.for_each_neighbour(face, [&](std::uint32_t k) {
        for (std::size_t j = 0; j < rings; ++j) {
          count_step(felt, inner + k * rings + j, ring + rings - 1 - j, statistics.edge_step,
                     statistics);
        }
        ring += rings;
      });
    }
  }

  static void count_sample(const Touch& contact, double error, SweepStatistics& s) {
    ++s.samples;
    s.touching += contact.touching;
    s.unconverged += (contact.flags & kConverged) == 0;
    s.iterations += static_cast<std::uint64_t>(contact.iterations);
    s.crossings += static_cast<std::uint64_t>(contact.crossings);
    s.error.add(error);
    s.residual.add(contact.residual_angle);
  }

  static void count_step(const Felt& felt, std::size_t p, std::size_t q, Histogram& step,
                         SweepStatistics& statistics) {
    const Vec3 &a = felt.touches[p].force, &b = felt.touches[q].force;
    const double size = (a - b).norm();
    step.add(size);
    const bool a_touches = felt.touches[p].touching, b_touches = felt.touches[q].touching;
    const double jump = ForceStatistics::kJump * felt.full_force;
    const bool jumps = !(size <= jump);
    statistics.felt_pairs += a_touches || b_touches;
    statistics.jumps += jumps;
    statistics.lost += jumps && a_touches != b_touches;
    if (jumps) {
      const double way = (felt.hips[p] - felt.hips[q]).norm();
      statistics.leaps += !(size <= jump + 2 * felt.stiffness * way);
    }
    if (a.squaredNorm() > 0 && b.squaredNorm() > 0)
      statistics.angle.add(std::atan2(a.cross(b).norm(), a.dot(b)));
  }

  // From each point of ring r - 1 to the one of ring r nearest to it in its sector.
  static void count_outward(const Felt& felt, std::uint32_t n, std::uint32_t r, std::size_t inner,
                            std::size_t ring, SweepStatistics& statistics) {
    for (std::size_t i = 0; i < std::size_t{n} * (r - 1); ++i) {
      const std::size_t sector = i / (r - 1), at = i % (r - 1);
      const std::size_t outward = sector * r + (2 * at + 1) * r / (2 * (r - 1));
      count_step(felt, inner + i, ring + outward, statistics.step, statistics);
    }
  }

  static void append(SweepBlock& block, const Felt& felt, std::size_t p) {
    const Touch& contact = felt.touches[p];
    const DomainPoint& at = felt.points[p];
    block.face.push_back(at.face);
    block.xi.push_back(at.xi);
    block.eta.push_back(at.eta);
    block.hip.push_back(felt.hips[p]);
    block.scp.push_back(contact.scp);
    block.force.push_back(contact.force);
    block.residual_angle.push_back(static_cast<float>(contact.residual_angle));
    block.iterations.push_back(static_cast<std::uint32_t>(contact.iterations));
    block.crossings.push_back(static_cast<std::uint32_t>(contact.crossings));
    block.flags.push_back(static_cast<std::uint8_t>(contact.flags));
  }

  const PatchCache& cache_;
  const Engine& engine_;
  const SweepOptions& options_;
  const SweepGrid grid_;
  const PartBounds parts_;
  const std::unique_ptr<ResidentSurface> surface_;
  Pace pace_;  // of HIPs
};

}  // namespace

SweepResult sweep(const PatchCache& cache, const Engine& engine, const SweepOptions& options,
                  const SweepSink& sink, const SweepProgress& progress, SweepParts* parts) {
  const PlainArithmetic plain;
  return Sweeper(cache, engine, options).run(every_part(), sink, progress, parts, false);
}

SweepResult sweep_parts(const PatchCache& cache, const Engine& engine, const SweepOptions& options,
                        const PartSource& source, SweepParts& parts, const SweepProgress& progress,
                        const SweepSink& sink) {
  const PlainArithmetic plain;
  return Sweeper(cache, engine, options).run(source, sink, progress, &parts, true);
}

SweepResult kept_statistics(const PatchCache& cache, const SweepOptions& options,
                            const SweepParts& parts, const SweepProgress& progress) {
  const SweepGrid grid(cache, options.rings);
  const PartBounds bounds(grid, options);
  const std::uint64_t total = grid.points_before(grid.chunk_count()) * options.depths.size();
  SweepResult result{.statistics = no_statistics(options)};
  for (std::size_t part = 0; part < bounds.count(); ++part) {
    const std::uint64_t end = grid.points_before(bounds.begin(part + 1)),
                        points = end - grid.points_before(bounds.begin(part));
    const auto kept = parts.statistics(part);
    if (kept.empty() || kept.front().samples != points) {
      throw std::runtime_error(fmt::format(
          "parts folder '{}': part {} is gone or damaged; the same command does it again",
          parts.folder(), part));
    }
    merge(kept, result.statistics);
    if (progress) progress(end * options.depths.size(), total);
  }
  return result;
}

std::size_t part_count(const PatchCache& cache, const SweepOptions& options) {
  return PartBounds(SweepGrid(cache, options.rings), options).count();
}

}  // namespace gliss
