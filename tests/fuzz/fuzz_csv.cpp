// Whatever the text of a table: finite points, or an error that names the file.
#include "gliss/files/line_reader.h"
#include "gliss/tables/point_table.h"
#include "tests/fuzz/fuzz.h"

namespace gliss::fuzz {
namespace {

void read(const std::string& path) {
  const PointTable table = read_points(path, 1e-3, {"step"});
  require(table.points.size() == table.table.rows, "a point for each row");
  for (const Vec3& point : table.points) require(point.allFinite(), "finite points");
  if (const auto* steps = table.table.find("step"))
    require(steps->size() == table.points.size(), "a step for each row");
}

void read_texts(const std::string& path) {
  const InputTable table = read_csv(path, {.alternatives = {{"fx"}, {}}, .texts = {"method", "x"}});
  if (const auto* methods = table.find_text("method"))
    require(methods->size() == table.rows, "a text for each row");
}

}  // namespace
}  // namespace gliss::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  const std::string path =
      fuzz::folder().write("table.csv", std::string(fuzz::text_of(data, size)));
  for (const auto use : {fuzz::read, fuzz::read_texts}) {
    try {
      use(path);
    } catch (const CsvError& error) {
      fuzz::require(std::string_view(error.what()).starts_with(path + ":"), "the place named");
    }
  }
  return 0;
}
