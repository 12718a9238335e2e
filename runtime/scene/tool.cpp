#include "gliss/scene/tool.h"

#include <algorithm>
#include <limits>

#include "gliss/base/plain_arithmetic.h"

namespace gliss {

std::vector<Vec3> spread_points(const Mesh& mesh, std::size_t count,
                                const std::function<void()>& poll) {
  const PlainArithmetic plain;
  std::vector<Vec3> points;
  if (mesh.positions.empty()) return points;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : mesh.positions) box.extend(p);
  // Squared, of each vertex to the nearest point so far.
  std::vector<double> away(mesh.positions.size(), std::numeric_limits<double>::infinity());
  Vec3 last = box.center();
  while (points.size() < std::min(count, mesh.positions.size())) {
    if (poll) poll();
    const bool is_first = points.empty();
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < away.size(); ++i) {
      const double to_last = (mesh.positions[i] - last).squaredNorm();
      away[i] = is_first ? to_last : std::min(away[i], to_last);
      if (away[i] > away[farthest]) farthest = i;
    }
    if (!is_first && !(away[farthest] > 0)) break;  // vertices at one place
    last = mesh.positions[farthest];
    points.push_back(mesh.unit * last);
    if (is_first) std::fill(away.begin(), away.end(), std::numeric_limits<double>::infinity());
  }
  return points;
}

}  // namespace gliss
