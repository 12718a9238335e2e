// Tables in HDF5 read as those in CSV are, with the units that they name.
#include "gliss/tables/input_table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gliss/tables/npy_reader.h"
#include "gliss/tables/point_table.h"
#include "gliss/tables/result_table.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class InputTables : public ::testing::Test {
 protected:
  // Columns x, y, z in a unit, and "step"; the same numbers whatever the format.
  std::string write(const std::string& name, const std::string& unit, double last = 6) {
    const std::string path = folder_ / name;
    const auto file = create_result_file(path);
    ResultTable table(*file, "",
                      Columns()
                          .add({"x", "y", "z"}, ColumnType::kFloat64, unit)
                          .add({"step"}, ColumnType::kUint32));
    const std::vector<Vec3> points{{1, 2, 3}, {4, 5, last}};
    table.fill_vectors(2, [&](std::size_t i) { return points[i]; });
    table.fill(2, [](std::size_t i) { return 7 + i; });
    table.write();
    file->close();
    return path;
  }

  test::ScratchFolder folder_;
};

TEST_F(InputTables, of_hdf5_and_csv_are_the_same) {
  const TableRequest request{.alternatives = {{"x_mm"}, {"x", "z"}}, .optional = {"step", "none"}};
  for (const char* name : {"p.h5", "p.hdf5", "p.csv"}) {
    const InputTable table = read_table(write(name, "mm"), request);
    EXPECT_EQ(table.rows, 2u) << name;
    EXPECT_EQ(table.alternative, 1u) << name;
    EXPECT_THAT(*table.find("x"), ElementsAre(1, 4)) << name;
    EXPECT_THAT(*table.find("z"), ElementsAre(3, 6)) << name;
    EXPECT_THAT(*table.find("step"), ElementsAre(7, 8)) << name;
    EXPECT_EQ(table.find("y"), nullptr) << name;
    EXPECT_EQ(table.find("none"), nullptr) << name;
    EXPECT_EQ(table.unit("x"), is_hdf5(name) ? "mm" : "") << name;
    EXPECT_EQ(table.unit("step"), "") << name;
  }
}

// Which is of the file, as messages say.
TEST_F(InputTables, come_some_rows_at_a_time) {
  for (const char* name : {"p.h5", "p.npy", "p.csv"}) {
    const std::string path = write(name, "");
    const auto reader = open_table(path, {.alternatives = {{"x", "z"}}, .optional = {"step"}});
    EXPECT_EQ(reader->rows(), 2u) << name;
    const InputTable second = reader->read(1, 2), none = reader->read(1, 1);
    EXPECT_EQ(second.rows, 1u) << name;
    EXPECT_THAT(*second.find("x"), ElementsAre(4)) << name;
    EXPECT_THAT(*second.find("step"), ElementsAre(8)) << name;
    EXPECT_THAT(second.place(0), EndsWith(is_hdf5(name) || is_npy(name) ? ": row 1" : ":3"))
        << name;
    EXPECT_EQ(none.rows, 0u) << name;
    EXPECT_TRUE(none.find("x")->empty()) << name;
    PointReader points(path, 0.5);
    EXPECT_THAT(points.read(1, 2).points, ElementsAre(Vec3(4, 5, 6))) << name;
    EXPECT_EQ(points.read(1, 2).unit, 0.5) << name;
  }
  for (const char* name : {"p.h5", "p.npy"}) {
    const auto reader = open_table(write(name, "", std::nan("")), {.alternatives = {{"x", "z"}}});
    EXPECT_EQ(reader->read(0, 1).rows, 1u) << name;
    EXPECT_THAT(test::message_of<std::runtime_error>([&] { reader->read(1, 2); }),
                HasSubstr(fmt::format("{}: row 1: column 'z': nan is not finite", name)));
  }
}

TEST_F(InputTables, of_hdf5_name_rows_from_0) {
  EXPECT_THAT(read_table(write("p.h5", ""), {.alternatives = {{"x"}}}).place(1),
              EndsWith("p.h5: row 1"));
}

TEST_F(InputTables, of_hdf5_without_what_is_wanted_are_refused) {
  const std::string path = write("p.h5", "");
  EXPECT_THAT(test::message_of<RecordingError>([&] {
                read_table(path, {.alternatives = {{"patch", "xi"}, {"x", "w"}}});
              }),
              AllOf(StartsWith(path), HasSubstr("wanted patch,xi or x,w")));
}

TEST_F(InputTables, of_hdf5_hold_finite_numbers_alone) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const std::string path = write("p.h5", "", bad);
    EXPECT_THAT(test::message_of<RecordingError>([&] { read_points(path, 1); }),
                AllOf(StartsWith(path + ": row 1: column 'z'"), HasSubstr("is not finite")));
  }
}

TEST_F(InputTables, of_points_are_in_the_unit_that_they_name) {
  EXPECT_EQ(read_points(write("p.h5", "mm"), 1).unit, 1e-3);
  EXPECT_EQ(read_points(write("p.h5", ""), 0.5).unit, 0.5);
  EXPECT_EQ(read_points(write("p.csv", "mm"), 0.5).unit, 0.5);
  EXPECT_THAT(read_points(write("p.h5", "mm"), 1).points,
              ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  const std::string path = write("p.h5", "furlong");
  EXPECT_THAT(test::message_of<RecordingError>([&] { read_points(path, 1); }),
              AllOf(StartsWith(path + ": column 'x'"), HasSubstr("furlong")));
}

}  // namespace
}  // namespace gliss
