// A whole sitting of gliss view: a page presses the hand into a ball, and reads what the methods
// do.
#include "tools/view/view_session.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "gliss/generate/generate.h"
#include "gliss/tables/point_table.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surfaces.h"
#include "tests/view/browser_side.h"
#include "tools/view/view_geometry.h"

namespace gliss::tools {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

struct SeenTick {
  double number, time;
  std::vector<float> row;

  double of(std::size_t method, std::size_t i) const { return double{row[9 + 10 * method + i]}; }
  double force(std::size_t method) const {
    return std::hypot(of(method, 0), of(method, 1), of(method, 2));
  }
  double sent() const { return std::hypot(double{row[4]}, double{row[5]}, double{row[6]}); }
};

class ViewSessionTest : public testing::Test {
 protected:
  void start(ViewSetting setting = {}) {
    SceneObject object;
    object.cache = cache_;
    setting.objects = {object};
    setting.names = {"ball"};
    setting.rules.reengage = true;
    setting.session.realtime = false;
    setting.page = "<p>";
    setting.token = token_;
    setting.command = "gliss view ball";
    setting.free_recordings = folder_ / "view.h5";
    session_ = std::make_unique<ViewSession>(std::move(setting));
    const std::string url = session_->url();
    page_ = std::make_unique<BrowserSide>(
        static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
    thread_ = std::thread([this] {
      while (session_->turn() && !stop_) {
      }
      session_->end();
    });
    ASSERT_FALSE(page_->open(token_));
  }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  ~ViewSessionTest() override { stop(); }

  // Points there for so long, as a page does, and gives the ticks that came meanwhile.
  std::vector<SeenTick> point(const Vec3& to, int times = 30) {
    std::vector<SeenTick> ticks;
    for (int i = 0; i < times; ++i) {
      page_->send(fmt::format("{{\"hand\":[{},{},{}]}}", to.x(), to.y(), to.z()));
      see(ticks);
    }
    return ticks;
  }
  // Presses until all of the force goes out: where the machine is busy, a loop that is not
  // real-time stands still now and then, and the guard takes the force away.
  SeenTick press() {
    SeenTick last;
    for (int i = 0; i < 20; ++i) {
      point(Vec3(0, 0, 0.02));
      last = point(Vec3(0, 0, 0.006), 60).back();
      if (last.sent() > 0.3 && std::abs(last.sent() - last.force(2)) < 0.02) break;
    }
    return last;
  }
  // Reads until a frame has come.
  void see(std::vector<SeenTick>& ticks) {
    for (;;) {
      const std::string bytes = page_->receive();
      if (bytes.empty()) return;
      std::uint32_t mark = 0, count = 0;
      std::memcpy(&mark, bytes.data(), 4);
      if (bytes.starts_with("{")) {
        const Json json = Json::parse(bytes);
        if (json.contains("state")) state_ = json["state"];
        continue;
      }
      if (mark != kFrameMark) continue;
      std::memcpy(&count, &bytes[4], 4);
      ASSERT_EQ(bytes.size(), 24 + 4 * kRowNumbers * count);
      for (std::uint32_t i = 0; i < count; ++i) {
        SeenTick& tick = ticks.emplace_back();
        std::memcpy(&tick.number, &bytes[8], 8);
        std::memcpy(&tick.time, &bytes[16], 8);
        tick.row.resize(kRowNumbers);
        std::memcpy(tick.row.data(), &bytes[24 + 4 * kRowNumbers * i], 4 * kRowNumbers);
      }
      return;
    }
  }

  const std::shared_ptr<const PatchCache> cache_ =
      std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  const std::string token_ = make_view_token();
  test::ScratchFolder folder_;
  std::unique_ptr<ViewSession> session_;
  std::unique_ptr<BrowserSide> page_;
  Json state_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST_F(ViewSessionTest, feels_all_methods_on_one_hip) {
  start();
  const SeenTick last = press();
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_GT(last.force(m), 0.3) << m;
    EXPECT_NEAR(last.of(m, 6), last.force(m) / 500, 2e-4) << "depth";
    EXPECT_EQ(last.of(m, 7), 1) << "touching";
  }
  EXPECT_NEAR(last.sent(), last.force(2), 0.02) << "the hand feels the patches";
  EXPECT_EQ(last.row[7], static_cast<float>(GuardState::kRun));
}

TEST_F(ViewSessionTest, ends_the_force_of_a_silent_page_and_gives_it_back) {
  start();
  EXPECT_GT(press().sent(), 0.3);
  std::vector<SeenTick> silent;
  for (int i = 0; i < 40; ++i) see(silent);
  EXPECT_EQ(silent.back().sent(), 0);
  EXPECT_EQ(silent.back().row[7], static_cast<float>(GuardState::kSafe));
  EXPECT_EQ(static_cast<GuardReason>(silent.back().row[8]), GuardReason::kLateInput);
  EXPECT_EQ(point(Vec3(0, 0, 0.006), 30).back().sent(), 0) << "not while it presses";
  EXPECT_GT(press().sent(), 0.3);
}

TEST_F(ViewSessionTest, tunes_within_the_limits_of_the_hand) {
  start();
  point(Vec3(0, 0, 0.02));
  point(Vec3(0, 0, 0.006), 60);
  page_->send(R"({"tune":{"method":"flat","stiffness":1e6,"friction":[0.5,0.4],"settle":0.01}})");
  const auto ticks = point(Vec3(0, 0, 0.006), 90);
  EXPECT_EQ(state_["method"], "flat");
  EXPECT_EQ(state_["stiffness"], 2000) << "what the hand takes";
  EXPECT_EQ(state_["command"],
            "gliss view ball --method flat --stiffness 2000N/m --friction 0.5,0.4 --settle 10ms");
  EXPECT_NEAR(ticks.back().of(0, 6), ticks.back().force(0) / 2000, 2e-4);
}

TEST_F(ViewSessionTest, records_where_its_program_says) {
  start();
  point(Vec3(0, 0, 0.02));
  for (const char* name : {"view.h5", "view-2.h5"}) {
    page_->send(R"({"record":true})");
    point(Vec3(0, 0, 0.006), 20);
    EXPECT_EQ(state_["recording"], folder_ / name);
    page_->send(R"({"record":false})");
    point(Vec3(0, 0, 0.02), 20);
    EXPECT_EQ(state_["recording"], "");
    EXPECT_GT(read_points(folder_ / name, 1).points.size(), 50u);
  }
  stop();
  EXPECT_EQ(session_->recorded().size(), 2u);
  EXPECT_GT(session_->touched(), 50u);
}

TEST_F(ViewSessionTest, goes_on_where_a_recording_cannot_be_written) {
  ViewSetting setting;
  start(std::move(setting));
  std::filesystem::remove_all(folder_ / "");
  page_->send(R"({"record":true})");
  point(Vec3(0, 0, 0.02));
  EXPECT_EQ(state_["recording"], "");
  EXPECT_NE(state_["failure"], "");
  EXPECT_GT(press().sent(), 0.3);
}

TEST(ViewGeometry, has_each_face_once_and_lies_on_the_patches) {
  SceneObject object;
  object.cache = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  object.pose.translation() = Vec3(1, 0, 0);
  const std::string bytes = geometry_of(object, 3, 20'000);
  std::array<std::uint32_t, 8> head;
  std::memcpy(head.data(), bytes.data(), sizeof head);
  const auto [mark, number, points, triangles, edges, polygons, none, nothing] = head;
  EXPECT_EQ(mark, kGeometryMark);
  EXPECT_EQ(number, 3u);
  EXPECT_LE(triangles, 20'000u);
  EXPECT_GT(triangles, 4'000u);
  EXPECT_EQ(bytes.size(), 32 + points * 24u + triangles * 12u + edges * 24u + polygons * 36u);
  std::vector<float> positions(3 * points);
  std::memcpy(positions.data(), &bytes[32], 12 * points);
  const double radius = object.cache->bounds().high.x() * object.cache->unit;
  for (std::size_t i = 0; i < points; ++i) {
    const Vec3 at(double{positions[3 * i]} - 1, double{positions[3 * i + 1]},
                  double{positions[3 * i + 2]});
    ASSERT_NEAR(at.norm(), radius, 0.05 * radius);
  }
  std::vector<std::uint32_t> index(3 * triangles);
  std::memcpy(index.data(), &bytes[32 + points * 24], 12 * triangles);
  for (const std::uint32_t i : index) ASSERT_LT(i, points);
}

}  // namespace
}  // namespace gliss::tools
