#include "gliss/query/work.h"

#include <array>
#include <cstdint>
#include <unordered_map>

namespace gliss {
namespace {

constexpr double kFewest = 16;  // mean steps, of a loop's length
constexpr double kAway = 2;     // mean steps, between a loop's begin and its middle

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cell)
      hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

}  // namespace

std::vector<PathLoop> closed_loops(std::span<const Vec3> path, const Poll& poll) {
  std::vector<PathLoop> loops;
  std::vector<double> length(path.size(), 0.0);  // of the path as far as each point
  for (std::size_t i = 1; i < path.size(); ++i)
    length[i] = length[i - 1] + (path[i] - path[i - 1]).norm();
  if (path.empty() || !(length.back() > 0) || !std::isfinite(length.back())) return loops;
  const double step = length.back() / static_cast<double>(path.size() - 1), near = step / 2;
  const Vec3 origin = path[0];
  std::unordered_map<Cell, std::size_t, CellHash> places;  // the first point in each cell
  const auto closes = [&](std::size_t begin, std::size_t end) {
    return (path[end] - path[begin]).norm() <= near &&
           length[end] - length[begin] >= kFewest * step &&
           (path[(begin + end) / 2] - path[begin]).norm() >= kAway * step;
  };
  // Finds the point at which the loop began that ends here; path.size(): none.
  const auto begin_of = [&](std::size_t end, const Cell& cell) {
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto place = places.find({cell[0] + x, cell[1] + y, cell[2] + z});
          if (place != places.end() && closes(place->second, end)) return place->second;
        }
      }
    }
    return path.size();
  };
  ItemPoll ask(poll);
  for (std::size_t i = 0; i < path.size(); ++i) {
    ask();
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::floor((path[i] - origin)[axis] / near));
    if (const std::size_t begin = begin_of(i, cell); begin < path.size()) {
      loops.push_back({begin, i});
      places.clear();
    }
    places.emplace(cell, i);
  }
  return loops;
}

}  // namespace gliss
