// A relief on a surface, finer than its mesh: grooves of a height that depends on the place.
#pragma once

#include "gliss/base/export.h"
#include "gliss/base/vector.h"
#include "gliss/surface/names.h"

namespace gliss {

enum class Relief { kNone, kGrating, kNoise };
inline constexpr Named<Relief> kReliefNames[] = {{"grating", Relief::kGrating},
                                                 {"noise", Relief::kNoise}};

// A relief in the object's frame, in m. It is solid: the place alone tells the height, so that it
// has no seams and needs no coordinates of the mesh's own.
struct TextureOptions {
  Relief relief = Relief::kNone;
  double height = 0;           // from the lowest place to the highest, which is the surface
  double period = 0;           // of a grating; of noise the side of its cells
  Vec3 along = Vec3::UnitX();  // of a grating: the way across its grooves, of any length

  bool any() const { return relief != Relief::kNone && height > 0; }
};

// Returns null if the options are valid; else why not, as the end of a sentence ("has a ...").
GLISS_EXPORT const char* fault_of(const TextureOptions& options) noexcept;

// The height of a relief, -height to 0, smooth to its second derivative. A grating is a cosine;
// noise is gradient noise (K. Perlin, Improving noise, 2002), the same on every machine.
class GLISS_EXPORT Texture {
 public:
  // The largest slope that a relief may have: steeper ones push more along the surface than out.
  static constexpr double kSteepest = 1;

  struct Place {
    double height;  // m
    Vec3 slope;     // its gradient
  };

  // Requires options without a fault.
  explicit Texture(const TextureOptions& options);

  // The height at a point, m.
  Place at(const Vec3& point) const noexcept;
  // A bound of its slope.
  double steepest() const;

 private:
  TextureOptions options_;
  Vec3 wave_;  // of a grating: the gradient of its phase, rad/m
};

}  // namespace gliss
