#include "gliss/sweep/sweep_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace gliss {
namespace {

// The body of a part: the statistics, the blocks.
static_assert(std::is_trivially_copyable_v<SweepStatistics>);

std::uint64_t hash_of_sweep(std::uint64_t surface, const SweepOptions& o, bool samples) {
  std::string told = fmt::format("sweep {} {} {} {} {} {} {} {}", sizeof(SweepStatistics), samples,
                                 o.part_contacts, o.rings, o.stiffness, static_cast<int>(o.solver),
                                 o.max_iterations, o.tolerance);
  for (const double depth : o.depths) told += fmt::format(" depth {}", depth);
  for (const Method method : o.methods) told += fmt::format(" method {}", static_cast<int>(method));
  return work_hash(surface, told);
}

// Calls f(column) for each column of a block.
template <class Block, class F>
void for_each_column(Block& block, const F& f) {
  f(block.face);
  f(block.xi);
  f(block.eta);
  f(block.hip);
  f(block.scp);
  f(block.force);
  f(block.residual_angle);
  f(block.iterations);
  f(block.crossings);
  f(block.flags);
}

void put(std::string& bytes, const void* from, std::size_t size) {
  bytes.append(static_cast<const char*>(from), size);
}

// Takes what was put; false at the end.
bool take(std::string_view& bytes, void* to, std::size_t size) {
  if (bytes.size() < size) return false;
  if (size > 0) std::memcpy(to, bytes.data(), size);
  bytes.remove_prefix(size);
  return true;
}

struct BlockHeader {
  std::uint64_t depth_index, method_index, rows;
};

bool take(std::string_view& bytes, SweepBlock& block, std::size_t depths, std::size_t methods) {
  BlockHeader header{};
  std::size_t row_bytes = 0;
  for_each_column(block, [&](const auto& column) { row_bytes += sizeof(column[0]); });
  if (!take(bytes, &header, sizeof header) || header.depth_index >= depths ||
      header.method_index >= methods || header.rows > bytes.size() / row_bytes) {
    return false;
  }
  block.depth_index = header.depth_index;
  block.method_index = header.method_index;
  bool whole = true;
  for_each_column(block, [&](auto& column) {
    column.resize(header.rows);
    whole = whole && take(bytes, column.data(), header.rows * sizeof(column[0]));
  });
  return whole;
}

// True if the points of a block, which is taken from a file, can be a sweep's. What was felt there
// need not be finite: where a surface is at fault it is not.
bool is_in_range(const SweepBlock& block, const PatchCache& cache) {
  const auto finite = [](const std::vector<double>& column) {
    return std::all_of(column.begin(), column.end(), [](double x) { return std::isfinite(x); });
  };
  const bool faces = std::all_of(block.face.begin(), block.face.end(), [&](std::uint32_t face) {
    return face < cache.mesh_face_count && cache.first_patch(face) != kNone;
  });
  return faces && finite(block.xi) && finite(block.eta);
}

}  // namespace

SweepParts::SweepParts(const std::string& folder, const PatchCache& cache,
                       const SweepOptions& options, bool samples, PartsAccess access)
    : SweepParts(folder, gliss::surface_hash(cache), cache, options, samples, access) {}

SweepParts::SweepParts(const std::string& folder, std::uint64_t surface, const PatchCache& cache,
                       const SweepOptions& options, bool samples, PartsAccess access)
    : PartFolder(folder, hash_of_sweep(surface, options, samples), access),
      cache_(cache),
      surface_hash_(surface),
      samples_(samples),
      depths_(options.depths),
      methods_(options.methods) {}

std::optional<SweepPart> SweepParts::load(std::size_t part) {
  // Room for what comes before the blocks, should it have to be done.
  file_.bytes.assign(
      PartFile::kHeaderBytes + depths_.size() * methods_.size() * sizeof(SweepStatistics), '\0');
  const auto file = PartFolder::load(part);
  if (!file) return {};
  auto found = parse(*file);
  if (!found) discard(part);
  return found;
}

std::optional<SweepPart> SweepParts::parse(const PartFile& file) const {
  std::string_view rest = file.body();
  SweepPart found;
  found.statistics.resize(depths_.size() * methods_.size());
  if (!take(rest, found.statistics.data(), found.statistics.size() * sizeof(SweepStatistics)))
    return {};
  while (!rest.empty()) {
    if (!take(rest, found.blocks.emplace_back(), depths_.size(), methods_.size())) return {};
  }
  if (!is_in_range(found)) return {};
  return found;
}

bool SweepParts::is_in_range(const std::vector<SweepStatistics>& statistics) const {
  for (std::size_t kind = 0; kind < statistics.size(); ++kind) {
    const SweepStatistics& s = statistics[kind];
    const Histogram* const all[] = {&s.step, &s.edge_step, &s.angle, &s.error, &s.residual};
    if (s.depth != depths_[kind / methods_.size()] ||
        s.method != methods_[kind % methods_.size()] || s.touching > s.samples ||
        s.unconverged > s.samples || s.error.count() != s.samples ||
        s.residual.count() != s.samples || s.jumps > s.step.count() + s.edge_step.count() ||
        s.lost > s.jumps || s.leaps > s.jumps ||
        !std::all_of(std::begin(all), std::end(all), [](auto* h) { return h->is_consistent(); })) {
      return false;
    }
  }
  return true;
}

bool SweepParts::is_in_range(const SweepPart& part) const {
  return is_in_range(part.statistics) &&
         std::all_of(part.blocks.begin(), part.blocks.end(),
                     [&](const SweepBlock& block) { return gliss::is_in_range(block, cache_); });
}

std::vector<SweepStatistics> SweepParts::statistics(std::size_t part) const {
  std::vector<SweepStatistics> found(depths_.size() * methods_.size());
  const std::string bytes = head(part, found.size() * sizeof found[0]);
  std::string_view rest = bytes;
  if (!take(rest, found.data(), found.size() * sizeof found[0]) || !is_in_range(found)) return {};
  return found;
}

void SweepParts::add(const SweepBlock& block) {
  if (!samples_) return;
  const BlockHeader header{block.depth_index, block.method_index, block.face.size()};
  put(file_.bytes, &header, sizeof header);
  for_each_column(block, [&](const auto& column) {
    put(file_.bytes, column.data(), column.size() * sizeof(column[0]));
  });
}

void SweepParts::save(std::size_t part, const std::vector<SweepStatistics>& statistics) {
  std::memcpy(&file_.bytes[PartFile::kHeaderBytes], statistics.data(),
              statistics.size() * sizeof(SweepStatistics));
  PartFolder::save(part, file_);
}

}  // namespace gliss
