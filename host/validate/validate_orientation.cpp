// Turns faces one way round: neighbours agree, and most faces win.
#include <algorithm>
#include <utility>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/validate/face_edit.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

class Orientation {
 public:
  Orientation(Mesh& mesh, Report& report)
      : mesh_(mesh),
        report_(report),
        side_face_(side_faces(mesh)),
        other_(pair_sides(mesh, side_face_)),
        flip_(mesh.face_count(), Flip::kUnknown),
        flipped_(mesh.face_count(), false) {}

  MeshParts repair() {
    report_borders();
    parts_.of_face.resize(mesh_.face_count());
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      if (flip_[face] != Flip::kUnknown) continue;
      const bool closed = gather_part(face);
      orient_part();
      for (const std::uint32_t of_part : part_)
        parts_.of_face[of_part] = static_cast<std::uint32_t>(parts_.count());
      parts_.first_face.push_back(face);
      parts_.closed.push_back(closed);
    }
    report_flipped();
    if (parts_.count() > 1)
      report_
          .add(Severity::kWarning, "several-parts", {.face = parts_.first_face[1]},
               "shares no edge with the part of the first face ({} parts)", parts_.count())
          .count = parts_.count();
    return std::move(parts_);
  }

 private:
  enum class Flip : std::uint8_t { kUnknown, kKeep, kFlip };

  static Flip opposite(Flip flip) { return flip == Flip::kKeep ? Flip::kFlip : Flip::kKeep; }

  // Fills part_ with all faces around the first, each turned to suit it; true if none has a border.
  bool gather_part(std::uint32_t first) {
    bool closed = true;
    orientable_ = true;
    part_.assign(1, first);
    flip_[first] = Flip::kKeep;
    // part_ grows on the way. NOLINTNEXTLINE(modernize-loop-convert)
    for (std::size_t done = 0; done < part_.size(); ++done) {
      report_.poll();
      const std::uint32_t face = part_[done];
      for (std::uint32_t side = mesh_.face_begin[face]; side < mesh_.face_begin[face + 1]; ++side) {
        if (other_[side] == kNone) {
          closed = false;
        } else {
          visit_neighbour(side);
        }
      }
    }
    return closed;
  }

  void visit_neighbour(std::uint32_t side) {
    const std::uint32_t face = side_face_[side];
    const std::uint32_t neighbour = side_face_[other_[side]];
    const bool agree = mesh_.corner_vertex[side] != mesh_.corner_vertex[other_[side]];
    const Flip needed = agree ? flip_[face] : opposite(flip_[face]);
    if (flip_[neighbour] == Flip::kUnknown) {
      flip_[neighbour] = needed;
      part_.push_back(neighbour);
    } else if (flip_[neighbour] != needed && std::exchange(orientable_, false)) {
      const std::uint32_t from = mesh_.corner_vertex[side];
      report_.add(Severity::kError, "non-orientable", {.face = face, .vertex = from},
                  "cannot be turned the way of its neighbour at edge {}-{} and of all others", from,
                  end_vertex(side));
    }
  }

  void orient_part() {
    if (!orientable_) return;
    const auto is_flipped = [&](std::uint32_t face) { return flip_[face] == Flip::kFlip; };
    const auto flipped = std::count_if(part_.begin(), part_.end(), is_flipped);
    if (2 * static_cast<std::size_t>(flipped) > part_.size()) reverse_part();
    for (const std::uint32_t face : part_) {
      flipped_[face] = is_flipped(face);
      if (flipped_[face]) reverse_face(mesh_, face);
    }
  }

  // Both in the order of the file, so that the first is named.
  void report_flipped() {
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      if (!flipped_[face]) continue;
      report_.add(Severity::kRepaired, "flipped-face", {.face = face},
                  "turned the other way than its part; turned back");
    }
  }
  void report_borders() {
    for (std::uint32_t side = 0; side < other_.size(); ++side) {
      report_.poll();
      if (other_[side] != kNone) continue;
      const std::uint32_t from = mesh_.corner_vertex[side];
      report_.add(Severity::kWarning, "open-border", {.face = side_face_[side], .vertex = from},
                  "has no neighbour beyond edge {}-{}", from, end_vertex(side));
    }
  }

  void reverse_part() {
    for (const std::uint32_t face : part_) flip_[face] = opposite(flip_[face]);
  }

  std::uint32_t end_vertex(std::uint32_t side) const {
    return mesh_.corner_vertex[next_corner(mesh_, side_face_[side], side)];
  }

  Mesh& mesh_;
  Report& report_;
  std::vector<std::uint32_t> side_face_;
  std::vector<std::uint32_t> other_;  // [side], across the edge; kNone: border
  std::vector<Flip> flip_;            // [face]
  std::vector<bool> flipped_;         // [face], against most of its part
  std::vector<std::uint32_t> part_;   // faces of the part in hand
  bool orientable_ = true;            // that part, so far
  MeshParts parts_;
};

}  // namespace

MeshParts repair_orientation(Mesh& mesh, Report& report) {
  return Orientation(mesh, report).repair();
}

}  // namespace gliss
