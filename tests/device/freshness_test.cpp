// A force ends within 20 ms of its device's last word, whatever the device stamps on its states:
// the loop judges by when they arrive, one path for every device.
#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "gliss/device/udp_device.h"
#include "gliss/generate/generate.h"
#include "gliss/haply/haply_device.h"
#include "gliss/loop/loop.h"
#include "tests/device/udp_fakes.h"
#include "tests/haply/haply_mock.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kSpeaks = 900ms, kWatched = 200ms, kLongest = 20ms;

// Words of a device: a hand from the open into a ball of 10 mm. From the moment that it presses
// its clock may be wrong.
class Hand {
 public:
  explicit Hand(Nanoseconds ahead) : ahead_(ahead) {}

  // Its device is open from now on, however long that took.
  void begin() { start_ = monotonic_time(); }
  Vec3 position() const { return {0, 0, 0.012 - 0.004 * std::clamp(age() / 0.4 - 0.5, 0.0, 1.0)}; }
  Nanoseconds stamp() const { return monotonic_time() + (age() > 0.3 ? ahead_ : 0ns); }
  // False from when it falls silent.
  bool speaks() {
    const Nanoseconds now = monotonic_time();
    if (now - start_.load() > kSpeaks) return false;
    last_ = now;
    return true;
  }
  Nanoseconds last() const { return last_; }

 private:
  double age() const { return in_seconds(monotonic_time() - start_.load()); }

  const Nanoseconds ahead_;
  std::atomic<Nanoseconds> start_{monotonic_time()}, last_{0ns};
};

// In this process.
class DirectDevice : public HapticDevice {
 public:
  explicit DirectDevice(Hand& hand) : hand_(hand) {}
  const DeviceInfo& info() const noexcept override { return info_; }
  DeviceState read(Nanoseconds) noexcept override {
    if (hand_.speaks()) {
      ++state_.sequence;
      state_.measured = hand_.stamp();
      state_.position = hand_.position();
    }
    return state_;
  }
  bool write(const Vec3&, Nanoseconds) noexcept override { return true; }

 private:
  Hand& hand_;
  DeviceInfo info_;
  DeviceState state_;
};

// Behind a UDP port, in a thread.
class UdpEnd {
 public:
  // `replays`: once the hand has fallen silent it says again what it has said, stamped as new.
  explicit UdpEnd(Hand& hand, bool replays = false)
      : thread_([this, &hand, replays] { speak(hand, replays); }) {}
  ~UdpEnd() {
    over_ = true;
    thread_.join();
  }
  std::uint16_t port() const { return peer_.socket.port(); }

 private:
  void speak(Hand& hand, bool replays) {
    while (!over_ && !peer_.receive<udp::ForceDatagram>()) std::this_thread::sleep_for(100us);
    peer_.socket.connect(peer_.from);
    hand.begin();
    std::uint64_t last = 0;
    for (; !over_ && hand.speaks(); std::this_thread::sleep_for(700us)) say(++last, hand);
    for (std::uint64_t i = 0; !over_; ++i, std::this_thread::sleep_for(700us)) {
      if (replays) say(last - i % last, hand);
    }
  }
  void say(std::uint64_t sequence, const Hand& hand) {
    DeviceState state;
    state.sequence = sequence;
    state.measured = hand.stamp();
    state.position = hand.position();
    peer_.socket.send(udp::encode(udp::datagram_of({}, state, 1).state));
  }

  test::Peer peer_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

struct Ended {
  bool pressed = false;
  Nanoseconds after{}, late{};  // the force, after the last word; the loop's latest tick
};

Ended drive(HapticDevice& device, const Hand& hand) {
  static const auto cache =
      std::make_shared<const PatchCache>(test::cache_of(goldberg(4, 10).mesh));
  const SceneObject ball{.cache = cache, .stiffness = 500};
  Tracker tracker({&ball, 1});
  HapticLoop loop(device, tracker);
  Ended ended;
  Nanoseconds last_force = 0ns;
  const Nanoseconds end = monotonic_time() + kSpeaks + kWatched;
  loop.run([&](const LoopTick& tick) {
    const Nanoseconds now = monotonic_time();
    ended.late = std::max(ended.late, tick.lateness);
    if (tick.sent != Vec3::Zero()) last_force = now;
    ended.pressed = ended.pressed || tick.sent.norm() > 0.3;
    return now < end;
  });
  ended.after = last_force - hand.last();
  return ended;
}

// A machine that stands still for longer tells nothing: then once more.
template <class Open>
void expect_fresh(Nanoseconds ahead, Open open) {
  for (int tries = 0;; ++tries) {
    Hand hand(ahead);
    const Ended ended = open(hand);
    if (ended.late > 5ms && tries < 10) continue;
    if (ended.pressed) {
      test::record("silence", "stamps {} s ahead: no force {:.1f} ms after the last word",
                   in_seconds(ahead), 1e3 * in_seconds(ended.after));
    }
    EXPECT_LE(ended.after, kLongest + ended.late);
    EXPECT_TRUE(ended.pressed || ahead != 0ns);
    return;
  }
}

class Freshness : public ::testing::TestWithParam<Nanoseconds> {};

TEST_P(Freshness, of_a_device_of_this_process) {
  expect_fresh(GetParam(), [](Hand& hand) {
    DirectDevice device(hand);
    return drive(device, hand);
  });
}

TEST_P(Freshness, of_a_device_behind_udp) {
  expect_fresh(GetParam(), [](Hand& hand) {
    UdpEnd end(hand);
    UdpDevice device(end.port());
    return drive(device, hand);
  });
}

INSTANTIATE_TEST_SUITE_P(Stamps, Freshness,
                         ::testing::Values(0ns, -1s, 1ms, 1s,
                                           Nanoseconds(1'000'000'000'000'000'000)),
                         [](const auto& info) { return std::to_string(info.index); });

TEST(UdpFreshness, of_a_device_whose_states_are_replayed) {
  expect_fresh(0ns, [](Hand& hand) {
    UdpEnd end(hand, true);
    UdpDevice device(end.port());
    return drive(device, hand);
  });
}

// Its messages have no stamps.
TEST(HaplyFreshness, of_a_device_behind_haplys_service) {
  expect_fresh(0ns, [](Hand& hand) {
    const test::HaplyMock mock([&](std::uint64_t number) {
      if (number == 0) hand.begin();
      std::this_thread::sleep_for(700us);
      if (!hand.speaks()) return test::HaplyReply{"", test::HaplyReply::kStaySilent};
      return test::HaplyReply{test::haply_message("049D", hand.position(), Vec3::Zero())};
    });
    HaplyDevice device({.port = mock.port()});
    return drive(device, hand);
  });
}

}  // namespace
}  // namespace gliss
