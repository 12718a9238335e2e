#include "gliss/build/patch_layout.h"

#include <algorithm>

namespace gliss {
namespace {

// The sides that the triangles of one face share.
void join_diagonals(const PatchCache& cache, PatchLayout& l) {
  for (std::uint32_t p = 0; p < cache.patch_count(); ++p) {
    for (std::uint32_t q = p + 1, end = cache.end_of_face(p); q < end; ++q) {
      for (std::uint32_t a = l.side_begin[p]; a < l.side_begin[p + 1]; ++a) {
        for (std::uint32_t b = l.side_begin[q]; b < l.side_begin[q + 1]; ++b) {
          const auto end_of = [&](std::uint32_t s, std::uint32_t patch) {
            return cache.corner_of_face[next_side(l.side_begin, patch, s)];
          };
          if (cache.corner_of_face[a] != end_of(b, q) || cache.corner_of_face[b] != end_of(a, p))
            continue;
          l.side_twin[a] = b;
          l.side_twin[b] = a;
        }
      }
    }
  }
}

// The side of a patch that is a side of the mesh; kNone: not built. A side of a split face is found
// among its triangles.
std::uint32_t patch_side(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                         const PatchLayout& l, std::uint32_t mesh_side) {
  const std::uint32_t face = topology.side_face[mesh_side], n = mesh.valence(face),
                      k = mesh_side - mesh.face_begin[face];
  const std::uint32_t first = cache.first_patch(face), end_of_face = cache.end_of_face(first);
  for (std::uint32_t p = first; p < end_of_face; ++p) {
    const std::uint32_t begin = l.side_begin[p], end = l.side_begin[p + 1];
    const auto is_it = [&](std::uint32_t s) {
      return cache.corner_of_face[s] == k &&
             cache.corner_of_face[next_side(l.side_begin, p, s)] == (k + 1) % n;
    };
    if (begin + k < end && is_it(begin + k)) return begin + k;
    for (std::uint32_t s = begin; s < end; ++s) {
      if (is_it(s)) return s;
    }
  }
  return kNone;
}

}  // namespace

void number_patches(const Mesh& mesh, std::span<const std::uint32_t> faces,
                    std::span<const DraftedFace> drafted, PatchCache& cache, PatchLayout& l) {
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t face = faces[i], n = mesh.valence(face);
    const DraftedFace& d = drafted[i];
    if (!cache.face_patch.empty()) cache.face_patch[face] = cache.patch_count();
    for (std::size_t t = 0; t < std::max<std::size_t>(d.tamer.size(), 1); ++t) {
      const PatchDraft* draft = d.tamer.empty() ? nullptr : &d.tamer[t];
      const std::size_t valence = draft == nullptr ? n : draft->face_corner.size();
      for (std::size_t k = 0; k < valence; ++k)
        cache.corner_of_face.push_back(draft == nullptr ? static_cast<std::uint32_t>(k)
                                                        : draft->face_corner[k]);
      l.side_begin.push_back(static_cast<std::uint32_t>(cache.corner_of_face.size()));
      cache.patch_face.push_back(face);
      cache.kind.push_back(draft == nullptr ? PatchKind::kPlain : draft->kind);
      cache.folded.push_back(d.flagged());
    }
  }
}

void join_sides(const Mesh& mesh, const Topology& topology, std::span<const std::uint32_t> faces,
                const PatchCache& cache, PatchLayout& l) {
  l.side_twin.assign(cache.corner_of_face.size(), kNone);
  for (const std::uint32_t face : faces) {
    for (std::uint32_t s = mesh.face_begin[face]; s < mesh.face_begin[face + 1]; ++s) {
      const std::uint32_t side = patch_side(mesh, topology, cache, l, s),
                          twin = topology.side_twin[s];
      if (side != kNone && twin != kNone)
        l.side_twin[side] = patch_side(mesh, topology, cache, l, twin);
    }
  }
  join_diagonals(cache, l);
}

}  // namespace gliss
