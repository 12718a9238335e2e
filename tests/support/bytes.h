// Turns what engines give into bytes to compare.
#pragma once

#include <string>
#include <vector>

#include "gliss/files/cache_file.h"
#include "gliss/sweep/sweep_parts.h"
#include "tests/support/scratch_folder.h"

namespace gliss::test {

template <class T>
void append(std::string& bytes, const T* from, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(from), count * sizeof(T));
}
template <class T>
void append(std::string& bytes, const std::vector<T>& from) {
  append(bytes, from.data(), from.size());
}

inline void append(std::string& bytes, const Histogram& h) {
  const double sums[] = {h.mean(), h.max()};
  append(bytes, h.bins().data(), h.bins().size());
  append(bytes, sums, 2);
}

// A cache as its file.
inline std::string bytes_of(const PatchCache& cache) {
  const ScratchFolder folder;
  save_cache(cache, folder / "cache");
  return folder.read("cache");
}

// Counts the bytes of the arrays that a device holds.
inline std::uint64_t surface_bytes(const PatchCache& cache) {
  return std::visit(
      [](const auto& s) -> std::uint64_t {
        const auto bytes = [](const auto&... arrays) {
          return ((arrays.size() * sizeof(arrays[0])) + ...);
        };
        return bytes(s.domain, s.domain_begin, s.side_begin, s.side_patch, s.side_twin, s.control,
                     s.control_begin, s.form, s.corner, s.patch, s.triangle, s.node, s.child,
                     s.tile, s.tile_begin, s.part, s.part_table, s.partner, s.part_box);
      },
      cache.surface);
}

// All that a sweep says.
inline std::string swept(const PatchCache& cache, const Engine& engine, const SweepOptions& options,
                         SweepParts* parts = nullptr, const SweepProgress& progress = nullptr) {
  std::string bytes;
  const auto sink = [&](const SweepBlock& block) {
    const std::size_t place[] = {block.depth_index, block.method_index};
    append(bytes, place, 2);
    append(bytes, block.face);
    for (const auto* numbers : {&block.xi, &block.eta}) append(bytes, *numbers);
    for (const auto* vectors : {&block.hip, &block.scp, &block.force}) append(bytes, *vectors);
    append(bytes, block.residual_angle);
    for (const auto* counts : {&block.iterations, &block.crossings}) append(bytes, *counts);
    append(bytes, block.flags);
  };
  const SweepResult result = sweep(cache, engine, options, sink, progress, parts);
  for (const SweepStatistics& s : result.statistics) {
    for (const Histogram* h : {&s.step, &s.edge_step, &s.angle, &s.error, &s.residual}) {
      append(bytes, *h);
    }
    const std::uint64_t counts[] = {s.samples,   s.touching,   s.unconverged, s.iterations,
                                    s.crossings, s.felt_pairs, s.jumps,       s.lost};
    append(bytes, counts, std::size(counts));
  }
  return bytes;
}

}  // namespace gliss::test
