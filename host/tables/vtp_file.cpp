#include "gliss/tables/vtp_file.h"

#include <fmt/format.h>

#include <bit>
#include <stdexcept>

#include "gliss/files/atomic_file.h"

namespace gliss {
namespace {

static_assert(std::endian::native == std::endian::little, "the header says LittleEndian");

using Indices = std::vector<std::int64_t>;  // VTK's own type: it loads without a conversion
using Block = std::variant<std::span<const double>, std::span<const float>,
                           std::span<const std::uint32_t>, std::span<const std::int64_t>>;
constexpr const char* kTypes[] = {"Float64", "Float32", "UInt32", "Int64"};

std::span<const std::byte> bytes_of(const Block& block) {
  return std::visit([](const auto& values) { return std::as_bytes(values); }, block);
}

std::size_t size_of(const VtpValues& values) {
  return std::visit([](const auto& span) { return span.size(); }, values);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char character : text) {
    switch (character) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += character;
    }
  }
  return result;
}

// The XML text and the blocks that it points to by their offsets behind the underscore.
struct Document {
  std::string xml;
  std::vector<Block> blocks;
  std::uint64_t offset = 0;

  void add_array(const std::string& name, int components, const Block& block) {
    xml += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        kTypes[block.index()], escaped(name), components, offset);
    blocks.push_back(block);
    offset += sizeof(std::uint64_t) + bytes_of(block).size();
  }

  void add_values(const std::string& name, int components, const VtpValues& values) {
    std::visit([&](const auto& span) { add_array(name, components, span); }, values);
  }

  void add_data(const char* tag, const std::vector<VtpArray>& arrays, std::size_t count) {
    xml += fmt::format("      <{}>\n", tag);
    for (const VtpArray& array : arrays) {
      const bool fits = size_of(array.values) == count * static_cast<std::size_t>(array.components);
      if (!fits || (array.components != 1 && array.components != 3)) {
        throw std::logic_error(fmt::format("{} '{}': {} numbers for {} x {}", tag, array.name,
                                           size_of(array.values), count, array.components));
      }
      add_values(array.name, array.components, array.values);
    }
    xml += fmt::format("      </{}>\n", tag);
  }
};

}  // namespace

void write_vtp(const std::string& path, const VtpData& data) {
  const std::size_t points = size_of(data.points) / 3;
  const bool polygons = !data.face_begin.empty();
  const std::size_t cells = polygons ? data.face_begin.size() - 1 : points;
  if (size_of(data.points) % 3 != 0) throw std::logic_error("VTP points are not triples");
  if (polygons && data.face_begin.back() != data.corner_vertex.size()) {
    throw std::logic_error("VTP faces do not end at the last corner");
  }

  Indices connectivity(data.corner_vertex.begin(), data.corner_vertex.end());
  Indices offsets;  // VTK's are the ends of the cells
  if (polygons) {
    offsets.assign(data.face_begin.begin() + 1, data.face_begin.end());
  } else {
    for (std::size_t point = 0; point < points; ++point) {
      connectivity.push_back(static_cast<std::int64_t>(point));
      offsets.push_back(static_cast<std::int64_t>(point + 1));
    }
  }

  Document document;
  document.xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <PolyData>\n"
      "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n      <Points>\n",
      points, polygons ? 0 : cells, polygons ? cells : 0);
  document.add_values("Points", 3, data.points);
  const char* kind = polygons ? "Polys" : "Verts";
  document.xml += fmt::format("      </Points>\n      <{}>\n", kind);
  document.add_array("connectivity", 1, connectivity);
  document.add_array("offsets", 1, offsets);
  document.xml += fmt::format("      </{}>\n", kind);
  document.add_data("PointData", data.point_data, points);
  document.add_data("CellData", data.cell_data, cells);
  document.xml += "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n_";

  AtomicFile output(path);
  output.write(document.xml);
  for (const Block& block : document.blocks) {
    const auto bytes = bytes_of(block);
    const std::uint64_t size = bytes.size();
    output.write(&size, sizeof size);
    output.write(bytes.data(), bytes.size());
  }
  output.write("\n  </AppendedData>\n</VTKFile>\n");
  output.commit();
}

}  // namespace gliss
