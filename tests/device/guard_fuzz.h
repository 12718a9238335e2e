// Guards under fuzz: inputs of every kind, and a judge of what comes of them.
#pragma once

#include <algorithm>
#include <array>

#include "gliss/device/guard.h"
#include "tests/oracle/oracle.h"
#include "tests/support/numbers.h"

namespace gliss::test {

// The inputs of a step of a guard.
struct GuardCase {
  std::chrono::nanoseconds now{0}, measured{0};
  Vec3 force = Vec3::Zero();
  GuardReason trip = GuardReason::kNone;
};

// A value that may stand where a number should.
inline double odd_number(oracle::Rng& rng) {
  constexpr double kOdd[] = {kNaN,    -kNaN, kInfinity, -kInfinity, 1e300, -1e300, 5e-324, -2e-308,
                             1.7e308, 0,     -0.0,      1e9,        -1e9,  0.2,    3.3};
  return kOdd[rng() % std::size(kOdd)];
}

// Sound stretches of a hand that moves, broken by every kind of bad input.
class GuardFuzz : public GuardCase {
 public:
  explicit GuardFuzz(std::uint64_t seed) : rng_(seed) {}

  void next() {
    if (left_-- == 0) {  // stretches of one mood: calm ones reach kRun, wild ones trip
      left_ = static_cast<int>(rng_() % 400);
      odds_ = 1u << (rng_() % 10);
      pace_ = static_cast<int>(rng_() % 16);
      size_ = std::array{0.02, 0.1, 1.0, 3.0, 30.0}[rng_() % 5];
      base_ = noise();
    }
    const auto any_dt = static_cast<std::int64_t>(rng_() % 4'000'000);
    now = shifted(now, pace_ < 4 ? any_dt : pace_ < 8 ? any_dt % 2 * 1'000'000 : 1'000'000);
    force = base_ + 0.1 * noise();
    age_ = static_cast<std::int64_t>(rng_() % 1'500'000);
    trip = GuardReason::kNone;
    if (rng_() % 1024 < odds_) spoil();
    measured = shifted(now, -age_);
  }

 private:
  using nanoseconds = std::chrono::nanoseconds;

  static nanoseconds shifted(nanoseconds time, std::int64_t by) {  // wraps
    return nanoseconds{static_cast<std::int64_t>(static_cast<std::uint64_t>(time.count()) +
                                                 static_cast<std::uint64_t>(by))};
  }
  Vec3 noise() { return oracle::uniform(rng_, 0, size_) * oracle::random_unit(rng_); }
  void spoil() {
    const auto any = static_cast<std::int64_t>(rng_());
    const auto any_ms = static_cast<std::int64_t>(rng_() % 15'000'000);
    switch (rng_() % 11) {
      case 0:  // the clock goes backwards
        now = shifted(now, -any_ms);
        break;
      case 1:  // the loop stalls
        now = shifted(now, any_ms);
        break;
      case 2:  // the device stalls
        age_ = any_ms;
        break;
      case 3:  // any age, often of the future
        age_ = rng_() % 2 ? any : -any_ms;
        break;
      case 4:
        force *= 1e3;
        break;
      case 5:
        force = -force;
        break;
      case 6:
        force = {odd_number(rng_), odd_number(rng_), odd_number(rng_)};
        break;
      case 7:
        if (rng_() % 4 == 0) now = nanoseconds{any};
        if (rng_() % 4 == 0)
          trip = rng_() % 2 ? GuardReason::kDeviceFault : GuardReason::kStopRequested;
        break;
      default:
        force[static_cast<int>(rng_() % 3)] = odd_number(rng_);
    }
  }

  oracle::Rng rng_;
  int left_ = 0, pace_ = 0;
  std::uint64_t odds_ = 0;
  double size_ = 0;
  Vec3 base_ = Vec3::Zero();
  std::int64_t age_ = 0;
};

// Judges each step by the header's words, with a clock of its own.
class GuardJudge {
 public:
  explicit GuardJudge(const GuardLimits& limits) : limits_(limits) {}

  bool sound(const GuardCase& in, const GuardOutput& out) {
    using enum GuardState;
    using enum GuardReason;
    const __int128 gap = started_ ? static_cast<__int128>(in.now.count()) - then_.count() : 0;
    const __int128 age = static_cast<__int128>(in.now.count()) - in.measured.count();
    const bool usable = in.force.allFinite() && age <= 2'000'000 && age >= -2'000'000;
    auto dt = static_cast<std::int64_t>(std::clamp<__int128>(gap, 0, 10'000'000));
    missing_ = std::min<std::int64_t>(missing_ + dt, 10'000'000);
    const bool unanswered = missing_ == 10'000'000;
    if (usable) missing_ = std::max<std::int64_t>(0, static_cast<std::int64_t>(age));
    tripped_ = tripped_ || in.trip != kNone || gap < 0 || out.reason == kTimeBackwards ||
               out.reason == kTimeStalled;
    if (tripped_) dt = std::max<std::int64_t>(dt, 1'000'000);

    const double size = out.force.norm(), before = last_.force.norm();
    const double change = limits_.max_rate * 1e-9 * static_cast<double>(dt);
    const bool sound = out.force.allFinite() && size <= limits_.max_force &&
                       (out.force - last_.force).norm() <= change + 1e-15 &&  // rounding of the sum
                       (out.state != kStart || size <= limits_.engage_below) &&
                       (out.state != kRun || (usable && !tripped_)) &&
                       (out.state != kHold || size <= before) &&
                       (out.state != kRamp || size <= before) &&
                       (out.state != kSafe || (size == 0 && out.reason != kNone)) &&
                       (last_.state != kSafe || engaged_ || out.state == kSafe) &&
                       (!unanswered || out.state == kSafe);
    last_ = out;
    then_ = in.now;
    started_ = true;
    engaged_ = false;
    return sound;
  }
  void engaged() {
    engaged_ = true;
    tripped_ = false;
    missing_ = 0;
  }

 private:
  GuardLimits limits_;
  GuardOutput last_;
  std::chrono::nanoseconds then_{0};
  std::int64_t missing_ = 0;  // ns, age of the last usable input
  bool started_ = false, engaged_ = false, tripped_ = false;
};

}  // namespace gliss::test
