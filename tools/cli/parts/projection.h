// The HIPs of a file, projected part by part.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gliss/base/pace.h"
#include "gliss/engine/engine.h"
#include "gliss/sweep/part_folder.h"
#include "gliss/tables/point_table.h"
#include "gliss/tables/table_columns.h"

namespace gliss::tools {

struct ProjectionOptions {
  QueryOptions query;
  std::optional<double> stiffness;  // N/m, of forces that are found as well
  double unit = 1;                  // m, of lengths in the result
  std::vector<std::string> keep;    // columns of the input, which it has
};

// Rows are made of it: the contacts of HIPs that begin with this one of a table.
struct ProjectedHips {
  std::span<const Contact> contacts;
  const InputTable& table;
  std::size_t begin;

  const Contact& operator[](std::size_t i) const { return contacts[i]; }
};

struct ProjectedPart {
  explicit ProjectedPart(const Columns& columns) : rows(columns) {}
  std::size_t number = 0, begin = 0, end = 0;  // of rows
  TableRows rows;                              // from `begin` on
  std::uint64_t inside = 0, unconverged = 0;   // of these
};

// For one thread, which alone reads the HIPs. All that it is made of outlives it.
class Projection {
 public:
  // A power of two: blocks of results are as they were before there were parts.
  static constexpr std::size_t kPartRows = 1 << 17;
  // Gets parts in the order of their source, from a thread while the next part is computed; no HIPs
  // are read meanwhile, for HDF5 is for one thread at a time.
  using Sink = std::function<void(const ProjectedPart&)>;

  Projection(const ProjectionOptions& options, const PatchCache& cache, const Engine& engine,
             PointReader& hips);

  const Columns& columns() const { return columns_.columns(); }  // of the result
  std::size_t part_count() const { return (hips_.rows() + kPartRows - 1) / kPartRows; }
  // Calls each(HIPs) for all rows, some at a time.
  void for_each_part(const std::function<void(const PointTable&)>& each);

  // Does the parts that `source` names, but takes those that are in `folder` (null: none) from
  // there, unless a few contacts that are done again differ, and keeps the others there; of the
  // last part of all only where it `keeps_last`. Gives all of them to `sink`, if there is one.
  // Returns how many contacts it computed.
  std::uint64_t run(const PartSource& source, PartFolder* folder, bool keeps_last,
                    const PartProgress& progress, const Sink& sink = nullptr);

 private:
  struct Part : ProjectedPart {
    using ProjectedPart::ProjectedPart;
    PointTable hips;  // none of a part that was there
  };

  std::unique_ptr<Part> fetch(const PartSource& source, PartFolder* folder);
  bool load(ProjectedPart& part, const PartFile& file);
  bool holds(const ProjectedPart& part);
  void save(const ProjectedPart& part, PartFolder& folder) const;
  void compute(Part& part, const PartProgress& progress);
  void place(PointTable& hips) const;
  void add(const PointTable& hips, std::size_t begin, const std::vector<Contact>& found,
           ProjectedPart& part) const;

  const ProjectionOptions& options_;
  const PatchCache& cache_;
  const Engine& engine_;
  PointReader& hips_;
  const TableColumns<ProjectedHips> columns_;
  const std::unique_ptr<ResidentSurface> surface_;
  Pace pace_;
};

}  // namespace gliss::tools
