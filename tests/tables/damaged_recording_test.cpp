// Recordings and traces cut short at every length, and with every bit flipped: read as they were,
// or refused by name. CSV has no checksum: digits that became others are read as such.
#include <cmath>

#include "gliss/tables/csv_reader.h"
#include "gliss/tables/hdf5_reader.h"
#include "gliss/tables/point_table.h"
#include "gliss/tables/result_table.h"
#include "tests/support/places.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

using test::Outcome, test::Process;
using ::testing::AllOf;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::vector<Vec3> kPath{{0.125, -2.5, 3}, {0.25, 1e-3, -7.75}, {1e9, 0, 0.1}};

class DamagedRecording : public ::testing::Test {
 protected:
  DamagedRecording() : path_(folder_ / "path.h5") {
    const auto file = create_result_file(path_);
    file->set_attribute({"program", "gliss"});
    ResultTable table(
        *file, "ticks",
        Columns().add({"x", "y", "z"}, ColumnType::kFloat64, "m").add({"state"}, ColumnType::kText),
        {}, kPath.size());
    table.fill_vectors(kPath.size(), [&](std::size_t i) { return kPath[i]; });
    table.fill(kPath.size(), [](std::size_t i) { return i == 1 ? "contact" : "free"; });
    table.write();
    file->close();
    sound_ = folder_.read("path.h5");
  }

  // Empty where it is read as it was written.
  std::string refusal() const {
    return test::message_of<RecordingError>(
        [&] { EXPECT_THAT(read_points(path_, 1).points, ElementsAreArray(kPath)); });
  }
  void expect_refused() const {
    ASSERT_THAT(refusal(), StartsWith("cannot read '" + path_ + "' as a recording: "));
  }

  const test::ScratchFolder folder_;
  const std::string path_;
  std::string sound_;
};

// A checksum behind HDF5's own end: name, length and sum.
constexpr std::size_t kSealBytes = 24, kSealNameBytes = 8;

TEST_F(DamagedRecording, hdf5_cut_short_is_refused) {
  EXPECT_EQ(refusal(), "");
  for (std::size_t size = sound_.size(); size-- > 0;) {
    std::filesystem::resize_file(path_, size);
    if (size >= sound_.size() - kSealBytes) {
      ASSERT_EQ(refusal(), "") << size;  // all of HDF5 is still there
    } else {
      ASSERT_NO_FATAL_FAILURE(expect_refused()) << size;
    }
  }
}

TEST_F(DamagedRecording, hdf5_with_a_flipped_bit_is_refused) {
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  const auto put = [&](std::size_t at, char byte) {
    file.seekp(static_cast<std::streamoff>(at)).put(byte).flush();
  };
  const std::size_t seal = sound_.size() - kSealBytes;
  for (std::size_t at = 0; at < sound_.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      put(at, static_cast<char>(sound_[at] ^ (1 << bit)));
      if (at >= seal && at < seal + kSealNameBytes) {
        ASSERT_EQ(refusal(), "") << at;  // no checksum any more, and no damage to what it is of
      } else {
        ASSERT_THAT(refusal(), HasSubstr("path.h5' as a recording: damaged, its checksum differs"))
            << at << " bit " << bit;
      }
    }
    put(at, sound_[at]);
  }
  EXPECT_EQ(refusal(), "");
}

TEST_F(DamagedRecording, hdf5_of_others_has_no_checksum_and_is_read) {
  folder_.write("path.h5", sound_.substr(0, sound_.size() - kSealBytes));
  EXPECT_EQ(refusal(), "");
  folder_.write("path.h5", sound_ + "more");
  EXPECT_EQ(refusal(), "");
  folder_.write("path.h5", "no HDF5 at all, but long enough to have a checksum at its end");
  expect_refused();
  folder_.write("path.h5", "");
  expect_refused();
  EXPECT_THAT(test::message_of<RecordingError>([&] { read_points(folder_ / "none.h5", 1); }),
              HasSubstr("none.h5' as a recording: "));
}

const std::string kCsv = "x,y,z,step\n0.125,-2.5,3,1\n0.25,1e-3,-7.75,2\n1e9,0,0.1,30\n";

// True if a table was read, of finite numbers alone; else nothing was, and the message names the
// file.
bool is_read(const std::string& path, std::size_t most_rows) {
  const std::string refusal = test::message_of<CsvError>([&] {
    const PointTable read = read_points(path, 1, {"step"});
    EXPECT_LE(read.points.size(), most_rows);
    for (const Vec3& point : read.points) EXPECT_TRUE(point.allFinite());
  });
  if (!refusal.empty()) {
    EXPECT_THAT(refusal, StartsWith(path + ":"));
  }
  return refusal.empty();
}

TEST_F(DamagedRecording, csv_cut_short_is_refused_but_between_its_rows_and_in_its_last_number) {
  std::vector<std::size_t> read;
  for (std::size_t size = 0; size < kCsv.size(); ++size) {
    if (is_read(folder_.write("path.csv", kCsv.substr(0, size)), 3)) read.push_back(size);
  }
  // From "x,y,z" to the end of the header, then after each digit of a row's last number, without
  // the line's end and with it.
  std::vector<std::size_t> expected{5, 6, 7, 8, 9, 10, 11};
  for (const std::string last : {"-2.5,3,1", "-7.75,2", "0.1,3", "0.1,30"}) {
    const std::size_t end = kCsv.find(last) + last.size();
    expected.push_back(end);
    if (kCsv[end] == '\n' && end + 1 < kCsv.size()) expected.push_back(end + 1);
  }
  EXPECT_EQ(read, expected);
}

TEST_F(DamagedRecording, csv_with_a_flipped_bit_is_a_table_of_numbers_or_is_refused) {
  std::size_t refused = 0;
  for (std::size_t at = 0; at < kCsv.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string text = kCsv;
      text[at] = static_cast<char>(text[at] ^ (1 << bit));
      refused += !is_read(folder_.write("path.csv", text), 4);
    }
  }
  fmt::print("  {} of {} flips are noticed\n", refused, 8 * kCsv.size());
  EXPECT_GT(2 * refused, 8 * kCsv.size());
}

// The programs that read them, with damage here and there.
TEST_F(DamagedRecording, programs_end_with_2_and_one_line) {
  folder_.write("tet.obj",
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  folder_.write("way.csv", kCsv);
  const auto gliss = [&](const std::vector<std::string>& words) {
    return Process(folder_ / "", test::kProgram, words).wait();
  };
  // The code; CSV may be damaged where nobody looks or nobody can tell.
  const auto refuse = [&](const std::vector<std::string>& words, const std::string& name) {
    const Outcome outcome = gliss(words);
    const bool refused = outcome.code == 2;
    EXPECT_TRUE(refused || (outcome.code == 0 && name.ends_with(".csv"))) << outcome.err;
    if (refused) {
      EXPECT_THAT(outcome.err, AllOf(StartsWith("gliss: "), HasSubstr(name)));
      EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    std::filesystem::remove(folder_ / words.back());
    return refused;
  };
  for (const std::string ending : {"h5", "csv"}) {
    const std::string trace = "trace." + ending, bad = "bad." + ending;
    ASSERT_EQ(gliss({"trace", "tet.obj", "--path", "way.csv", "-o", trace, "--quiet"}).code, 0);
    const std::string text = folder_.read(trace);
    int refused = 0, runs = 0;
    for (std::size_t part = 0; part < 8; ++part) {
      const std::size_t at = text.size() * part / 8;
      SCOPED_TRACE(fmt::format("{} at {}", trace, at));
      std::string flipped = text;
      flipped[at] = static_cast<char>(flipped[at] ^ 4);
      for (const std::string& damaged : {flipped, text.substr(0, at)}) {
        folder_.write(bad, damaged);
        runs += 2;
#ifdef GLISS_WITH_REPORT
        ++runs;
        refused += refuse({"report", bad, "-o", "page.html"}, bad);
#endif
        refused += refuse({"trace", "tet.obj", "--path", bad, "-o", "out.csv"}, bad);
        refused += refuse({"project", "tet.obj", "--hip", bad, "-o", "out.csv"}, bad);
      }
    }
    EXPECT_EQ(refused == runs, ending == "h5") << refused;
    EXPECT_GE(refused, 2 * runs / 5);
  }
}

}  // namespace
}  // namespace gliss
