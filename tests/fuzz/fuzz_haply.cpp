// Whatever a service answers, after a line with the id that is asked for: a finite state, to which
// a command can be written, or a HaplyProtocolError.
#include "gliss/haply/haply_protocol.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  const std::string_view input = fuzz::text_of(data, size);
  const std::size_t end = std::min(input.find('\n'), size);
  const std::string_view id = input.substr(0, end), text = input.substr(end);
  try {
    const HaplyState state = read_haply_state(text, id);
    fuzz::require(id.empty() || state.device_id == id, "the device that was asked for");
    fuzz::require(state.position.allFinite() && state.velocity.allFinite(), "a finite state");
    haply_force_command(state.device_id, state.velocity);
  } catch (const HaplyProtocolError&) {
  }
  return 0;
}
