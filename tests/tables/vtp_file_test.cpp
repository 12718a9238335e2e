// ParaView files: the XML names each array once, and its offset leads to exactly its numbers.
#include "gliss/tables/vtp_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <regex>

#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

struct ParsedArray {
  std::string type;
  int components = 0;
  std::string bytes;

  template <class Number>
  std::vector<Number> as() const {
    std::vector<Number> numbers(bytes.size() / sizeof(Number));
    std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
  }
};

struct ParsedFile {
  std::string xml;
  std::map<std::string, ParsedArray> arrays;
};

// The tags must nest, the blocks must lie end to end, and the closing tags must follow the last
// one.
ParsedFile parse(const std::string& text) {
  ParsedFile file;
  const std::size_t data = text.find("encoding=\"raw\">\n_") + 17;
  file.xml = text.substr(0, data);
  std::size_t end = data;
  const std::regex array(
      "<DataArray type=\"(\\w+)\" Name=\"([^\"<]*)\" NumberOfComponents=\"(\\d)\" "
      "format=\"appended\" "
      "offset=\"(\\d+)\"/>");
  for (std::sregex_iterator match(file.xml.begin(), file.xml.end(), array), none; match != none;
       ++match) {
    const std::size_t begin = data + std::stoull((*match)[4]);
    EXPECT_EQ(begin, end) << "blocks lie end to end";
    std::uint64_t size = 0;
    if (begin + sizeof size > text.size()) throw std::runtime_error("offset beyond the file");
    std::memcpy(&size, text.data() + begin, sizeof size);
    file.arrays[(*match)[2]] = {(*match)[1], std::stoi((*match)[3]), text.substr(begin + 8, size)};
    end = begin + 8 + size;
  }
  EXPECT_EQ(text.substr(end), "\n  </AppendedData>\n</VTKFile>\n");
  std::vector<std::string> open;
  const std::string tags = file.xml + "</AppendedData></VTKFile>";
  const std::regex tag("<(/?)(\\w+)[^<>]*?(/?)>");
  for (std::sregex_iterator match(tags.begin(), tags.end(), tag), none; match != none; ++match) {
    if ((*match)[1] == "/") {
      EXPECT_EQ(open.back(), (*match)[2]);
      open.pop_back();
    } else if ((*match)[3] != "/") {
      open.push_back((*match)[2]);
    }
  }
  EXPECT_TRUE(open.empty());
  return file;
}

TEST(VtpFile, PolygonsWithPointAndCellData) {
  const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}, {2, 0.5, 0}};
  const std::vector<std::uint32_t> face_begin = {0, 4, 7}, corner_vertex = {0, 1, 2, 3, 1, 4, 2};
  const std::vector<float> height = {0.5f, 1, 2, 3, 4};
  const std::vector<double> normals = {0, 0, 1, 0, 0, -1};
  const std::vector<std::uint32_t> valence = {4, 3};
  const test::ScratchFolder folder;
  write_vtp(folder / "m.vtp",
            {.points = packed(positions),
             .face_begin = face_begin,
             .corner_vertex = corner_vertex,
             .point_data = {{"a < \"b\" & c", 1, std::span<const float>(height)}},
             .cell_data = {{"normal", 3, std::span<const double>(normals)},
                           {"valence", 1, std::span<const std::uint32_t>(valence)}}});

  const ParsedFile file = parse(folder.read("m.vtp"));
  EXPECT_NE(file.xml.find("NumberOfPoints=\"5\" NumberOfVerts=\"0\""), std::string::npos);
  EXPECT_NE(file.xml.find("NumberOfPolys=\"2\""), std::string::npos);
  ASSERT_EQ(file.arrays.size(), 6u);
  EXPECT_EQ(file.arrays.at("Points").type, "Float64");
  EXPECT_EQ(file.arrays.at("Points").components, 3);
  EXPECT_EQ(file.arrays.at("Points").as<double>()[11], 0.1);
  EXPECT_EQ(file.arrays.at("connectivity").type, "Int64");
  EXPECT_EQ(file.arrays.at("connectivity").as<std::int64_t>(),
            (std::vector<std::int64_t>{0, 1, 2, 3, 1, 4, 2}));
  EXPECT_EQ(file.arrays.at("offsets").as<std::int64_t>(), (std::vector<std::int64_t>{4, 7}));
  EXPECT_EQ(file.arrays.at("a &lt; &quot;b&quot; &amp; c").as<float>(), height);
  EXPECT_EQ(file.arrays.at("normal").as<double>(), normals);
  EXPECT_EQ(file.arrays.at("normal").components, 3);
  EXPECT_EQ(file.arrays.at("valence").type, "UInt32");
  EXPECT_EQ(file.arrays.at("valence").as<std::uint32_t>(), valence);
}

TEST(VtpFile, PointsAreOneVertexCellEach) {
  const std::vector<float> points = {0, 0, 0, 1, 2, 3};
  const test::ScratchFolder folder;
  write_vtp(folder / "p.vtp", {.points = std::span<const float>(points),
                               .point_data = {{"force", 3, std::span<const float>(points)}}});
  const ParsedFile file = parse(folder.read("p.vtp"));
  EXPECT_NE(file.xml.find("NumberOfPoints=\"2\" NumberOfVerts=\"2\""), std::string::npos);
  EXPECT_NE(file.xml.find("<Verts>"), std::string::npos);
  EXPECT_EQ(file.arrays.at("Points").type, "Float32");
  EXPECT_EQ(file.arrays.at("connectivity").as<std::int64_t>(), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(file.arrays.at("offsets").as<std::int64_t>(), (std::vector<std::int64_t>{1, 2}));
}

TEST(VtpFile, EmptyIsAFileToo) {
  const test::ScratchFolder folder;
  write_vtp(folder / "e.vtp", {});
  EXPECT_EQ(parse(folder.read("e.vtp")).arrays.size(), 3u);
}

TEST(VtpFile, SizesThatDoNotFitWriteNothing) {
  const std::vector<double> points = {0, 0, 0, 1, 1, 1};
  const std::vector<std::uint32_t> face_begin = {0, 3}, corner_vertex = {0, 1};
  const std::span<const double> good(points), bad(points.data(), 5);
  const test::ScratchFolder folder;
  const auto write = [&](const VtpData& data) { write_vtp(folder / "b.vtp", data); };
  EXPECT_THROW(write({.points = bad}), std::logic_error);
  EXPECT_THROW(write({.points = good, .point_data = {{"v", 1, bad}}}), std::logic_error);
  EXPECT_THROW(write({.points = good, .point_data = {{"v", 2, good}}}), std::logic_error);
  EXPECT_THROW(write({.points = good, .face_begin = face_begin, .corner_vertex = corner_vertex}),
               std::logic_error);
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace gliss
