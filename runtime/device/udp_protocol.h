// The datagrams between a loop and a haptic device in another process of this machine: fixed
// layouts, little-endian, without padding. Both processes read the same CLOCK_MONOTONIC. What does
// not hold of a datagram makes it none: nothing of it is used.
//
// A device that has a pass (gliss/device/udp_pass.h) takes forces with that pass alone, and
// answers others with a RefusalDatagram. One without takes them from whoever comes first.
#pragma once

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "gliss/device/device.h"

namespace gliss::udp {

static_assert(std::endian::native == std::endian::little, "the datagrams are memory as it lies");

inline constexpr std::uint32_t kStateMagic = 0x53534c47;    // "GLSS"
inline constexpr std::uint32_t kForceMagic = 0x46534c47;    // "GLSF"
inline constexpr std::uint32_t kRefusalMagic = 0x52534c47;  // "GLSR"
inline constexpr std::uint16_t kVersion = 1;

// Bits of StateDatagram::flags and of ForceDatagram::flags; others must be zero.
inline constexpr std::uint16_t kHasVelocity = 1, kFault = 2, kEnded = 4;
inline constexpr std::uint16_t kBye = 1;  // the loop ends, its force too

using Triple = std::array<double, 3>;
using Quad = std::array<double, 4>;
using Pass = std::array<std::byte, 16>;

// From the device, in each of its ticks.
struct StateDatagram {
  std::uint32_t magic = kStateMagic;
  std::uint16_t version = kVersion;
  std::uint16_t flags = 0;
  std::uint64_t session = 0;    // when the device's side began, ns: orders those of one port
  std::uint64_t sequence = 0;   // of the measurement, from 1
  std::int64_t measured = 0;    // ns
  Triple position{};            // m
  Triple velocity{};            // m/s
  double max_force = 0;         // N, 0: no limit
  double max_stiffness = 0;     // N/m, 0: no limit
  Triple box_min{}, box_max{};  // m, the workspace; box_min > box_max in any: not known
};

// From a device that has an orientation, in place of that.
struct TurningStateDatagram {
  StateDatagram state;
  Quad orientation{1, 0, 0, 0};  // w, x, y, z of a unit quaternion
  double max_torque = 0;         // N m, 0: no limit
};

// From the loop, in each of its ticks. The first may have any force, a hello has none.
struct ForceDatagram {
  std::uint32_t magic = kForceMagic;
  std::uint16_t version = kVersion;
  std::uint16_t flags = 0;
  std::uint64_t sequence = 0;  // from 1
  std::uint64_t answers = 0;   // sequence of the state, 0: of none
  std::int64_t sent = 0;       // ns; what waited in a queue for too long is not a fresh force
  Triple force{};              // N
};

// From a loop that has the device's pass.
struct PassedForceDatagram {
  ForceDatagram force;
  Pass pass{};
};

// ... to a device that has an orientation, in place of these.
struct WrenchDatagram {
  ForceDatagram force;
  Triple torque{};  // N m, about the device's position
};
struct PassedWrenchDatagram {
  WrenchDatagram wrench;
  Pass pass{};
};

// From the device, to a loop whose forces it does not take: no pass, or another.
struct RefusalDatagram {
  std::uint32_t magic = kRefusalMagic;
  std::uint16_t version = kVersion;
  std::uint16_t reserved = 0;
};

template <class Datagram>
inline constexpr bool kPlain =
    std::is_trivially_copyable_v<Datagram>&& std::is_standard_layout_v<Datagram>;
static_assert(kPlain<StateDatagram> && kPlain<ForceDatagram> && kPlain<PassedForceDatagram>);
static_assert(kPlain<TurningStateDatagram> && kPlain<PassedWrenchDatagram>);
// They are as long as their members together: there is no padding.
static_assert(sizeof(StateDatagram) == 4 + 2 + 2 + 3 * 8 + 2 * 24 + 2 * 8 + 2 * 24);
static_assert(sizeof(ForceDatagram) == 4 + 2 + 2 + 3 * 8 + 24);
static_assert(sizeof(PassedForceDatagram) == sizeof(ForceDatagram) + sizeof(Pass));
static_assert(sizeof(TurningStateDatagram) == sizeof(StateDatagram) + 4 * 8 + 8);
static_assert(sizeof(WrenchDatagram) == sizeof(ForceDatagram) + sizeof(Triple));
static_assert(sizeof(PassedWrenchDatagram) == sizeof(WrenchDatagram) + sizeof(Pass));
static_assert(sizeof(RefusalDatagram) == 4 + 2 + 2);
static_assert(offsetof(StateDatagram, box_max) == sizeof(StateDatagram) - sizeof(Triple));
static_assert(offsetof(ForceDatagram, force) == sizeof(ForceDatagram) - sizeof(Triple));
static_assert(sizeof(double) == 8 && std::numeric_limits<double>::is_iec559);

inline constexpr std::size_t kLargest = sizeof(TurningStateDatagram);

// A loop that falls silent has no force; no other gets the device for so long.
inline constexpr std::chrono::seconds kPlaceKept{5};

inline bool is_finite(const Triple& v) noexcept {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

inline bool is_valid(const StateDatagram& d) noexcept {
  const auto limit = [](double x) { return x >= 0 && std::isfinite(x); };
  return d.magic == kStateMagic && d.version == kVersion &&
         (d.flags & ~(kHasVelocity | kFault | kEnded)) == 0 && d.session > 0 && d.sequence > 0 &&
         d.measured >= 0 && is_finite(d.position) && is_finite(d.velocity) && limit(d.max_force) &&
         limit(d.max_stiffness) && is_finite(d.box_min) && is_finite(d.box_max);
}

inline bool is_valid(const TurningStateDatagram& d) noexcept {
  const Quad& q = d.orientation;
  const double length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return is_valid(d.state) && std::abs(length2 - 1) < 1e-6 && d.max_torque >= 0 &&
         std::isfinite(d.max_torque);
}

inline bool is_valid(const ForceDatagram& d) noexcept {
  return d.magic == kForceMagic && d.version == kVersion && (d.flags & ~kBye) == 0 &&
         d.sequence > 0 && d.sent >= 0 && is_finite(d.force);
}

inline bool is_valid(const PassedForceDatagram& d) noexcept { return is_valid(d.force); }

inline bool is_valid(const WrenchDatagram& d) noexcept {
  return is_valid(d.force) && is_finite(d.torque);
}

inline bool is_valid(const PassedWrenchDatagram& d) noexcept { return is_valid(d.wrench); }

inline bool is_valid(const RefusalDatagram& d) noexcept {
  return d.magic == kRefusalMagic && d.version == kVersion && d.reserved == 0;
}

template <class Datagram>
std::array<std::byte, sizeof(Datagram)> encode(const Datagram& datagram) noexcept {
  static_assert(kPlain<Datagram>);
  std::array<std::byte, sizeof(Datagram)> bytes;
  std::memcpy(bytes.data(), &datagram, sizeof datagram);
  return bytes;
}

// decode<ForceDatagram>(bytes); nothing where that is not one.
template <class Datagram>
std::optional<Datagram> decode(std::span<const std::byte> bytes) noexcept {
  static_assert(kPlain<Datagram>);
  if (bytes.size() != sizeof(Datagram)) return std::nullopt;
  Datagram datagram;
  std::memcpy(&datagram, bytes.data(), sizeof datagram);
  if (!is_valid(datagram)) return std::nullopt;
  return datagram;
}

inline Triple triple(const Vec3& v) noexcept { return {v.x(), v.y(), v.z()}; }
inline Vec3 vector(const Triple& v) noexcept { return {v[0], v[1], v[2]}; }

// A limit of a device as datagrams have it, where none is 0, and back.
inline double sent_limit(double x) noexcept { return std::isinf(x) && x > 0 ? 0 : x; }
inline double read_limit(double x) noexcept {
  return x == 0 ? std::numeric_limits<double>::infinity() : x;
}

// A datagram that is not valid where the state is not, such as for a position that is NaN. Without
// an orientation its `state` alone is sent.
inline TurningStateDatagram datagram_of(const DeviceInfo& info, const DeviceState& state,
                                        std::uint64_t session) noexcept {
  TurningStateDatagram turning;
  StateDatagram& d = turning.state;
  d.flags = static_cast<std::uint16_t>((info.has_velocity ? kHasVelocity : 0) |
                                       (state.fault ? kFault : 0) | (state.ended ? kEnded : 0));
  d.session = session;
  d.sequence = state.sequence;
  d.measured = state.measured.count();
  d.position = triple(state.position);
  if (info.has_velocity) d.velocity = triple(state.velocity);
  d.max_force = sent_limit(info.max_force);
  d.max_stiffness = sent_limit(info.max_stiffness);
  d.box_min = triple(info.workspace.min());
  d.box_max = triple(info.workspace.max());
  if (!info.has_orientation) return turning;
  const Rotation& q = state.orientation;
  turning.orientation = {q.w(), q.x(), q.y(), q.z()};
  turning.max_torque = sent_limit(info.max_torque);
  return turning;
}

// Without its sequence, which the loop counts across sessions.
inline DeviceState state_of(const TurningStateDatagram& turning) noexcept {
  const StateDatagram& d = turning.state;
  DeviceState state;
  state.measured = Nanoseconds(d.measured);
  state.position = vector(d.position);
  if ((d.flags & kHasVelocity) != 0) state.velocity = vector(d.velocity);
  const Quad& q = turning.orientation;
  state.orientation = Rotation(q[0], q[1], q[2], q[3]);
  state.fault = (d.flags & kFault) != 0;
  state.ended = (d.flags & kEnded) != 0;
  return state;
}

// `has_orientation`: it came as a TurningStateDatagram.
inline DeviceInfo info_of(const TurningStateDatagram& turning, bool has_orientation,
                          std::string name) {
  const StateDatagram& d = turning.state;
  DeviceInfo info;
  info.name = std::move(name);
  info.max_force = read_limit(d.max_force);
  info.max_stiffness = read_limit(d.max_stiffness);
  const Eigen::AlignedBox3d box(vector(d.box_min), vector(d.box_max));
  if (!box.isEmpty()) info.workspace = box;
  info.has_velocity = (d.flags & kHasVelocity) != 0;
  info.has_orientation = has_orientation;
  info.max_torque = read_limit(turning.max_torque);
  return info;
}

}  // namespace gliss::udp
