// Patches that stand in for one that folds or degenerates.
#pragma once

#include <vector>

#include "gliss/build/patch_draft.h"

namespace gliss {

// One patch, or one for each triangle of the face. Boundary curves are kept, so that the surface
// stays closed; boundary normals unless the kind is kBent. `exact` is examined; `tables` has the
// valence of the face and 3.
std::vector<PatchDraft> draft_tamer(const FaceCorners& face, PatchDraft exact,
                                    const ValenceTables& tables);

}  // namespace gliss
