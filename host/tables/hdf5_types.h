// The types that columns and attributes of results have in HDF5.
#pragma once

#include "gliss/tables/hdf5_handle.h"
#include "gliss/tables/result_file.h"

namespace gliss::hdf5 {

struct Representation {
  hid_t in_file;    // little-endian everywhere: the same results are the same bytes
  hid_t in_memory;  // this machine's
  bool compressed;  // whether shuffle and deflate pay
};
Representation representation(ColumnType type);

// Text of up to `bytes` bytes, UTF-8. Never of variable length: HDF5 1.10 reads that through a heap
// that it does not check, and a damaged one makes it hang or write past its memory.
Handle text_type(std::size_t bytes);

Handle properties(hid_t kind);

// Writes it to a file's root, a group or a dataset, and replaces one of the same name. A text that
// is too long for an attribute is cut to 32 KiB.
void write_attribute(hid_t object, const Attribute& attribute, const std::string& action);

}  // namespace gliss::hdf5
