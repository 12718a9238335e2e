// Names that shared libraries of Gliss give away: all others are their own.
#pragma once

#if defined(__GNUC__)
#define GLISS_EXPORT __attribute__((visibility("default")))
#else
#define GLISS_EXPORT
#endif
