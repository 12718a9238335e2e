#include "host/patch_cache.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "host/hierarchy.h"
#include "host/kernels.h"
#include "host/patch_draft.h"
#include "host/topology.h"

namespace gliss {
namespace {

// Faces that are built share nothing, so that they may be drafted in any order.
constexpr std::size_t kGrain = 64;

// Everything of a build that outlives a step.
class CacheBuilder {
 public:
  CacheBuilder(const Mesh& mesh, const Topology& topology, const BuildOptions& options,
               const ParallelFor& parallel, bool base_only = false)
      : mesh_(mesh),
        topology_(topology),
        options_(options),
        parallel_(parallel),
        base_only_(base_only) {}

  PatchCache build(BuildReport* report) {
    set_frame();
    drafted_.resize(faces_.size());
    if (!base_only_) draft_faces(report);
    lay_out();
    if (options_.precision == Precision::kFloat) {
      cache_.surface.emplace<0>();
      fill(std::get<0>(cache_.surface));
    } else {
      cache_.surface.emplace<1>();
      fill(std::get<1>(cache_.surface));
    }
    return std::move(cache_);
  }

 private:
  struct Drafted {
    PatchShape shape;               // of the exact patch
    std::vector<PatchDraft> tamer;  // empty: the exact patch
    bool folded = false, degenerate = false;
  };

  void set_frame() {
    Box box{mesh_.positions[mesh_.corner_vertex[0]], mesh_.positions[mesh_.corner_vertex[0]]};
    for (const std::uint32_t v : mesh_.corner_vertex) {
      box.low = box.low.cwiseMin(mesh_.positions[v]);
      box.high = box.high.cwiseMax(mesh_.positions[v]);
    }
    cache_.unit = mesh_.unit;
    cache_.origin = box.low + 0.5 * (box.high - box.low);
    int exponent = 0;
    std::frexp(0.5 * (box.high - box.low).maxCoeff(), &exponent);
    cache_.scale = std::ldexp(1.0, -exponent);
    cache_.mesh_face_count = static_cast<std::uint32_t>(mesh_.face_count());
    cache_.mesh_hash = hash_of(mesh_);
    cache_.face_valence.resize(mesh_.face_count());
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) cache_.face_valence[f] = mesh_.valence(f);
    faces_ = options_.faces;
    if (faces_.empty()) {
      faces_.resize(mesh_.face_count());
      for (std::size_t f = 0; f < faces_.size(); ++f) faces_[f] = static_cast<std::uint32_t>(f);
    }
  }

  FaceCorners corners_of(std::uint32_t face) const {
    FaceCorners c;
    for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
      c.position.push_back((mesh_.positions[mesh_.corner_vertex[s]] - cache_.origin) *
                           cache_.scale);
      c.normal.push_back(mesh_.normals[mesh_.corner_normal[s]].normalized());
    }
    return c;
  }

  void draft_faces(BuildReport* report) {
    parallel_(faces_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FaceCorners corners = corners_of(faces_[i]);
        PatchDraft exact = draft_exact(corners);
        exact.shape = examine(exact);
        Drafted& d = drafted_[i];
        d.shape = exact.shape;
        d.degenerate = is_degenerate(exact);
        d.folded = is_folded(exact);
        if ((d.folded || d.degenerate) && options_.tame)
          d.tamer = draft_tamer(corners, std::move(exact));
      }
    });
    if (report == nullptr) return;
    *report = {};
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const Drafted& d = drafted_[i];
      if (!d.folded && !d.degenerate) continue;
      report->flagged_faces.push_back(faces_[i]);
      report->folded += d.folded;
      report->degenerate += d.degenerate;
      if (d.tamer.empty()) continue;
      const bool bent = std::any_of(d.tamer.begin(), d.tamer.end(),
                                    [](const PatchDraft& p) { return p.kind == PatchKind::kBent; });
      ++(bent ? report->bent : d.tamer.size() > 1 ? report->split : report->eased);
    }
  }

  // Which patch is where, and which sides meet.
  void lay_out() {
    cache_.face_patch.assign(mesh_.face_count(), kNone);
    side_begin_.push_back(0);
    std::vector<std::uint32_t> patch_side(mesh_.corner_vertex.size(), kNone);  // [mesh side]
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const std::uint32_t face = faces_[i], first = mesh_.face_begin[face], n = mesh_.valence(face);
      const Drafted& d = drafted_[i];
      cache_.face_patch[face] = static_cast<std::uint32_t>(cache_.patch_face.size());
      for (std::size_t t = 0; t < std::max<std::size_t>(d.tamer.size(), 1); ++t) {
        const PatchDraft* draft = d.tamer.empty() ? nullptr : &d.tamer[t];
        const std::size_t valence = draft == nullptr ? n : draft->face_corner.size();
        for (std::size_t k = 0; k < valence; ++k) {
          const auto corner = [&](std::size_t j) {
            return draft == nullptr ? static_cast<std::uint32_t>(j % n)
                                    : draft->face_corner[j % valence];
          };
          const auto side = static_cast<std::uint32_t>(cache_.corner_of_face.size());
          if (corner(k) < n && corner(k + 1) == (corner(k) + 1) % n)
            patch_side[first + corner(k)] = side;
          cache_.corner_of_face.push_back(corner(k));
        }
        side_begin_.push_back(static_cast<std::uint32_t>(cache_.corner_of_face.size()));
        cache_.patch_face.push_back(face);
        cache_.kind.push_back(draft == nullptr ? PatchKind::kExact : draft->kind);
        cache_.folded.push_back(d.folded || d.degenerate);
      }
    }
    side_twin_.assign(cache_.corner_of_face.size(), kNone);
    for (std::size_t s = 0; s < patch_side.size(); ++s) {
      const std::uint32_t twin = topology_.side_twin[s];
      if (patch_side[s] != kNone && twin != kNone) side_twin_[patch_side[s]] = patch_side[twin];
    }
    join_diagonals();
  }

  // The sides that the triangles of one face share.
  void join_diagonals() {
    for (std::uint32_t p = 0; p < cache_.patch_count(); ++p) {
      for (std::uint32_t q = p + 1;
           q < cache_.patch_count() && cache_.patch_face[q] == cache_.patch_face[p]; ++q) {
        for (std::uint32_t a = side_begin_[p]; a < side_begin_[p + 1]; ++a) {
          for (std::uint32_t b = side_begin_[q]; b < side_begin_[q + 1]; ++b) {
            const auto end = [&](std::uint32_t s, std::uint32_t patch) {
              return cache_
                  .corner_of_face[s + 1 == side_begin_[patch + 1] ? side_begin_[patch] : s + 1];
            };
            if (cache_.corner_of_face[a] != end(b, q) || cache_.corner_of_face[b] != end(a, p))
              continue;
            side_twin_[a] = b;
            side_twin_[b] = a;
          }
        }
      }
    }
  }

  template <class Real>
  void fill(Surface<Real>& s) {
    const std::size_t sides = side_twin_.size(), patches = cache_.patch_count();
    s.side_begin = std::move(side_begin_);
    s.side_twin = std::move(side_twin_);
    s.side_patch.resize(sides);
    for (std::uint32_t p = 0; p < patches; ++p) {
      for (std::uint32_t side = s.side_begin[p]; side < s.side_begin[p + 1]; ++side)
        s.side_patch[side] = p;
    }
    if (!base_only_) s.control.resize(sides * kSideReals);
    s.corner.resize(sides * 6);
    s.patch.resize(patches * kPatchReals);
    s.triangle.resize(3 * (sides - 2 * patches));
    cache_.rho_min.resize(patches);
    fill_domain(s);
    std::vector<Box> boxes(patches);
    parallel_(faces_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t first = cache_.face_patch[faces_[i]];
        std::vector<PatchDraft>& tamer = drafted_[i].tamer;
        if (tamer.empty()) {
          PatchDraft exact = draft_exact(corners_of(faces_[i]));
          exact.shape = base_only_ ? base_shape(exact) : drafted_[i].shape;
          store(exact, first, s, boxes);
        } else {
          for (std::size_t t = 0; t < tamer.size(); ++t)
            store(tamer[t], first + static_cast<std::uint32_t>(t), s, boxes);
        }
      }
    });
    build_hierarchy(boxes, s.node, s.child, parallel_);
  }

  template <class Real>
  void fill_domain(Surface<Real>& s) {
    const auto most = *std::max_element(cache_.face_valence.begin(), cache_.face_valence.end());
    s.domain_begin.assign(most + 1, 0);
    std::vector<char> used(most + 1, 0);
    for (std::uint32_t p = 0; p < s.patch_count(); ++p) used[s.valence(p)] = 1;
    // Splits ask for the domain of their whole face too.
    for (const std::uint32_t f : faces_) used[cache_.face_valence[f]] = 1;
    for (std::uint32_t n = 3; n <= most; ++n) {
      if (!used[n]) continue;
      s.domain_begin[n] = static_cast<std::uint32_t>(s.domain.size());
      s.domain.resize(s.domain.size() + kernels<Real>().domain_reals(n));
      kernels<Real>().fill_domain(n, &s.domain[s.domain_begin[n]]);
    }
  }

  template <class Real>
  void store(const PatchDraft& d, std::uint32_t patch, Surface<Real>& s, std::vector<Box>& boxes) {
    const auto narrow = [](const std::vector<double>& from, Real* to) {
      for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<Real>(from[i]);
    };
    const std::size_t first = s.side_begin[patch];
    if (!base_only_) narrow(d.control, &s.control[first * kSideReals]);
    narrow(d.corner, &s.corner[first * 6]);
    std::copy(d.triangle.begin(), d.triangle.end(),
              s.triangle.begin() + static_cast<std::ptrdiff_t>(3 * (first - 2 * patch)));
    Real* numbers = &s.patch[patch * kPatchReals];
    const auto put = [&](std::size_t at, const Vec3& v) {
      for (int i = 0; i < 3; ++i)
        numbers[at + static_cast<std::size_t>(i)] = static_cast<Real>(v[i]);
    };
    put(kPatchOrigin, d.origin);
    put(kPatchNormal, d.normal);
    put(kPatchTangent, d.tangent);
    put(kPatchLow, d.shape.low);
    put(kPatchHigh, d.shape.high);
    put(kPatchBend, d.shape.bend);
    numbers[kPatchScale] = static_cast<Real>(d.scale);
    numbers[kPatchUnscale] = static_cast<Real>(1 / d.scale);
    numbers[kPatchSag] = static_cast<Real>(d.shape.sag);
    // Flat patches have no end of it; what matters is how it compares with distances.
    numbers[kPatchRho] = static_cast<Real>(std::min(d.shape.rho_min, 1e30));
    boxes[patch] = {d.origin + d.shape.box.low / d.scale, d.origin + d.shape.box.high / d.scale};
    cache_.rho_min[patch] =
        std::min(d.shape.rho_min / (d.scale * cache_.scale), std::numeric_limits<double>::max());
  }

  const Mesh& mesh_;
  const Topology& topology_;
  const BuildOptions& options_;
  const ParallelFor& parallel_;
  const bool base_only_;
  PatchCache cache_;
  std::vector<std::uint32_t> faces_;
  std::vector<Drafted> drafted_;           // [faces_]
  std::vector<std::uint32_t> side_begin_;  // [patch + 1]
  std::vector<std::uint32_t> side_twin_;   // [side]
};

}  // namespace

void serial_for(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) {
  for (std::size_t begin = 0; begin < count; begin += grain)
    body(begin, std::min(count, begin + grain));
}

PatchCache build_cache(const Mesh& mesh, const Topology& topology, const BuildOptions& options,
                       BuildReport* report, const ParallelFor& parallel) {
  if (mesh.face_count() == 0) throw MeshError(mesh.source + ": no faces to build");
  for (const std::uint32_t f : options.faces) {
    if (f >= mesh.face_count()) {
      throw MeshError(mesh.source + ": face " + std::to_string(f) + " is out of range (" +
                      std::to_string(mesh.face_count()) + " faces)");
    }
  }
  if (std::adjacent_find(options.faces.begin(), options.faces.end(), std::greater_equal<>()) !=
      options.faces.end()) {
    throw MeshError(mesh.source + ": the faces to build must be ascending, each once");
  }
  return CacheBuilder(mesh, topology, options, parallel).build(report);
}

PatchCache build_base(const Mesh& mesh, const Topology& topology, Precision precision) {
  BuildOptions options;
  options.precision = precision;
  const ParallelFor serial = serial_for;
  return CacheBuilder(mesh, topology, options, serial, true).build(nullptr);
}

PatchCache build_cache(const Mesh& mesh, const BuildOptions& options, BuildReport* report,
                       const ParallelFor& parallel) {
  if (!mesh.normals.empty())
    return build_cache(mesh, build_topology(mesh), options, report, parallel);
  Mesh with_normals = mesh;
  add_vertex_normals(with_normals);
  PatchCache cache =
      build_cache(with_normals, build_topology(with_normals), options, report, parallel);
  cache.mesh_hash = hash_of(mesh);
  return cache;
}

std::vector<std::uint32_t> faces_in_box(const Mesh& mesh, const Box& box) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    Box face{Vec3::Constant(std::numeric_limits<double>::infinity()),
             Vec3::Constant(-std::numeric_limits<double>::infinity())};
    for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s) {
      face.low = face.low.cwiseMin(mesh.positions[mesh.corner_vertex[s]]);
      face.high = face.high.cwiseMax(mesh.positions[mesh.corner_vertex[s]]);
    }
    if ((face.low.array() <= box.high.array()).all() &&
        (face.high.array() >= box.low.array()).all())
      faces.push_back(f);
  }
  return faces;
}

std::vector<std::uint32_t> faces_around(const Mesh& mesh, const Topology& topology,
                                        std::uint32_t face, int rings) {
  std::vector<std::uint32_t> found{face}, front{face};
  std::vector<char> seen(mesh.face_count(), 0);
  seen[face] = 1;
  for (int r = 0; r < rings; ++r) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t f : front) {
      for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s) {
        const std::uint32_t twin = topology.side_twin[s];
        if (twin == kNone || seen[topology.side_face[twin]]) continue;
        seen[topology.side_face[twin]] = 1;
        next.push_back(topology.side_face[twin]);
      }
    }
    found.insert(found.end(), next.begin(), next.end());
    front = std::move(next);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::uint64_t hash_of(const Mesh& mesh) {
  XXH64_hash_t hash = XXH3_64bits(&mesh.unit, sizeof(mesh.unit));
  const auto add = [&](const auto& v) {
    if (!v.empty()) hash = XXH3_64bits_withSeed(v.data(), v.size() * sizeof(v[0]), hash);
  };
  add(mesh.positions);
  add(mesh.normals);
  add(mesh.face_begin);
  add(mesh.corner_vertex);
  add(mesh.corner_normal);
  return hash;
}

double PatchCache::smallest_rho() const {
  return *std::min_element(rho_min.begin(), rho_min.end());
}

Box PatchCache::bounds() const {
  return std::visit(
      [&](const auto& s) {
        Box box{Vec3::Constant(std::numeric_limits<double>::infinity()),
                Vec3::Constant(-std::numeric_limits<double>::infinity())};
        for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
          const auto* numbers = &s.patch[p * kPatchReals];
          const Vec3 at(numbers[0], numbers[1], numbers[2]);
          for (std::uint32_t side = s.side_begin[p]; side < s.side_begin[p + 1]; ++side) {
            const auto* c = &s.corner[6 * side];
            const Vec3 x =
                origin +
                (at + Vec3(c[0], c[1], c[2]) * static_cast<double>(numbers[kPatchUnscale])) / scale;
            box.low = box.low.cwiseMin(x);
            box.high = box.high.cwiseMax(x);
          }
        }
        return box;
      },
      surface);
}

std::size_t PatchCache::bytes() const {
  const auto size = [](const auto& v) { return v.size() * sizeof(v[0]); };
  return std::visit(
      [&](const auto& s) {
        return size(s.domain) + size(s.domain_begin) + size(s.side_begin) + size(s.side_patch) +
               size(s.side_twin) + size(s.control) + size(s.corner) + size(s.patch) +
               size(s.triangle) + size(s.node) + size(s.child) + size(patch_face) +
               size(face_patch) + size(kind) + size(folded) + size(rho_min) + size(corner_of_face) +
               size(face_valence);
      },
      surface);
}

}  // namespace gliss
