// .npy files: written as NumPy reads them, read as NumPy writes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "gliss/tables/csv_reader.h"
#include "gliss/tables/point_table.h"
#include "gliss/tables/result_table.h"
#include "tests/support/require.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using ::testing::ElementsAre, ::testing::HasSubstr;

std::string npy(const std::string& dictionary, const std::string& data, char version = 1) {
  std::string header = "\x93NUMPY";
  header += {version, 0};
  const std::size_t size = dictionary.size() + 1;
  header += {static_cast<char>(size & 255), static_cast<char>(size >> 8)};
  if (version > 1) header += std::string(2, '\0');
  return header + dictionary + "\n" + data;
}

template <class Number>
std::string bytes_of(std::initializer_list<Number> numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), numbers.begin(), bytes.size());
  return bytes;
}

class Npy : public ::testing::Test {
 protected:
  std::vector<Vec3> points(const std::string& text) {
    return read_points(folder_.write("a.npy", text), 1).points;
  }
  std::string refusal(const std::string& text) {
    const std::string path = folder_.write("a.npy", text);
    const std::string what = test::message_of<CsvError>([&] { read_points(path, 1); });
    return what.starts_with(path) ? what.substr(path.size() + 2) : what;
  }

  test::ScratchFolder folder_;
};

TEST_F(Npy, tables_come_back_as_they_were_written) {
  const std::string path = folder_ / "t.npy";
  const auto file = create_result_file(path);
  ResultTable table(*file, "",
                    Columns()
                        .add({"x", "y", "z"})
                        .add({"f"}, ColumnType::kFloat32)
                        .add({"n"}, ColumnType::kUint32)
                        .add({"b"}, ColumnType::kUint8)
                        .add({"word"}, ColumnType::kText));
  for (int block = 0; block < 2; ++block) {
    table.fill_vectors(3, [&](std::size_t i) { return Vec3(0.1 * double(i), 1e-300, -3 - block); });
    table.fill(3, [](std::size_t i) { return 0.1f * float(i); });
    table.fill(3, [](std::size_t i) { return 4294967295u - unsigned(i); });
    table.fill(3, [](std::size_t i) { return 255 - i; });
    table.fill(3, [](std::size_t) { return "gregory"; });
    table.write();
  }
  file->close();
  const InputTable read =
      read_table(path, {.alternatives = {{"x", "y", "z"}}, .optional = {"n", "b", "f", "absent"}});
  EXPECT_EQ(read.rows, 6u);
  EXPECT_THAT(*read.find("x"), ElementsAre(0, 0.1, 0.2, 0, 0.1, 0.2));
  EXPECT_THAT(*read.find("z"), ElementsAre(-3, -3, -3, -4, -4, -4));
  EXPECT_EQ((*read.find("y"))[5], 1e-300);
  EXPECT_EQ((*read.find("f"))[2], static_cast<double>(0.1f * 2));
  EXPECT_EQ((*read.find("n"))[1], 4294967294.0);
  EXPECT_EQ((*read.find("b"))[4], 254);
  EXPECT_EQ(read.find("absent"), nullptr);
}

TEST_F(Npy, numpy_reads_what_is_written_and_writes_what_is_read) {
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0)
    GLISS_SKIP_UNLESS_REQUIRED("NumPy is not there");
  const std::string path = folder_ / "t.npy", script = folder_.write("t.py", R"(
import sys, numpy as np
a = np.load(sys.argv[1])
assert a.dtype.names == ('x', 'y', 'z', 'word'), a.dtype
assert a['x'].tolist() == [0.0, 0.5, 1.0] and a['word'][2] == b'flat', a
p = np.arange(12.0).reshape(4, 3)
np.save(sys.argv[2] + '/c.npy', p)
np.save(sys.argv[2] + '/f.npy', np.asfortranarray(p.astype('f4')))
s = np.zeros(4, dtype=[('id', 'U9'), ('z', 'i2'), ('y', 'u8'), ('x', 'f8')])
s['x'], s['y'], s['z'] = p.T
np.save(sys.argv[2] + '/s.npy', s)
)");
  const auto file = create_result_file(path);
  ResultTable table(*file, "", Columns().add({"x", "y", "z"}).add({"word"}, ColumnType::kText));
  table.fill_vectors(3, [](std::size_t i) { return Vec3(0.5 * double(i), 0, 0); });
  table.fill(3, [](std::size_t) { return "flat"; });
  table.write();
  file->close();
  ASSERT_EQ(
      std::system(
          ("/usr/bin/python3 '" + script + "' '" + path + "' '" + (folder_ / "") + "'").c_str()),
      0);
  for (const char* name : {"c.npy", "f.npy", "s.npy"})
    EXPECT_THAT(read_points(folder_ / name, 1).points,
                ElementsAre(Vec3(0, 1, 2), Vec3(3, 4, 5), Vec3(6, 7, 8), Vec3(9, 10, 11)))
        << name;
}

TEST_F(Npy, versions_and_types_are_read_and_others_refused_by_name) {
  const std::string three = bytes_of({1.0, 2.0, 3.0});
  const std::string plain = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }";
  for (const char version : {'\1', '\2', '\3'})
    EXPECT_THAT(points(npy(plain, three, version)), ElementsAre(Vec3(1, 2, 3)));
  EXPECT_THAT(points(npy("{'shape':(1,3),\"descr\":'|i1','fortran_order':True}", "\1\2\xff")),
              ElementsAre(Vec3(1, 2, -1)));
  EXPECT_THAT(points(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (0, 3), }", "")),
              ElementsAre());
  EXPECT_EQ(refusal("\x93NUMPX\1" + plain), "not an .npy file");
  EXPECT_EQ(refusal(npy(plain, three, 9)), "a version of .npy that is not known");
  EXPECT_EQ(refusal(npy("{'descr': '>f8', 'fortran_order': False, 'shape': (1, 3), }", three)),
            "column 'x': '>f8' is not a type of little-endian numbers");
  EXPECT_THAT(refusal(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 4), }", three)),
              HasSubstr("an array of 4 columns without names; wanted x,y,z or x_mm,y_mm,z_mm"));
  EXPECT_EQ(refusal(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }", three)),
            "an array without names must have two dimensions");
  EXPECT_EQ(
      refusal(npy("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (3,), }", three)),
      "missing columns: wanted x,y,z or x_mm,y_mm,z_mm");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(npy(plain, bytes_of({1.0, nan, 3.0}))),
              HasSubstr("column 'y': nan is not finite"));
}

// Whatever is cut, and whatever the header claims, is refused and not read beyond.
TEST_F(Npy, damaged_files_are_refused) {
  const std::string good =
      npy("{'descr': [('x', '<f8'), ('y', '<f8'), ('z', '<f8')], 'fortran_order': False, 'shape': "
          "(2,), }",
          bytes_of({1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_THAT(points(good), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_NE(refusal(good.substr(0, size)), "") << size;
  EXPECT_THAT(refusal(good + "x"),
              HasSubstr("its header says 2 rows of 24 bytes, and 49 bytes follow"));
  for (const char* shape :
       {"(3,)", "(18446744073709551615,)", "(99999999999999999999,)", "(-1,)", "(2, 1)", "()"}) {
    std::string other = good;
    other.replace(other.find("(2,)"), 4, shape);
    const std::size_t length = other.find('\n') - 9;
    other[8] = static_cast<char>(length & 255), other[9] = static_cast<char>(length >> 8);
    EXPECT_NE(refusal(other), "") << shape;
  }
}

}  // namespace
}  // namespace gliss
