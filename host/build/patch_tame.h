// Patches that stand in for one that folds or degenerates.
#pragma once

#include <vector>

#include "gliss/build/patch_draft.h"

namespace gliss {

// One patch, or one for each triangle of the face. Boundary curves are kept, so that the surface
// stays closed; boundary normals unless the kind is kBent. `exact` is examined; Its
// tables have the valence of the face and 3.
std::vector<PatchDraft> draft_tamer(const FaceCorners& face, PatchDraft exact,
                                    const Sampler& sampler);

// The patch of a face that neither folds nor degenerates, eased until it leaves its polygon by
// `most` (mesh frame), or as little as can be; none where it cannot be eased. Boundary normals are
// kept.
std::vector<PatchDraft> draft_flatter(const FaceCorners& face, PatchDraft exact, double most,
                                      const Sampler& sampler);

}  // namespace gliss
