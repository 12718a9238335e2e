// The work of a force on the hand: what a path costs, and what a closed one should not.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/base/vector.h"

namespace gliss {

// A sum over steps, in the unit of force times that of length. `gross` counts each step as
// positive; `effort` takes the force for its full size, whatever its direction.
struct Work {
  double net = 0, gross = 0, effort = 0;

  // A step by `way`, the force going from `before` to `after` (trapezoidal rule).
  void add(const Vec3& before, const Vec3& after, const Vec3& way) noexcept {
    const double work = of_step(before, after, way);
    net += work;
    gross += std::abs(work);
    effort += 0.5 * (before.norm() + after.norm()) * way.norm();
  }
  // The net work of such a step.
  static double of_step(const Vec3& before, const Vec3& after, const Vec3& way) noexcept {
    return 0.5 * (before + after).dot(way);
  }
  Work since(const Work& start) const {
    return {net - start.net, gross - start.gross, effort - start.effort};
  }
};

// A part of a path that leads back to where it began, from one index to another.
struct PathLoop {
  std::size_t begin, end;
};

// Closed parts of a path, one after another: those that come back to within half of the path's mean
// step after 16 of them at least, having been farther away. Allocates.
GLISS_EXPORT std::vector<PathLoop> closed_loops(std::span<const Vec3> path, const Poll& poll = {});

// Net work that a closed loop gives the hand, as a share of its effort, and how far the truth may
// lie from that. NaN: there was no loop with a force.
struct LoopGain {
  double gain = std::numeric_limits<double>::quiet_NaN(), error = gain;

  // True if the hand was given, or lost, more than the error.
  bool is_certain() const noexcept { return std::abs(gain) > error; }
  double excess() const noexcept { return gain - error; }
};

// Measures the gain of closed loops of a path, each time round. Where a force has a potential, as
// that of a nearest point has, it is nothing. The error has three parts. Sampling: a sum over every
// other tick differs by so much, each pair of steps by its size. Closing: the step back to where
// the loop began may hold a leap of the force. Potential: a round that does not end as it began has
// at one end more of the k |F / k|^2 / 2 of a spring of stiffness k.
class LoopMeter {
 public:
  // The loops must outlive it. `stiffness`: of the force, in its unit per that of length.
  LoopMeter(std::span<const PathLoop> loops, double stiffness)
      : loops_(loops), stiffness_(stiffness) {}

  // Takes the next point of the path and the force there.
  void add(const Vec3& point, const Vec3& force) noexcept {
    const Place now{point, force};
    if (index_ > 0) all_.add(last_.force, force, point - last_.point);
    if (index_ % 2 == 0) {
      if (index_ > 0) sampling_ += disagreement(now);
      even_ = now;
    }
    last_ = now;
    if (next_ < loops_.size() && index_ == loops_[next_].end) {
      finish(now);
      ++next_;
    }
    if (next_ < loops_.size() && index_ == loops_[next_].begin) {
      start_ = now;
      start_work_ = all_;
      start_sampling_ = sampling_;
    }
    ++index_;
  }

  const Work& work() const { return all_; }  // of the whole path
  // The loop whose gain exceeds its error by most.
  const LoopGain& largest() const { return largest_; }

 private:
  struct Place {
    Vec3 point = Vec3::Zero(), force = Vec3::Zero();
  };

  // Between the last two steps and one step over both.
  double disagreement(const Place& now) const noexcept {
    const double one = Work::of_step(even_.force, now.force, now.point - even_.point);
    const double two = Work::of_step(even_.force, last_.force, last_.point - even_.point) +
                       Work::of_step(last_.force, now.force, now.point - last_.point);
    return std::abs(one - two);
  }

  void finish(const Place& now) noexcept {
    Work round = all_.since(start_work_);
    round.add(now.force, start_.force, start_.point - now.point);
    if (!(round.effort > 0)) return;
    const double closing =
        0.5 * (now.force - start_.force).norm() * (now.point - start_.point).norm();
    const double potential =
        stiffness_ > 0
            ? std::abs(now.force.squaredNorm() - start_.force.squaredNorm()) / (2 * stiffness_)
            : 0;
    const LoopGain gain{round.net / round.effort,
                        (sampling_ - start_sampling_ + closing + potential) / round.effort};
    if (!(gain.excess() <= largest_.excess())) largest_ = gain;
  }

  std::span<const PathLoop> loops_;
  double stiffness_;
  std::size_t index_ = 0, next_ = 0;  // of the path; of the loops
  Place last_, even_, start_;         // even: the last point of an even index
  Work all_, start_work_;
  double sampling_ = 0, start_sampling_ = 0;
  LoopGain largest_;
};

}  // namespace gliss
