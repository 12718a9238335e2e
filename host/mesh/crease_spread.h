// Moves the vertices of a mesh along its surface, so that its creases can be rounded by more than
// the faces at them allow. Private to host/.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "gliss/mesh/crease_steps.h"
#include "gliss/mesh/smooth_walk.h"

namespace gliss {

// Vertices near creases make way for the corners that step away from the edge: those within smooth
// regions, and those on creases near their ends and bends, which stay. Triangles that lie in one
// plane, or nearly so, exchange diagonals.
class CreaseSpread {
 public:
  // All of them must outlive it; `room`: that of the mesh as it is.
  CreaseSpread(const Mesh& mesh, const Topology& topology, const CreaseSteps& steps,
               const CreaseRoom& room);

  // Makes more room, for a radius that does not fit yet. Returns false where that comes to an end.
  // Until it fits, nothing depends on that radius: so all up to the largest that fits do.
  bool widen(double radius);
  // The largest radius that fits now, and the face with the least room.
  CreaseRoom fits() const { return {std::max(tried_, kRoom * room_.radius), room_.face}; }
  // The same of all times.
  const CreaseRoom& best() const { return best_; }

  // The mesh and the rest as they are now; it has no normals, and its faces may be turned over
  // beside the creases until the corners have made their steps.
  const Mesh& mesh() const { return mesh_; }
  const Topology& topology() const { return topology_; }
  const CreaseSteps& steps() const { return steps_; }
  const SmoothWalk& walk() const { return walk_; }

 private:
  // A place near a free vertex.
  struct Pull {
    std::uint32_t vertex;
    Vec3 step;
    double weight;
  };
  // The ways of a vertex: it stays, moves within its smooth region, or along its crease.
  enum class Kind : std::uint8_t { kFixed, kFree, kSlides };

  std::uint32_t vertex_of(std::uint32_t corner) const { return mesh_.corner_vertex[corner]; }
  const Vec3& position(std::uint32_t corner) const { return mesh_.positions[vertex_of(corner)]; }
  const Vec3& normal(std::uint32_t corner) const {
    return steps_.sectors.normals[steps_.sectors.group[corner]];
  }
  std::uint32_t next(std::uint32_t side) const { return next_side(mesh_, topology_, side); }
  std::uint32_t prev(std::uint32_t side) const { return prev_side(mesh_, topology_, side); }
  std::uint32_t right_of(std::uint32_t side) const { return next(topology_.side_twin[side]); }

  template <class Visit>
  void for_each_corner(std::uint32_t vertex, Visit visit) const;
  void place_corners();
  std::size_t inverted_count() const;
  void list_sectors();
  void find_kinds();
  bool is_smooth(std::uint32_t vertex) const;
  bool passes(std::uint32_t vertex);
  void spread_reach(std::vector<double>& reach, bool on_creases) const;

  bool flip_all();
  bool flips(std::uint32_t side) const;
  Vec3 first_place(std::uint32_t corner) const;
  bool is_opened(std::uint32_t corner) const;
  bool is_in_opened(std::uint32_t corner) const;
  bool are_joined(std::uint32_t side, std::uint32_t vertex) const;
  void flip(std::uint32_t side);

  double length_of(std::uint32_t side) const;
  double stretch_of(std::uint32_t side) const;
  void slide_along();
  void add_pulls(std::uint32_t vertex, std::vector<Pull>& pulls) const;
  void follow();
  Vec3 speed_of(std::uint32_t vertex, const Vec3& step) const;
  Vec3 slide_of(std::uint32_t vertex) const;
  void move(double time);
  void put_on_crease(std::uint32_t vertex);

  const SmoothWalk walk_;
  Mesh mesh_;
  Topology topology_;
  CreaseSteps steps_;
  CreaseRoom room_;  // from where corners are placed
  CreaseRoom best_;
  std::size_t inverted_count_ = 0;  // at first
  int idle_ = 0;                    // steps since the best room grew
  double tried_ = 0;                // the radius by which corners are placed now

  std::vector<Vec3> place_;                                // [corner], at that radius
  std::vector<Kind> kind_;                                 // [vertex]
  std::vector<std::uint8_t> is_corner_;                    // [vertex], 1: it is cut, and stays
  std::vector<std::uint32_t> crease_ahead_, crease_back_;  // [vertex], sides where a crease passes
  std::vector<double> slide_;                // [vertex], along its crease ahead, by a radius of 1
  std::vector<Vec3> speed_;                  // [vertex], of free ones, by a radius of 1
  std::vector<SmoothWalk::OnFace> on_face_;  // [vertex], of free ones
  std::vector<SmoothWalk::OnCrease> on_crease_;  // [vertex], of cut ones
  std::vector<std::uint32_t> vertex_ahead_;      // [vertex], of cut ones: that along its crease
};

}  // namespace gliss
