// Whatever comes in a datagram: nothing, or one that is valid, with finite numbers, and leaves as
// the bytes it came as.
#include "gliss/device/udp_protocol.h"
#include "tests/fuzz/fuzz.h"

namespace gliss::fuzz {
namespace {

template <class Datagram>
std::optional<Datagram> decoded(std::span<const std::byte> bytes) {
  const auto datagram = udp::decode<Datagram>(bytes);
  if (datagram) {
    const auto again = udp::encode(*datagram);
    require(std::equal(bytes.begin(), bytes.end(), again.begin(), again.end()), "the same bytes");
  }
  return datagram;
}

void require_usable(const udp::TurningStateDatagram& datagram, bool turns) {
  DeviceState state = udp::state_of(datagram);
  state.sequence = datagram.state.sequence;
  const DeviceInfo info = udp::info_of(datagram, turns, "fuzz");
  require(state.position.allFinite() && state.velocity.allFinite(), "a finite state");
  require(std::abs(state.orientation.norm() - 1) < 1e-6, "a rotation");
  require(info.max_force > 0 && info.max_stiffness > 0 && info.max_torque >= 0, "limits");
  require(udp::is_valid(udp::datagram_of(info, state, datagram.state.session)), "one to send on");
}

}  // namespace
}  // namespace gliss::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  const auto bytes = std::as_bytes(std::span(data, size));
  if (const auto state = fuzz::decoded<udp::StateDatagram>(bytes))
    fuzz::require_usable({.state = *state}, false);
  if (const auto state = fuzz::decoded<udp::TurningStateDatagram>(bytes))
    fuzz::require_usable(*state, true);
  if (const auto force = fuzz::decoded<udp::ForceDatagram>(bytes))
    fuzz::require(udp::vector(force->force).allFinite(), "a finite force");
  if (const auto wrench = fuzz::decoded<udp::PassedWrenchDatagram>(bytes))
    fuzz::require(udp::vector(wrench->wrench.torque).allFinite(), "a finite torque");
  return 0;
}
