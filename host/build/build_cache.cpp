// From a mesh to its cache, a chunk of faces at a time.
#include "gliss/build/build_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "gliss/base/pace.h"
#include "gliss/base/plain_arithmetic.h"
#include "gliss/build/departure.h"
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

// Faces that are built share nothing, so that they may be drafted in any order. Those that fold
// take a hundred times as long as others.
constexpr std::size_t kFaceGrain = 8;

// Patches of more sides are looked at closely for folds: their samples are far apart.
constexpr std::uint32_t kFewSides = 8;

// Fair patches that are drafted together, in lanes.
constexpr std::size_t kFairTogether = 16;

// A patch as it goes into the cache.
struct FinishedPatch {
  std::uint32_t valence;
  PatchKind kind;
  const PatchFrame* frame;
  PatchShape shape;
  const double *corner, *drafted;  // control data as drafted, in a form that another may replace
  const std::uint32_t* triangle;
  std::uint32_t form = kFormPaper;
  const PatchDraft* in_fan = nullptr;  // where it holds a piece of its face's polygon
  std::vector<double> control{};       // in another form; empty: as drafted
  PatchTiles tiles{};

  // The control data as drafted, until the patch is finished in another form.
  ControlData control_data() const {
    return {control.empty() ? drafted : control.data(), form, valence};
  }
  std::size_t real_count() const { return kernels<double>().control_reals(form, valence); }
};

// A patch in a form of the level.
struct FormedPatch {
  std::uint32_t form = kNone;  // kNone: none yet
  std::vector<double> control;
  PatchShape shape;
  PatchSamples samples;
};

// faces_[first] to faces_[first + count - 1] and their patches, those that a backend builds first.
struct Chunk {
  std::size_t first = 0, count = 0;
  PatchBatch batch;
  std::vector<PatchFrame> frame;        // [patch of the batch]
  std::vector<std::uint32_t> in_batch;  // [face of the chunk], its patch there
  std::vector<DraftedFace> drafted;     // [face of the chunk]
  // [face of the chunk], its own patch, or those that it becomes.
  std::vector<FinishedPatch> plain;
  std::vector<std::vector<FinishedPatch>> tamer;
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
  kernels<double>().examine(nullptr, nullptr, 0, 0, nullptr, kFormPaper,
                            &b.corner[b.side_begin[p] * 6], &b.triangle[3 * b.first_triangle(p)],
                            &b.frame[p * kFrameReals], b.valence(p), nullptr, nullptr, reals);
  return shape_from(reals);
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
        base_only_(base_only) {
    if (mesh.face_count() == 0) throw MeshError(mesh.source + ": no faces to build");
  }

  PatchCache build(BuildReport* report) {
    set_frame();
    if (!base_only_) {
      make_tables();
      if (options_.level.construction == Construction::kFair)
        fair_.emplace(mesh_frame(), topology_, faces_, backend_.parallel);
    }
    if (options_.precision == Precision::kFloat) {
      cache_.surface.emplace<0>();
      fill(std::get<0>(cache_.surface));
    } else {
      cache_.surface.emplace<1>();
      fill(std::get<1>(cache_.surface));
    }
    if (report != nullptr) *report = std::move(report_);
    if (options_.like == nullptr) {
      find_open_parts(cache_);
      find_folds(cache_);
      if (!base_only_) find_departures(cache_, sag_, backend_.parallel);
    }
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
    const Box box = box_of(mesh_);
    cache_.origin = box.low + 0.5 * (box.high - box.low);
    int exponent = 0;
    std::frexp(0.5 * (box.high - box.low).maxCoeff(), &exponent);
    cache_.scale = std::ldexp(1.0, -exponent);
    cache_.mesh_hash = hash_of(mesh_);
    cache_.crease_count =
        static_cast<std::uint32_t>(std::count(mesh_.sharp.begin(), mesh_.sharp.end(), 1) / 2);
    cache_.face_patch.assign(mesh_.face_count(), kNone);
    LargeArray<std::uint32_t>& valence = cache_.face_valence.write();
    valence.resize(mesh_.face_count());
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) valence[f] = mesh_.valence(f);
  }

  MeshFrame mesh_frame() const { return {mesh_, cache_.origin, cache_.scale}; }

  void corners_of(std::uint32_t face, FaceCorners& c) const {
    c.position.clear(), c.normal.clear(), c.tangent.clear(), c.side.clear();
    for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
      c.position.push_back(mesh_frame().position(s));
      c.normal.push_back(mesh_frame().normal(s));
    }
    if (!is_sharp(face)) return;
    for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
      for (const std::uint32_t end : {0u, 1u}) c.tangent.push_back(mesh_frame().tangent(s, end));
    }
  }

  // Adds the sides of the fair construction to the corners, if it is that.
  void face_of(std::uint32_t face, FaceCorners& c) const {
    corners_of(face, c);
    if (fair_) fair_->sides_of({&face, 1}, c.side);
  }
  FaceCorners face_of(std::uint32_t face) const {
    FaceCorners c;
    face_of(face, c);
    return c;
  }

  bool is_fair(std::uint32_t face) const {
    return fair_ && cache_.face_valence[face] <= kMostFairSides;
  }
  // True if a side has tangents of its own.
  bool is_sharp(std::uint32_t face) const {
    for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s)
      if (mesh_.has_tangents(s)) return true;
    return false;
  }
  // True if a backend builds its patch from corners alone; else it is drafted here.
  bool is_to_build(std::uint32_t face) const {
    return base_only_ || !(is_fair(face) || is_sharp(face));
  }

  Sampler sampler() const { return {*tables_, &backend_.poll}; }

  // Makes the tables of the faces, and of the triangles that a face may be split into.
  void make_tables() {
    std::vector<char> used(4, 0);
    used[3] = 1;
    for (const std::uint32_t f : faces_) {
      const std::uint32_t n = cache_.face_valence[f];
      if (n >= used.size()) used.resize(n + 1, 0);
      used[n] = 1;
    }
    tables_ = shared_valence_tables(used);
  }

  // Calls body(chunk) for all faces, in order, with their patches.
  template <class Body>
  void for_chunks(Body body) {
    Chunk c;
    c.batch.tables = tables_.get();
    std::vector<std::uint32_t> valences, forms;
    Pace pace(8 * kFaceGrain, backend_.chunk);
    pace.for_pieces(faces_.size(), [&](std::size_t begin, std::size_t end) {
      c.first = begin;
      c.count = end - begin;
      c.in_batch.resize(c.count);
      c.drafted.assign(c.count, {});
      c.plain.resize(c.count);
      c.tamer.assign(c.count, {});
      valences.clear(), forms.clear();
      for (const bool to_build : {true, false}) {
        for (std::size_t i = 0; i < c.count; ++i) {
          const std::uint32_t face = faces_[c.first + i], n = cache_.face_valence[face];
          if (is_to_build(face) != to_build) continue;
          c.in_batch[i] = static_cast<std::uint32_t>(valences.size());
          valences.push_back(n);
          forms.push_back(is_fair(face) ? fair_form(n) : kFormPaper);
        }
        if (to_build) c.batch.to_build = valences.size();
      }
      c.batch.resize(valences, forms);
      c.frame.resize(valences.size());
      backend_.parallel(c.count, kFaceGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) place(c, c.in_batch[i], faces_[c.first + i]);
        for (std::size_t i = from; i < to; i += kFairTogether)
          place_fair(c, i, std::min(i + kFairTogether, to));
      });
      if (!base_only_) backend_.build(c.batch, backend_.parallel);
      body(c);
    });
  }

  // Calls body(i) for the faces of a chunk, on all threads.
  template <class Body>
  void for_faces(const Chunk& c, Body body) const {
    backend_.parallel(c.count, kFaceGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  // Puts the polygon of a face into the batch, with its patch if that comes drafted and is the
  // paper's.
  void place(Chunk& c, std::size_t p, std::uint32_t face) const {
    thread_local FaceCorners corners;
    thread_local PatchDraft draft;
    PatchBatch& b = c.batch;
    double* corner = &b.corner[b.side_begin[p] * 6];
    std::uint32_t* triangle = &b.triangle[3 * b.first_triangle(p)];
    b.inward_share[p] = 1;
    corners_of(face, corners);
    if (p < b.to_build || is_fair(face)) {
      c.frame[p] = place_polygon(corners, all_corners(b.valence(p)), corner, triangle);
    } else {
      draft.face_corner = all_corners(b.valence(p));
      draft_patch(corners, draft);
      c.frame[p] = draft.frame;
      std::copy(draft.corner.begin(), draft.corner.end(), corner);
      std::copy(draft.triangle.begin(), draft.triangle.end(), triangle);
      std::copy(draft.control.begin(), draft.control.end(), &b.control[b.control_begin[p]]);
      b.soundness[p] = draft.soundness;
      b.inward_share[p] = draft.inward_share;
    }
    c.frame[p].store(&b.frame[p * kFrameReals]);
  }

  // Puts the patches of those faces of the chunk that are fair, and placed, into the batch: their
  // sides together, and patches that follow one another and have as many sides.
  void place_fair(Chunk& c, std::size_t begin, std::size_t end) const {
    thread_local std::vector<std::uint32_t> faces, patches;
    thread_local std::vector<double> sides;
    faces.clear(), patches.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_fair(faces_[c.first + i])) continue;
      faces.push_back(faces_[c.first + i]);
      patches.push_back(c.in_batch[i]);
    }
    if (faces.empty()) return;
    fair_->sides_of(faces, sides);
    PatchBatch& b = c.batch;
    double* side = sides.data();
    for (const std::uint32_t p : patches) {
      b.soundness[p] = 1;
      for (std::uint32_t k = 0; k < b.valence(p); ++k, side += kFairReals) {
        c.frame[p].place_side(side);
        b.soundness[p] = std::min(b.soundness[p], side[kFairSound]);
      }
    }
    side = sides.data();
    for (std::size_t i = 0, next; i < patches.size(); i = next) {
      const std::uint32_t p = patches[i], n = b.valence(p);
      const auto follows = [&](std::size_t k) {
        return k < patches.size() && patches[k] == p + (k - i) && b.valence(patches[k]) == n;
      };
      for (next = i + 1; follows(next);) ++next;
      kernels<double>().fair_controls(side, next - i, n, nullptr, 1, &b.control[b.control_begin[p]],
                                      &b.inward_share[p]);
      side += (next - i) * n * kFairReals;
    }
  }

  // Examines a face's patch, finds tamer ones if it folds, and finishes what the face becomes.
  template <class Real>
  void build_face(Chunk& c, std::size_t i) const {
    thread_local PatchSamples samples;
    thread_local FormedPatch formed;
    const std::uint32_t face = faces_[c.first + i], p = c.in_batch[i];
    DraftedFace& drafted = c.drafted[i];
    const PatchBatch& b = c.batch;
    FinishedPatch& plain = c.plain[i];
    plain = {b.valence(p),
             PatchKind::kPlain,
             &c.frame[p],
             {},
             &b.corner[b.side_begin[p] * 6],
             &b.control[b.control_begin[p]],
             &b.triangle[3 * b.first_triangle(p)],
             b.form[p]};
    PatchSamples* its_samples = nullptr;
    formed.form = kNone;
    if (base_only_) {
      drafted.shape = base_shape(b, p);
    } else if (b.shape.empty() && b.inward_share[p] > 0 && !is_degenerate(b.soundness[p]) &&
               is_gentle_at_level(plain, formed)) {
      drafted.shape = formed.shape;
    } else {
      PatchShape shape = b.shape.empty() ? examine(c.frame[p], plain.corner, plain.triangle,
                                                   plain.control_data(), sampler(), &samples)
                                         : examined(b, p, samples);
      if (!(b.inward_share[p] > 0)) shape.least_cosine = -1;
      judge(face, c.frame[p], shape, b.soundness[p], drafted);
      its_samples = &samples;
    }
    for (const PatchDraft& d : drafted.tamer) {
      c.tamer[i].push_back(to_finish(d));
      formed.form = kNone;
      finish<Real>(c.tamer[i].back(), nullptr, formed);
    }
    if (!drafted.tamer.empty()) return;
    plain.shape = drafted.shape;
    finish<Real>(plain, its_samples, formed);
  }

  // The shape and the samples that a backend found.
  static PatchShape examined(const PatchBatch& b, std::size_t p, PatchSamples& samples) {
    const double* shape = &b.shape[p * kShapeReals];
    samples.rows.assign(&b.sample[b.sample_begin[p]], &b.sample[b.sample_begin[p + 1] - 1] + 1);
    samples.count = static_cast<std::uint32_t>(samples.rows.size() / kCutRows);
    samples.set_shape(shape, b.valence(p));
    return shape_from(shape);
  }

  static FinishedPatch to_finish(const PatchDraft& d) {
    return {d.valence(),       d.kind,          &d.frame,
            d.shape,           d.corner.data(), d.control.data(),
            d.triangle.data(), d.form,          d.piece.empty() ? nullptr : &d};
  }

  static PatchDraft draft(const FaceCorners& face) {
    return draft_patch(face, all_corners(static_cast<std::uint32_t>(face.position.size())));
  }

  // The most by which the patch of a face should leave its polygon, mesh frame.
  double most_sag(std::uint32_t face) const {
    return mesh_.most_sag.empty() ? std::numeric_limits<double>::infinity()
                                  : mesh_.most_sag[face] * cache_.scale;
  }

  // Flags a face by its patch's shape and soundness, and finds tamer patches for a flagged one and
  // one that bulges.
  void judge(std::uint32_t face, const PatchFrame& frame, const PatchShape& shape, double soundness,
             DraftedFace& d) const {
    d.shape = shape;
    if (may_fold_unseen(d.shape) || (mesh_.valence(face) > kFewSides && !is_folded(d.shape)))
      d.shape.least_cosine =
          std::min(d.shape.least_cosine, least_cosine_closely(draft(face_of(face)), sampler()));
    d.folded = is_folded(d.shape);
    d.degenerate = is_degenerate(soundness);
    const double most = most_sag(face);
    const bool bulges =
        shape.sag > most * frame.scale && !(is_fair(face) && mesh_.valence(face) <= 4);
    if (!options_.tame || !(d.flagged() || bulges)) return;
    const FaceCorners corners = face_of(face);
    PatchDraft patch = draft(corners);
    patch.shape = d.shape;
    d.tamer = d.flagged() ? draft_tamer(corners, std::move(patch), sampler())
                          : draft_flatter(corners, std::move(patch), most, sampler());
  }

  void report(const Chunk& c) {
    for (std::size_t i = 0; i < c.count; ++i) {
      const DraftedFace& d = c.drafted[i];
      if (d.flagged()) report_.flagged_faces.push_back(faces_[c.first + i]);
      report_.folded += d.folded;
      report_.degenerate += d.degenerate;
      if (d.tamer.empty()) continue;
      const bool bent = std::any_of(d.tamer.begin(), d.tamer.end(),
                                    [](const PatchDraft& p) { return p.kind == PatchKind::kBent; });
      ++(bent ? report_.bent : d.tamer.size() > 1 ? report_.split : report_.eased);
    }
  }

  template <class Real>
  void fill(Surface<Real>& s) {
    if (!base_only_) s.tile_begin.push_back(0);
    std::vector<Box> boxes;
    for_chunks([&](Chunk& c) {
      for_faces(c, [&](std::size_t i) { build_face<Real>(c, i); });
      report(c);
      store_chunk(c, s, boxes);
      backend_.progress(c.first + c.count);
    });
    const std::uint32_t patches = cache_.patch_count();
    join_sides(mesh_, topology_, faces_, cache_, layout_);
    s.side_begin = std::move(layout_.side_begin);
    s.side_twin = std::move(layout_.side_twin);
    s.side_patch.resize(s.side_twin.size());
    for (std::uint32_t p = 0; p < patches; ++p) {
      for (std::uint32_t side = s.side_begin[p]; side < s.side_begin[p + 1]; ++side)
        s.side_patch[side] = p;
    }
    fill_domain(s);
    if (base_only_) {
      s.control_begin.assign(patches, 0);
      s.tile_begin.assign(patches + 1, 0);
    } else {
      free_sharp_sides(s, *tables_, backend_.parallel);
    }
    build_hierarchy(boxes, s.node, s.child, backend_.parallel);
    find_parts(boxes, s, backend_.poll);
  }

  // Resizes an array of the surface when all patches up to face `done` of faces_ are known. If it
  // has to move it gets room for what the other faces will need, should they be like those: pages
  // that are not used cost nothing.
  template <class Array>
  void grow(Array& array, std::size_t size, std::size_t done) const {
    if (size > array.capacity()) {
      const double others = static_cast<double>(faces_.size() - done) / static_cast<double>(done);
      array.reserve(size + static_cast<std::size_t>(1.0625 * others * static_cast<double>(size)));
    }
    array.resize(size);
  }

  std::uint32_t most_sides() const {
    if (options_.like == nullptr)
      return *std::max_element(cache_.face_valence.begin(), cache_.face_valence.end());
    const auto most = [](const auto& s) { return s.domain_begin.size() - 1; };
    return static_cast<std::uint32_t>(std::visit(most, options_.like->surface));
  }

  template <class Real>
  void fill_domain(Surface<Real>& s) {
    const std::uint32_t most = most_sides();
    s.domain_begin.assign(most + 1, 0);
    s.domain_begin[0] = (cache_.crease_count > 0 ? kHasCreases : 0) | (has_fans_ ? kHasFans : 0);
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
    const std::uint32_t first = cache_.patch_count();
    number_patches(mesh_, {&faces_[c.first], c.count}, c.drafted, cache_, layout_);
    std::vector<const FinishedPatch*> finished;
    finished.reserve(cache_.patch_count() - first);
    for (std::size_t i = 0; i < c.count; ++i) {
      if (c.tamer[i].empty()) finished.push_back(&c.plain[i]);
      for (const FinishedPatch& patch : c.tamer[i]) {
        finished.push_back(&patch);
        has_fans_ = has_fans_ || patch.in_fan != nullptr;
      }
    }
    make_room(c, finished, s, boxes);
    backend_.parallel(finished.size(), kFaceGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        store(*finished[i], first + static_cast<std::uint32_t>(i), s, boxes);
    });
  }

  // Room for finished patches, after those before, in all arrays.
  template <class Real>
  void make_room(const Chunk& c, const std::vector<const FinishedPatch*>& finished,
                 Surface<Real>& s, std::vector<Box>& boxes) {
    const std::size_t done = c.first + c.count, patches = cache_.patch_count(),
                      sides = layout_.side_begin.back(), before = patches - finished.size();
    grow(boxes, patches, done);
    grow(cache_.rho_min, patches, done);
    sag_.resize(patches);
    grow(s.form, patches, done);
    grow(s.patch, patches * kPatchReals, done);
    grow(s.corner, sides * 6, done);
    grow(s.triangle, 3 * (sides - 2 * patches), done);
    if (base_only_) return;
    grow(s.control_begin, patches, done);
    grow(s.tile_begin, patches + 1, done);
    std::size_t control = s.control.size(), tiles = s.tile.size() / kTileUints;
    for (std::size_t i = 0; i < finished.size(); ++i) {
      s.control_begin[before + i] = static_cast<std::uint32_t>(control / 3);
      control += finished[i]->real_count();
      tiles += finished[i]->tiles.words.size() / kTileUints;
      if (control / 3 >= kNone || tiles >= kNone)
        throw MeshError(mesh_.source + ": too many sides for one cache");
      s.tile_begin[before + i + 1] = static_cast<std::uint32_t>(tiles);
    }
    grow(s.control, control, done);
    grow(s.tile, tiles * kTileUints, done);
  }

  // Takes a patch as drafted to a form, and examines it there.
  void form_patch(const FinishedPatch& d, std::uint32_t form, FormedPatch& to) const {
    const Kernels<double>& k = kernels<double>();
    to.form = form;
    to.control.resize(k.control_reals(form, d.valence));
    take_to_form(d.corner, d.control_data(), form, sampler(), to.control.data());
    to.shape = examine(*d.frame, d.corner, d.triangle, {to.control.data(), form, d.valence},
                       sampler(), &to.samples);
  }

  // True if a patch is gentle in the first form that it may have at the level, and its normals as
  // drafted tell no fold either: then it needs no examination as drafted.
  bool is_gentle_at_level(const FinishedPatch& d, FormedPatch& formed) const {
    const std::vector<std::uint32_t> forms = forms_of(options_.level, d);
    if (forms.empty()) return false;
    form_patch(d, forms.front(), formed);
    return formed.samples.is_gentle && keeps_direction(*d.frame, d.control_data(), sampler());
  }

  // Takes a patch to the level that was asked for and cuts it into tiles. `samples`: those of the
  // patch as drafted, or null. `formed`: a form that it was taken to already, if any.
  template <class Real>
  void finish(FinishedPatch& d, const PatchSamples* samples, FormedPatch& formed) const {
    if (base_only_) return;
    d.control.clear();
    for (const std::uint32_t form : forms_of(options_.level, d)) {
      if (formed.form != form) form_patch(d, form, formed);
      // A patch that folds whatever is done about it may as well fold in the form asked for.
      if (is_folded(formed.shape) && !is_folded(d.shape)) continue;
      d.control = formed.control;
      d.form = form;
      d.shape = formed.shape;
      samples = &formed.samples;
      break;
    }
    if (d.in_fan != nullptr) {
      for (const Vec3& corner : d.in_fan->piece_corner) d.shape.hold(corner, *d.frame);
    }
    const Box stored{d.shape.low.cast<Real>().template cast<double>(),
                     d.shape.high.cast<Real>().template cast<double>()};
    d.tiles = cut_tiles(*d.frame, d.shape, stored, d.control_data(), *tables_, samples);
  }

  template <class Real>
  void store(const FinishedPatch& d, std::uint32_t patch, Surface<Real>& s,
             std::vector<Box>& boxes) {
    const std::size_t first = layout_.side_begin[patch], n = d.valence;
    const auto narrow = [](const double* from, std::size_t count, Real* to) {
      for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<Real>(from[i]);
    };
    s.form[patch] = d.form;
    if (!base_only_) {
      narrow(d.control_data().reals, d.real_count(),
             &s.control[3 * std::size_t{s.control_begin[patch]}]);
      std::copy(d.tiles.words.begin(), d.tiles.words.end(),
                &s.tile[kTileUints * std::size_t{s.tile_begin[patch]}]);
    }
    narrow(d.corner, n * 6, &s.corner[first * 6]);
    std::uint32_t* triangle = &s.triangle[3 * (first - 2 * patch)];
    std::copy(d.triangle, d.triangle + 3 * (n - 2), triangle);
    if (d.in_fan != nullptr) {
      const std::uint32_t face = cache_.patch_face[patch];
      const std::vector<std::uint32_t>& c = d.in_fan->piece;
      triangle[0] = kFanPiece | c[0] | c[1] << kFanBits | c[2] << 2 * kFanBits;
      triangle[1] = layout_.side_begin[cache_.first_patch(face)];
      triangle[2] = cache_.face_valence[face];
    }
    Real* numbers = &s.patch[patch * kPatchReals];
    const auto put = [&](std::size_t at, const Vec3& v) { narrow(v.data(), 3, numbers + at); };
    put(kPatchOrigin, d.frame->origin);
    put(kPatchNormal, d.frame->normal);
    put(kPatchTangent, d.frame->tangent);
    put(kPatchLow, d.shape.low);
    put(kPatchHigh, d.shape.high);
    put(kPatchSecondForm, d.shape.second_form);
    numbers[kPatchScale] = static_cast<Real>(d.frame->scale);
    numbers[kPatchUnscale] = static_cast<Real>(1 / d.frame->scale);
    numbers[kPatchSag] = static_cast<Real>(d.shape.sag);
    numbers[kPatchCurvature] = static_cast<Real>(d.tiles.curvature);
    boxes[patch] = {d.frame->origin + d.shape.box.low / d.frame->scale,
                    d.frame->origin + d.shape.box.high / d.frame->scale};
    sag_[patch] = d.shape.sampled_sag / d.frame->scale;
    cache_.rho_min[patch] = std::min(d.shape.rho_min / (d.frame->scale * cache_.scale),
                                     std::numeric_limits<double>::max());
  }

  const Mesh& mesh_;
  const Topology& topology_;
  const BuildOptions& options_;
  const BuildBackend& backend_;
  const bool base_only_;
  PatchCache cache_;
  std::shared_ptr<const ValenceTables> tables_;
  std::optional<FairSides> fair_;
  std::vector<std::uint32_t> faces_;
  std::vector<double> sag_;  // [patch], of its samples, mesh frame
  PatchLayout layout_;
  bool has_fans_ = false;  // of the surface so far
  BuildReport report_;
};

}  // namespace

PatchCache build_cache(const Mesh& mesh, const Topology& topology, const BuildOptions& options,
                       BuildReport* report, const BuildBackend& backend) {
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

PatchCache build_base(const Mesh& mesh, const Topology& topology, Precision precision,
                      const BuildBackend& backend) {
  BuildOptions options;
  options.precision = precision;
  const PlainArithmetic plain;
  return CacheBuilder(mesh, topology, options, backend, true).build(nullptr);
}

PatchCache build_cache(const Mesh& mesh, const BuildOptions& options, BuildReport* report,
                       const BuildBackend& backend) {
  const PlainArithmetic plain;
  Mesh complete = mesh;
  const Topology topology = complete_mesh(complete, options.level.construction, backend.parallel);
  PatchCache cache = build_cache(complete, topology, options, report, backend);
  cache.mesh_hash = hash_of(mesh);
  return cache;
}

}  // namespace gliss
