// Random numbers and places on a mesh, for walks: the same with every standard library.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "gliss/base/vector.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

// The same numbers with every standard library, whose distributions differ.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t walker);
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  // A sum of twelve: normal but for tails beyond 3, without a logarithm, whose last bit libraries
  // disagree on.
  double normal();
  // Between `least` and `least` x 2^octaves, about evenly by size. It takes products alone, for the
  // same reason.
  double size(double least, double octaves);
  Vec3 vector();  // of any direction

 private:
  std::mt19937_64 engine_;
};

// The triangles of a mesh's polygons, to choose points by area.
class Places {
 public:
  explicit Places(const Mesh& mesh);

  double area() const { return until_.back() / 2; }
  Vec3 choose(Random& random) const;

 private:
  std::vector<Vec3> corner_;   // [triangle][3]
  std::vector<double> until_;  // [triangle], sum of areas
};

// The middle and the diagonal of a mesh's bounding box.
struct BoxMeasure {
  explicit BoxMeasure(const Mesh& mesh);
  Vec3 middle;
  double diagonal;
};

// Turns a tangent about the normal by about `angle`, which is small.
Vec3 turned(const Vec3& direction, const Vec3& normal, double angle);

}  // namespace gliss
