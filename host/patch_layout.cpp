#include "host/patch_layout.h"

#include <algorithm>

namespace gliss {
namespace {

// The sides that the triangles of one face share.
void join_diagonals(const PatchCache& cache, PatchLayout& l) {
  for (std::uint32_t p = 0; p < cache.patch_count(); ++p) {
    for (std::uint32_t q = p + 1;
         q < cache.patch_count() && cache.patch_face[q] == cache.patch_face[p]; ++q) {
      for (std::uint32_t a = l.side_begin[p]; a < l.side_begin[p + 1]; ++a) {
        for (std::uint32_t b = l.side_begin[q]; b < l.side_begin[q + 1]; ++b) {
          const auto end = [&](std::uint32_t s, std::uint32_t patch) {
            return cache
                .corner_of_face[s + 1 == l.side_begin[patch + 1] ? l.side_begin[patch] : s + 1];
          };
          if (cache.corner_of_face[a] != end(b, q) || cache.corner_of_face[b] != end(a, p))
            continue;
          l.side_twin[a] = b;
          l.side_twin[b] = a;
        }
      }
    }
  }
}

}  // namespace

PatchLayout lay_out(const Mesh& mesh, const Topology& topology,
                    const std::vector<std::uint32_t>& faces,
                    const std::vector<DraftedFace>& drafted, PatchCache& cache) {
  PatchLayout l;
  cache.face_patch.assign(mesh.face_count(), kNone);
  std::vector<std::uint32_t> patch_side(mesh.corner_vertex.size(), kNone);  // [mesh side]
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t face = faces[i], first = mesh.face_begin[face], n = mesh.valence(face);
    const DraftedFace& d = drafted[i];
    cache.face_patch[face] = static_cast<std::uint32_t>(cache.patch_face.size());
    for (std::size_t t = 0; t < std::max<std::size_t>(d.tamer.size(), 1); ++t) {
      const PatchDraft* draft = d.tamer.empty() ? nullptr : &d.tamer[t];
      const std::size_t valence = draft == nullptr ? n : draft->face_corner.size();
      for (std::size_t k = 0; k < valence; ++k) {
        const auto corner = [&](std::size_t j) {
          return draft == nullptr ? static_cast<std::uint32_t>(j % n)
                                  : draft->face_corner[j % valence];
        };
        const auto side = static_cast<std::uint32_t>(cache.corner_of_face.size());
        if (corner(k) < n && corner(k + 1) == (corner(k) + 1) % n)
          patch_side[first + corner(k)] = side;
        cache.corner_of_face.push_back(corner(k));
      }
      l.side_begin.push_back(static_cast<std::uint32_t>(cache.corner_of_face.size()));
      cache.patch_face.push_back(face);
      cache.kind.push_back(draft == nullptr ? PatchKind::kExact : draft->kind);
      cache.folded.push_back(d.flagged());
    }
  }
  l.side_twin.assign(cache.corner_of_face.size(), kNone);
  for (std::size_t s = 0; s < patch_side.size(); ++s) {
    const std::uint32_t twin = topology.side_twin[s];
    if (patch_side[s] != kNone && twin != kNone) l.side_twin[patch_side[s]] = patch_side[twin];
  }
  join_diagonals(cache, l);
  return l;
}

}  // namespace gliss
