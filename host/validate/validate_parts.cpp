#include "gliss/validate/validate_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "gliss/build/hierarchy.h"
#include "gliss/build/overlaps.h"
#include "gliss/mesh/solid_angle.h"
#include "gliss/mesh/triangulate.h"
#include "gliss/validate/face_edit.h"

namespace gliss {
namespace {

using Triangle = const Vec3*;  // three corners

// On which side of the plane of a, b, c a point lies: 0 where rounding could decide.
int side_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 u = a - x, v = b - x, w = c - x;
  const double volume = u.dot(v.cross(w));
  const double most = u.cwiseAbs().dot(Vec3(std::abs(v.y() * w.z()) + std::abs(v.z() * w.y()),
                                            std::abs(v.z() * w.x()) + std::abs(v.x() * w.z()),
                                            std::abs(v.x() * w.y()) + std::abs(v.y() * w.x())));
  return std::abs(volume) <= 1e-14 * most ? 0 : volume > 0 ? 1 : -1;
}

// True if a segment that does not lie in the triangle's plane meets it.
bool pierces(const Vec3& from, const Vec3& to, Triangle t) {
  const int begin = side_of(t[0], t[1], t[2], from), end = side_of(t[0], t[1], t[2], to);
  if (begin == end || begin * end > 0) return false;
  int sum = 0, sides = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = side_of(from, t[k], t[(k + 1) % 3], to);
    sum += side;
    sides += side != 0;
  }
  return std::abs(sum) == sides;
}

bool meet(Triangle a, Triangle b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (pierces(a[k], a[(k + 1) % 3], b) || pierces(b[k], b[(k + 1) % 3], a)) return true;
  }
  return false;
}

// Six times the volume of the cone from `apex` over faces, and its size without sign.
struct Volume {
  double value = 0;
  double size = 0;
};

Volume cone_volume(const Mesh& mesh, const std::vector<std::uint32_t>& faces, const Vec3& apex) {
  const auto from_apex = [&](std::uint32_t corner) -> Vec3 {
    return mesh.positions[mesh.corner_vertex[corner]] - apex;
  };
  Volume all;
  for (const std::uint32_t face : faces) {
    const std::uint32_t begin = mesh.face_begin[face];
    const Vec3 first = from_apex(begin);
    Volume own;
    for (std::uint32_t c = begin + 1; c + 1 < mesh.face_begin[face + 1]; ++c) {
      const double part = first.dot(from_apex(c).cross(from_apex(c + 1)));
      own.value += part;
      own.size += std::abs(part);
    }
    all.value += own.value;
    all.size += own.size;
  }
  return all;
}

}  // namespace

PartPairs::PartPairs(Mesh& mesh, MeshParts& parts, Report& report)
    : mesh_(mesh), parts_(parts), report_(report), faces_(parts.count()) {
  for (std::uint32_t face = 0; face < parts.of_face.size(); ++face)
    faces_[parts.of_face[face]].push_back(face);
  find_volumes();
}

void PartPairs::find_volumes() {
  constexpr double kRounding = 1e-12;
  for (std::uint32_t part = 0; part < parts_.count(); ++part) {
    const Vec3 apex = corner(mesh_.face_begin[parts_.first_face[part]]);
    const Volume sum = cone_volume(mesh_, faces_[part], apex);
    parts_.volume.push_back(std::abs(sum.value) > kRounding * sum.size ? sum.value : 0);
    if (parts_.closed[part] && parts_.volume[part] == 0)
      report_.add(Severity::kWarning, "no-volume", {.face = parts_.first_face[part]},
                  "belongs to a closed part that encloses nothing ({} faces)", faces_[part].size());
  }
}

void PartPairs::turn(const LoadOptions& options) {
  std::vector<std::uint32_t> closed;
  bool is_any_inside_out = false;
  for (std::uint32_t part = 0; part < parts_.count(); ++part) {
    if (encloses(part)) {
      closed.push_back(part);
      is_any_inside_out = is_any_inside_out || parts_.volume[part] < 0;
    } else if (!parts_.closed[part] && options.flip) {
      reverse_part(part);
    }
  }
  if (!is_any_inside_out || options.orient == Orient::kFile) return;
  find_containers();
  // A part that holds others comes before these.
  std::stable_sort(closed.begin(), closed.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::abs(parts_.volume[a]) > std::abs(parts_.volume[b]);
  });
  std::vector<char> turned(parts_.count(), 0);
  for (const std::uint32_t part : closed) {
    // A part that is turned takes all within along.
    const std::uint32_t around = (*container_)[part];
    bool is_reversed = around != kNone && turned[around] != 0;
    const bool is_inward = is_reversed != (parts_.volume[part] < 0);
    if (is_inward && !lies_in_solid(part)) {
      is_reversed = !is_reversed;
      if (is_reversed)
        report_.add(
            report_.mended, "inside-out-part", {.face = parts_.first_face[part]},
            "belongs to a part that is inside out ({} faces): a mistake, which turns outward "
            "unless strict, or a room, which stays with orient=file",
            faces_[part].size());
    }
    if (is_reversed) reverse_part(part);
    turned[part] = is_reversed;
  }
}

void PartPairs::reverse_part(std::uint32_t part) {
  for (const std::uint32_t face : faces_[part]) reverse_face(mesh_, face);
  parts_.volume[part] = -parts_.volume[part];
}

void PartPairs::warn() {
  const auto is_closed = [](char closed) { return closed != 0; };
  if (parts_.count() > 1 && std::any_of(parts_.closed.begin(), parts_.closed.end(), is_closed)) {
    find_meeting();
    if (!met_.empty())
      report_
          .add(Severity::kWarning, "parts-intersect", {.face = meets_},
               "meets face {} of another part ({} pairs of parts{})", report_.number_of(other_),
               met_.size(), met_.size() < kMostPairs ? "" : " or more; no others are looked for")
          .count = met_.size();
    if (met_.size() < kMostPairs) find_containers();
  }
  for (std::uint32_t part = 0; part < parts_.count(); ++part) warn_of_place(part);
  for (std::uint32_t part = 0; part < parts_.count(); ++part) {
    if (!parts_.closed[part]) warn_of_inward(part);
  }
}

// Says that a part lies within another, or has the space around it for its solid.
void PartPairs::warn_of_place(std::uint32_t part) {
  const Report::Place place{.face = parts_.first_face[part]};
  const bool is_cavity = encloses(part) && parts_.volume[part] < 0;
  if (lies_in_solid(part)) {
    const std::uint32_t around = report_.number_of(parts_.first_face[(*container_)[part]]);
    if (is_cavity) {
      report_.add(Severity::kWarning, "cavity", place,
                  "belongs to a cavity of the part of face {} ({} faces)", around,
                  faces_[part].size());
    } else {
      report_.add(Severity::kWarning, "part-inside-part", place,
                  "belongs to a part that lies within that of face {}", around);
    }
  } else if (is_cavity) {
    report_.add(Severity::kWarning, "room", place,
                "belongs to a closed part that is a room ({} faces): its inside is free, and what "
                "is around it is solid",
                faces_[part].size());
  }
}

// Says that most of an open part faces its own middle. A flat one has none.
void PartPairs::warn_of_inward(std::uint32_t part) {
  constexpr double kMost = 0.5, kFlat = 1e-3;
  const std::vector<std::uint32_t>& faces = faces_[part];
  Vec3 middle = Vec3::Zero();
  std::size_t corners = 0;
  for (const std::uint32_t face : faces) {
    for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c) {
      middle += corner(c);
      ++corners;
    }
  }
  middle /= static_cast<double>(corners);
  const Volume sum = cone_volume(mesh_, faces, middle);
  double reach2 = 0;
  for (const std::uint32_t face : faces)
    reach2 = std::max(reach2, (corner(mesh_.face_begin[face]) - middle).squaredNorm());
  if (!(sum.value < -kMost * sum.size) || !(sum.size > kFlat * reach2 * std::sqrt(reach2))) return;
  report_.add(Severity::kWarning, "faces-inward", {.face = parts_.first_face[part]},
              "belongs to an open part most of which faces its own middle ({} faces): where that "
              "is its outside, --flip turns it over",
              faces.size());
}

// True if the closed part next around it is solid there, and not a cavity or a room.
bool PartPairs::lies_in_solid(std::uint32_t part) const {
  if (!container_) return false;
  const std::uint32_t around = (*container_)[part];
  return around != kNone && parts_.volume[around] > 0;
}

void PartPairs::find_boxes() {
  if (!boxes_.empty()) return;
  for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
    report_.poll();
    boxes_.push_back(box_of(mesh_, face));
  }
  for (const std::vector<std::uint32_t>& faces : faces_) {
    Box all = boxes_[faces.front()];
    for (const std::uint32_t face : faces) all.hold(boxes_[face]);
    part_boxes_.push_back(all);
  }
}

// Fills met_ with the pairs of parts that meet, one of them closed.
void PartPairs::find_meeting() {
  if (std::exchange(has_met_, true)) return;
  find_boxes();
  LargeArray<double> node;
  LargeArray<std::uint32_t> child;
  build_hierarchy(boxes_, node, child, serial_for);
  const std::vector<std::uint32_t>& part = parts_.of_face;
  Overlaps<double>(node, child, part)
      .for_each(
          [&](std::uint32_t a, std::uint32_t b) {
            report_.poll();
            return (!parts_.closed[a] && !parts_.closed[b]) || met_.contains(key(a, b));
          },
          [&](std::uint32_t a, std::uint32_t b) {
            report_.poll();
            if (!faces_meet(a, b)) return true;
            met_.insert(key(part[a], part[b]));
            if (std::min(a, b) < meets_) {
              meets_ = std::min(a, b);
              other_ = std::max(a, b);
            }
            return met_.size() < kMostPairs;
          });
}

bool PartPairs::faces_meet(std::uint32_t a, std::uint32_t b) const {
  std::vector<Vec3> of_a, of_b;
  append_triangles(mesh_, a, of_a), append_triangles(mesh_, b, of_b);
  for (std::size_t i = 0; i < of_a.size(); i += 3) {
    for (std::size_t k = 0; k < of_b.size(); k += 3) {
      if (meet(&of_a[i], &of_b[k])) return true;
    }
  }
  return false;
}

// Finds the smallest of the closed parts that a part lies in and does not meet.
void PartPairs::find_containers() {
  if (container_) return;
  container_.emplace(parts_.count(), kNone);
  if (parts_.count() < 2) return;
  find_meeting();
  const BoxTree boxes(part_boxes_);
  const auto size = [&](std::uint32_t part) { return std::abs(parts_.volume[part]); };
  for (std::uint32_t part = 0; part < parts_.count(); ++part) {
    const Vec3& x = corner(mesh_.face_begin[parts_.first_face[part]]);
    (*container_)[part] = boxes.smallest_at(x, size, [&](std::uint32_t other) {
      return other != part && encloses(other) && !met_.contains(key(part, other)) &&
             winds_round(other, x);
    });
  }
}

bool PartPairs::winds_round(std::uint32_t part, const Vec3& x) const {
  double angle = 0;
  std::vector<Vec3> t;
  for (const std::uint32_t face : faces_[part]) {
    report_.poll();
    t.clear();
    append_triangles(mesh_, face, t);
    for (std::size_t i = 0; i < t.size(); i += 3)
      angle += solid_angle(t[i] - x, t[i + 1] - x, t[i + 2] - x);
  }
  return std::abs(angle) > 2 * std::numbers::pi;
}

}  // namespace gliss
