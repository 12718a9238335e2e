// Results on disk: what is written is what is read, and a failed writer leaves nothing behind.
#include "gliss/tables/result_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "gliss/tables/hdf5_reader.h"
#include "tests/support/require.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using test::message_of;
using test::ScratchFolder;
using ::testing::HasSubstr;

struct Rows {
  std::vector<double> force;
  std::vector<float> depth;
  std::vector<std::uint32_t> patch;
  std::vector<std::uint8_t> flag;
  std::vector<std::string> label;

  // Values that a writer of too few digits would change.
  explicit Rows(std::size_t count, std::size_t first = 0) {
    for (std::size_t row = first; row < first + count; ++row) {
      force.push_back(1.0 / static_cast<double>(row + 3));
      depth.push_back(1.0f / static_cast<float>(row + 3));
      patch.push_back(static_cast<std::uint32_t>(row * 2654435761u));
      flag.push_back(static_cast<std::uint8_t>(row % 256));
      label.push_back("row " + std::to_string(row));
    }
  }

  std::vector<ColumnData> block() const {
    return {std::span<const double>(force), std::span<const float>(depth),
            std::span<const std::uint32_t>(patch), std::span<const std::uint8_t>(flag),
            std::span<const std::string>(label)};
  }
};

const std::vector<Column> kColumns = {{"force", ColumnType::kFloat64, "N"},
                                      {"depth", ColumnType::kFloat32, "m"},
                                      {"patch", ColumnType::kUint32, ""},
                                      {"flag", ColumnType::kUint8, ""},
                                      {"label", ColumnType::kText, ""}};

void write_tables(const std::string& path) {
  const auto file = create_result_file(path);
  file->set_attribute({"version", "0"});
  file->set_attribute({"version", "0.1 \u00B5"});  // replaces
  const auto big = file->add_table("sweep/depth_2mm/gregory", kColumns, {{"stiffness", 500.0}});
  const auto small =
      file->add_table("sweep/depth_2mm/flat", kColumns, {{"count", std::int64_t{1} << 40}}, 7);
  file->add_table("empty", kColumns);
  for (std::size_t first = 0; first < 40000; first += 10000) {
    file->append(big, Rows(10000, first).block());
    if (first < 20000) file->append(small, Rows(3, first).block());
  }
  file->close();
}

TEST(ResultFile, Hdf5IsReadByH5py) {
  constexpr const char* kPython = "/usr/bin/python3";
  if (std::system((std::string(kPython) + " -c 'import h5py' 2>/dev/null").c_str()) != 0) {
    GLISS_SKIP_UNLESS_REQUIRED("h5py is absent");
  }
  const ScratchFolder folder;
  write_tables(folder / "r.h5");
  const std::string script = folder.write("check.py", R"(
import h5py, numpy as np, sys
def check(group, rows):
    rows = np.array(rows, dtype=np.uint64)
    assert list(group) == ['force', 'depth', 'patch', 'flag', 'label'], list(group)
    assert group['force'].dtype == '<f8' and group['depth'].dtype == '<f4'
    assert group['patch'].dtype == '<u4' and group['flag'].dtype == 'u1'
    assert group['force'].attrs['unit'] == b'N' and 'unit' not in group['patch'].attrs
    assert (group['force'][:] == 1.0 / (rows + 3).astype(np.float64)).all()
    assert (group['depth'][:] == np.float32(1) / (rows + 3).astype(np.float32)).all()
    assert (group['patch'][:] == (rows * 2654435761 % 2**32)).all()
    assert (group['flag'][:] == rows % 256).all()
    assert list(group['label'].asstr()[:]) == ['row %d' % r for r in rows]
with h5py.File(sys.argv[1]) as f:
    assert f.attrs['version'].decode() == '0.1 \u00b5', f.attrs['version']
    big, small = f['sweep/depth_2mm/gregory'], f['sweep/depth_2mm/flat']
    check(big, range(40000))
    check(small, [0, 1, 2, 10000, 10001, 10002])
    check(f['empty'], [])
    assert big.attrs['stiffness'] == 500.0 and small.attrs['count'] == 2**40
    assert big['patch'].compression == big['label'].compression == 'gzip' and big['force'].compression is None
    assert big['force'].maxshape == (None,) and small['force'].chunks == (7,)
)");
  EXPECT_EQ(std::system((std::string(kPython) + " " + script + " " + (folder / "r.h5")).c_str()),
            0);
}

TEST(ResultFile, NumbersAreAttributesOfTheFile) {
  const ScratchFolder folder;
  const auto file = create_result_file(folder / "r.h5");
  file->set_attribute({"stiffness_N_per_m", 0.5});
  file->set_attribute({"creases", std::int64_t{7}});
  file->set_attribute({"unit", "mm"});
  file->close();
  const Hdf5Reader reader(folder / "r.h5", "a result");
  EXPECT_EQ(reader.number_attribute("stiffness_N_per_m"), 0.5);
  EXPECT_EQ(reader.number_attribute("creases"), 7);
  EXPECT_EQ(reader.number_attribute("unit"), std::nullopt);
  EXPECT_EQ(reader.number_attribute("missing"), std::nullopt);
}

TEST(ResultFile, SameResultsAreTheSameBytes) {
  const ScratchFolder folder;
  write_tables(folder / "a.h5");
  write_tables(folder / "b.hdf5");
  EXPECT_EQ(folder.read("a.h5"), folder.read("b.hdf5"));
  EXPECT_FALSE(folder.read("a.h5").empty());
}

// Chunks have 16,384 rows: some blocks end one, some are many, some begin and end within.
TEST(ResultFile, Hdf5KeepsRowsOfBlocksOfAnySize) {
  const ScratchFolder folder;
  std::size_t rows = 0;
  {
    const auto file = create_result_file(folder / "r.h5");
    const auto table = file->add_table("", kColumns);
    for (const std::size_t block : {16384, 100, 50000, 15436, 32768, 16383, 1, 1}) {
      file->append(table, Rows(block, rows).block());
      rows += block;
    }
    file->close();
  }
  const Rows all(rows);
  const Hdf5Reader read(folder / "r.h5", "a result");
  EXPECT_TRUE(std::ranges::equal(read.numbers("force"), all.force));
  EXPECT_TRUE(std::ranges::equal(read.numbers("depth"), all.depth));
  EXPECT_TRUE(std::ranges::equal(read.numbers("patch"), all.patch));
  EXPECT_TRUE(std::ranges::equal(read.numbers("flag"), all.flag));
  EXPECT_EQ(read.texts("label"), all.label);
}

TEST(ResultFile, BlocksThatDoNotFitAreRefused) {
  const ScratchFolder folder;
  for (const char* name : {"r.csv", "r.h5"}) {
    const auto file = create_result_file(folder / name);
    const auto table = file->add_table("t", {kColumns[0], kColumns[1]});
    const Rows rows(3);
    const ColumnData force = std::span<const double>(rows.force);
    const ColumnData depth = std::span<const float>(rows.depth);
    const ColumnData two = std::span<const float>(rows.depth).first(2);
    const auto append = [&](std::vector<ColumnData> block) { file->append(table, block); };
    EXPECT_THROW(append({force}), std::logic_error);
    EXPECT_THROW(append({force, force}), std::logic_error);
    EXPECT_THROW(append({force, two}), std::logic_error);
    append({force, depth});
  }
}

TEST(ResultFile, NothingIsLeftWithoutClose) {
  const ScratchFolder folder;
  for (const char* name : {"r.csv", "r.h5"}) {
    const auto file = create_result_file(folder / name);
    file->append(file->add_table("t", kColumns), Rows(50000).block());
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(ResultFile, UnusablePathsAreNamed) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "folder.csv");
  const auto create = [](const std::string& path) {
    return message_of<std::runtime_error>([&] { create_result_file(path); });
  };
  EXPECT_THAT(create(folder / "r.txt"), HasSubstr("r.txt"));
  EXPECT_THAT(create(folder / "none/r.h5"), HasSubstr("none/r.h5': No such file"));
  EXPECT_THAT(create(folder / "folder.csv"), HasSubstr("folder.csv': Is a directory"));
}

TEST(ResultFile, DuplicateColumnsOfHdf5AreNamed) {
  const ScratchFolder folder;
  const auto file = create_result_file(folder / "r.h5");
  EXPECT_THAT(message_of<std::runtime_error>([&] {
                file->add_table("t", {kColumns[0], kColumns[0]});
              }),
              HasSubstr("r.h5': column 'force': name already exists"));
}

// A limit on the size of files fails the same calls as a full disk.
[[noreturn]] void write_beyond_the_limit(const std::string& path) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit = {1 << 20, 1 << 20};
  setrlimit(RLIMIT_FSIZE, &limit);
  const std::string message = message_of<std::runtime_error>([&] {
    const auto file = create_result_file(path);
    const auto table = file->add_table("t", kColumns);
    for (int i = 0; i < 100; ++i) file->append(table, Rows(5000).block());
    file->close();
  });
  std::fprintf(stderr, "%s\n", message.c_str());
  std::exit(7);  // runs what HDF5 does at exit, which must not crash
}

TEST(ResultFileDeathTest, FullDiskIsAnErrorAndTheOldFileStays) {
  const ScratchFolder folder;
  for (const char* name : {"r.csv", "r.h5"}) {
    folder.write(name, "old");
    EXPECT_EXIT(write_beyond_the_limit(folder / name), ::testing::ExitedWithCode(7),
                "cannot write '.*': File too large");
    EXPECT_EQ(folder.read(name), "old");
  }
  EXPECT_EQ(folder.file_count(), 2u);
}

}  // namespace
}  // namespace gliss
