#include "tests/oracle/dense_oracle.h"

namespace gliss::test {

DenseOracle::DenseOracle(const PatchCache& cache, int resolution)
    : cache_(&cache), resolution_(resolution) {
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face)
    if (cache.first_patch(face) != kNone) add_face(face);
}

Foot DenseOracle::nearest_sample(const Vec3& hip) const {
  std::vector<Near>& near = faces_by_distance(hip);
  Foot best;
  for (const Near& face : near) {
    if (face.distance2 > best.distance * best.distance) break;
    scan(faces_[face.face], hip, best);
  }
  return best;
}

Foot DenseOracle::nearest(const Vec3& hip) const {
  Foot best = nearest_sample(hip);
  std::vector<Foot> starts;
  const double d = best.distance;
  for (const Near& near : faces_by_distance(hip)) {
    if (near.distance2 > d * d) break;
    add_starts(faces_[near.face], hip, d, starts);
  }
  std::sort(starts.begin(), starts.end(),
            [](const Foot& a, const Foot& b) { return a.distance < b.distance; });
  if (starts.size() > kMostStarts) starts.resize(kMostStarts);
  std::vector<Vec3> found;
  for (const Foot& start : starts) {
    const double h = faces_[start.at.face].spacing;
    const bool known = std::any_of(found.begin(), found.end(), [&](const Vec3& p) {
      return (p - start.position).norm() < 0.5 * h;
    });
    if (known) continue;
    const Foot foot = descend(hip, start);
    found.push_back(foot.position);
    if (foot.distance < best.distance) best = foot;
  }
  return best;
}

Foot DenseOracle::descend(const Vec3& hip, Foot foot) const {
  const Domain& domain = domains_.at(cache_->face_valence[foot.at.face]);
  for (int i = 0; i < 40; ++i) {
    const Vec2 X(foot.at.xi, foot.at.eta);
    const Around around = evaluate_around(foot.at);
    const SurfacePoint& here = around[0];
    const Vec2 g = gradient(here, hip);
    Vec2 step = newton_step(hip, around, g);
    for (const Vec2& outward : domain.outward) {  // along a side that it leans on
      if (domain.apothem - outward.dot(X) > 1e-12 || outward.dot(step) <= 0) continue;
      const Vec2 along(-outward.y(), outward.x());
      step = along.dot(step) * along;
    }
    bool moved = false;
    const double length = step.norm();
    if (length > 2.0 / resolution_) step *= 2.0 / resolution_ / length;
    const Vec2 steepest = -g / (here.d_xi.squaredNorm() + here.d_eta.squaredNorm());
    for (const Vec2& way : {step, steepest}) {
      double part = 1;
      for (int halvings = 0; halvings < 12 && !moved; ++halvings, part /= 2)
        moved = improve(hip, domain.clamp(X + part * way), foot);
      if (moved) break;
    }
    if (!moved || length < 1e-7) break;
  }
  return foot;
}

void DenseOracle::add_face(std::uint32_t index) {
  const int n = static_cast<int>(cache_->face_valence[index]);
  domains_.try_emplace(static_cast<std::uint32_t>(n), n);
  Face face;
  face.face = index;
  for (const Vec2& X : oracle::sample_domain<double>(n, resolution_))
    face.at.push_back({index, X.x(), X.y()});
  std::vector<SurfacePoint> points(face.at.size());
  evaluate(*cache_, face.at, points);
  face.low = face.high = points[0].position;
  double stretch = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfacePoint& p = points[i];
    face.position.push_back(p.position);
    face.low = face.low.cwiseMin(p.position), face.high = face.high.cwiseMax(p.position);
    stretch = std::max(stretch, std::sqrt(p.d_xi.squaredNorm() + p.d_eta.squaredNorm()));
    if (i == 0) continue;
    const double apart = (p.position - points[i - 1].position).norm();
    if (apart > 0)
      face.bend =
          std::max(face.bend, oracle::angle<double>(p.normal, points[i - 1].normal) / apart);
  }
  face.spacing = 0.6 * stretch / resolution_;
  const Vec3 margin = Vec3::Constant(0.5 * face.bend * face.spacing * face.spacing);
  face.low -= margin, face.high += margin;
  faces_.push_back(std::move(face));
}

std::vector<DenseOracle::Near>& DenseOracle::faces_by_distance(const Vec3& hip) const {
  thread_local std::vector<Near> near;
  near.clear();
  double least = std::numeric_limits<double>::infinity();
  for (const Face& face : faces_) least = std::min(least, (face.position[0] - hip).squaredNorm());
  for (std::uint32_t i = 0; i < faces_.size(); ++i) {
    const Face& face = faces_[i];
    const Vec3 beyond = (face.low - hip).cwiseMax(hip - face.high).cwiseMax(0.0);
    if (beyond.squaredNorm() <= least) near.push_back({beyond.squaredNorm(), i});
  }
  std::sort(near.begin(), near.end(),
            [](const Near& a, const Near& b) { return a.distance2 < b.distance2; });
  return near;
}

void DenseOracle::scan(const Face& face, const Vec3& hip, Foot& best) {
  std::size_t nearest = face.at.size();
  double least = best.distance * best.distance;
  for (std::size_t i = 0; i < face.position.size(); ++i) {
    const double d2 = (face.position[i] - hip).squaredNorm();
    if (d2 < least) least = d2, nearest = i;
  }
  if (nearest < face.at.size()) best = {face.at[nearest], face.position[nearest], std::sqrt(least)};
}

void DenseOracle::add_starts(const Face& face, const Vec3& hip, double d,
                             std::vector<Foot>& starts) const {
  const double h = face.spacing, most = d * d + h * h * (1 + d * face.bend);
  thread_local std::vector<std::pair<double, std::uint32_t>> near;
  near.clear();
  for (std::uint32_t i = 0; i < face.position.size(); ++i) {
    const double d2 = (face.position[i] - hip).squaredNorm();
    if (d2 <= most) near.emplace_back(d2, i);
  }
  for (int taken = 0; taken < 3 && !near.empty(); ++taken) {
    const auto [d2, i] = *std::min_element(near.begin(), near.end());
    starts.push_back({face.at[i], face.position[i], std::sqrt(d2)});
    std::erase_if(near, [&, i = i](const auto& other) {
      const DomainPoint &a = face.at[i], &b = face.at[other.second];
      return std::hypot(a.xi - b.xi, a.eta - b.eta) < 2.5 / resolution_;
    });
  }
}

Vec2 DenseOracle::gradient(const SurfacePoint& p, const Vec3& hip) {
  const Vec3 r = p.position - hip;
  return {r.dot(p.d_xi), r.dot(p.d_eta)};
}

DenseOracle::Around DenseOracle::evaluate_around(const DomainPoint& at) const {
  const Vec2 X = (1 - 4 * kApart) * Vec2(at.xi, at.eta);  // off the sides
  std::array<DomainPoint, 5> points{at};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2 there = X + (i % 2 ? kApart : -kApart) * Vec2::Unit(static_cast<int>(i / 2));
    points[i + 1] = {at.face, there.x(), there.y()};
  }
  Around around;
  evaluate(*cache_, points, around);
  return around;
}

Vec2 DenseOracle::newton_step(const Vec3& hip, const Around& around, const Vec2& g) {
  const SurfacePoint& here = around[0];
  Eigen::Matrix2d H;
  for (int axis = 0; axis < 2; ++axis) {
    const auto before = static_cast<std::size_t>(1 + 2 * axis);
    H.col(axis) =
        (gradient(around[before + 1], hip) - gradient(around[before], hip)) / (2 * kApart);
  }
  H(0, 1) = H(1, 0) = 0.5 * (H(0, 1) + H(1, 0));
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(H);
  const double least = 1e-9 * (here.d_xi.squaredNorm() + here.d_eta.squaredNorm());
  const Vec2 size = eigen.eigenvalues().cwiseAbs().cwiseMax(least);
  const Vec2 turned = eigen.eigenvectors().transpose() * g;
  return -(eigen.eigenvectors() * turned.cwiseQuotient(size));
}

bool DenseOracle::improve(const Vec3& hip, const Vec2& X, Foot& foot) const {
  const DomainPoint at{foot.at.face, X.x(), X.y()};
  const Vec3 position = evaluate(*cache_, at).position;
  const double distance = (position - hip).norm();
  if (!(distance < foot.distance)) return false;
  foot = {at, position, distance};
  return true;
}

}  // namespace gliss::test
