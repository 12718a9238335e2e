#include "host/hdf5_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/file_seal.h"
#include "host/hdf5_types.h"

namespace gliss {

using hdf5::Handle;

namespace {

// Above what deflate can reach: a damaged file that says more would have all memory asked for.
constexpr hsize_t kMostRowsPerByte = 2048;

}  // namespace

struct Hdf5Reader::Dataset {
  std::string action;
  Handle dataset, space;
  hsize_t rows;

  hid_t select(hsize_t begin, hsize_t stride, hsize_t count) const {
    hdf5::check(H5Sselect_hyperslab(space, H5S_SELECT_SET, &begin, &stride, &count, nullptr),
                action);
    return space;
  }
};

Hdf5Reader::Hdf5Reader(const std::string& path, const std::string& what)
    : action_(fmt::format("cannot read '{}' as {}", path, what)) {
  if (check_seal(path) == Seal::kBroken)
    throw std::runtime_error(action_ + ": damaged, its checksum differs");
  hdf5::Quiet quiet;
  file_ = std::make_shared<const Handle>(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                                         H5Fclose, action_);
}

bool Hdf5Reader::has(const std::string& name) const {
  hdf5::Quiet quiet;
  // A name may be asked for only where the group that it is in is there.
  for (auto end = name.find('/'); end != name.npos; end = name.find('/', end + 1)) {
    if (H5Lexists(*file_, name.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return H5Lexists(*file_, name.c_str(), H5P_DEFAULT) > 0;
}

Hdf5Reader::Dataset Hdf5Reader::open(const std::string& column) const {
  Dataset d{fmt::format("{}: column '{}'", action_, column), {}, {}, 0};
  d.dataset = {H5Dopen2(*file_, column.c_str(), H5P_DEFAULT), H5Dclose, d.action};
  d.space = {H5Dget_space(d.dataset), H5Sclose, d.action};
  if (H5Sget_simple_extent_ndims(d.space) != 1) throw std::runtime_error(d.action + ": no list");
  d.rows = static_cast<hsize_t>(hdf5::check(H5Sget_simple_extent_npoints(d.space), d.action));
  const hsize_t bytes = H5Dget_storage_size(d.dataset);
  if (d.rows / kMostRowsPerByte > bytes)
    throw std::runtime_error(fmt::format("{}: {} rows in {} bytes", d.action, d.rows, bytes));
  return d;
}

std::size_t Hdf5Reader::rows(const std::string& column) const {
  hdf5::Quiet quiet;
  return open(column).rows;
}

std::vector<double> Hdf5Reader::numbers(const std::string& column, std::size_t stride) const {
  hdf5::Quiet quiet;
  const Dataset d = open(column);
  const hsize_t count = (d.rows + stride - 1) / stride;
  std::vector<double> values(count);
  if (count == 0) return values;
  const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, d.action);
  hdf5::check(H5Dread(d.dataset, H5T_NATIVE_DOUBLE, memory, d.select(0, stride, count), H5P_DEFAULT,
                      values.data()),
              d.action);
  return values;
}

std::vector<std::string> Hdf5Reader::texts(const std::string& column) const {
  constexpr hsize_t kBlock = 65536;  // bounds what HDF5 allocates
  hdf5::Quiet quiet;
  const Dataset d = open(column);
  const hid_t type = hdf5::representation(ColumnType::kText).in_memory;
  std::vector<std::string> values;
  values.reserve(d.rows);
  std::vector<char*> block;
  for (hsize_t begin = 0; begin < d.rows; begin += kBlock) {
    const hsize_t count = std::min(kBlock, d.rows - begin);
    block.assign(count, nullptr);
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, d.action);
    hdf5::check(
        H5Dread(d.dataset, type, memory, d.select(begin, 1, count), H5P_DEFAULT, block.data()),
        d.action);
    for (const char* text : block) values.emplace_back(text ? text : "");
    hdf5::check(H5Dvlen_reclaim(type, memory, H5P_DEFAULT, block.data()), d.action);
  }
  return values;
}

std::optional<std::string> Hdf5Reader::text_attribute(const std::string& name) const {
  hdf5::Quiet quiet;
  const std::string action = fmt::format("{}: attribute '{}'", action_, name);
  if (H5Aexists(*file_, name.c_str()) <= 0) return std::nullopt;
  const Handle attribute(H5Aopen(*file_, name.c_str(), H5P_DEFAULT), H5Aclose, action);
  const Handle space(H5Aget_space(attribute), H5Sclose, action);
  if (H5Sget_simple_extent_npoints(space) != 1) throw std::runtime_error(action + ": not one text");
  const hid_t type = hdf5::representation(ColumnType::kText).in_memory;
  char* text = nullptr;
  hdf5::check(H5Aread(attribute, type, &text), action);
  const std::string value = text ? text : "";
  hdf5::check(H5Dvlen_reclaim(type, space, H5P_DEFAULT, &text), action);
  return value;
}

}  // namespace gliss
