// A whole sitting of gliss view: a page presses the hand into a ball, and reads what the methods
// do.
#include "tools/view/view_session.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
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

  double of(std::size_t method, std::size_t i) const { return double{row[9 + 11 * method + i]}; }
  double force(std::size_t method) const {
    return std::hypot(of(method, 0), of(method, 1), of(method, 2));
  }
  double sent() const { return std::hypot(double{row[4]}, double{row[5]}, double{row[6]}); }
};

// Returns those columns of a recording as CSV, a list for each tick.
std::vector<std::vector<double>> felt(const std::string& path,
                                      const std::vector<std::string>& names) {
  std::ifstream file(path);
  std::string line;
  const auto cells = [&] {
    std::vector<std::string> list;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) list.push_back(word);
    return list;
  };
  std::getline(file, line);
  const std::vector<std::string> head = cells();
  std::vector<std::vector<double>> all;
  while (std::getline(file, line)) {
    const std::vector<std::string> row = cells();
    std::vector<double>& tick = all.emplace_back();
    for (const std::string& name : names)
      tick.push_back(std::stod(row.at(
          static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin()))));
  }
  return all;
}

class ViewSessionTest : public testing::Test {
 protected:
  void start(ViewSetting setting = {}) {
    setting.open = [this](const BuildChoice& build) { return open(build); };
    setting.command = [](const BuildChoice& build) {
      return std::string("gliss view ball") + (build ? " --level exact" : "");
    };
    setting.save = [this](const BuildChoice&, const TuneMessage& tuning) {
      if (refuses_) throw std::runtime_error("the disk is full");
      return fmt::format("saved-{:g}.toml", tuning.stiffness);
    };
    setting.session.realtime = false;
    setting.page = "<p>";
    setting.token = token_;
    if (setting.free_recordings.empty()) setting.free_recordings = folder_ / "view.h5";
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
    std::string text;
    do {  // a hand that comes before the scene is not heard
      text = page_->receive();
      ASSERT_NE(text, "");
    } while (!text.starts_with("{\"hello\""));
  }
  ViewScene open(const BuildChoice& build) const {
    if (refuses_) throw std::runtime_error("no mesh");
    ViewScene scene;
    SceneObject object;
    object.cache = cache_;
    if (build)
      object.cache = std::make_shared<PatchCache>(build->level.construction == Construction::kPaper
                                                      ? test::paper_cache_of(goldberg().mesh)
                                                      : test::cache_of(goldberg().mesh));
    scene.objects = {object};
    scene.names = {"ball"};
    scene.rules.reengage = true;
    scene.files = {folder_ / "ball.obj"};
    return scene;
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
  void wait_for(const std::function<bool()>& done) {
    for (int i = 0; i < 500 && !done(); ++i) point(Vec3(0, 0, 0.02), 2);
    EXPECT_TRUE(done()) << state_;
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
  std::atomic<bool> refuses_ = false;  // to open and to save
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
  page_->send(R"({"tune":{"method":"flat","stiffness":1e6,"friction":[0.5,0.4],"settle":0.01,)"
              R"("texture":{"kind":"grating","height":5e-5,"period":2e-3}}})");
  const auto ticks = point(Vec3(0, 0, 0.006), 90);
  EXPECT_EQ(state_["method"], "flat");
  EXPECT_EQ(state_["stiffness"], 2000) << "what the hand takes";
  EXPECT_EQ(state_["command"],
            "gliss view ball --method flat --stiffness 2000N/m --friction 0.5,0.4 --settle 10ms "
            "--texture grating,50um,2mm");
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

TEST_F(ViewSessionTest, builds_again_as_the_page_chooses) {
  start();
  press();
  const std::string paper = R"({"build":{"level":"exact","construction":"paper","crease":null}})";
  page_->send(paper);
  wait_for([&] { return state_["construction"] == "paper" && state_["opening"] == false; });
  EXPECT_GT(press().sent(), 0.3) << "with another loop";
  EXPECT_EQ(state_["failure"], "");
  EXPECT_NE(state_["command"].get<std::string>().find("--level exact"), std::string::npos);
  refuses_ = true;
  page_->send(R"({"build":{"level":"exact","construction":"fair","crease":null}})");
  wait_for([&] { return state_["failure"] == "no mesh"; });
  EXPECT_EQ(state_["construction"], "paper") << "the old surface stays";
  EXPECT_GT(press().sent(), 0.3);
}

TEST_F(ViewSessionTest, reads_files_again_that_have_changed) {
  std::ofstream(folder_ / "ball.obj") << "v 0 0 0\n";
  ViewSetting setting;
  setting.watch = true;
  start(std::move(setting));
  press();
  refuses_ = true;
  std::ofstream(folder_ / "ball.obj") << "v 0 0 0 broken\n";
  wait_for([&] { return state_["failure"] == "no mesh"; });
  EXPECT_GT(press().sent(), 0.3) << "the old surface stays";
  refuses_ = false;
  std::ofstream(folder_ / "ball.obj") << "v 0 0 0\n";
  wait_for([&] { return state_["failure"] == ""; });
  EXPECT_GT(press().sent(), 0.3);
}

TEST_F(ViewSessionTest, replays_a_recording_with_the_same_forces) {
  ViewSetting setting;
  setting.free_recordings = folder_ / "felt.csv";
  start(std::move(setting));
  point(Vec3(0, 0, 0.02));
  page_->send(R"({"record":true})");
  press();
  page_->send(R"({"record":false})");
  wait_for([&] { return state_["recording"] == "" && !state_["recorded"].empty(); });
  page_->send(R"({"replay":true})");
  wait_for([&] { return state_["replaying"] == true; });
  page_->send(R"({"record":true})");
  wait_for([&] { return state_["replaying"] == false; });
  stop();
  ASSERT_EQ(session_->recorded().size(), 2u) << session_->failure();
  const std::vector<std::string> names{"x", "y", "z", "fx", "fy", "fz"};
  const auto first = felt(session_->recorded()[0], names),
             again = felt(session_->recorded()[1], names);
  ASSERT_GT(again.size(), first.size() / 2);
  // It began while the replay was under way, and the hand was free.
  const std::size_t missing = first.size() - again.size();
  // A replay knows no missed periods, so that the last bits may differ.
  for (std::size_t i = 0; i < again.size(); ++i) {
    for (std::size_t k = 0; k < names.size(); ++k)
      ASSERT_NEAR(again[i][k], first[missing + i][k], k < 3 ? 0 : 1e-9) << i << " " << names[k];
  }
}

TEST_F(ViewSessionTest, feels_the_same_where_its_page_reads_nothing) {
  ViewSetting setting;
  setting.recording = folder_ / "felt.csv";
  start(std::move(setting));
  for (int i = 0; i < 120; ++i) {
    page_->send(fmt::format(R"({{"hand":[0,0,{}]}})", i < 30 ? 0.02 : 0.006));
    std::this_thread::sleep_for(16ms);
  }
  stop();
  SceneObject object;
  object.cache = cache_;
  Tracker tracker({&object, 1});
  std::size_t touching = 0;
  for (const auto& tick : felt(session_->recorded().at(0), {"x", "y", "z", "fx", "fy", "fz"})) {
    const Vec3 force = tracker.step({tick[0], tick[1], tick[2]});
    ASSERT_EQ(force, Vec3(tick[3], tick[4], tick[5]));
    touching += tracker.touching();
  }
  EXPECT_GT(touching, 300u);
}

TEST_F(ViewSessionTest, saves_a_scene) {
  start();
  page_->send(R"({"save":true})");
  wait_for([&] { return state_["saved"] == "saved-500.toml"; });
  refuses_ = true;
  page_->send(R"({"save":true})");
  wait_for([&] { return state_["failure"] == "the disk is full"; });
}

// A device that rests in the ball.
class RestingDevice final : public HapticDevice {
 public:
  RestingDevice() { info_.name = "resting"; }
  const DeviceInfo& info() const noexcept override { return info_; }
  DeviceState read(Nanoseconds now) noexcept override {
    DeviceState state;
    state.sequence = ++reads_;
    state.measured = now;
    state.position = Vec3(0, 0, reads_ < 200 ? 0.02 : 0.009);
    return state;
  }
  bool write(const Vec3&, Nanoseconds) noexcept override { return true; }

 private:
  DeviceInfo info_;
  std::uint64_t reads_ = 0;
};

TEST_F(ViewSessionTest, never_moves_a_device_and_tunes_it) {
  ViewSetting setting;
  setting.device = std::make_unique<RestingDevice>();
  start(std::move(setting));
  const SeenTick last = point(Vec3(1, 1, 1), 60).back();
  EXPECT_EQ(last.row[1], 0.0F);
  EXPECT_EQ(last.row[3], 0.009F);
  const double force = last.force(2);
  EXPECT_GT(force, 0.1);
  page_->send(R"({"tune":{"method":"gregory","stiffness":1000,"friction":[0,0],"settle":0,)"
              R"("texture":{"kind":"none","height":0,"period":0}}})");
  EXPECT_NEAR(point(Vec3(1, 1, 1), 30).back().force(2), 2 * force, 1e-3);
  page_->send(R"({"replay":true})");
  point(Vec3(1, 1, 1), 5);
  EXPECT_EQ(state_["replaying"], false);
}

TEST(ViewGeometry, has_each_face_once_and_lies_on_the_patches) {
  SceneObject object;
  object.cache = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  object.pose.translation() = Vec3(1, 0, 0);
  const std::string bytes = geometry_of(object, 3, 20'000);
  std::array<std::uint32_t, 8> head;
  std::memcpy(head.data(), bytes.data(), sizeof head);
  const auto [mark, number, points, triangles, edges, polygons, faces, sides] = head;
  EXPECT_EQ(mark, kGeometryMark);
  EXPECT_EQ(number, 3u);
  EXPECT_LE(triangles, 20'000u);
  EXPECT_GT(triangles, 4'000u);
  EXPECT_EQ(bytes.size(), 32 + points * 24u + triangles * 12u + edges * 24u + polygons * 36u +
                              faces * 8u + sides * 4u);
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

TEST(ViewGeometry, draws_many_faces_by_their_corners_alone) {
  SceneObject object;
  object.cache = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  const std::string bytes = geometry_of(object, 0, 100);
  std::array<std::uint32_t, 8> head;
  std::memcpy(head.data(), bytes.data(), sizeof head);
  EXPECT_EQ(head[2], head[7]) << "a point for each corner";
  EXPECT_EQ(head[3], head[7] - 2 * head[6]);
}

TEST(ViewGeometry, tells_the_curvature_of_faces_and_which_lie_beside_them) {
  SceneObject object;
  object.cache = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  const std::string bytes = geometry_of(object, 0, 1000);
  const auto number = [&](std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, &bytes[at], 4);
    return value;
  };
  const std::uint32_t faces = number(24), sides = number(28);
  const std::size_t across = bytes.size() - 4 * sides, firsts = across - 4 * faces,
                    curvatures = firsts - 4 * faces;
  for (std::uint32_t face = 0; face < faces; ++face) {
    float curvature;
    std::memcpy(&curvature, &bytes[curvatures + 4 * face], 4);
    EXPECT_NEAR(curvature, 100, 40) << "1/m, of a ball of 10 mm";
    const std::uint32_t first = number(firsts + 4 * face),
                        end = face + 1 < faces ? number(firsts + 4 * face + 4) : sides;
    for (std::uint32_t side = first; side < end; ++side) {
      const std::uint32_t other = number(across + 4 * side);
      ASSERT_LT(other, faces);
      const std::uint32_t begin = number(firsts + 4 * other);
      bool back = false;
      for (std::uint32_t i = 0; i < 6; ++i) back |= number(across + 4 * (begin + i)) == face;
      EXPECT_TRUE(back) << face << " and " << other;
    }
  }
}

}  // namespace
}  // namespace gliss::tools
