// Files of HIPs for commands that go by parts, and parts of their own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "gliss/base/vector.h"
#include "gliss/files/cache_format.h"
#include "gliss/tables/result_table.h"

namespace gliss::test {

// HIPs 8 to 12 mm from the origin, in mm, and their numbers as "id": those from `first` on of a
// list without end. One of them has no y.
inline void write_hips(const std::string& path, std::size_t rows, std::size_t first = 0,
                       std::size_t without_y = std::numeric_limits<std::size_t>::max()) {
  const auto hip = [first, without_y](std::size_t row) {
    const auto i = static_cast<double>(first + row);
    const double radius = 10 + 2 * std::sin(i), turn = 2.4 * i, z = std::cos(0.37 * i);
    return Vec3(
        radius * std::sqrt(1 - z * z) * std::cos(turn),
        first + row == without_y ? std::nan("") : radius * std::sqrt(1 - z * z) * std::sin(turn),
        radius * z);
  };
  const auto file = create_result_file(path);
  ResultTable table(*file, "", Columns().add({"x_mm", "y_mm", "z_mm"}).add({"id"}));
  table.fill_vectors(rows, hip);
  table.fill(rows, [&](std::size_t row) { return first + row; });
  table.write();
  file->close();
}

// Paths of the parts in a folder, in their order; none where it is not there.
inline std::vector<std::string> part_paths(const std::string& folder) {
  std::error_code none;
  std::vector<std::string> paths;
  for (const auto& file : std::filesystem::directory_iterator(folder, none)) {
    if (file.path().extension() == ".part") paths.push_back(file.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

inline std::string read_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Gives a part's file the checksum of what it holds.
inline void set_part_checksum(std::string& bytes) {
  constexpr std::size_t kChecksumAt = 8, kCheckedFrom = 16;
  const std::uint64_t sum =
      cache_format::checksum(bytes.data() + kCheckedFrom, bytes.size() - kCheckedFrom);
  std::memcpy(bytes.data() + kChecksumAt, &sum, sizeof sum);
}

}  // namespace gliss::test
