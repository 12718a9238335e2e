// Thin parts at any speed: a HIP that enters a plate or a fin stays on the side that it came from,
// however many thicknesses it moves in a tick.
#include <mutex>

#include "gliss/contact/tracker.h"
#include "gliss/engine/engine.h"
#include "tests/extremes/extreme_hips.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Extreme;

// A way into a part, in ticks: the first HIP is outside.
struct Entry {
  Vec3 from, to, side;  // side: outward normal of the surface that it enters by
  Vec3 near;            // of the way, outside
  int ticks;
};

// Through the top or the bottom, away from the rim, to as far beyond the other side.
Entry plate_entry(Rng& rng, const Extreme& e) {
  constexpr double kThickness = 0.5, kInner = 10, kHalf = kThickness / 2;
  const double up = rng() % 2 ? 1 : -1;
  const auto inner = [&] { return uniform(rng, -kInner, kInner); };
  const double above = kThickness * std::pow(10, uniform(rng, -3, 2)),
               beneath = kThickness * std::pow(10, uniform(rng, -3, 1));
  const Vec3 from(inner(), inner(), up * (kHalf + above)),
      to(inner(), inner(), up * (kHalf - beneath));
  return {e.middle() + from, e.middle() + to, up * Vec3::UnitZ(), e.middle() + from,
          1 + static_cast<int>(rng() % 12)};
}

// Through a flank of the wedge, which bulges to 5.1 mm, to any place between the flanks.
Entry fin_entry(Rng& rng, const Extreme&) {
  const double side = rng() % 2 ? 1 : -1;
  const auto flank = [&](double x) {
    return Vec3(side * x, uniform(rng, -10, 10), uniform(rng, 3, 9));
  };
  const Vec3 from = flank(5.2 + 5 * std::pow(10, uniform(rng, -3, 1.5))),
             to = flank(uniform(rng, -3.5, 3.5));
  const double left = (side * from.x() - 5.2) / (side * (from - to).x());
  return {from, to, side * Vec3::UnitX(), from + left * (to - from),
          1 + static_cast<int>(rng() % 12)};
}

Contact at_end(const Extreme& e, const Vec3& from, const Vec3& to, int ticks) {
  ContactTracker tracker(e.cache, test::leaping());
  Contact contact = tracker.tick(from);
  for (int k = 1; k <= ticks; ++k) contact = tracker.tick(from + (to - from) * k / ticks);
  // What one tick may not spend, the next ones do.
  for (int late = 0; late < 50 && !contact.touching; ++late) contact = tracker.tick(to);
  return contact;
}

bool keeps_side(const Contact& contact, const Entry& entry) {
  return contact.touching && contact.normal.dot(entry.side) > 0;
}

// Deep beyond the middle of a part that is round, no point of the side that it came in by may be
// nearest to what is around it: then a slow hand is pushed to the other side too.
bool is_sound(const Extreme& e, const Entry& entry, const Contact& contact) {
  if (keeps_side(contact, entry)) return true;
  const bool beyond = (entry.to - e.middle()).dot(entry.side) < 0;
  return contact.touching && beyond && !keeps_side(at_end(e, entry.near, entry.to, 400), entry);
}

struct Passing {
  std::uint64_t through = 0, free = 0, slid = 0;
  std::string first;

  void add(const Passing& other) {
    if (first.empty()) first = other.first;
    through += other.through, free += other.free, slid += other.slid;
  }
};

struct Thin {
  const char* name;
  Entry (*entry)(Rng&, const Extreme&);
  std::uint64_t many;
  double through = 0;  // what is reached where that is more than the goal
};

void PrintTo(const Thin& thin, std::ostream* out) { *out << thin.name; }

class ExtremeEntry : public ::testing::TestWithParam<Thin> {};

TEST_P(ExtremeEntry, keeps_its_side_at_any_speed) {
  constexpr std::size_t kBlock = 250;
  const Extreme& e = test::extreme(GetParam().name);
  const std::uint64_t count = test::samples(3'000, GetParam().many);
  const auto engine = make_tbb_engine();
  Passing all;
  std::mutex mutex;
  engine->for_each(count, kBlock, [&](std::size_t begin, std::size_t end) {
    Rng rng(9000 + begin);
    Passing p;
    for (std::size_t i = begin; i < end; ++i) {
      const Entry entry = GetParam().entry(rng, e);
      const Contact contact = at_end(e, entry.from, entry.to, entry.ticks);
      if (is_sound(e, entry, contact)) {
        p.slid += !keeps_side(contact, entry);
        continue;
      }
      ++(contact.touching ? p.through : p.free);
      if (p.first.empty())
        p.first = fmt::format("({:.17g}, {:.17g}, {:.17g}) to ({:.17g}, {:.17g}, {:.17g}) in {}",
                              entry.from.x(), entry.from.y(), entry.from.z(), entry.to.x(),
                              entry.to.y(), entry.to.z(), entry.ticks);
    }
    const std::lock_guard lock(mutex);
    all.add(p);
  });
  test::record(GetParam().name, "{} through, {} free, {} slid round as a slow hand; first {}",
               all.through, all.free, all.slid, all.first);
  const auto share = [&](std::uint64_t some) {
    return static_cast<double>(some) / static_cast<double>(count);
  };
  const std::string what =
      fmt::format("entries of a {} at any speed: share that is ", GetParam().name);
  test::hold({"Tracking", what + "pushed to the other side", 0, GetParam().through,
              "so deep that the flank's nearest point vanishes, where it goes depends on the pace"},
             share(all.through), count);
  test::hold({"Tracking", what + "not felt", 0}, share(all.free), count);
}

INSTANTIATE_TEST_SUITE_P(, ExtremeEntry,
                         ::testing::Values(Thin{"plate", plate_entry, 1'000'000},
                                           Thin{"fin", fin_entry, 250'000, 2e-3},
                                           Thin{"fair fin", fin_entry, 250'000, 2e-3}),
                         test::kNameOf);

}  // namespace
}  // namespace gliss
