// All of the mathematics, in order. Included once for each instance: OpenCL C, and in C++ inside a
// namespace. The host includes what it alone builds with where it needs that: bezier_side.h,
// fair.h, to_form.h, second_table.h, cut.h (host/surface/instances_*.inc).
//
// The bytes of caches depend on those, and here on all up to forms.h, build.h, triangle.h,
// second.h, examine.h and the words of reach.h. The others only read caches: box.h, descent.h,
// view.h, polygon.h, track.h, hierarchy.h, tile.h, search.h, contact.h, union.h.
// clang-format off
#include "kernels/layout.h"
#include "kernels/real.h"
#include "kernels/vector.h"
#include "kernels/domain.h"
#include "kernels/side.h"
#include "kernels/ribbon.h"
#include "kernels/patch.h"
#include "kernels/quad.h"
#include "kernels/bezier.h"
#include "kernels/sextic.h"
#include "kernels/curved.h"
#ifndef GLISS_PACKED
#include "kernels/table.h"
#endif
#include "kernels/forms.h"
#include "kernels/box.h"
#if GLISS_LANES == 1 || defined(GLISS_PACKED)
#include "kernels/build.h"
#include "kernels/descent.h"
#endif
#ifndef GLISS_PACKED
#include "kernels/view.h"
#include "kernels/triangle.h"
#include "kernels/second.h"
#include "kernels/examine.h"
#endif
#if !defined(GLISS_PACKED) && (GLISS_LANES == 1 || !defined(__OPENCL_C_VERSION__))
#include "kernels/tile_code.h"
#include "kernels/reach.h"
#endif
#if GLISS_LANES == 1
#include "kernels/polygon.h"
#include "kernels/track.h"
#include "kernels/hierarchy.h"
#include "kernels/tile.h"
#include "kernels/search.h"
#include "kernels/contact.h"
#include "kernels/union.h"
#endif
// clang-format on
