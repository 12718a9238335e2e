// The smallest loop with a device of one's own: three functions, a surface, and the loop's guard.
//
//   find_package(gliss REQUIRED COMPONENTS runtime)
//   target_link_libraries(own_device PRIVATE gliss::runtime)
#include <gliss/build/build_cache.h>
#include <gliss/generate/generate.h>
#include <gliss/loop/loop.h>
#include <gliss/thread/realtime.h>

#include <cmath>
#include <cstdio>

// Your driver's calls go here. This one dips 2 mm into a ball of 10 mm, twice a second.
class OwnDevice final : public gliss::HapticDevice {
 public:
  OwnDevice() {
    info_.name = "own";
    info_.max_force = 3;         // N
    info_.max_stiffness = 2000;  // N/m
  }
  const gliss::DeviceInfo& info() const noexcept override { return info_; }
  gliss::DeviceState read(gliss::Nanoseconds now) noexcept override {
    if (state_.sequence == 0) start_ = now;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    ++state_.sequence;  // a measurement more
    state_.measured = now;
    state_.position = {0, 0, 0.011 + 0.003 * std::cos(4 * 3.14159265 * seconds)};  // m
    return state_;
  }
  bool write(const gliss::Vec3& force, gliss::Nanoseconds) noexcept override {
    force_ = force;
    return true;  // false: the device has failed
  }
  const gliss::Vec3& force() const { return force_; }

 private:
  gliss::DeviceInfo info_;
  gliss::DeviceState state_;
  gliss::Nanoseconds start_{};
  gliss::Vec3 force_ = gliss::Vec3::Zero();
};

int main() {
  const auto ball =
      std::make_shared<const gliss::PatchCache>(gliss::build_cache(gliss::goldberg().mesh));
  const gliss::SceneObject object{.cache = ball, .stiffness = 500, .friction = {0.4, 0.3}};
  gliss::Tracker tracker({&object, 1});
  OwnDevice device;
  gliss::HapticLoop loop(device, tracker, {.guard = {.max_force = 2, .max_rate = 500}});
  const gliss::Realtime realtime;  // as far as this machine permits
  double most = 0;
  const gliss::LoopEnd end = loop.run([&](const gliss::LoopTick& tick) {
    most = std::max(most, tick.sent.norm());
    return tick.number < 2000;
  });
  std::printf("%s; at most %.2f N, in the end %.2f N\n", gliss::loop_end_text(end), most,
              device.force().norm());
}
