// The C++ instances of one precision (instances_isa.cpp), counting, as the kernels of the program.
#include "tests/counting/counting.h"

#define EVALUATES (++gliss::counting::counts.evaluations)
#define PROMISE(holds) \
  ((holds) ? (void)0 : gliss::counting::break_promise(#holds, __FILE__, __LINE__))
#define GLISS_ISA counting
#include "../../host/surface/instances_isa.cpp"

namespace gliss {
namespace {

using Contacts = RawContact<GLISS_SCALAR>;

void add_told(const Contacts* contacts, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    counting::counts.told += contacts[i].evaluations;
    counting::counts.iterations += contacts[i].uints[instance::kContactIterations] + 1;
  }
}

void nearest(const Surface<GLISS_SCALAR>& s, const Method* methods, std::size_t method_count,
             const TrackOptions<GLISS_SCALAR>& options, const RawHip<GLISS_SCALAR>* hips,
             std::size_t count, Contacts* out) {
  counting::GLISS_TABLE().nearest(s, methods, method_count, options, hips, count, out);
  add_told(out, count * method_count);
}

void track(const Surface<GLISS_SCALAR>& s, Method method, const TrackOptions<GLISS_SCALAR>& options,
           const RawHip<GLISS_SCALAR>* hips, std::size_t count, Contacts* states) {
  counting::GLISS_TABLE().track(s, method, options, hips, count, states);
  add_told(states, count);
}

void tick(const Surface<GLISS_SCALAR>& s, Method method, const TrackOptions<GLISS_SCALAR>& options,
          const RawHip<GLISS_SCALAR>& hip, Contacts* state) {
  counting::GLISS_TABLE().tick(s, method, options, hip, state);
  add_told(state, 1);
}

}  // namespace

template <>
const Kernels<GLISS_SCALAR>& kernels<GLISS_SCALAR>() {
  static const Kernels<GLISS_SCALAR> table = [] {
    Kernels<GLISS_SCALAR> table = counting::GLISS_TABLE();
    table.nearest = nearest;
    table.track = track;
    table.tick = tick;
    return table;
  }();
  return table;
}

}  // namespace gliss
