#include "gliss/tables/hdf5_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "gliss/files/open_file.h"
#include "gliss/tables/file_seal.h"
#include "gliss/tables/hdf5_types.h"

namespace gliss {

using hdf5::Handle;

namespace {

// Bytes that a column may unpack to: 4.6 hours of a hand at rest, or so many times the whole file.
constexpr std::uint64_t kSmallColumn = 1 << 27, kMostBytesPerByte = 64;
constexpr hsize_t kBlockRows = 1 << 20;

// Called by HDF5 where a path leads out of the file, whose name it keeps; below 0 refuses.
herr_t keep_elsewhere(const char*, const char*, const char* file, const char*, unsigned*, hid_t,
                      void* elsewhere) {
  *static_cast<std::string*>(elsewhere) = file;
  return -1;
}

// Access that follows no link into another file. `elsewhere` must outlive it.
Handle within_file(hid_t kind, std::string& elsewhere) {
  Handle access = hdf5::properties(kind);
  hdf5::check(H5Pset_elink_cb(access, keep_elsewhere, &elsewhere), "cannot set up HDF5");
  return access;
}

void refuse_elsewhere(const std::string& action, const std::string& elsewhere) {
  if (elsewhere.empty()) return;
  throw std::runtime_error(
      fmt::format("{}: it is linked to another file, '{}', which is not read", action, elsewhere));
}

// The type to read texts of a type by, ended or filled by zeros; nothing for what is no text of a
// fixed length (hdf5::text_type).
std::optional<Handle> readable_text(hid_t type, const std::string& action) {
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) return std::nullopt;
  Handle text(H5Tcopy(type), H5Tclose, action);
  hdf5::check(H5Tset_strpad(text, H5T_STR_NULLPAD), action);
  return text;
}

// An attribute that is there, and one value.
std::optional<Handle> open_attribute(hid_t of, const std::string& name, const std::string& action) {
  if (H5Aexists(of, name.c_str()) <= 0) return std::nullopt;
  Handle attribute(H5Aopen(of, name.c_str(), H5P_DEFAULT), H5Aclose, action);
  const Handle space(H5Aget_space(attribute), H5Sclose, action);
  if (H5Sget_simple_extent_npoints(space) != 1)
    throw std::runtime_error(action + ": not one value");
  return attribute;
}

// The text in a place of so many bytes.
std::string text_at(const char* place, std::size_t bytes) {
  return {place, std::find(place, place + bytes, '\0')};
}

}  // namespace

struct Hdf5Reader::Dataset {
  std::string action;
  Handle dataset, space, creation, type;
  hsize_t rows, chunk, block;  // rows; of a chunk, or 1; to read at once: whole chunks

  hid_t select(hsize_t begin, hsize_t stride, hsize_t count) const {
    hdf5::check(H5Sselect_hyperslab(space, H5S_SELECT_SET, &begin, &stride, &count, nullptr),
                action);
    return space;
  }
};

Hdf5Reader::Hdf5Reader(const std::string& path, const std::string& what, Poll poll)
    : action_(fmt::format("cannot read '{}' as {}", path, what)), poll_(std::move(poll)) {
  const OpenFile file(path);
  if (file.descriptor() < 0) throw std::runtime_error(action_ + ": " + file.why());
  file_bytes_ = file.size();
  if (check_seal(path, poll_) == Seal::kBroken)
    throw std::runtime_error(action_ + ": damaged, its checksum differs");
  hdf5::Quiet quiet;
  file_ = std::make_shared<const Handle>(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                                         H5Fclose, action_);
}

bool Hdf5Reader::has(const std::string& name) const {
  hdf5::Quiet quiet;
  std::string elsewhere;
  const Handle access = within_file(H5P_LINK_ACCESS, elsewhere);
  // A name may be asked for only where the group that it is in is there.
  for (std::size_t end = 0; end != name.npos;) {
    end = name.find('/', end + 1);
    const htri_t found = H5Lexists(*file_, name.substr(0, end).c_str(), access);
    refuse_elsewhere(fmt::format("{}: '{}'", action_, name), elsewhere);
    if (found <= 0) return false;
  }
  return true;
}

Hdf5Reader::Dataset Hdf5Reader::open(const std::string& column) const {
  Dataset d{fmt::format("{}: column '{}'", action_, column), {}, {}, {}, {}, 0, 1, 0};
  if (!has(column)) throw std::runtime_error(d.action + ": it is not there");
  std::string elsewhere;
  const Handle access = within_file(H5P_DATASET_ACCESS, elsewhere);
  const hid_t dataset = H5Dopen2(*file_, column.c_str(), access);
  refuse_elsewhere(d.action, elsewhere);
  d.dataset = {dataset, H5Dclose, d.action};
  d.creation = {H5Dget_create_plist(d.dataset), H5Pclose, d.action};
  if (H5Pget_layout(d.creation) == H5D_VIRTUAL || H5Pget_external_count(d.creation) != 0)
    throw std::runtime_error(d.action + ": its numbers are in another file, which is not read");
  d.space = {H5Dget_space(d.dataset), H5Sclose, d.action};
  if (H5Sget_simple_extent_ndims(d.space) != 1) throw std::runtime_error(d.action + ": no list");
  d.rows = static_cast<hsize_t>(hdf5::check(H5Sget_simple_extent_npoints(d.space), d.action));
  check_size(d);
  return d;
}

// Believes a size as far as something is stored.
void Hdf5Reader::check_size(Dataset& d) const {
  d.type = {H5Dget_type(d.dataset), H5Tclose, d.action};
  const hsize_t row_bytes = std::max<hsize_t>(H5Tget_size(d.type), 1);
  hsize_t stored = H5Dget_storage_size(d.dataset) / row_bytes;
  if (H5Pget_layout(d.creation) == H5D_CHUNKED) {
    hdf5::check(H5Pget_chunk(d.creation, 1, &d.chunk), d.action);
    hdf5::check(H5Dget_num_chunks(d.dataset, d.space, &stored), d.action);
    stored *= d.chunk;
  }
  if (d.rows > stored) {
    throw std::runtime_error(
        fmt::format("{}: {} rows, of which {} are stored", d.action, d.rows, stored));
  }
  const std::uint64_t bytes =
      std::max(d.rows * std::max<hsize_t>(row_bytes, sizeof(double)), d.chunk * row_bytes);
  if (bytes > most_bytes()) {
    throw std::runtime_error(fmt::format("{}: {} bytes unpacked, too many for a file of {}",
                                         d.action, bytes, file_bytes_));
  }
  d.block = (kBlockRows + d.chunk - 1) / d.chunk * d.chunk;
}

std::uint64_t Hdf5Reader::most_bytes() const {
  return std::max(kSmallColumn, kMostBytesPerByte * file_bytes_);
}

void Hdf5Reader::poll() const { poll_(); }

std::size_t Hdf5Reader::rows(const std::string& column) const {
  hdf5::Quiet quiet;
  return open(column).rows;
}

std::size_t Hdf5Reader::chunk_rows(const std::string& column) const {
  hdf5::Quiet quiet;
  return open(column).chunk;
}

LargeArray<double> Hdf5Reader::numbers(const std::string& column, std::size_t stride) const {
  hdf5::Quiet quiet;
  const Dataset d = open(column);
  return read(d, 0, d.rows, stride);
}

LargeArray<double> Hdf5Reader::numbers(const std::string& column, std::size_t begin,
                                       std::size_t end) const {
  hdf5::Quiet quiet;
  const Dataset d = open(column);
  if (begin > end || end > d.rows)
    throw std::runtime_error(fmt::format("{}: {} rows, not {}", d.action, d.rows, end));
  return read(d, begin, end, 1);
}

LargeArray<double> Hdf5Reader::read(const Dataset& d, std::uint64_t begin, std::uint64_t end,
                                    std::uint64_t stride) const {
  LargeArray<double> values((end - begin + stride - 1) / stride);
  hsize_t next = 0;
  for (hsize_t done = begin; done < end;) {
    poll();
    // Up to whole chunks.
    done = std::min<hsize_t>(end, (done / d.block + 1) * d.block);
    const hsize_t count = (done - begin + stride - 1) / stride - next;
    if (count == 0) continue;
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, d.action);
    hdf5::check(H5Dread(d.dataset, H5T_NATIVE_DOUBLE, memory,
                        d.select(begin + next * stride, stride, count), H5P_DEFAULT, &values[next]),
                d.action);
    next += count;
  }
  return values;
}

std::vector<std::string> Hdf5Reader::texts(const std::string& column) const {
  hdf5::Quiet quiet;
  const Dataset d = open(column);
  const auto type = readable_text(d.type, d.action);
  if (!type) throw std::runtime_error(d.action + ": its rows are not texts of a fixed length");
  const std::size_t bytes = H5Tget_size(*type);
  std::vector<std::string> values;
  values.reserve(d.rows);
  std::string block;
  for (hsize_t begin = 0; begin < d.rows; begin += d.block) {
    poll();
    const hsize_t count = std::min(d.block, d.rows - begin);
    block.resize(count * bytes);
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, d.action);
    hdf5::check(
        H5Dread(d.dataset, *type, memory, d.select(begin, 1, count), H5P_DEFAULT, block.data()),
        d.action);
    for (hsize_t row = 0; row < count; ++row) values.push_back(text_at(&block[row * bytes], bytes));
  }
  return values;
}

std::optional<std::string> Hdf5Reader::text_attribute(const std::string& name) const {
  return text_attribute(*file_, name);
}

std::optional<double> Hdf5Reader::number_attribute(const std::string& name) const {
  hdf5::Quiet quiet;
  const std::string action = fmt::format("{}: attribute '{}'", action_, name);
  const auto attribute = open_attribute(*file_, name, action);
  if (!attribute) return std::nullopt;
  const Handle in_file(H5Aget_type(*attribute), H5Tclose, action);
  const H5T_class_t kind = H5Tget_class(in_file);
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) return std::nullopt;
  double value = 0;
  hdf5::check(H5Aread(*attribute, H5T_NATIVE_DOUBLE, &value), action);
  return value;
}

std::optional<std::string> Hdf5Reader::unit(const std::string& column) const {
  hdf5::Quiet quiet;
  return text_attribute(open(column).dataset, "unit");
}

std::optional<std::string> Hdf5Reader::text_attribute(const Handle& of,
                                                      const std::string& name) const {
  hdf5::Quiet quiet;
  const std::string action = fmt::format("{}: attribute '{}'", action_, name);
  const auto attribute = open_attribute(of, name, action);
  if (!attribute) return std::nullopt;
  const Handle in_file(H5Aget_type(*attribute), H5Tclose, action);
  const auto type = readable_text(in_file, action);
  if (!type) return std::nullopt;
  std::string value(H5Tget_size(*type), '\0');
  if (value.size() > most_bytes()) throw std::runtime_error(action + ": too long");
  hdf5::check(H5Aread(*attribute, *type, value.data()), action);
  return text_at(value.data(), value.size());
}

}  // namespace gliss
