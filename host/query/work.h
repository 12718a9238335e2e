// The work of a force on the hand: what a path costs, and what a closed one should not.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"

namespace gliss {

// A sum over steps, in the unit of force times that of length. `gross` counts each step as
// positive.
struct Work {
  double net = 0, gross = 0;

  // A step by `way`, the force going from `before` to `after` (trapezoidal rule).
  void add(const Vec3& before, const Vec3& after, const Vec3& way) noexcept {
    const double work = 0.5 * (before + after).dot(way);
    net += work;
    gross += std::abs(work);
  }
  Work since(const Work& start) const { return {net - start.net, gross - start.gross}; }
  // The net work as a share of the gross; NaN where there was none.
  double gain() const { return gross > 0 ? net / gross : std::numeric_limits<double>::quiet_NaN(); }
};

// A part of a path that leads back to where it began, from one index to another.
struct PathLoop {
  std::size_t begin, end;
};

// Closed parts of a path, one after another: those that come back to within half of the path's mean
// step after 16 of them at least, having been farther away. Allocates.
GLISS_EXPORT std::vector<PathLoop> closed_loops(std::span<const Vec3> path);

// The largest share of the gross work that a closed loop gives the hand, each time round. Where a
// force has a potential, as that of a nearest point has, it is nothing.
class LoopGain {
 public:
  // The loops must outlive it.
  explicit LoopGain(std::span<const PathLoop> loops) : loops_(loops) {}

  // Takes the next point of the path and the force there.
  void add(const Vec3& point, const Vec3& force) noexcept {
    if (index_ > 0) all_.add(last_force_, force, point - last_);
    last_ = point;
    last_force_ = force;
    if (next_ < loops_.size() && index_ == loops_[next_].end) {
      Work round = all_.since(start_);
      round.add(force, start_force_, start_point_ - point);
      if (!(round.gain() <= largest_) && !std::isnan(round.gain())) largest_ = round.gain();
      ++next_;
    }
    if (next_ < loops_.size() && index_ == loops_[next_].begin) {
      start_ = all_;
      start_point_ = point;
      start_force_ = force;
    }
    ++index_;
  }

  const Work& work() const { return all_; }    // of the whole path
  double largest() const { return largest_; }  // NaN where no loop had work

 private:
  std::span<const PathLoop> loops_;
  std::size_t index_ = 0, next_ = 0;  // of the path; of the loops
  Work all_, start_;
  Vec3 last_ = Vec3::Zero(), last_force_ = Vec3::Zero();
  Vec3 start_point_ = Vec3::Zero(), start_force_ = Vec3::Zero();
  double largest_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace gliss
