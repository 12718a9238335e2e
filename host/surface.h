// The arrays that the kernels read (kernels/view.h), in one precision.
#pragma once

#include <cstdint>
#include <vector>

namespace gliss {

template <class Real>
struct Surface {
  std::vector<Real> domain;                  // tables of the valences in use
  std::vector<std::uint32_t> domain_begin;   // [valence]
  std::vector<std::uint32_t> side_begin;     // [patch + 1]
  std::vector<std::uint32_t> side_patch;     // [side]
  std::vector<std::uint32_t> side_twin;      // [side], kNone: border
  std::vector<Real> control;                 // of all patches, by their forms
  std::vector<std::uint32_t> control_begin;  // [patch], where its own begins, in triples
  std::vector<std::uint32_t> form;           // [patch], kForm...; of a table with r << 8
  std::vector<Real> corner;                  // [side][2][3]
  std::vector<Real> patch;                   // [patch][patch_reals]
  std::vector<std::uint32_t> triangle;       // [side_begin[p] - 2 p][3]
  std::vector<Real> node;                    // [node][2][6]
  std::vector<std::uint32_t> child;          // [node][2]

  std::uint32_t patch_count() const { return static_cast<std::uint32_t>(side_begin.size()) - 1; }
  std::uint32_t valence(std::uint32_t patch) const {
    return side_begin[patch + 1] - side_begin[patch];
  }
};

}  // namespace gliss
