#include "gliss/build/patch_batch.h"

#include <cmath>
#include <mutex>
#include <numbers>

#include "gliss/build/patch_draft.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

constexpr std::size_t kPatchGrain = 64;
constexpr std::uint32_t kMostCutSides = 32;  // of polygons whose ways to be cut into tiles are kept

}  // namespace

ValenceTables make_valence_tables(std::span<const char> used) {
  const Kernels<double>& k = kernels<double>();
  ValenceTables t;
  t.domain_begin.assign(used.size(), 0);
  t.probe_begin.assign(used.size(), 0);
  t.probe_count.assign(used.size(), 0);
  t.cuts.resize(used.size());
  t.second_begin.assign(2 * used.size(), 0);
  for (std::uint32_t n = 3; n < used.size(); ++n) {
    if (!used[n]) continue;
    append_domain(n, t.domain, t.domain_begin);
    t.probe_count[n] = k.probe_count(n);
    t.probe_begin[n] = static_cast<std::uint32_t>(t.probe.size());
    t.probe.resize(t.probe.size() + k.probe_reals(n));
    k.fill_probes(n, t.domain_of(n), &t.probe[t.probe_begin[n]]);
    if (n <= kMostCutSides) t.cuts[n] = tile_cuts_of(n);
    for (const std::uint32_t form : {fair_form(n), kFormPaper}) {
      const std::size_t begin = t.second.size(), reals = k.second_reals(form, n);
      if (reals == 0) continue;
      t.second_begin[2 * n + blends_sides(form)] = static_cast<std::uint32_t>(begin);
      t.second.resize(begin + reals);
      k.fill_second(t.domain_of(n), form, n, t.probes_of(n), &t.second[begin]);
    }
  }
  return t;
}

std::shared_ptr<const ValenceTables> shared_valence_tables(std::span<const char> used) {
  static std::mutex mutex;
  static std::shared_ptr<const ValenceTables> kept;
  static std::vector<char> kept_for;  // [valence]
  if (used.size() > kMostCutSides + 1)
    return std::make_shared<const ValenceTables>(make_valence_tables(used));
  const std::lock_guard lock(mutex);
  std::vector<char> all(kMostCutSides + 1, 0);
  for (std::size_t n = 0; n < all.size(); ++n)
    all[n] = (n < kept_for.size() && kept_for[n]) || (n < used.size() && used[n]);
  if (all != kept_for) {
    kept = std::make_shared<const ValenceTables>(make_valence_tables(all));
    kept_for = std::move(all);
  }
  return kept;
}

const double* ValenceTables::second_of(std::uint32_t form, std::uint32_t n) const {
  if (kernels<double>().second_reals(form, n) == 0) return nullptr;
  return &second[second_begin[2 * n + blends_sides(form)]];
}

void PatchBatch::resize(std::span<const std::uint32_t> valences,
                        std::span<const std::uint32_t> forms) {
  side_begin.assign(1, 0);
  control_begin.assign(1, 0);
  sample_begin.assign(1, 0);
  form.assign(forms.begin(), forms.end());
  for (std::size_t p = 0; p < valences.size(); ++p) {
    const std::size_t reals = kernels<double>().control_reals(forms[p], valences[p]);
    side_begin.push_back(side_begin.back() + valences[p]);
    control_begin.push_back(control_begin.back() + static_cast<std::uint32_t>(reals));
    const std::size_t samples = kCutRows * kernels<double>().probe_reals(valences[p]) / 2;
    sample_begin.push_back(sample_begin.back() + static_cast<std::uint32_t>(samples));
  }
  const std::size_t sides = side_begin.back(), patches = size();
  corner.resize(sides * 6);
  triangle.resize(3 * (sides - 2 * patches));
  frame.resize(patches * kFrameReals);
  inward_share.resize(patches);
  control.resize(control_begin.back());
  soundness.resize(patches);
  shape.clear(), sample.clear();
}

void build_patches(PatchBatch& b, const ParallelFor& parallel) {
  const Kernels<double>& k = kernels<double>();
  parallel(b.to_build, kPatchGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t first = begin, last; first < end; first = last) {  // of one valence
      const std::uint32_t n = b.valence(first);
      for (last = first + 1; last < end && b.valence(last) == n;) ++last;
      const std::size_t side = b.side_begin[first];
      k.build_patches(&b.corner[side * 6], n, last - first, &b.control[b.control_begin[first]],
                      &b.soundness[first]);
    }
  });
}

}  // namespace gliss
