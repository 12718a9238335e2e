// gliss serve in one process and gliss run in another, either of which is killed.
#include "tests/support/run_files.h"

namespace gliss {
namespace {

using test::Outcome, test::Process;
using ::testing::HasSubstr;

class RunUdp : public test::RunTest {
 protected:
  // The port where it serves.
  std::string port_of(Process& server) const {
    const std::string word = " as udp:";
    const auto told = [&] {
      const std::string err = server.err();
      const auto at = err.find(word);
      return at != err.npos && err.find('\n', at) != err.npos;
    };
    EXPECT_TRUE(test::await([&] { return server.over() || told(); }));
    const std::string err = server.err();
    const auto at = err.find(word) + word.size();
    return at < err.size() ? err.substr(at, err.find('\n', at) - at) : "?";
  }
  std::unique_ptr<Process> serve() const { return start("serve", "scene.toml --port 0 --json"); }
  nlohmann::json counts_of(Process& server) const {
    server.kill(SIGINT);
    const Outcome outcome = server.wait();
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    return json_of(outcome);
  }
};

TEST_F(RunUdp, drives_a_device_in_another_process) {
  const auto server = serve();
  const std::string port = port_of(*server);
  const auto json =
      json_of_run(fmt::format("scene.toml --device udp:{} --seconds 2 -o run.csv", port));
  EXPECT_EQ(json.at("device"), "udp:" + port);
  EXPECT_EQ(json.at("end"), "stopped");
  EXPECT_GE(json.at("ticks").get<int>() + json.at("missed").get<int>(), 2000);
  const test::TextTable felt(folder_.read("run.csv"));
  EXPECT_GT(std::count(felt["state"].begin(), felt["state"].end(), "contact"), 100);
  EXPECT_EQ(felt.sent(felt.rows() - 1), Vec3::Zero());
  const auto counts = counts_of(*server);
  EXPECT_GE(counts.at("loops"), 1);
  EXPECT_GE(counts.at("received"), json.at("ticks").get<int>() / 2);
  EXPECT_EQ(counts.at("rejected"), 0);
}

TEST_F(RunUdp, ends_with_a_device_whose_process_was_killed) {
  const auto server = serve();
  const auto loop =
      start_recording("scene.toml --json --device udp:" + port_of(*server), "run.csv");
  server->kill(SIGKILL);
  const Outcome outcome = loop->wait();
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("the device's process has ended\n"));
  const auto json = json_of(outcome);
  EXPECT_EQ(json.at("end"), "the device reports a fault");
  EXPECT_GE(json.at("guard_trips"), 1);  // the fault, or a late input before it
  const test::TextTable felt(folder_.read("run.csv"));
  EXPECT_EQ(json.at("ticks"), felt.rows());
  EXPECT_EQ(felt.sent(felt.rows() - 1), Vec3::Zero());
}

TEST_F(RunUdp, takes_the_force_of_a_killed_loop_and_serves_the_next) {
  const auto server = serve();
  const std::string device = " --device udp:" + port_of(*server);
  EXPECT_EQ(stop_recording("scene.toml" + device, "run.csv", SIGKILL).code, -1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.csv"));
  const auto json = json_of_run("scene.toml --seconds 1" + device);
  EXPECT_GE(json.at("ticks").get<int>() + json.at("missed").get<int>(), 1000);
  const auto counts = counts_of(*server);
  EXPECT_GE(counts.at("loops"), 2);
  EXPECT_GE(counts.at("watchdog_trips").get<int>() + counts.at("lost").get<int>(), 1);
}

TEST_F(RunUdp, ends_with_a_server_that_was_told_to) {
  const auto server = serve();
  const auto loop =
      start_recording("scene.toml --json --device udp:" + port_of(*server), "run.csv");
  counts_of(*server);
  const Outcome outcome = loop->wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(json_of(outcome).at("end"), "the device has ended");
}

TEST_F(RunUdp, names_what_is_wrong_before_anything_runs) {
  std::string port;
  {
    const auto server = serve();
    port = port_of(*server);
    expect_error(run("scene.toml --no-wait --device udp:" + port), 2, "--no-wait: udp:");
    expect_error(start("serve", "scene.toml --quiet --port " + port)->wait(), 4, port);
    write_scene("stiffness = 2500");
    expect_error(run("scene.toml --device udp:" + port), 2, "renders at most 2000");
  }
  expect_error(run("scene.toml --device udp:" + port), 4, "no haptic device answered");
}

}  // namespace
}  // namespace gliss
