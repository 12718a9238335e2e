// The commands of docs/signs.md give the distances that it shows.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support/gliss_process.h"
#include "tests/support/places.h"
#include "tests/support/run_files.h"
#include "tests/support/scratch_folder.h"

namespace gliss::test {
namespace {

// Runs a shell that finds the program as `gliss`; returns what it writes.
std::string output_of(const std::string& commands, const ScratchFolder& folder) {
  const std::string program = kProgram, file = folder.write("page.sh", commands);
  const std::string line = fmt::format("cd '{}' && PATH=\"{}:$PATH\" sh -e '{}' > output 2> errors",
                                       folder / "", program.substr(0, program.rfind('/')), file);
  EXPECT_EQ(std::system(line.c_str()), 0) << folder.read("errors");
  return folder.read("output");
}

TEST(SignsPage, shows_the_distances_that_its_commands_give) {
  std::ifstream page(std::string(kTests) + "/../docs/signs.md");
  ASSERT_TRUE(page);
  std::string commands;
  std::vector<double> shown;
  int cases = 0;
  bool is_code = false;
  const auto judge = [&] {
    if (commands.empty()) return;
    const ScratchFolder folder;
    const std::string output = output_of(commands, folder);
    const TextTable table(output.substr(output.find("face,xi")));
    ASSERT_EQ(table.rows(), shown.size()) << commands;
    for (std::size_t i = 0; i < shown.size(); ++i)
      EXPECT_NEAR(table.number("distance", i), shown[i], 0.0051) << commands;
    ++cases;
    commands.clear(), shown.clear();
  };
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("```")) {
      is_code = !is_code;
      if (is_code) judge();
    } else if (is_code) {
      commands += line + "\n";
    } else if (const auto cells = split(line, '|'); cells.size() > 3) {
      std::istringstream number(cells[2]);
      if (double x; number >> x) shown.push_back(x);
    }
  }
  judge();
  EXPECT_EQ(cases, 5);
}

}  // namespace
}  // namespace gliss::test
