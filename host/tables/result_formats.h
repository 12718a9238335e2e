// The formats behind create_result_file, and the contract that they share.
#pragma once

#include "gliss/tables/result_file.h"

namespace gliss {

std::unique_ptr<ResultFile> create_hdf5_file(const std::string& path);
std::unique_ptr<ResultFile> create_csv_file(const std::string& path);
std::unique_ptr<ResultFile> create_npy_file(const std::string& path);

// Rows of a block that fits the columns in number, types and lengths; throws std::logic_error
// otherwise.
std::size_t block_rows(const std::vector<Column>& columns, std::span<const ColumnData> block);

}  // namespace gliss
