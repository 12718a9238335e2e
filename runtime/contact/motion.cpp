#include "gliss/contact/motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace gliss {
namespace {

[[noreturn]] void refuse(std::size_t i, const char* what) {
  throw std::invalid_argument("motion: pose " + std::to_string(i) + " " + what);
}

}  // namespace

bool is_rigid(const Pose& pose) noexcept {
  constexpr double kMost = 1e-6;
  const Eigen::Matrix3d turn = pose.linear();
  if (!pose.matrix().allFinite() || !(turn.cwiseAbs().maxCoeff() < 2)) return false;
  const Eigen::Matrix3d skew = turn.transpose() * turn - Eigen::Matrix3d::Identity();
  return skew.cwiseAbs().maxCoeff() <= kMost && turn.determinant() > 0;
}

Motion::Motion(std::vector<double> times, const std::vector<Pose>& poses, bool repeats)
    : times_(std::move(times)), repeats_(repeats) {
  if (poses.empty()) throw std::invalid_argument("motion: has no pose");
  if (poses.size() != times_.size()) throw std::invalid_argument("motion: as many times as poses");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!(times_[i] >= 0 && std::isfinite(times_[i]))) refuse(i, "is not at 0 s or later");
    if (i > 0 && !(times_[i] > times_[i - 1])) refuse(i, "is not later than the one before it");
    if (!is_rigid(poses[i])) refuse(i, "is not a rotation and translation");
    rotations_.emplace_back(Eigen::Quaterniond(Eigen::Matrix3d(poses[i].linear())));
    places_.push_back(poses[i].translation());
  }
  if (repeats && times_.size() < 2) throw std::invalid_argument("motion: repeats a single pose");
}

Pose Motion::at(double time) const noexcept {
  const double first = times_.front(), round = times_.back() - first;
  if (repeats_ && time > first) time = first + std::fmod(time - first, round);
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const auto b = static_cast<std::size_t>(std::min(after, times_.end() - 1) - times_.begin()),
             a = after == times_.begin() || after == times_.end() ? b : b - 1;
  const double share = a == b ? 0 : (time - times_[a]) / (times_[b] - times_[a]);
  Pose pose = Pose::Identity();
  pose.linear() = rotations_[a].slerp(share, rotations_[b]).toRotationMatrix();
  pose.translation() = places_[a] + share * (places_[b] - places_[a]);
  return pose;
}

bool PoseChannel::publish(const Pose& pose) noexcept {
  if (!is_rigid(pose)) return false;
  std::array<double, 12> numbers;
  Eigen::Map<Eigen::Matrix<double, 3, 4>>(numbers.data()) = pose.matrix().topRows<3>();
  lock_.store(numbers);
  return true;
}

std::optional<Pose> PoseChannel::latest() const noexcept {
  const auto sample = lock_.load();
  if (!sample) return std::nullopt;
  Pose pose = Pose::Identity();
  pose.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4>>(sample->value.data());
  return pose;
}

}  // namespace gliss
