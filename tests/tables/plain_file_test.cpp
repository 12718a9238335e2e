// Plain HDF5 files: the same bytes whoever writes which rows, sealed by blocks.
#include "gliss/tables/plain_file.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <numeric>

#include "gliss/tables/file_seal.h"
#include "gliss/tables/hdf5_reader.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

class PlainFiles : public ::testing::Test {
 protected:
  static constexpr std::size_t kRows = 300'000;  // some blocks of the seal
  const std::vector<Column> columns_ = {{"x", ColumnType::kFloat64, "m"},
                                        {"face", ColumnType::kUint32, ""}};

  static std::vector<std::uint64_t> hashes(const std::string& path) {
    return block_hashes(path, std::filesystem::file_size(path));
  }
  void add_tables(ResultFile& file) const {
    for (const char* name : {"a/first", "a/second"}) file.add_table(name, columns_, {}, kRows);
  }
  static void put(PlainFile& file, std::size_t begin, std::size_t end) {
    std::vector<double> x(end - begin);
    std::vector<std::uint32_t> face(end - begin);
    std::iota(x.begin(), x.end(), 0.5 + static_cast<double>(begin));
    std::iota(face.begin(), face.end(), static_cast<std::uint32_t>(begin));
    const ColumnData block[] = {std::span<const double>(x), std::span<const std::uint32_t>(face)};
    for (const ResultFile::TableId table : {0, 1}) {
      file.seek(table, begin);
      file.append(table, block);
    }
  }
  // Written as `write` does, between what comes first and last.
  template <class Write>
  std::string written(const Write& write) const {
    const auto file = create_plain_file(folder_ / "p.h5", hashes);
    add_tables(*file);
    file->reopen();
    write(*file);
    file->reopen();
    const double sum[] = {0.25};
    const ColumnData row[] = {std::span<const double>(sum)};
    file->append(file->add_table("sums", {{"x", ColumnType::kFloat64, ""}}, {}, 1), row);
    file->close();
    return folder_.read("p.h5");
  }
  std::string in_order() const {
    return written([](PlainFile& file) { put(file, 0, kRows); });
  }

  const test::ScratchFolder folder_;
};

TEST_F(PlainFiles, have_the_same_bytes_in_whatever_order_and_by_whomever_rows_come) {
  const std::string want = in_order();
  EXPECT_GT(want.size(), 2 * kRows * (sizeof(double) + sizeof(std::uint32_t)));
  EXPECT_TRUE(written([](PlainFile& file) {
                put(file, 150'001, kRows);
                put(file, 0, 7);
                put(file, 7, 150'001);
              }) == want);
  EXPECT_TRUE(written([&](PlainFile& file) {
                put(file, 0, 1000);
                const auto joined =
                    join_plain_file(file.temporary_path(), folder_ / "p.h5", nullptr);
                add_tables(*joined);
                put(*joined, 1000, kRows);
                joined->close();
              }) == want);
  EXPECT_EQ(folder_.file_count(), 1u);
}

TEST_F(PlainFiles, are_read_as_others_are) {
  in_order();
  const Hdf5Reader read(folder_ / "p.h5", "a result");
  const auto x = read.numbers("a/second/x"), face = read.numbers("a/second/face");
  ASSERT_EQ(x.size(), kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    ASSERT_EQ(x[row], static_cast<double>(row) + 0.5);
    ASSERT_EQ(face[row], static_cast<double>(row));
  }
  EXPECT_EQ(read.unit("a/second/x"), "m");
  EXPECT_EQ(read.numbers("sums/x")[0], 0.25);
}

TEST_F(PlainFiles, that_fail_leave_nothing) {
  const auto file = create_plain_file(folder_ / "p.h5", hashes);
  add_tables(*file);
  EXPECT_ANY_THROW(put(*file, kRows - 1, kRows + 1));
  EXPECT_EQ(test::message_of<std::exception>([&] {
              join_plain_file(folder_ / "none.h5", folder_ / "p.h5", nullptr);
            }).find("cannot write '" + folder_ / "p.h5" + "': "),
            0u);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "p.h5"));
}

TEST_F(PlainFiles, are_sealed_by_blocks_that_many_find) {
  const std::string sound = in_order(), path = folder_ / "p.h5";
  EXPECT_EQ(check_seal(path), Seal::kSound);
  const auto all = block_hashes(path, sound.size());
  ASSERT_EQ(all.size(), 7u);
  std::vector<std::uint64_t> sum(all.size());
  for (const std::size_t first : {0, 1, 2}) {
    const auto some = block_hashes(path, sound.size(), first, 3);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += some[i];
  }
  EXPECT_EQ(sum, all);
  for (std::size_t at = 0; at + 24 < sound.size(); at += 499'979) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 16);
    folder_.write("p.h5", damaged);
    EXPECT_EQ(check_seal(path), Seal::kBroken) << at;
  }
  folder_.write("p.h5", sound.substr(0, sound.size() - 8));
  EXPECT_EQ(check_seal(path), Seal::kNone);
  EXPECT_THROW(block_hashes(path, sound.size() + 1), std::system_error);
}

}  // namespace
}  // namespace gliss
