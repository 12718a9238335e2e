// Sweeps that are stopped, killed or find their parts damaged end in the same bytes.
#include "gliss/sweep/sweep_parts.h"
#include "gliss/build/build_cache.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "gliss/generate/generate.h"
#include "tests/support/bytes.h"
#include "tests/support/part_files.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using test::swept;
using ::testing::HasSubstr;

// Seven parts of a chunk each.
class SweepPartsTest : public ::testing::Test {
 protected:
  SweepPartsTest() {
    options_.depths = {1e-3, 2e-3};
    options_.methods = {Method::kShaded, Method::kFlat};
    options_.rings = 5;
    options_.part_contacts = 16'000;
  }

  SweepParts open(bool samples = true) const {
    return SweepParts(folder_ / "parts", cache_, options_, samples);
  }
  std::vector<std::string> files() const { return test::part_paths(folder_ / "parts"); }
  static std::string read(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  const PatchCache cache_ = test::cache_of(torus_knot(60, 8).mesh);
  const std::unique_ptr<Engine> engine_ = make_tbb_engine(2);
  const test::ScratchFolder folder_;
  SweepOptions options_;
};

TEST_F(SweepPartsTest, are_left_by_a_whole_sweep_and_removed_when_asked) {
  const std::string want = swept(cache_, *engine_, options_);
  {
    SweepParts parts = open();
    EXPECT_EQ(parts.kept(), 0u);
    EXPECT_EQ(swept(cache_, *engine_, options_, &parts), want);
    EXPECT_EQ(parts.kept(), 7u);
    EXPECT_EQ(files().size(), parts.kept());
    parts.remove();
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "parts"));
}

// Stopped after each window in turn, by another engine each time; a little later where a machine is
// so slow that it is asked within windows.
TEST_F(SweepPartsTest, go_on_from_wherever_the_sweep_was_stopped) {
  const std::string want = swept(cache_, *engine_, options_);
  const auto serial = make_serial_engine();
  std::size_t stops = 0, kept = 0;
  for (bool complete = false; !complete; ++stops) {
    SweepParts parts = open();
    EXPECT_GE(parts.kept(), kept);
    kept = parts.kept();
    const Engine& engine = stops % 2 == 0 ? *engine_ : *serial;
    std::size_t windows = 0;
    struct Stop {};
    try {
      EXPECT_EQ(swept(cache_, engine, options_, &parts,
                      [&](std::uint64_t, std::uint64_t) {
                        if (++windows >= kept + 1 + stops / 10) throw Stop();
                      }),
                want);
      complete = true;
    } catch (const Stop&) {
    }
    ASSERT_LT(stops, 100u);
  }
  EXPECT_GE(stops, 5u);
}

// A kill comes as by kill -9 or a power cut, at any moment.
TEST_F(SweepPartsTest, survive_kills) {
  const auto start = std::chrono::steady_clock::now();
  const auto serial = make_serial_engine();
  const std::string want = swept(cache_, *serial, options_);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> share(0, 0.6);
  bool complete = false;
  int kills = 0;
  for (; !complete && kills < 200; ++kills) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      SweepParts parts = open();
      _exit(swept(cache_, *serial, options_, &parts) == want ? 0 : 1);
    }
    // Longer and longer: a part and its fsync may take most of the whole.
    std::this_thread::sleep_for(share(rng) * (1 + kills / 20.0) * whole);
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    complete = WIFEXITED(status);
    if (complete) {
      EXPECT_EQ(WEXITSTATUS(status), 0);
    }
  }
  EXPECT_TRUE(complete);
  test::record("sweep", "killed {} times", kills - 1);
  SweepParts parts = open();
  EXPECT_EQ(swept(cache_, *engine_, options_, &parts), want);
  EXPECT_TRUE(parts.damaged().empty());
  parts.remove();
  EXPECT_TRUE(files().empty());  // the temporaries of the killed as well
}

TEST_F(SweepPartsTest, that_are_damaged_are_found_and_only_they_are_done_again) {
  SweepParts first = open();
  const std::string want = swept(cache_, *engine_, options_, &first);
  const std::vector<std::string> paths = files();
  std::mt19937_64 rng(2);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string whole = read(paths[i]);
    std::string bytes = whole;
    if (i % 3 == 0) bytes[rng() % bytes.size()] ^= static_cast<char>(1 << rng() % 8);
    if (i % 3 == 1) bytes.resize(rng() % bytes.size());
    if (i % 3 == 2) bytes.resize(std::min<std::size_t>(i / 3 * 8, bytes.size()));  // in its header
    std::ofstream(paths[i], std::ios::binary) << bytes;
    const SweepResult result = sweep(
        cache_, *engine_, options_, [](const SweepBlock&) {}, nullptr, &first);
    ASSERT_EQ(first.damaged().size(), i + 1);
    EXPECT_EQ(first.damaged().back(), paths[i]);
    // It and the last part, which is never kept.
    EXPECT_LE(result.computed, 3 * options_.part_contacts);
    EXPECT_EQ(read(paths[i]), whole);
  }
  EXPECT_EQ(swept(cache_, *engine_, options_, &first), want);
}

TEST_F(SweepPartsTest, any_flipped_bit_is_found) {
  options_.depths = {1e-3};
  options_.methods = {Method::kFlat};
  options_.part_contacts = 1;
  SweepParts parts = open(false);
  sweep(cache_, *engine_, options_, nullptr, nullptr, &parts);
  ASSERT_GE(parts.kept(), 2u);
  // Under a second name, since parts that are damaged are removed.
  const std::string path = files().front(), kept = folder_ / "kept";
  std::filesystem::create_hard_link(path, kept);
  std::fstream file(kept, std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes = read(kept);
  const auto put = [&](std::size_t at, char byte) {
    file.seekp(static_cast<std::streamoff>(at)).put(byte).flush();
  };
  // All bits of what leads and of 200 bytes behind, and those of one byte in 20 of the rest.
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    if (bit / 8 > PartFile::kHeaderBytes + 200 && bit / 8 % 20 != 7) continue;
    const char was = bytes[bit / 8];
    put(bit / 8, static_cast<char>(was ^ (1 << bit % 8)));
    ASSERT_FALSE(parts.load(0)) << "bit " << bit;
    put(bit / 8, was);
    std::filesystem::create_hard_link(kept, path);
  }
  EXPECT_TRUE(parts.load(0));
}

// Parts of another mesh, precision, level or option are neither read nor removed.
TEST_F(SweepPartsTest, of_other_sweeps_never_mix_in) {
  {
    SweepParts parts = open();
    swept(cache_, *engine_, options_, &parts);
  }
  const std::vector<std::string> old = files();
  const auto expect_foreign = [&](const PatchCache& cache, const SweepOptions& options,
                                  bool samples) {
    SweepParts parts(folder_ / "parts", cache, options, samples);
    EXPECT_EQ(parts.kept(), 0u);
    EXPECT_EQ(parts.foreign(), old.size());
    EXPECT_EQ(swept(cache, *engine_, options, samples ? &parts : nullptr),
              swept(cache, *engine_, options));
    parts.remove();
    EXPECT_EQ(files(), old);
  };
  const Mesh mesh = torus_knot(60, 8).mesh;
  expect_foreign(cache_, options_, false);
  expect_foreign(test::cache_of(mesh, Precision::kFloat), options_, true);
  expect_foreign(test::cache_of(torus_knot(61, 8).mesh), options_, true);
  BuildOptions ribbons;
  ribbons.level = {Level::kRibbon, 0, Construction::kPaper};
  expect_foreign(build_cache(test::with_normals(mesh), ribbons), options_, true);
  const auto changed = [&](const auto& change) {
    SweepOptions options = options_;
    change(options);
    expect_foreign(cache_, options, true);
  };
  changed([](SweepOptions& o) { o.depths[1] = 3e-3; });
  changed([](SweepOptions& o) { o.depths.pop_back(); });
  changed([](SweepOptions& o) { o.methods.pop_back(); });
  changed([](SweepOptions& o) { std::swap(o.methods[0], o.methods[1]); });
  changed([](SweepOptions& o) { o.rings = 4; });
  changed([](SweepOptions& o) { o.stiffness = 501; });
  changed([](SweepOptions& o) { o.tolerance = 1e-6; });
  changed([](SweepOptions& o) { o.max_iterations = 7; });
  changed([](SweepOptions& o) { o.solver = Solver::kPaper; });
  changed([](SweepOptions& o) { o.part_contacts = 20'000; });
}

TEST_F(SweepPartsTest, are_of_one_process_at_a_time) {
  SweepParts parts = open();
  const std::string message = test::message_of<std::runtime_error>([&] { open(); });
  EXPECT_THAT(message, HasSubstr(folder_ / "parts"));
  EXPECT_THAT(message, HasSubstr("another command is at work"));
}

TEST_F(SweepPartsTest, name_the_folder_that_cannot_be) {
  const auto open_in = [&](const std::string& folder) {
    return test::message_of<std::system_error>([&] { SweepParts(folder, cache_, options_, true); });
  };
  EXPECT_THAT(open_in(folder_ / "no/parts"), HasSubstr(folder_ / "no/parts"));
  folder_.write("file", "");
  EXPECT_THAT(open_in(folder_ / "file"), HasSubstr(folder_ / "file"));
}

}  // namespace
}  // namespace gliss
