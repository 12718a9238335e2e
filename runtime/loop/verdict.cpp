#include "gliss/loop/verdict.h"

#include <algorithm>

namespace gliss {
namespace {

bool meets(const TickRecord& loop, const LoopGoals& goals, Nanoseconds floor) {
  return loop.ticks() > 0 && loop.lateness().quantile(0.999) <= floor + goals.wake &&
         loop.compute().quantile(0.99) <= goals.compute && loop.success() >= goals.success;
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kUsable:
      return "usable";
    case Verdict::kUnfit:
      break;
  }
  return "unfit";
}

Verdict judge(const TickRecord& floor, const TickRecord& loop) {
  const Nanoseconds floor_wake =
      std::min(floor.lateness().quantile(0.999), kLatestGoodWake - kGood.wake);
  if (meets(loop, kGood, floor_wake)) return Verdict::kGood;
  return meets(loop, kUsable, Nanoseconds(0)) ? Verdict::kUsable : Verdict::kUnfit;
}

}  // namespace gliss
