// Results as CSV: every bit survives, and only what needs quotes has them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "gliss/tables/csv_reader.h"
#include "gliss/tables/result_file.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using test::ScratchFolder;
using testing::ElementsAreArray;

void write_csv(const std::string& path, const std::vector<Column>& columns,
               const std::vector<ColumnData>& block) {
  const auto file = create_result_file(path);
  file->append(file->add_table("t", columns), block);
  file->close();
}

TEST(CsvFile, NumbersReadBackAsTheSameBits) {
  std::vector<double> doubles = {5e-324, -std::numeric_limits<double>::max(), 0.1, -0.0, 1e22};
  std::vector<float> floats = {1e-45f, std::numeric_limits<float>::max(), 0.1f, -0.0f, 1e10f};
  std::vector<std::uint32_t> integers = {0, 0xFFFFFFFFu, 7, 8, 9};
  std::vector<std::uint8_t> bytes = {0, 255, 10, 34, 44};
  for (int i = 3; i < 1000; ++i) {
    doubles.push_back(1.0 / i);
    floats.push_back(1.0f / static_cast<float>(i));
    integers.push_back(2654435761u * static_cast<std::uint32_t>(i));
    bytes.push_back(static_cast<std::uint8_t>(i));
  }
  const ScratchFolder folder;
  write_csv(folder / "r.csv",
            {{"a", ColumnType::kFloat64, "N"},
             {"b", ColumnType::kFloat32, "m"},
             {"c", ColumnType::kUint32, ""},
             {"d", ColumnType::kUint8, ""}},
            {std::span<const double>(doubles), std::span<const float>(floats),
             std::span<const std::uint32_t>(integers), std::span<const std::uint8_t>(bytes)});
  const InputTable table = read_csv(folder / "r.csv", {.alternatives = {{"a", "b", "c", "d"}}});
  EXPECT_THAT(*table.find("a"), ElementsAreArray(doubles));
  const auto& b = *table.find("b");  // its digits name a float, not a double
  EXPECT_EQ(std::vector<float>(b.begin(), b.end()), floats);
  EXPECT_THAT(*table.find("c"), ElementsAreArray(integers));
  EXPECT_THAT(*table.find("d"), ElementsAreArray(bytes));
}

TEST(CsvFile, QuotesOnlyWhatNeedsIt) {
  const ScratchFolder folder;
  const std::vector<std::string> texts = {"plain text", "a,b", "say \"hi\"", "", " padded", "#1"};
  write_csv(folder / "r.csv", {{"label", ColumnType::kText, ""}},
            {std::span<const std::string>(texts)});
  EXPECT_EQ(folder.read("r.csv"),
            "label\nplain text\n\"a,b\"\n\"say \"\"hi\"\"\"\n\"\"\n\" padded\"\n\"#1\"\n");
}

TEST(CsvFile, HoldsOneTable) {
  const ScratchFolder folder;
  const auto file = create_result_file(folder / "r.csv");
  file->add_table("a", {{"x", ColumnType::kFloat64, "m"}});
  EXPECT_THAT(test::message_of<std::runtime_error>([&] { file->add_table("b", {}); }),
              ::testing::HasSubstr("r.csv"));
}

}  // namespace
}  // namespace gliss
