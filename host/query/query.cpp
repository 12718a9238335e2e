#include "gliss/query/query.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/frames.h"
#include "gliss/surface/domain.h"

namespace gliss {
namespace {

// HIPs that the kernels are asked about at once.
constexpr std::size_t kHips = 256;

template <class Real>
struct HipPiece {
  std::vector<RawHip<Real>> hips = std::vector<RawHip<Real>>(kHips);
  std::vector<RawContact<Real>> contacts = std::vector<RawContact<Real>>(kMethods * kHips);
};
template <class Real>
HipPiece<Real>& own_hips() {
  thread_local HipPiece<Real> piece;
  return piece;
}

template <class Real, class T>
void take_hips(const PatchCache& cache, const HipArrays<T>& hips, std::size_t begin,
               std::size_t count, HipPiece<Real>& piece) {
  for (std::size_t i = 0; i < count; ++i)
    piece.hips[i] = raw_hip<Real>(cache, hip_at(hips, begin + i));
}

template <class T>
void find_nearest(const PatchCache& cache, const HipArrays<T>& hips,
                  std::span<const Method> methods, const QueryOptions& options,
                  std::span<const ContactArrays<T>> out) {
  require_patches(cache);
  require_room(kMethods, methods.size());
  require_room(out.size(), methods.size());
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    HipPiece<Real>& piece = own_hips<Real>();
    for (std::size_t begin = 0; begin < hips.count; begin += kHips) {
      const std::size_t count = std::min(kHips, hips.count - begin);
      take_hips(cache, hips, begin, count, piece);
      kernels<Real>().nearest(s, methods.data(), methods.size(), track_options<Real>(options),
                              piece.hips.data(), count, piece.contacts.data());
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t m = 0; m < methods.size(); ++m) {
          RawContact<Real>& raw = piece.contacts[i * methods.size() + m];
          correct_state(cache, methods[m], piece.hips[i], raw);
          store_contact(cache, s, raw, out[m], begin + i);
        }
      }
    }
  });
}

template <class T>
void track_from(const PatchCache& cache, const HipArrays<T>& hips, const PointArrays<T>& starts,
                const QueryOptions& options, const ContactArrays<T>& out) {
  require_patches(cache);
  require_room(starts.count, hips.count);
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    HipPiece<Real>& piece = own_hips<Real>();
    for (std::size_t begin = 0; begin < hips.count; begin += kHips) {
      const std::size_t count = std::min(kHips, hips.count - begin);
      take_hips(cache, hips, begin, count, piece);
      for (std::size_t i = 0; i < count; ++i) {
        piece.contacts[i] = {};
        place_at(place_of(cache, s, point_at(starts, begin + i)), piece.contacts[i]);
      }
      kernels<Real>().track(s, options.method, track_options<Real>(options), piece.hips.data(),
                            count, piece.contacts.data());
      for (std::size_t i = 0; i < count; ++i)
        store_contact(cache, s, piece.contacts[i], out, begin + i);
    }
  });
}

}  // namespace

void require_room(std::size_t room, std::size_t needed) {
  if (room < needed) {
    throw std::invalid_argument("a batch of " + std::to_string(needed) +
                                " has room or starts for " + std::to_string(room) + " only");
  }
}

DomainPoint on_side(std::uint32_t face, std::uint32_t n, std::uint32_t k, double t) {
  const DomainVec X = on_side(n, k, t);
  return {face, X.x(), X.y()};
}

bool in_domain(const PatchCache& cache, const DomainPoint& point) {
  if (point.face >= cache.mesh_face_count || cache.first_patch(point.face) == kNone) return false;
  return with_surface(cache, [&](const auto& s) {
    const std::uint32_t n = cache.face_valence[point.face];
    const auto* domain = &s.domain[s.domain_begin[n]];
    const double apothem = static_cast<double>(domain[0]);
    for (std::uint32_t k = 0; k < n; ++k) {
      const auto* outward = domain + kDomainHead + kDomainStride * k;
      const double along =
          static_cast<double>(outward[0]) * point.xi + static_cast<double>(outward[1]) * point.eta;
      if (!(along <= apothem + 1e-6)) return false;
    }
    return true;
  });
}

Contact nearest(const PatchCache& cache, const Vec3& hip, const QueryOptions& options) {
  Contact contact;
  nearest(cache, hip, {&options.method, 1}, options, {&contact, 1});
  return contact;
}

void nearest(const PatchCache& cache, const Vec3& hip, std::span<const Method> methods,
             const QueryOptions& options, std::span<Contact> out) {
  require_patches(cache);
  require_room(kMethods, methods.size());
  require_room(out.size(), methods.size());
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    std::array<RawContact<Real>, kMethods> raw;
    const RawHip<Real> there = raw_hip<Real>(cache, hip);
    kernels<Real>().nearest(s, methods.data(), methods.size(), track_options<Real>(options), &there,
                            1, raw.data());
    for (std::size_t i = 0; i < methods.size(); ++i) {
      correct_state(cache, methods[i], there, raw[i]);
      out[i] = contact_of(cache, s, raw[i]);
    }
  });
}

void nearest(const PatchCache& cache, const HipArrays<double>& hips,
             std::span<const Method> methods, const QueryOptions& options,
             std::span<const ContactArrays<double>> out) {
  find_nearest(cache, hips, methods, options, out);
}
void nearest(const PatchCache& cache, const HipArrays<float>& hips, std::span<const Method> methods,
             const QueryOptions& options, std::span<const ContactArrays<float>> out) {
  find_nearest(cache, hips, methods, options, out);
}
void nearest(const PatchCache& cache, std::span<const Vec3> hips, std::span<const Method> methods,
             const QueryOptions& options, std::span<Contact> out) {
  require_room(kMethods, methods.size());
  find_nearest<double>(cache, arrays_of(hips), methods, options,
                       by_method(out, hips.size(), methods.size()));
}

void track(const PatchCache& cache, const HipArrays<double>& hips,
           const PointArrays<double>& starts, const QueryOptions& options,
           const ContactArrays<double>& out) {
  track_from(cache, hips, starts, options, out);
}
void track(const PatchCache& cache, const HipArrays<float>& hips, const PointArrays<float>& starts,
           const QueryOptions& options, const ContactArrays<float>& out) {
  track_from(cache, hips, starts, options, out);
}
void track(const PatchCache& cache, std::span<const Vec3> hips, std::span<const DomainPoint> starts,
           const QueryOptions& options, std::span<Contact> out) {
  require_room(out.size(), hips.size());
  track_from(cache, arrays_of(hips), arrays_of(starts), options, arrays_of(out));
}

HipArrays<double> arrays_of(std::span<const Vec3> hips) {
  if (hips.empty()) return {};
  return {hips.size(), strided_vectors(hips.data()->data(), sizeof(Vec3))};
}

namespace {

template <class N>
Strided<N> column_of(N& number) {
  return {&number, sizeof(Contact)};
}
StridedVectors<double> column_of(Vec3& vector) {
  return strided_vectors(vector.data(), sizeof(Contact));
}

}  // namespace

ContactArrays<double> arrays_of(std::span<Contact> contacts) {
  ContactArrays<double> arrays;
  if (contacts.empty()) return arrays;
  Contact& first = contacts.front();
#define GLISS_COLUMN_OF(Type, name, place) arrays.name = column_of(first.place);
  GLISS_CONTACT_COLUMNS(GLISS_COLUMN_OF)
  return arrays;
}

std::array<ContactArrays<double>, kMethods> by_method(std::span<Contact> contacts, std::size_t hips,
                                                      std::size_t methods) {
  require_room(contacts.size(), methods * hips);
  std::array<ContactArrays<double>, kMethods> arrays;
  for (std::size_t m = 0; m < std::min(methods, kMethods); ++m)
    arrays[m] = arrays_of(contacts.subspan(m * hips, hips));
  return arrays;
}

}  // namespace gliss
