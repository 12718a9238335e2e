// From a mesh to its cache, a chunk of faces at a time.
#include "gliss/build/build_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/build/fair_sides.h"
#include "gliss/build/hierarchy.h"
#include "gliss/build/mesh_frame.h"
#include "gliss/build/parts.h"
#include "gliss/build/patch_layout.h"
#include "gliss/build/patch_tame.h"
#include "gliss/build/patch_tiles.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

// Faces that are built share nothing, so that they may be drafted in any order.
constexpr std::size_t kGrain = 64;

// faces_[first] to faces_[first + count - 1]. What the paper's construction makes of them is a
// batch; the others have drafts of their own.
struct Chunk {
  std::size_t first = 0, count = 0;
  PatchBatch batch;
  std::vector<PatchFrame> frame;        // [patch of the batch]
  std::vector<std::uint32_t> in_batch;  // [face of the chunk], its patch there; kNone: none
};

// A patch as it goes into the cache.
struct FinishedPatch {
  std::uint32_t valence;
  PatchKind kind;
  const PatchFrame* frame;
  PatchShape shape;
  const double *corner, *drafted;  // control data as drafted, in a form that another may replace
  const std::uint32_t* triangle;
  std::uint32_t form = kFormPaper;
  std::vector<double> control{};  // in another form; empty: as drafted
  PatchTiles tiles{};

  const double* reals() const { return control.empty() ? drafted : control.data(); }
  std::size_t real_count() const { return kernels<double>().control_reals(form, valence); }
};

// Lists the forms that a patch may have at a level. It takes the first in which it does not fold,
// else it stays as it was drafted.
std::vector<std::uint32_t> forms_of(const Level& level, const FinishedPatch& patch) {
  if (level.kind == Level::kTable) return {kFormTable | level.cells << 8};
  // Bent patches do not have the cross tangents that the other forms are made from.
  if (patch.form != kFormPaper || patch.kind == PatchKind::kBent) return {};
  std::vector<std::uint32_t> forms;
  if (patch.valence <= 4 && level.kind == Level::kBezier) forms.push_back(kFormBezier);
  if (level.kind != Level::kExact) forms.push_back(kFormRibbon);
  return forms;
}

PatchShape base_shape(const PatchBatch& b, std::size_t p) {
  double reals[kShapeReals];
  kernels<double>().examine(nullptr, nullptr, 0, nullptr, kFormPaper,
                            &b.corner[b.side_begin[p] * 6], &b.triangle[3 * b.first_triangle(p)],
                            &b.frame[p * kFrameReals], b.valence(p), reals);
  return shape_from(reals, b.valence(p));
}

// Everything of a build that outlives a step.
class CacheBuilder {
 public:
  CacheBuilder(const Mesh& mesh, const Topology& topology, const BuildOptions& options,
               const BuildBackend& backend, bool base_only = false)
      : mesh_(mesh),
        topology_(topology),
        options_(options),
        backend_(backend),
        base_only_(base_only) {}

  PatchCache build(BuildReport* report) {
    set_frame();
    drafted_.resize(faces_.size());
    if (!base_only_) {
      make_tables();
      if (options_.level.construction == Construction::kFair)
        fair_.emplace(mesh_frame(), topology_, faces_, backend_.parallel);
      draft_faces();
    }
    if (report != nullptr) *report = report_of();
    layout_ = lay_out(mesh_, topology_, faces_, drafted_, cache_);
    if (options_.precision == Precision::kFloat) {
      cache_.surface.emplace<0>();
      fill(std::get<0>(cache_.surface));
    } else {
      cache_.surface.emplace<1>();
      fill(std::get<1>(cache_.surface));
    }
    if (options_.like == nullptr) find_open_parts(cache_);
    return std::move(cache_);
  }

 private:
  void set_frame() {
    cache_.unit = mesh_.unit;
    cache_.level = options_.level;
    cache_.mesh_face_count = static_cast<std::uint32_t>(mesh_.face_count());
    faces_ = options_.faces;
    if (faces_.empty()) {
      faces_.resize(mesh_.face_count());
      for (std::size_t f = 0; f < faces_.size(); ++f) faces_[f] = static_cast<std::uint32_t>(f);
    }
    if (options_.like != nullptr) {
      cache_.origin = options_.like->origin;
      cache_.scale = options_.like->scale;
      cache_.mesh_hash = options_.like->mesh_hash;
      cache_.open = options_.like->open;
      cache_.face_valence = options_.like->face_valence;
      cache_.crease_count = options_.like->crease_count;
      return;
    }
    Box box{mesh_.positions[mesh_.corner_vertex[0]], mesh_.positions[mesh_.corner_vertex[0]]};
    for (const std::uint32_t v : mesh_.corner_vertex) {
      box.low = box.low.cwiseMin(mesh_.positions[v]);
      box.high = box.high.cwiseMax(mesh_.positions[v]);
    }
    cache_.origin = box.low + 0.5 * (box.high - box.low);
    int exponent = 0;
    std::frexp(0.5 * (box.high - box.low).maxCoeff(), &exponent);
    cache_.scale = std::ldexp(1.0, -exponent);
    cache_.mesh_hash = hash_of(mesh_);
    cache_.crease_count =
        static_cast<std::uint32_t>(std::count(mesh_.sharp.begin(), mesh_.sharp.end(), 1) / 2);
    cache_.face_valence.resize(mesh_.face_count());
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) cache_.face_valence[f] = mesh_.valence(f);
  }

  MeshFrame mesh_frame() const { return {mesh_, cache_.origin, cache_.scale}; }

  FaceCorners corners_of(std::uint32_t face) const {
    FaceCorners c;
    for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
      c.position.push_back(mesh_frame().position(s));
      c.normal.push_back(mesh_frame().normal(s));
    }
    if (is_sharp(face)) {
      for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
        for (const std::uint32_t end : {0u, 1u}) c.tangent.push_back(mesh_frame().tangent(s, end));
      }
    }
    return c;
  }

  // Adds the sides of the fair construction to the corners, if it is that.
  FaceCorners face_of(std::uint32_t face) const {
    FaceCorners c = corners_of(face);
    if (fair_) c.side = fair_->sides_of(face);
    return c;
  }

  bool is_fair(std::uint32_t face) const { return fair_ && cache_.face_valence[face] <= 4; }
  // True if a side has tangents of its own.
  bool is_sharp(std::uint32_t face) const {
    for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s)
      if (mesh_frame().has_tangents(s)) return true;
    return false;
  }
  // True if the batch has nothing for its patch.
  bool is_single(std::uint32_t face) const { return is_fair(face) || is_sharp(face); }

  // Makes the tables of the faces, and of the triangles that a face may be split into.
  void make_tables() {
    std::vector<char> used(4, 0);
    used[3] = 1;
    for (const std::uint32_t f : faces_) {
      const std::uint32_t n = cache_.face_valence[f];
      if (n >= used.size()) used.resize(n + 1, 0);
      used[n] = 1;
    }
    tables_ = make_valence_tables(used);
  }

  // Calls body(chunk) for all faces, in order, with the paper's patches of those that need them.
  template <class Body>
  void for_chunks(BatchStep step, Body body) {
    Chunk c;
    c.batch.tables = &tables_;
    std::vector<std::uint32_t> valences;
    for (c.first = 0; c.first < faces_.size(); c.first += c.count) {
      c.count = std::min(backend_.chunk, faces_.size() - c.first);
      c.in_batch.assign(c.count, kNone);
      valences.clear();
      for (std::size_t i = 0; i < c.count; ++i) {
        const bool is_drafted = !base_only_ && is_single(faces_[c.first + i]);
        if (is_drafted || !drafted_[c.first + i].tamer.empty()) continue;
        c.in_batch[i] = static_cast<std::uint32_t>(valences.size());
        valences.push_back(cache_.face_valence[faces_[c.first + i]]);
      }
      c.batch.resize(valences);
      c.frame.resize(valences.size());
      for_faces(c, [&](std::size_t i) {
        if (c.in_batch[i] != kNone) place(c, c.in_batch[i], faces_[c.first + i]);
      });
      if (!base_only_ && c.batch.size() > 0) backend_.build(c.batch, step, backend_.parallel);
      body(c);
    }
  }

  // Calls body(i) for the faces of a chunk, on all threads.
  template <class Body>
  void for_faces(const Chunk& c, Body body) const {
    backend_.parallel(c.count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  void place(Chunk& c, std::size_t p, std::uint32_t face) const {
    PatchBatch& b = c.batch;
    c.frame[p] =
        place_polygon(corners_of(face), all_corners(b.valence(p)), &b.corner[b.side_begin[p] * 6],
                      &b.triangle[3 * b.first_triangle(p)]);
    c.frame[p].store(&b.frame[p * kFrameReals]);
  }

  void draft_faces() {
    for_chunks(BatchStep::kExamine, [&](const Chunk& c) {
      for_faces(c, [&](std::size_t i) {
        const std::uint32_t face = faces_[c.first + i], p = c.in_batch[i];
        if (p == kNone) {
          const PatchDraft patch = draft(face_of(face));
          judge(face, examine(patch, tables_), patch.soundness, drafted_[c.first + i]);
        } else {
          judge(face, shape_from(&c.batch.shape[p * kShapeReals], c.batch.valence(p)),
                c.batch.soundness[p], drafted_[c.first + i]);
        }
      });
      backend_.progress(c.first + c.count);
    });
  }

  static PatchDraft draft(const FaceCorners& face) {
    return draft_patch(face, all_corners(static_cast<std::uint32_t>(face.position.size())));
  }

  // Flags a face by its patch's shape and soundness, and finds tamer patches for a flagged one.
  void judge(std::uint32_t face, const PatchShape& shape, double soundness, DraftedFace& d) const {
    d.shape = shape;
    if (may_fold_unseen(d.shape))
      d.shape.turn = std::min(d.shape.turn, closer_turn(draft(face_of(face)), tables_));
    d.folded = is_folded(d.shape);
    d.degenerate = is_degenerate(soundness);
    if (!d.flagged() || !options_.tame) return;
    const FaceCorners corners = face_of(face);
    PatchDraft patch = draft(corners);
    patch.shape = d.shape;
    d.tamer = draft_tamer(corners, std::move(patch), tables_);
  }

  BuildReport report_of() const {
    BuildReport report;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const DraftedFace& d = drafted_[i];
      if (!d.flagged()) continue;
      report.flagged_faces.push_back(faces_[i]);
      report.folded += d.folded;
      report.degenerate += d.degenerate;
      if (d.tamer.empty()) continue;
      const bool bent = std::any_of(d.tamer.begin(), d.tamer.end(),
                                    [](const PatchDraft& p) { return p.kind == PatchKind::kBent; });
      ++(bent ? report.bent : d.tamer.size() > 1 ? report.split : report.eased);
    }
    return report;
  }

  template <class Real>
  void fill(Surface<Real>& s) {
    const std::size_t sides = layout_.side_twin.size(), patches = cache_.patch_count();
    s.side_begin = std::move(layout_.side_begin);
    s.side_twin = std::move(layout_.side_twin);
    s.side_patch.resize(sides);
    for (std::uint32_t p = 0; p < patches; ++p) {
      for (std::uint32_t side = s.side_begin[p]; side < s.side_begin[p + 1]; ++side)
        s.side_patch[side] = p;
    }
    s.control_begin.resize(patches);
    s.form.resize(patches);
    if (!base_only_ && options_.level.kind == Level::kExact) s.control.reserve(exact_reals());
    s.corner.resize(sides * 6);
    s.patch.resize(patches * kPatchReals);
    s.tile_begin.assign(patches + 1, 0);
    s.triangle.resize(3 * (sides - 2 * patches));
    cache_.rho_min.resize(patches);
    fill_domain(s);
    std::vector<Box> boxes(patches);
    for_chunks(BatchStep::kControl, [&](const Chunk& c) { store_chunk(c, s, boxes); });
    s.control.shrink_to_fit();
    s.tile.shrink_to_fit();
    if (!base_only_) free_sharp_sides(s, backend_.parallel);
    build_hierarchy(boxes, s.node, s.child, backend_.parallel);
    find_parts(boxes, s, [&] { backend_.progress(faces_.size()); });
  }

  // Numbers of all control data, unless a level replaces them.
  std::size_t exact_reals() const {
    const Kernels<double>& k = kernels<double>();
    std::size_t sum = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const std::vector<PatchDraft>& tamer = drafted_[i].tamer;
      const std::uint32_t n = cache_.face_valence[faces_[i]];
      if (tamer.empty()) sum += k.control_reals(is_fair(faces_[i]) ? fair_form(n) : kFormPaper, n);
      for (const PatchDraft& d : tamer) sum += d.control.size();
    }
    return sum;
  }

  template <class Real>
  void fill_domain(Surface<Real>& s) {
    const auto most = *std::max_element(cache_.face_valence.begin(), cache_.face_valence.end());
    s.domain_begin.assign(most + 1, 0);
    s.domain_begin[0] = cache_.crease_count > 0;
    std::vector<char> used(most + 1, 0);
    for (std::uint32_t p = 0; p < s.patch_count(); ++p) used[s.valence(p)] = 1;
    // Splits ask for the domain of their whole face too.
    for (const std::uint32_t f : faces_) used[cache_.face_valence[f]] = 1;
    for (std::uint32_t n = 3; n <= most; ++n) {
      if (used[n]) append_domain(n, s.domain, s.domain_begin);
    }
  }

  template <class Real>
  void store_chunk(const Chunk& c, Surface<Real>& s, std::vector<Box>& boxes) {
    const std::uint32_t first = cache_.face_patch[faces_[c.first]];
    const std::size_t next = c.first + c.count;
    const std::uint32_t last =
        next < faces_.size() ? cache_.face_patch[faces_[next]] : cache_.patch_count();
    std::vector<FinishedPatch> finished(last - first);
    // [face of the chunk], of single ones.
    std::vector<PatchDraft> single(fair_ || !mesh_.tangents.empty() ? c.count : 0);
    for_faces(c, [&](std::size_t i) {
      finish_face(c, i, single, &finished[cache_.face_patch[faces_[c.first + i]] - first]);
    });
    if (!base_only_) {
      backend_.parallel(finished.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) tile<Real>(finished[i]);
      });
    }
    if (!base_only_) {
      std::size_t end = s.control.size();
      for (std::size_t i = 0; i < finished.size(); ++i) {
        s.control_begin[first + i] = static_cast<std::uint32_t>(end / 3);
        end += finished[i].real_count();
      }
      if (end / 3 >= kNone) throw MeshError(mesh_.source + ": too many sides for one cache");
      s.control.resize(end);
      for (std::size_t i = 0; i < finished.size(); ++i) {
        const std::vector<std::uint32_t>& words = finished[i].tiles.words;
        for (std::size_t row = 0; row < kTileUints; ++row) {
          for (std::size_t at = row; at < words.size(); at += kTileUints)
            s.tile.push_back(words[at]);
        }
        if (s.tile.size() / kTileUints >= kNone)
          throw MeshError(mesh_.source + ": too many sides for one cache");
        s.tile_begin[first + i + 1] = static_cast<std::uint32_t>(s.tile.size() / kTileUints);
      }
    }
    backend_.parallel(finished.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        store(finished[i], first + static_cast<std::uint32_t>(i), s, boxes);
    });
  }

  // Finishes the patches of face i of a chunk, one after the other. A single one is drafted once
  // more, into single[i]: to keep all drafts would take several times the memory of the cache.
  void finish_face(const Chunk& c, std::size_t i, std::vector<PatchDraft>& single,
                   FinishedPatch* out) const {
    const std::uint32_t face = faces_[c.first + i], p = c.in_batch[i];
    const DraftedFace& drafted = drafted_[c.first + i];
    if (p != kNone) {
      const PatchBatch& b = c.batch;
      *out = {b.valence(p),
              PatchKind::kPlain,
              &c.frame[p],
              base_only_ ? base_shape(b, p) : drafted.shape,
              &b.corner[b.side_begin[p] * 6],
              &b.control[b.side_begin[p] * kSideReals],
              &b.triangle[3 * b.first_triangle(p)]};
      return choose_form(*out);
    }
    std::span<const PatchDraft> patches = drafted.tamer;
    if (patches.empty()) {
      single[i] = draft(face_of(face));
      single[i].shape = drafted.shape;
      patches = {&single[i], 1};
    }
    for (const PatchDraft& d : patches) {
      *out = {d.valence(),     d.kind,           &d.frame,          d.shape,
              d.corner.data(), d.control.data(), d.triangle.data(), d.form};
      choose_form(*out++);
    }
  }

  void choose_form(FinishedPatch& d) const {
    if (base_only_) return;
    const Kernels<double>& k = kernels<double>();
    for (const std::uint32_t form : forms_of(options_.level, d)) {
      d.control.resize(k.control_reals(form, d.valence));
      k.to_form(tables_.domain_of(d.valence), d.corner, d.drafted, d.form, form, d.valence,
                d.control.data());
      const PatchShape shape =
          examine(*d.frame, d.corner, d.triangle, d.control.data(), form, d.valence, tables_);
      // A patch that folds whatever is done about it may as well fold in the form asked for.
      if (is_folded(shape) && !is_folded(d.shape)) continue;
      d.form = form;
      d.shape = shape;
      return;
    }
    d.control.clear();
  }

  // Cuts a patch into tiles, in its box as it is stored.
  template <class Real>
  void tile(FinishedPatch& d) const {
    d.tiles = cut_tiles(*d.frame, d.shape, d.shape.low.cast<Real>().template cast<double>(),
                        d.shape.high.cast<Real>().template cast<double>(), d.reals(), d.form,
                        d.valence, tables_);
  }

  template <class Real>
  void store(const FinishedPatch& d, std::uint32_t patch, Surface<Real>& s,
             std::vector<Box>& boxes) {
    const std::size_t first = s.side_begin[patch], n = d.valence;
    const auto narrow = [](const double* from, std::size_t count, Real* to) {
      for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<Real>(from[i]);
    };
    s.form[patch] = d.form;
    if (!base_only_)
      narrow(d.reals(), d.real_count(), &s.control[3 * std::size_t{s.control_begin[patch]}]);
    narrow(d.corner, n * 6, &s.corner[first * 6]);
    std::copy(d.triangle, d.triangle + 3 * (n - 2), &s.triangle[3 * (first - 2 * patch)]);
    Real* numbers = &s.patch[patch * kPatchReals];
    const auto put = [&](std::size_t at, const Vec3& v) { narrow(v.data(), 3, numbers + at); };
    put(kPatchOrigin, d.frame->origin);
    put(kPatchNormal, d.frame->normal);
    put(kPatchTangent, d.frame->tangent);
    put(kPatchLow, d.shape.low);
    put(kPatchHigh, d.shape.high);
    put(kPatchBend, d.shape.bend);
    numbers[kPatchScale] = static_cast<Real>(d.frame->scale);
    numbers[kPatchUnscale] = static_cast<Real>(1 / d.frame->scale);
    numbers[kPatchSag] = static_cast<Real>(d.shape.sag);
    numbers[kPatchCurvature] = static_cast<Real>(d.tiles.curvature);
    boxes[patch] = {d.frame->origin + d.shape.box.low / d.frame->scale,
                    d.frame->origin + d.shape.box.high / d.frame->scale};
    cache_.rho_min[patch] = std::min(d.shape.rho_min / (d.frame->scale * cache_.scale),
                                     std::numeric_limits<double>::max());
  }

  const Mesh& mesh_;
  const Topology& topology_;
  const BuildOptions& options_;
  const BuildBackend& backend_;
  const bool base_only_;
  PatchCache cache_;
  ValenceTables tables_;
  std::optional<FairSides> fair_;
  std::vector<std::uint32_t> faces_;
  LargeArray<DraftedFace> drafted_;  // [faces_]
  PatchLayout layout_;
};

}  // namespace

PatchCache build_cache(const Mesh& mesh, const Topology& topology, const BuildOptions& options,
                       BuildReport* report, const BuildBackend& backend) {
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
  const PlainArithmetic plain;
  return CacheBuilder(mesh, topology, options, backend).build(report);
}

PatchCache build_base(const Mesh& mesh, const Topology& topology, Precision precision) {
  BuildOptions options;
  options.precision = precision;
  const BuildBackend serial;
  const PlainArithmetic plain;
  return CacheBuilder(mesh, topology, options, serial, true).build(nullptr);
}

PatchCache build_cache(const Mesh& mesh, const BuildOptions& options, BuildReport* report,
                       const BuildBackend& backend) {
  const PlainArithmetic plain;
  if (has_vertex_normals(mesh))
    return build_cache(mesh, build_topology(mesh), options, report, backend);
  Mesh with_normals = mesh;
  add_vertex_normals(with_normals, normal_weights(options.level.construction));
  PatchCache cache =
      build_cache(with_normals, build_topology(with_normals), options, report, backend);
  cache.mesh_hash = hash_of(mesh);
  return cache;
}

}  // namespace gliss
