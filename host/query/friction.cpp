#include "gliss/query/friction.h"

#include <algorithm>
#include <cmath>

namespace gliss {
namespace {

constexpr double kMostOnBorder = 0.5;

}  // namespace

const char* fault_of(const FrictionOptions& options) noexcept {
  const auto is_coefficient = [](double mu) { return mu >= 0 && mu <= FrictionOptions::kMost; };
  if (!is_coefficient(options.at_rest)) return "has a static friction that is not from 0 to 5";
  if (!is_coefficient(options.slipping)) return "has a dynamic friction that is not from 0 to 5";
  if (options.slipping > options.at_rest) return "has a dynamic friction above the static one";
  if (!(options.settle >= 0 && options.settle <= kMostSettleTime))
    return "has a settle of its friction that is not from 0 to 1 s";
  return nullptr;
}

Friction::Friction(const FrictionOptions& options)
    : static_(options.at_rest), dynamic_(options.slipping), settle_(options.settle), mu_(static_) {}

void Friction::change(const FrictionOptions& options) noexcept {
  mu_ = mu_ == static_ ? options.at_rest : std::clamp(mu_, options.slipping, options.at_rest);
  static_ = options.at_rest;
  dynamic_ = options.slipping;
  settle_ = options.settle;
  has_grip_ = has_grip_ && is_on();
}

void Friction::begin(const Vec3& axis, bool has_grip) noexcept {
  axis_ = axis;
  lag_.setZero();
  has_grip_ = has_grip;
  slips_ = false;
  mu_ = static_;
  narrowed_ = press_ = 0;
}

double Friction::coefficient(bool on_border) const {
  return on_border ? std::min(mu_, kMostOnBorder) : mu_;
}

bool Friction::holds(const Vec3& offset, bool on_border) const {
  const double press = offset.dot(axis_);
  return (offset - press * axis_).norm() <= coefficient(on_border) * press;
}

void Friction::narrow(double dt) noexcept {
  const double stays = settle_ > 0 ? std::exp(-dt / settle_) : 0;
  const double next = dynamic_ + stays * (mu_ - dynamic_);
  narrowed_ = mu_ - next;
  mu_ = next;
}

Vec3 Friction::lag_within(const Vec3& offset, bool on_border) const {
  const Vec3 lag = across(axis_, offset);
  const double most = coefficient(on_border) * std::max(0.0, offset.dot(axis_)),
               length = lag.norm();
  return length > most ? Vec3(most / length * lag) : lag;
}

double Friction::lag_factor(const Vec3& offset, const Vec3& rest, const Vec3& axis,
                            bool on_border) const {
  const double most = coefficient(on_border) * std::max(0.0, offset.dot(axis));
  const Vec3 lag = across(axis, offset), out = across(axis, rest);
  const double over = on_border && !out.isZero(0) ? lag.dot(out) / out.norm() : 0;
  const double free2 = lag.squaredNorm() - over * over, most2 = most * most - over * over;
  return free2 > 0 ? std::sqrt(std::max(0.0, most2) / free2) : 1;
}

Vec3 Friction::feel(const Vec3& offset, const Vec3& axis, bool slips, bool on_border) noexcept {
  axis_ = axis;
  press_ = std::max(0.0, offset.dot(axis));
  lag_ = across(axis, offset);
  slips_ = slips;
  if (!slips) {
    mu_ = static_;
    narrowed_ = 0;
  }
  return on_border && lag_.norm() > coefficient(true) * press_ ? past_border(offset) : offset;
}

Vec3 Friction::past_border(const Vec3& offset) const {
  const double mu = coefficient(true), ends = 2 / ((1 + mu) * (1 + mu)), ends2 = ends * ends;
  const Vec3 edge = (axis_ + mu / lag_.norm() * lag_).normalized();
  const double depth = offset.dot(edge), bend = 1 + 2 / ends2;
  const Vec3 aside = offset - depth * edge;
  const double past = aside.norm();
  if (!(past < ends * depth)) return Vec3::Zero();
  if (bend * ends * past <= depth) return depth * edge - bend * aside;
  const double pressed = (ends2 + 2) / (ends2 + 1) * (depth - past / ends);
  return pressed * (edge - 1 / (ends * past) * aside);
}

double Friction::share() const {
  const double most = static_ * press_;
  return most > 0 ? lag_.norm() / most : 0;
}

}  // namespace gliss
