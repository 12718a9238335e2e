#include "gliss/query/frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "gliss/surface/winding.h"

namespace gliss {

bool is_piece_of_face(const PatchCache& cache, std::uint32_t patch) {
  const std::uint32_t face = cache.patch_face[patch], next = patch + 1;
  return cache.first_patch(face) != patch ||
         (next < cache.patch_count() && cache.patch_face[next] == face);
}

template <class Real>
Eigen::Vector2d domain_corner(const Surface<Real>& s, std::uint32_t n, std::uint32_t k) {
  const Real* c = &s.domain[s.domain_begin[n] + kDomainHead + kDomainStride * k + kDomainCorner];
  return {static_cast<double>(c[0]), static_cast<double>(c[1])};
}

namespace {

// The corners of a part in the domain of its face, and in its own.
template <class Real>
struct PieceDomain {
  Eigen::Matrix3d in_face, in_patch;  // columns: corners, homogeneous
  PieceDomain(const PatchCache& cache, const Surface<Real>& s, std::uint32_t patch) {
    const std::uint32_t n = cache.face_valence[cache.patch_face[patch]];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = cache.corner_of_face[s.side_begin[patch] + k];
      in_face.col(k) << (corner < n ? domain_corner(s, n, corner) : Eigen::Vector2d(0, 0)), 1.0;
      in_patch.col(k) << domain_corner(s, 3, k), 1.0;
    }
  }
};

template <class Real>
DomainPoint face_point(const PatchCache& cache, const Surface<Real>& s, std::uint32_t patch,
                       double xi, double eta) {
  DomainPoint point{cache.patch_face[patch], xi, eta};
  if (!is_piece_of_face(cache, patch)) return point;
  const PieceDomain<Real> piece(cache, s, patch);
  const Vec3 at = piece.in_face * piece.in_patch.inverse() * Vec3(xi, eta, 1);
  point.xi = at.x();
  point.eta = at.y();
  return point;
}

template <class Real>
Vec3 from_local(const PatchCache& cache, const Surface<Real>& s, std::uint32_t patch,
                const Vec3& local) {
  return cache.origin + from_local(s, patch, local) * (1 / cache.scale);
}

// The sign of a NaN is a matter of compilers: one for all.
template <class Real>
double number(Real x) {
  return std::isnan(x) ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(x);
}
template <class Real>
Vec3 vec(const Real* v) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

}  // namespace

template <class Real>
PatchPlace place_of(const PatchCache& cache, const Surface<Real>& s, const DomainPoint& point) {
  PatchPlace place;
  place.patch = cache.first_patch(point.face);
  place.xi = point.xi;
  place.eta = point.eta;
  if (!is_piece_of_face(cache, place.patch)) return place;
  double best = -1;
  const std::uint32_t first = place.patch, end = cache.end_of_face(first);
  for (std::uint32_t p = first; p < end; ++p) {
    const PieceDomain<Real> piece(cache, s, p);
    const Vec3 at = piece.in_face.inverse() * Vec3(point.xi, point.eta, 1);
    if (at.minCoeff() <= best && p != first) continue;
    best = at.minCoeff();
    const Vec3 own = piece.in_patch * at;
    place = {p, own.x(), own.y()};
  }
  return place;
}

template <class Real, class T>
void place_points(const PatchCache& cache, const Surface<Real>& s,
                  const EvaluatedPoints<Real>& points, const SurfaceArrays<T>& out,
                  const Kernels<Real>& by) {
  const Vec3& o = cache.origin;
  const MeshPlacement mesh{{o.x(), o.y(), o.z()}, 1 / cache.scale};
  if constexpr (sizeof(T) == 4) {
    by.place_float(s, mesh, points, out);
  } else {
    by.place_double(s, mesh, points, out);
  }
  if (!out.d_xi && !out.d_eta) return;
  std::uint32_t last = kNone;
  Eigen::Matrix<double, 2, 2> map;  // d(patch xi, eta) / d(face xi, eta), of a part
  double per = 0;
  bool maps = false;
  if (points.patch_step == 0 && !is_piece_of_face(cache, *points.patch)) return;
  for (std::size_t i = 0; i < points.count; ++i) {
    const std::uint32_t p = points.patch_of(i);
    if (p != last) {
      last = p;
      maps = is_piece_of_face(cache, p);
      if (maps) {
        const PieceDomain<Real> piece(cache, s, p);
        map = (piece.in_patch * piece.in_face.inverse()).template topLeftCorner<2, 2>();
        per = static_cast<double>(s.patch[p * kPatchReals + kPatchUnscale]) * mesh.per;
      }
    }
    if (!maps) continue;
    const std::size_t to = points.target(i);
    for (std::size_t c = 0; c < 3; ++c) {
      const double xi = static_cast<double>(points.row(3 + c)[i]) * per,
                   eta = static_cast<double>(points.row(6 + c)[i]) * per;
      const int axis = static_cast<int>(c);
      if (out.d_xi) out.d_xi[axis][to] = static_cast<T>(xi * map(0, 0) + eta * map(1, 0));
      if (out.d_eta) out.d_eta[axis][to] = static_cast<T>(xi * map(0, 1) + eta * map(1, 1));
    }
  }
}

template <class Real>
RawHip<Real> raw_hip(const PatchCache& cache, const Vec3& hip) {
  RawHip<Real> raw;
  for (int i = 0; i < 3; ++i) {
    const double x = (hip[i] - cache.origin[i]) * cache.scale;
    raw.parts[i] = static_cast<Real>(x);
    raw.parts[i + 3] = static_cast<Real>(x - static_cast<double>(raw.parts[i]));
  }
  return raw;
}

template <class Real>
void correct_state(const PatchCache& cache, Method method, const RawHip<Real>& hip,
                   RawContact<Real>& raw) {
  if (cache.winding == nullptr) return;
  using Triple = Eigen::Map<Eigen::Matrix<Real, 3, 1>>;
  const Triple offset(&raw.reals[kContactOffset]);
  const double distance = offset.template cast<double>().norm();
  if (!(distance > 0)) return;  // NaN too
  const Vec3 x = vector_at(&hip.parts[0]) + vector_at(&hip.parts[3]);
  const WindingTree& winding = *cache.winding;
  // Through a hole goes whoever comes that way.
  if (!winding.counts(raw.uints[kContactPatch]) || (raw.uints[kContactFlags] & kOnBorder)) return;
  if (method == Method::kGregory && winding.may_be_between(x, distance)) return;
  const bool is_inside = winding.is_inside(x);
  if (is_inside == (raw.uints[kContactState] != 0)) return;
  raw.uints[kContactState] = is_inside;
  if (!is_inside) return;
  Triple(&raw.reals[kContactPush]) = offset;
  Triple(&raw.reals[kContactNormal]) = offset / static_cast<Real>(distance);
}

template <class Real>
TrackOptions<Real> track_options(const QueryOptions& options) {
  double tolerance = options.tolerance;
  // The paper's solver ends by the residual angle: its threshold of 1e-5.
  if (tolerance == 0)
    tolerance = options.solver == Solver::kPaper ? 1e-5 : sizeof(Real) == 4 ? 0x1p-18 : 0x1p-36;
  return {options.solver, options.max_iterations, static_cast<Real>(tolerance), options.budget};
}

namespace {

template <class T, class U>
void store(const Strided<T>& out, std::size_t i, U number) {
  out[i] = static_cast<T>(number);
}
template <class T>
void store(const StridedVectors<T>& out, std::size_t i, const Vec3& v) {
  for (int c = 0; c < 3; ++c) out[c][i] = static_cast<T>(v[c]);
}

// The numbers of a contact in the mesh's unit, by the names of their columns. The scale is a power
// of two: to multiply by 1 / scale is to divide.
template <class Real>
class ContactRows {
 public:
  ContactRows(const PatchCache& cache, const Surface<Real>& s, const RawContact<Real>& raw)
      : cache_(cache), s_(s), raw_(raw), per_(1 / cache.scale) {}

#define GLISS_NUMBER(Name, name) \
  double name() const { return number(raw_.reals[kContact##Name]); }
#define GLISS_LENGTH(Name, name) \
  double name() const { return number(raw_.reals[kContact##Name]) * per_; }
#define GLISS_POINT(Name, name) \
  Vec3 name() const { return from_local(cache_, s_, patch(), vec(raw_.reals + kContact##Name)); }
#define GLISS_DIRECTION(Name, name) \
  Vec3 name() const { return vec(raw_.reals + kContact##Name); }
#define GLISS_WAY(Name, name) \
  Vec3 name() const { return vec(raw_.reals + kContact##Name) * per_; }
#define GLISS_WORD(Name, name) \
  std::uint32_t name() const { return raw_.uints[kContact##Name]; }
  CONTACT_NUMBERS(GLISS_NUMBER, GLISS_LENGTH, GLISS_POINT, GLISS_DIRECTION, GLISS_WAY)
  CONTACT_WORDS(GLISS_WORD)

 protected:
  const PatchCache& cache_;
  const Surface<Real>& s_;
  const RawContact<Real>& raw_;
  const double per_;
};

// ... and those that are others for users.
template <class Real>
class ContactColumns : public ContactRows<Real> {
 public:
  using Rows = ContactRows<Real>;
  ContactColumns(const PatchCache& cache, const Surface<Real>& s, const RawContact<Real>& raw)
      : Rows(cache, s, raw), normal_(Rows::normal()), offset_(Rows::offset()) {}

  bool touching() const { return this->state() != 0; }
  std::uint32_t face() { return at().face; }
  double xi() { return at().xi; }
  double eta() { return at().eta; }
  Vec3 push() const {
    const Vec3 push = Rows::push();
    return touching() || push.hasNaN() ? push : Vec3(Vec3::Zero());
  }
  const Vec3& normal() const { return normal_; }
  double distance() const { return (touching() ? -1 : 1) * offset_.norm(); }
  double residual_angle() const {
    return std::atan2(offset_.cross(normal_).norm(), std::abs(offset_.dot(normal_)));
  }

 private:
  const DomainPoint& at() {
    if (!at_) at_ = face_point(this->cache_, this->s_, this->patch(), Rows::xi(), Rows::eta());
    return *at_;
  }
  const Vec3 normal_, offset_;
  std::optional<DomainPoint> at_;
};

}  // namespace

template <class Real>
Contact contact_of(const PatchCache& cache, const Surface<Real>& s, const RawContact<Real>& raw) {
  ContactColumns<Real> columns(cache, s, raw);
  Contact c;
#define GLISS_COLUMN_PLACED(Type, name, place) \
  c.place = static_cast<decltype(c.place)>(columns.name());
  GLISS_CONTACT_COLUMNS(GLISS_COLUMN_PLACED)
  return c;
}

template <class Real, class T>
void store_contact(const PatchCache& cache, const Surface<Real>& s, const RawContact<Real>& raw,
                   const ContactArrays<T>& out, std::size_t i) {
  ContactColumns<Real> columns(cache, s, raw);
#define GLISS_COLUMN_STORED(Type, name, place) \
  if (out.name) store(out.name, i, columns.name());
  GLISS_CONTACT_COLUMNS(GLISS_COLUMN_STORED)
}

#define GLISS_FRAMES(REAL)                                                                        \
  template Eigen::Vector2d domain_corner(const Surface<REAL>&, std::uint32_t, std::uint32_t);     \
  template PatchPlace place_of(const PatchCache&, const Surface<REAL>&, const DomainPoint&);      \
  template RawHip<REAL> raw_hip(const PatchCache&, const Vec3&);                                  \
  template void correct_state(const PatchCache&, Method, const RawHip<REAL>&, RawContact<REAL>&); \
  template TrackOptions<REAL> track_options(const QueryOptions&);                                 \
  template Contact contact_of(const PatchCache&, const Surface<REAL>&, const RawContact<REAL>&);  \
  GLISS_FRAMES_OUT(REAL, float)                                                                   \
  GLISS_FRAMES_OUT(REAL, double)
#define GLISS_FRAMES_OUT(REAL, T)                                                               \
  template void place_points(const PatchCache&, const Surface<REAL>&,                           \
                             const EvaluatedPoints<REAL>&, const SurfaceArrays<T>&,             \
                             const Kernels<REAL>&);                                             \
  template void store_contact(const PatchCache&, const Surface<REAL>&, const RawContact<REAL>&, \
                              const ContactArrays<T>&, std::size_t);
GLISS_FRAMES(float)
GLISS_FRAMES(double)

}  // namespace gliss
