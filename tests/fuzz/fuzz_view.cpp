// Whatever a browser sends to gliss view: a request is let in only with the host, origin and token
// that are its own, and a message that is read is finite and in range.
#include "gliss/query/friction.h"
#include "tests/fuzz/fuzz.h"
#include "tools/view/view_protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  using namespace gliss::tools;
  const std::string_view input = fuzz::text_of(data, size);
  const ViewDoor door{8080, "0123456789abcdef0123456789abcdef"};
  const ViewAnswer answer = judge_request(input, door).answer;
  const auto has = [&](std::string_view text) { return input.find(text) != input.npos; };
  if (answer == ViewAnswer::kPage || answer == ViewAnswer::kSocket)
    fuzz::require(has("127.0.0.1:8080") || has("localhost:8080"), "the host");
  if (answer == ViewAnswer::kSocket) {
    fuzz::require(has("gliss." + door.token), "the token");
    fuzz::require(has("http://127.0.0.1:8080") || has("http://localhost:8080"), "the origin");
  }
  const auto message = read_view_message(input);
  if (!message) return 0;
  fuzz::require(size <= kLongestMessage, "short messages");
  if (const auto* hand = std::get_if<HandMessage>(&*message))
    fuzz::require(hand->target.allFinite(), "a finite target");
  if (const auto* tune = std::get_if<TuneMessage>(&*message))
    fuzz::require(tune->stiffness > 0 && is_stiffness(tune->stiffness) &&
                      fault_of(tune->friction) == nullptr && tune->settle >= 0,
                  "material in range");
  return 0;
}
