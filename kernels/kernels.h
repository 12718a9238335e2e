// All of the mathematics, in order. Included once for each instance: OpenCL C, and in C++ inside a
// namespace.
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
