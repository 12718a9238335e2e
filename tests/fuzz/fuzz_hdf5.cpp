// Whatever stands where a recording should, in a sound HDF5 file or (where the input begins as one)
// any bytes: finite points, or a std::runtime_error that names the file.
#include <hdf5.h>

#include <optional>

#include "gliss/tables/hdf5_reader.h"
#include "gliss/tables/point_table.h"
#include "tests/fuzz/fuzz.h"

namespace gliss::fuzz {
namespace {

constexpr std::string_view kMagic = "\x89HDF";

hid_t type_of(Input& input) {
  static const hid_t text = [] {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    return type;
  }();
  const hid_t types[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT, H5T_NATIVE_INT32,
                         H5T_STD_U8BE,      H5T_C_S1,         text,
                         H5T_STD_B16LE};
  return types[input.choice(std::size(types))];
}

// In chunks, most of which are never written: any number of rows takes no place.
void add_dataset(hid_t file, const char* name, Input& input) {
  const hid_t type = type_of(input);
  const int rank = input.choice(8) == 0 ? 2 : 1;
  hsize_t rows[2] = {input.choice(16), 3}, limits[2] = {H5S_UNLIMITED, 3}, chunk[2] = {16, 3};
  const bool huge = input.choice(8) == 0;
  const hid_t space = H5Screate_simple(rank, rows, limits), how = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(how, rank, chunk);
  const hid_t parents = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(parents, 1);
  const hid_t set = H5Dcreate2(file, name, type, space, parents, how, H5P_DEFAULT);
  if (set >= 0 && H5Tget_class(type) == H5T_FLOAT) {
    double values[48] = {};
    for (hsize_t i = 0; i < rows[0]; ++i) values[i] = input.number<double>();
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  }
  if (huge) {
    rows[0] = input.number<std::uint64_t>();
    H5Dset_extent(set, rows);
  }
  if (set >= 0) H5Dclose(set);
  H5Sclose(space), H5Pclose(how), H5Pclose(parents);
}

void add_attribute(hid_t file, Input& input) {
  hsize_t rows = 1 + input.choice(3);
  const hid_t space = input.flag() ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &rows, nullptr);
  const hid_t attribute = H5Acreate2(file, "unit", type_of(input), space, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute >= 0) H5Aclose(attribute);
  H5Sclose(space);
}

void write_file(Input& input, const std::string& path) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  require(file >= 0, "a file can be made");
  for (const char* name : {"ticks/x", "ticks/y", "ticks/z", "ticks/method"}) {
    if (input.choice(16) != 15) add_dataset(file, name, input);
  }
  if (input.flag()) add_attribute(file, input);
  H5Fclose(file);
}

void read(const std::string& path) {
  const Hdf5Reader file(path, "a recording");
  if (file.has("ticks/method")) {
    const std::size_t rows = file.rows("ticks/method");
    require(file.texts("ticks/method").size() == rows, "a text for each row");
  }
  file.text_attribute("unit");
  file.number_attribute("unit");
}

void read_path(const std::string& path) {
  for (const Vec3& point : read_points(path, 1).points) require(point.allFinite(), "finite points");
}

}  // namespace
}  // namespace gliss::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const std::string path = fuzz::folder() / "recording.h5";
  fuzz::Input input(data, size);
  if (fuzz::text_of(data, size).starts_with(fuzz::kMagic)) {
    fuzz::folder().write("recording.h5", std::string(fuzz::text_of(data, size)));
  } else {
    fuzz::write_file(input, path);
  }
  for (const auto use : {fuzz::read, fuzz::read_path}) {
    try {
      use(path);
    } catch (const std::runtime_error& error) {
      fuzz::require(std::string_view(error.what()).find(path) != std::string_view::npos,
                    "the file named");
    }
  }
  return 0;
}
