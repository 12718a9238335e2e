#include "tools/cli/parts/projection.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <future>
#include <random>

#include "gliss/base/units.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

constexpr int kSpotChecks = 4;  // of a part that is read
// Of a distance, and of the surface's size: other engines round otherwise.
constexpr double kAgreement = 1e-3, kRounding = 1e-6;
constexpr char kDistance[] = "distance";

// The body of a part: this, and the columns.
struct PartCounts {
  std::uint64_t inside, unconverged;
};

TableColumns<ProjectedHips> projection_columns(const ProjectionOptions& options,
                                               const PatchCache& cache) {
  using enum ColumnType;
  const std::string unit = unit_name(options.unit);
  const UnitChange outward(cache.unit, options.unit);
  TableColumns<ProjectedHips> columns;
  columns.add("face", kUint32, "", [](const Contact& c) { return c.at.face; })
      .was("patch")
      .add("xi", kFloat64, "", [](const Contact& c) { return c.at.xi; })
      .add("eta", kFloat64, "", [](const Contact& c) { return c.at.eta; })
      .add_vector({"x", "y", "z"}, kFloat64, unit,
                  [outward](const Contact& c) { return outward(c.scp); })
      .add_vector({"nx", "ny", "nz"}, kFloat64, "", &Contact::normal)
      .add(kDistance, kFloat64, unit, [outward](const Contact& c) { return outward(c.distance); })
      .add("iterations", kUint32, "", &Contact::iterations)
      .add("flags", kUint32, "", &Contact::flags);
  if (options.stiffness)
    columns.add_vector({"fx", "fy", "fz"}, kFloat64, "N",
                       [&cache, stiffness = *options.stiffness](const Contact& c) {
                         return contact_force(cache, c, stiffness);
                       });
  for (const std::string& name : options.keep)
    columns.add(name.c_str(), kFloat64, "", [name](const ProjectedHips& hips) {
      return hips.table.find(name)->begin() + hips.begin;
    });
  return columns;
}

}  // namespace

Projection::Projection(const ProjectionOptions& options, const PatchCache& cache,
                       const Engine& engine, PointReader& hips)
    : options_(options),
      cache_(cache),
      engine_(engine),
      hips_(hips),
      columns_(projection_columns(options, cache)),
      surface_(engine.reside(cache)) {}

void Projection::for_each_part(const std::function<void(const PointTable&)>& each) {
  for (std::size_t begin = 0; begin < hips_.rows(); begin += kPartRows)
    each(hips_.read(begin, std::min(hips_.rows(), begin + kPartRows)));
}

std::uint64_t Projection::run(const PartSource& source, PartFolder* folder, bool keeps_last,
                              const PartProgress& progress, const Sink& sink) {
  const auto policy = engine_.threads() > 1 ? std::launch::async : std::launch::deferred;
  std::uint64_t computed = 0;
  std::future<void> keeping;  // the part before
  const auto finish = [&] {
    if (keeping.valid()) keeping.get();
  };
  for (auto part = fetch(source, folder); part;) {
    const std::size_t missing = part->hips.points.size();
    compute(*part, progress);
    computed += missing;
    finish();
    auto next = fetch(source, folder);
    const bool saves =
        folder != nullptr && missing > 0 && (keeps_last || part->number + 1 < part_count());
    keeping = std::async(policy, [=, this, &sink, part = std::move(part)] {
      if (saves) save(*part, *folder);
      if (sink) sink(*part);
    });
    if (policy == std::launch::deferred) keeping.wait();
    part = std::move(next);
  }
  finish();
  return computed;
}

std::unique_ptr<Projection::Part> Projection::fetch(const PartSource& source, PartFolder* folder) {
  const std::size_t number = source();
  if (number >= part_count()) return nullptr;
  auto part = std::make_unique<Part>(columns());
  part->number = number;
  part->begin = number * kPartRows;
  part->end = std::min(hips_.rows(), part->begin + kPartRows);
  const auto file = folder == nullptr ? std::nullopt : folder->load(number);
  if (file && load(*part, *file)) return part;
  if (file) {
    folder->discard(number);
    part->rows.clear();
    part->inside = part->unconverged = 0;
  }
  part->hips = hips_.read(part->begin, part->end);
  return part;
}

bool Projection::load(ProjectedPart& part, const PartFile& file) {
  const std::size_t size = part.end - part.begin;
  PartCounts counts{};
  if (file.body().size() < sizeof counts) return false;
  std::memcpy(&counts, file.body().data(), sizeof counts);
  part.inside = counts.inside;
  part.unconverged = counts.unconverged;
  return std::max(part.inside, part.unconverged) <= size &&
         part.rows.take(file.body().substr(sizeof counts), size) && holds(part);
}

// True if some contacts, done again, are as far away.
bool Projection::holds(const ProjectedPart& part) {
  const auto rows = part.rows.block(0, part.rows.rows());
  const auto distances = std::get<std::span<const double>>(rows[columns().place_of(kDistance)]);
  const UnitChange inward(options_.unit, cache_.unit);
  std::minstd_rand dice(std::random_device{}());
  for (int i = 0; i < kSpotChecks; ++i) {
    const std::size_t row = dice() % part.rows.rows();
    PointTable hip = hips_.read(part.begin + row, part.begin + row + 1);
    place(hip);
    Contact contact;
    surface_->project(hip.points, options_.query, {&contact, 1});
    const double found = contact.distance, kept = inward(distances[row]);
    const double most = kAgreement * std::abs(found) + kRounding * diagonal_of(cache_.bounds());
    if (std::isfinite(found) ? !(std::abs(found - kept) <= most) : std::isfinite(kept))
      return false;
  }
  return true;
}

void Projection::save(const ProjectedPart& part, PartFolder& folder) const {
  const PartCounts counts{part.inside, part.unconverged};
  PartFile file;
  file.bytes.append(reinterpret_cast<const char*>(&counts), sizeof counts);
  part.rows.put(file.bytes);
  folder.save(part.number, file);
}

// Takes HIPs to the mesh's unit.
void Projection::place(PointTable& hips) const {
  const UnitChange inward(hips.unit, cache_.unit);
  for (Vec3& hip : hips.points) hip = inward(hip);
}

// Finds the contacts that are missing.
void Projection::compute(Part& part, const PartProgress& progress) {
  place(part.hips);
  const std::vector<Vec3>& hips = part.hips.points;
  std::vector<Contact> found;
  pace_.for_pieces(hips.size(), [&](std::size_t begin, std::size_t end) {
    found.resize(end - begin);
    surface_->project(std::span(hips).subspan(begin, end - begin), options_.query, found);
    add(part.hips, begin, found, part);
    progress(part.begin + part.rows.rows(), hips_.rows());
  });
  if (hips.empty()) progress(part.end, hips_.rows());
}

// Adds the contacts of HIPs from `begin` on.
void Projection::add(const PointTable& hips, std::size_t begin, const std::vector<Contact>& found,
                     ProjectedPart& part) const {
  columns_.fill(part.rows, {found, hips.table, begin}, found.size());
  for (const Contact& contact : found) {
    part.inside += contact.touching;
    part.unconverged += (contact.flags & kConverged) == 0;
  }
}

}  // namespace gliss::tools
