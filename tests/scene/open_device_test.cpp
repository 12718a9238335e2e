// Devices of scenes, by the words that name them.
#include "gliss/scene/open_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gliss/haply/haply_device.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using test::message_of;

std::string refusal(const std::string& words, const DeviceOpening& opening = {}) {
  return message_of<std::invalid_argument>([&] { open_device(words, Scene(), opening); });
}

TEST(OpenDevice, says_which_words_there_are) {
  EXPECT_EQ(refusal("hand"), "device: 'hand' is not one of sim, replay:FILE, udp:PORT");
  EXPECT_EQ(refusal("haply"), "device: 'haply' is not one of sim, replay:FILE, udp:PORT");
  EXPECT_EQ(refusal("udp:x"), "device udp: 'x' is not a number that fits");
  EXPECT_EQ(refusal("sim"),
            "device sim: the scene has no [sim] with waypoints, the way of the hand");
  EXPECT_EQ(refusal("replay:none.csv"), "cannot read 'none.csv': No such file or directory");
}

TEST(OpenDevice, asks_for_devices_of_other_libraries) {
  const DeviceOpening with_haply{
      .name = "--device", .open_other = open_haply, .other_words = kHaplyWords};
  EXPECT_EQ(refusal("hand", with_haply),
            "--device: 'hand' is not one of sim, replay:FILE, udp:PORT, haply, haply:HOST or "
            "haply:HOST:PORT");
  EXPECT_EQ(refusal("haply:localhost:x", with_haply),
            "--device haply: 'x' is not a number that fits");
}

// A thread of the device's own comes before the loop's, where there may be one.
TEST(OpenDevice, gives_others_a_priority_above_the_loops) {
  Scene scene;
  scene.priority = 80;
  int asked = -1;
  DeviceOpening opening;
  opening.open_other = [&](const std::string&, int priority) {
    asked = priority;
    return nullptr;
  };
  EXPECT_THROW(open_device("other", scene, opening), std::invalid_argument);
  EXPECT_EQ(asked, 81);
  scene.priority = 99;
  EXPECT_THROW(open_device("other", scene, opening), std::invalid_argument);
  EXPECT_EQ(asked, 100);  // which no thread can have
  opening.realtime = false;
  EXPECT_THROW(open_device("other", scene, opening), std::invalid_argument);
  EXPECT_EQ(asked, 0);
}

}  // namespace
}  // namespace gliss
