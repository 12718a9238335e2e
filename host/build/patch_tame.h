// Patches that stand in for one that folds or degenerates.
//
// Several tests tell folds. A patch folds where its normal is at right angles to its base
// polygon's, or beyond; the cosine between both is its turn. Each test, what it costs beside
// building, and what it is for:
// - soundness: the weakest ribbon has cross tangents. Nothing; every patch.
// - PatchDraft::turned: cross tangents point into the face. Nothing; fair patches.
// - keeps_direction: the turn at the coarse probes. A sample at each; patches of other levels.
// - is_gentle (kernels/examine.h): the same, and curvature there allows no fold between. Nothing
//   beside examine(), which it ends; every patch.
// - PatchShape::turn: the least at all probes, n r (r + 1) / 2 of probe_levels r. These samples;
//   patches that are not gentle.
// - may_fold_unseen: that curvature allows a fold between probes. Nothing; the same.
// - least_cosine_closely: the least at nine times as many points. These; what may fold unseen,
// faces of many
//   sides, and substitutes.
// - least_cosine_at_rim: the least at the n r outermost probes. These; substitutes, before
// examine().
// - keeps_normals: the outside is out all along the boundary. 8 samples a side; substitutes.
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
