// Each allocation on the way failing, once or with all that follow: a clear error, no descriptor
// left open, no file half written.
#include <sys/resource.h>

#include <cstring>
#include <new>

#include "gliss/build/build_cache.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/tables/point_table.h"
#include "gliss/tables/result_table.h"
#include "tests/support/allocations.h"
#include "tests/support/bytes.h"
#include "tests/support/gliss_process.h"
#include "tests/support/mesh_files.h"
#include "tests/support/places.h"
#include "tests/support/reserved_file.h"
#include "tests/support/scene_files.h"

namespace gliss {
namespace {

using test::FailingAllocation;
using ::testing::HasSubstr;

std::size_t open_descriptors() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

class AllocationFailure : public MeshFiles {
 protected:
  void SetUp() override {
    if (!test::allocations_are_counted()) GTEST_SKIP() << "a sanitizer has malloc";
  }

  // `work` with each allocation failing, until none is left that does; `check` after each, told
  // whether it went through.
  template <class Work, class Check>
  void expect_clear_errors(const std::string& name, const Work& work, const Check& check) {
    work();  // what is made once and kept is there
    check(true);
    std::uint64_t failures = 0;
    for (const bool lasting : {false, true}) {
      for (std::uint64_t k = 1;; ++k) {
        SCOPED_TRACE(fmt::format("{}: allocation {}{}", name, k, lasting ? " and later" : ""));
        const std::size_t descriptors = open_descriptors();
        char what[300] = "";
        bool done = false;
        FailingAllocation failing(k, lasting);
        try {
          work();
          done = true;
        } catch (const std::bad_alloc&) {
          failing.end();
        } catch (const std::exception& error) {
          failing.end();
          std::strncpy(what, error.what(), sizeof(what) - 1);
        }
        failing.end();
        EXPECT_EQ(open_descriptors(), descriptors);
        if (what[0]) {
          EXPECT_THAT(std::string(what), HasSubstr("Cannot allocate memory"));
        }
        check(done);
        if (HasFailure()) return;
        if (!failing.has_failed()) {
          EXPECT_TRUE(done);
          break;
        }
        ++failures;
      }
    }
    EXPECT_GT(failures, 0u);
    fmt::print("  {}: {} failures\n", name, failures);
  }

  std::optional<Mesh> mesh_;
  std::optional<PatchCache> cache_;
};

TEST_F(AllocationFailure, of_meshes) {
  const std::string odd = "v 9 9 9\nvn 0 0 1\nf 1 2 3\n";  // with things to warn of and to repair
  const Mesh made = prism(5).mesh;
  const std::pair<std::string, std::string> files[] = {
      {"a.obj", kCube + odd},
      {"a.off", to_off(made)},
      {"ascii.ply", to_ply(made, "ascii")},
      {"little.ply", to_ply(made, "binary_little_endian")},
      {"big.ply", to_ply(made, "binary_big_endian")}};
  for (const auto& [name, text] : files) {
    const std::string file = folder_.write(name, text);
    expect_clear_errors(
        name, [&] { mesh_ = load_mesh(file, {}, &findings_); },
        [&](bool done) {
          if (done) {
            EXPECT_EQ(mesh_->face_count(), 7u);
          }
        });
  }
}

TEST_F(AllocationFailure, of_builds) {
  const Mesh mesh = prism(5).mesh;
  const std::string whole = test::bytes_of(build_cache(mesh));
  expect_clear_errors(
      "build", [&] { cache_ = build_cache(mesh); },
      [&](bool done) {
        if (done) {
          EXPECT_TRUE(test::bytes_of(*cache_) == whole);
        }
      });
}

TEST_F(AllocationFailure, of_caches) {
  const PatchCache cache = build_cache(prism(5).mesh);
  const std::string file = path("a.gliss");
  save_cache(cache, file);
  const std::string whole = folder_.read("a.gliss");
  expect_clear_errors(
      "load", [&] { cache_ = load_cache(file); },
      [&](bool done) {
        if (done) {
          EXPECT_TRUE(test::bytes_of(*cache_) == whole);
        }
      });
  expect_clear_errors(
      "save", [&] { save_cache(cache, file); },
      [&](bool done) {
        EXPECT_TRUE(folder_.read("a.gliss") == (done ? whole : "old"));
        EXPECT_EQ(folder_.file_count(), 1u);
        folder_.write("a.gliss", "old");
      });
}

TEST_F(AllocationFailure, of_scenes_and_paths) {
  const test::SceneFiles files;
  const std::string text =
      "[[object]]\nname = 'ball'\nmesh = 'ball.obj'\nunit = 'mm'\n[sim]\npath = 'path.csv'\n";
  std::optional<Scene> scene;
  const std::string file = files.folder.write("scene.toml", text);
  expect_clear_errors(
      "scene", [&] { scene = read_scene(file); },
      [&](bool done) {
        if (done) {
          EXPECT_EQ(scene->objects.at(0).name, "ball");
        }
      });
  std::optional<PointTable> points;
  expect_clear_errors(
      "path", [&] { points = read_points(files.folder / "path.csv", 1, {"step"}); },
      [&](bool done) {
        if (done) {
          EXPECT_EQ(points->points.size(), 2u);
        }
      });
}

TEST_F(AllocationFailure, of_tables) {
  const std::string file = path("a.csv");
  folder_.write("a.csv", "old");
  const auto write = [&] {
    const auto result = create_result_file(file);
    ResultTable table(*result, "", Columns().add({"x"}, ColumnType::kFloat64));
    table.fill(3, [](std::size_t i) { return static_cast<double>(i); });
    table.write();
    result->close();
  };
  expect_clear_errors("table", write, [&](bool done) {
    EXPECT_EQ(folder_.read("a.csv"), done ? "x\n0\n1\n2\n" : "old");
    EXPECT_EQ(folder_.file_count(), 1u);
    folder_.write("a.csv", "old");
  });
}

// A user's file is larger than the memory.
TEST_F(AllocationFailure, of_the_program_is_one_line_and_exit_code_1) {
  folder_.write("large.ply",
                "ply\nformat binary_little_endian 1.0\nelement vertex 8000000000\nend_header\n");
  if (!test::reserve(folder_ / "large.ply", 1 << 30)) GTEST_SKIP() << "no place for a gigabyte";
  folder_.write("large.gliss", "old");
  const auto little_memory = [] {
    const rlimit limit{rlim_t{1} << 29, rlim_t{1} << 29};
    return setrlimit(RLIMIT_AS, &limit) == 0;
  };
  const test::Outcome outcome =
      test::Process(folder_ / "", test::kProgram,
                    {"bake", "large.ply", "-o", "large.gliss", "--threads", "1", "--quiet"},
                    little_memory)
          .wait();
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "gliss: out of memory\n");
  EXPECT_EQ(folder_.read("large.gliss"), "old");
  EXPECT_EQ(folder_.file_count(), 2u);
}

}  // namespace
}  // namespace gliss
