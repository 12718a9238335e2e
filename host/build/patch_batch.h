// The exact patches of many faces as flat arrays, for a backend to build and examine at once.
// Private to host/.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/build/build_backend.h"
#include "gliss/build/tile_cuts.h"

namespace gliss {

// Tables that patches of one valence share.
struct ValenceTables {
  std::vector<double> domain;               // tables of the valences in use
  std::vector<double> probe;                // points where patches are examined
  std::vector<std::uint32_t> domain_begin;  // [valence]
  std::vector<std::uint32_t> probe_begin;   // [valence], xi of all and then eta of all
  std::vector<std::uint32_t> probe_count;  // [valence], points; rows are longer (kernels/examine.h)
  std::vector<std::vector<TileCut>> cuts;  // [valence], of few sides
  // For second derivatives (kernels/second.h), of fair patches and of those that blend sides:
  // [valence][2], where they begin.
  std::vector<double> second;
  std::vector<std::uint32_t> second_begin;

  const double* domain_of(std::uint32_t n) const { return &domain[domain_begin[n]]; }
  const double* probes_of(std::uint32_t n) const { return &probe[probe_begin[n]]; }
  // Null: a form whose curvature is found by differences.
  const double* second_of(std::uint32_t form, std::uint32_t n) const;
};

// `used`: [valence], 1 where tables are wanted.
GLISS_EXPORT ValenceTables make_valence_tables(std::span<const char> used);

// Gives tables that are kept for the process, since they take longer than a small build, perhaps
// with those of more valences. Polygons of very many sides have them made anew. Any thread may ask.
std::shared_ptr<const ValenceTables> shared_valence_tables(std::span<const char> used);

// Patches before `to_build` are the paper's, whose control data a backend computes from their
// corners; the others come drafted.
struct GLISS_EXPORT PatchBatch {
  const ValenceTables* tables = nullptr;
  std::size_t to_build = 0;
  std::vector<std::uint32_t> side_begin{0};     // [patch + 1]
  std::vector<std::uint32_t> control_begin{0};  // [patch + 1]
  std::vector<std::uint32_t> form;              // [patch]
  std::vector<double> corner;                   // [side][2][3]: position (local frame), unit normal
  std::vector<std::uint32_t> triangle;          // [side_begin[p] - 2 p][3]
  std::vector<double> frame;  // [patch][kFrameReals]: unit normal, tangent of the base polygon
  std::vector<double> inward_share;  // [patch], as PatchDraft has it
  // Computed by a backend, the first two up to `to_build`:
  std::vector<double> control;    // [control_begin[patch]], in its form
  std::vector<double> soundness;  // [patch], of its weakest ribbon
  // [patch][kShapeReals]; empty: a backend may leave them to the build, which samples patches
  // anyway. With them the samples, [sample_begin[patch]], rows as PatchSamples has them.
  std::vector<double> shape, sample;
  std::vector<std::uint32_t> sample_begin{0};  // [patch + 1]

  std::size_t size() const { return side_begin.size() - 1; }
  std::uint32_t valence(std::size_t patch) const {
    return side_begin[patch + 1] - side_begin[patch];
  }
  std::size_t first_triangle(std::size_t patch) const { return side_begin[patch] - 2 * patch; }
  // Makes room in all arrays for patches of these valences and forms; their content is what it was.
  void resize(std::span<const std::uint32_t> valences, std::span<const std::uint32_t> forms);
};

}  // namespace gliss
