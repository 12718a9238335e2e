// Scenes and paths for gliss run, and what it leaves.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tests/support/gliss_process.h"
#include "tests/support/places.h"

namespace gliss::test {

inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

// A table as text, column by column.
struct TextTable {
  explicit TextTable(const std::string& csv) {
    const auto lines = split(csv, '\n');
    for (const std::string& name : split(lines.at(0), ',')) names.push_back(name);
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const auto fields = split(lines[i], ',');
      for (std::size_t c = 0; c < names.size(); ++c) columns[names[c]].push_back(fields.at(c));
    }
  }
  std::size_t rows() const { return columns.at(names.front()).size(); }
  const std::vector<std::string>& operator[](const std::string& name) const {
    return columns.at(name);
  }
  double number(const std::string& name, std::size_t row) const {
    const std::string& text = columns.at(name).at(row);
    double value = std::nan("");
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }
  Vec3 vector(const std::string& x, const std::string& y, const std::string& z,
              std::size_t row) const {
    return {number(x, row), number(y, row), number(z, row)};
  }
  Vec3 sent(std::size_t row) const { return vector("sent_x", "sent_y", "sent_z", row); }

  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> columns;
};

class RunTest : public ::testing::Test {
 protected:
  RunTest() {
    save_obj(goldberg().mesh, folder_ / "ball.obj");
    write_scene("");
  }

  // A ball of 10 mm that a simulated hand presses most of the time, for long.
  void write_scene(const std::string& more_of_ball, const std::string& more = "") {
    folder_.write("hand.csv", "x_mm,y_mm,z_mm\n0,0,11\n0,0,8\n0,0,8\n0,0,8\n0,0,8\n0,0,8\n");
    folder_.write("scene.toml",
                  fmt::format("[[object]]\nname = 'ball'\nmesh = 'ball.obj'\nunit = 'mm'\n{}\n"
                              "[guards]\nreengage = true\n"
                              "[sim]\npath = 'hand.csv'\ninterval = 0.25\nrounds = 1000\n"
                              "hand_stiffness = '1N/mm'\nhand_damping = 20\n{}\n",
                              more_of_ball, more));
  }

  // "bake ball.obj -o ball.gliss": words without spaces.
  Outcome gliss(const std::string& words) const {
    return Process(folder_ / "", test::kProgram, split(words, ' ')).wait();
  }
  // "scene.toml --device sim": words without spaces.
  std::unique_ptr<Process> start(
      const std::string& command, const std::string& words,
      const std::function<bool()>& in_child = [] { return true; }) const {
    auto all = split(words, ' ');
    all.insert(all.begin(), command);
    return std::make_unique<Process>(folder_ / "", test::kProgram, all, in_child);
  }
  Outcome run(
      const std::string& words, const std::function<bool()>& in_child = [] { return true; }) const {
    return start("run", words, in_child)->wait();
  }
  static nlohmann::json json_of(const Outcome& outcome) {
    const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << outcome.out << outcome.err;
    return json;
  }
  nlohmann::json json_of_run(const std::string& words) const {
    const Outcome outcome = run(words + " --json");
    EXPECT_EQ(outcome.code, 0) << words << ": " << outcome.err;
    return json_of(outcome);
  }
  // The recording of a run that must succeed.
  TextTable recorded(const std::string& words) const {
    const Outcome outcome = run(words + " -o recorded.csv");
    EXPECT_EQ(outcome.code, 0) << words << ": " << outcome.err;
    return TextTable(folder_.read("recorded.csv"));
  }

  // An error is one line, and nothing ran.
  void expect_error(const Outcome& outcome, int code, const std::string& what) const {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err,
                ::testing::AllOf(::testing::StartsWith("gliss: "), ::testing::HasSubstr(what)));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }

  // Until the loop runs and some of its ticks are in the recording, which has another name until
  // it is whole.
  bool await_recording(Process& process, const std::string& name) const {
    const auto begun = [&] {
      std::error_code gone;
      for (const auto& file : std::filesystem::directory_iterator(folder_ / "")) {
        const std::string other = file.path().filename();
        if (other.find(name) != other.npos && other != name && file.file_size(gone) > 10000 &&
            !gone)
          return true;
      }
      return false;
    };
    return await([&] { return process.over() || begun(); }) && !process.over();
  }

  // A run that has begun to record.
  std::unique_ptr<Process> start_recording(const std::string& words,
                                           const std::string& name) const {
    auto loop = start("run", words + " -o " + name);
    EXPECT_TRUE(await_recording(*loop, name)) << loop->err();
    return loop;
  }
  // The end of such a run by a signal.
  Outcome stop_recording(const std::string& words, const std::string& name, int signal) const {
    const auto loop = start_recording(words, name);
    loop->kill(signal);
    return loop->wait();
  }

  const ScratchFolder folder_;
};

}  // namespace gliss::test
