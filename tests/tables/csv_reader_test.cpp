// CSV input: what people's spreadsheets write is read, and what is wrong is named by line and
// column.
#include "gliss/tables/csv_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <system_error>

#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class CsvReader : public ::testing::Test {
 protected:
  InputTable read(const std::string& text,
                  const TableRequest& request = {.alternatives = {{"x", "y"}}}) {
    return read_csv(folder_.write("p.csv", text), request);
  }
  std::string error(const std::string& text) {
    return test::message_of<CsvError>([&] { read(text); });
  }

  test::ScratchFolder folder_;
};

TEST_F(CsvReader, FindsColumnsByName) {
  const InputTable table = read("y,name,x\n2,left,1\n4,right,-3.5e-3\n");
  EXPECT_EQ(table.rows, 2u);
  EXPECT_THAT(*table.find("x"), ElementsAre(1, -3.5e-3));
  EXPECT_THAT(*table.find("y"), ElementsAre(2, 4));
  EXPECT_EQ(table.find("name"), nullptr);
}

TEST_F(CsvReader, KeepsWordsThatAreAskedFor) {
  const InputTable table = read("y,name,x\n2, left ,1\n4,\"r,ight\",3\n",
                                {.alternatives = {{"x"}}, .texts = {"name", "y", "absent"}});
  EXPECT_THAT(*table.find_text("name"), ElementsAre("left", "r,ight"));
  EXPECT_THAT(*table.find_text("y"), ElementsAre("2", "4"));
  EXPECT_THAT(*table.find("x"), ElementsAre(1, 3));
  EXPECT_EQ(table.find_text("absent"), nullptr);
  EXPECT_EQ(table.find_text("x"), nullptr);
}

TEST_F(CsvReader, TakesTheFirstCompleteAlternativeAndOptionalColumns) {
  const TableRequest request{.alternatives = {{"x", "y", "z"}, {"x_mm", "y_mm"}},
                             .optional = {"step", "missing"}};
  const InputTable table = read("x,y,x_mm,y_mm,step\n1,2,3,4,5\n", request);
  EXPECT_EQ(table.alternative, 1u);
  EXPECT_EQ(table.find("x"), nullptr);
  EXPECT_THAT(*table.find("x_mm"), ElementsAre(3));
  EXPECT_THAT(*table.find("step"), ElementsAre(5));
  EXPECT_EQ(table.find("missing"), nullptr);
}

TEST_F(CsvReader, AcceptsWhatSpreadsheetsWrite) {
  const InputTable table = read(
      "\xEF\xBB\xBF# made by hand\r\n# in mm\r\n\r\n x , \"y\" ,\"a \"\"note\"\"\"\r\n"
      "+1 ,\t2,\"so, so\"\r\n\"3\", 4 ,\r\n\r\n  \r\n");
  EXPECT_THAT(*table.find("x"), ElementsAre(1, 3));
  EXPECT_THAT(*table.find("y"), ElementsAre(2, 4));
  EXPECT_THAT(table.place(1), EndsWith("p.csv:6"));
}

TEST_F(CsvReader, LastLineNeedsNoEnd) {
  EXPECT_THAT(*read("x,y\n1,2\n3,4").find("y"), ElementsAre(2, 4));
  EXPECT_EQ(read("x,y").rows, 0u);
}

TEST_F(CsvReader, LinesAcrossBlocksOfTheFile) {
  std::string text = "x,note,y\n";
  for (int row = 0; row < 3000; ++row) {
    text += std::to_string(row) + "," + std::string(static_cast<std::size_t>(row), 'n') + ",1\n";
  }
  text += "7," + std::string(3 << 20, 'n') + ",8\n";  // longer than a block
  const InputTable table = read(text);
  ASSERT_EQ(table.rows, 3001u);
  for (std::size_t row = 0; row < 3000; ++row) {
    EXPECT_EQ((*table.find("x"))[row], static_cast<double>(row));
  }
  EXPECT_EQ(table.find("y")->back(), 8);
}

TEST_F(CsvReader, NamesLineAndColumnOfWhatIsNoFiniteNumber) {
  EXPECT_THAT(error("x,y\n1,2\n3,4q\n"), EndsWith("p.csv:3: column 'y': '4q' is not a number"));
  EXPECT_THAT(error("# c\nx,y\n1,\n"), EndsWith("p.csv:3: column 'y': '' is not a number"));
  EXPECT_THAT(error("x,y\n1,0x10\n"), EndsWith("column 'y': '0x10' is not a number"));
  EXPECT_THAT(error("x,y\n1,+-2\n"), EndsWith("column 'y': '+-2' is not a number"));
  EXPECT_THAT(error("x,y\nnan,2\n"), EndsWith("p.csv:2: column 'x': 'nan' is not finite"));
  EXPECT_THAT(error("x,y\n1,-INF\n"), EndsWith("p.csv:2: column 'y': '-INF' is not finite"));
  EXPECT_THAT(error("x,y\n1,1e999\n"),
              EndsWith("column 'y': '1e999' is beyond the range of double"));
}

TEST_F(CsvReader, NamesTheLineOfAWrongRow) {
  EXPECT_THAT(error("x,y\n1,2\n3\n"), EndsWith("p.csv:3: 1 fields, the header has 2"));
  EXPECT_THAT(error("x,y\n1,2,3\n"), EndsWith("p.csv:2: 3 fields, the header has 2"));
  EXPECT_THAT(error("x,y\n1,2\n\n3,4\n"), EndsWith("p.csv:4: a blank line before this row"));
  EXPECT_THAT(error("x,y\n1,\"2\n"), EndsWith("p.csv:2: a quoted field does not end on its line"));
  EXPECT_THAT(error("x,y\n1,\"2\"2\n"), EndsWith("p.csv:2: text behind a quoted field"));
}

TEST_F(CsvReader, NamesMissingAndDoubleColumns) {
  EXPECT_THAT(error("x,z\n1,2\n"),
              EndsWith("p.csv:1: missing columns: wanted x,y; the header has x,z"));
  EXPECT_THAT(error("x,y,x\n1,2,3\n"), EndsWith("p.csv:1: two columns are named 'x'"));
  EXPECT_THAT(error("1,2\n"), HasSubstr("the header has 1,2"));
  EXPECT_THAT(error(""), HasSubstr("no header"));
}

TEST_F(CsvReader, UnreadableFilesAreNamed) {
  const auto read = [](const std::string& path) {
    return test::message_of<std::system_error>([&] { read_csv(path, {}); });
  };
  EXPECT_THAT(read(folder_ / "none.csv"), HasSubstr("none.csv': No such file"));
  EXPECT_THAT(read(folder_ / "."), HasSubstr("Is a directory"));
}

}  // namespace
}  // namespace gliss
