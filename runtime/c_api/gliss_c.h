/* Gliss for C99, and for what calls C: libgliss.so.0, the target gliss::c, pkg-config gliss.
 *
 * Errors. A function that returns int32_t returns 0, or the code that the program would exit with:
 * 1 internal, such as too little memory; 2 bad input; 3 a stale, foreign or damaged cache; 4 not
 * available. gliss_last_error() then tells this thread why, in one line. Nothing is changed where a
 * function fails, and nothing is thrown. NULL where a pointer is needed is bad input.
 *
 * Units. Points of a surface are in its mesh's unit, which gliss_surface_unit() gives in metres;
 * hands live in the world, in m, s, N and N m. Distances are negative inside.
 *
 * Memory. What a function creates is released by the function of that name; NULL is fine there. A
 * surface is shared by counting: hands keep theirs. Arrays are the caller's, and may lie in any
 * order: strides are in bytes.
 *
 * Threads. A surface may be used by any number of threads, everything else by one at a time.
 *
 * Versions. Structs begin with their size, which the GLISS_..._INIT macros set. A later library
 * reads those of an earlier header, and refuses what it does not know. */
#ifndef GLISS_C_H
#define GLISS_C_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define GLISS_API __attribute__((visibility("default")))
#else
#define GLISS_API
#endif

#define GLISS_ABI 0x000104u

typedef struct gliss_surface gliss_surface;
typedef struct gliss_hand gliss_hand;
typedef struct gliss_guard gliss_guard;

/* The ABI of the library, as GLISS_ABI is of this header: their upper 16 bits agree, or nothing
 * else is to be called. */
GLISS_API uint32_t gliss_abi_version(void);
/* "0.1.0". Lives as long as the library. */
GLISS_API const char* gliss_version(void);
/* Why the last call of this thread failed; "" if it did not. Valid until its next call. */
GLISS_API const char* gliss_last_error(void);

/* ---- Surfaces ---- */

#define GLISS_DOUBLE 0u
#define GLISS_FLOAT 1u

typedef struct {
  uint32_t size;         /* sizeof of this struct */
  uint32_t precision;    /* GLISS_DOUBLE or GLISS_FLOAT; of a cache file its own */
  double unit;           /* m, of the mesh's coordinates; a cache file has its own */
  const char* level;     /* "exact", "ribbon", "bezier", "table"; NULL: "exact" */
  uint32_t construction; /* GLISS_FAIR or GLISS_PAPER */
  uint32_t threads;      /* that build and ask; 0: as many as the machine has */
  const char* crease;    /* edges to keep sharp, as --crease has them: "40deg", "auto", "none",
                            "edges:FILE"; NULL: those that the mesh asks for */
  uint32_t orient;       /* of closed parts: GLISS_OUTWARD, or GLISS_AS_GIVEN: rooms stay rooms */
  uint32_t flip;         /* not 0: open parts are turned over */
} gliss_options;
#define GLISS_FAIR 0u
#define GLISS_PAPER 1u
#define GLISS_OUTWARD 0u
#define GLISS_AS_GIVEN 1u
#define GLISS_OPTIONS_INIT \
  { (uint32_t)sizeof(gliss_options), GLISS_DOUBLE, 1.0, NULL, GLISS_FAIR, 0, NULL, 0, 0 }

/* From a mesh (OBJ, OFF, PLY, STL) or a cache file, by its path in UTF-8. Options NULL: the
 * defaults. */
GLISS_API int32_t gliss_surface_load(const char* path, const gliss_options* options,
                                     gliss_surface** out);
/* From arrays: `vertices` points of three doubles, `stride` bytes apart (0: 24); faces as `begin`
 * [faces + 1], of which face i has the corners begin[i] to begin[i + 1], and `corners`, indices of
 * vertices, anticlockwise from outside. */
GLISS_API int32_t gliss_surface_from_arrays(const double* points, size_t stride, size_t vertices,
                                            const uint32_t* begin, const uint32_t* corners,
                                            size_t faces, const gliss_options* options,
                                            gliss_surface** out);
GLISS_API void gliss_surface_retain(gliss_surface* surface);
GLISS_API void gliss_surface_release(gliss_surface* surface);

/* Writes a cache file. */
GLISS_API int32_t gliss_surface_save(const gliss_surface* surface, const char* path);
GLISS_API double gliss_surface_unit(const gliss_surface* surface);  /* m; 0 of NULL */
GLISS_API size_t gliss_surface_faces(const gliss_surface* surface); /* 0 of NULL */
/* Corners low and high of the bounding box, mesh's unit. */
GLISS_API int32_t gliss_surface_bounds(const gliss_surface* surface, double low[3], double high[3]);
/* How far the patch of a face leaves its polygon, and the room that it has there: the way along the
 * polygon's normal to the next face across, through the solid or a gap (infinite: there is none).
 * That of the patch which takes the largest share of its room, if it is more than a third, and else
 * the largest distance. Mesh's unit. */
GLISS_API int32_t gliss_surface_departure(const gliss_surface* surface, double* distance,
                                          double* room, uint32_t* face);

#define GLISS_GREGORY 0u
#define GLISS_SHADED 1u
#define GLISS_FLAT 2u

/* Bits of flags. */
#define GLISS_CONVERGED 1u
#define GLISS_ON_BORDER 2u
#define GLISS_ON_CREASE 4u
#define GLISS_UNFINISHED 16u
#define GLISS_SETTLING 32u
#define GLISS_SLIPPING 64u

/* A surface contact point (SCP), 128 bytes. Lengths in the mesh's unit. */
typedef struct {
  uint32_t touching; /* 1: the HIP is inside */
  uint32_t face;
  double xi, eta; /* of the SCP, in the regular polygon of the face's domain */
  double scp[3], normal[3];
  double push[3];  /* the force over the stiffness */
  double distance; /* negative inside */
  uint32_t flags;
  uint32_t iterations;
  uint64_t reserved[2];
} gliss_contact;

/* The nearest point of the surface to each of `count` points, which are finite, of scalars of
 * `bytes`: 8 (double) or 4 (float), three in a row, `stride` bytes from point to point (0: close
 * together). */
GLISS_API int32_t gliss_surface_nearest(const gliss_surface* surface, uint32_t method,
                                        const void* points, size_t stride, size_t bytes,
                                        size_t count, gliss_contact* out);
/* Points of faces, at xi and eta: positions and unit normals, three doubles each; NULL: not wanted.
 */
GLISS_API int32_t gliss_surface_evaluate(const gliss_surface* surface, const uint32_t* face,
                                         const double* xi, const double* eta, size_t count,
                                         double* positions, double* normals);

/* ---- Hands ---- */

typedef struct {
  uint32_t size;          /* sizeof of this struct */
  uint32_t method;        /* GLISS_GREGORY, ... */
  gliss_surface* surface; /* the hand keeps it */
  double stiffness;       /* N/m, 0 or more */
  double rotation[4];     /* of the object, a unit quaternion w, x, y, z */
  double position[3];     /* m */
  /* s in which the force changes by 20 % while the contact slides to where the nearest point has
   * leapt, 0 to 1; 0: it leaps. */
  double settle;
  double friction_static, friction_dynamic; /* 0 to 5 */
  double friction_settle;                   /* s from the one to the other, 0 to 1 */
  double damping;                           /* s/m, 0 to 20 */
  double viscosity;                         /* N s/m, 0 to 20 */
  double magnet_force, magnet_range;        /* N, m */
  uint32_t texture;                         /* 0: none; 1: a grating; 2: noise */
  uint32_t reserved;                        /* 0 */
  double texture_height, texture_period;    /* m */
  double texture_along[3];                  /* the way across the grooves of a grating */
  double tick; /* s, 1e-6 to 1, of a tick whose time is not told; the same in all objects */
} gliss_object;
/* Makes an object what it is by default, of no surface yet. `size`: sizeof of it as the caller
 * knows it, so that no byte beyond is written. */
GLISS_API int32_t gliss_object_set_defaults(gliss_object* object, size_t size);
static inline gliss_object gliss_object_init(void) {
  gliss_object object;
  object.size = 0; /* so that a library that does not know this header refuses it in use, too */
  gliss_object_set_defaults(&object, sizeof object);
  return object;
}

/* A hand touches `objects`, which are as far apart as the size of the first, which all have. Its
 * tool has `hips` points, three doubles each in the tool's frame (m); 0: one, at the device's
 * position. */
GLISS_API int32_t gliss_hand_create(const gliss_object* objects, size_t count, const double* points,
                                    size_t hips, gliss_hand** out);
GLISS_API void gliss_hand_release(gliss_hand* hand);
/* A tick: the force (N) on a device at a position (m), `tick` after the last one. It allocates
 * nothing, takes no lock, and its work is bounded. The force is NaN where the surface is at fault
 * or the position or rotation is not finite: let gliss_guard_step see it. The contact is kept. */
GLISS_API int32_t gliss_hand_tick(gliss_hand* hand, const double position[3], double force[3]);
/* The same of a device that turns: rotation is a unit quaternion w, x, y, z; torque in N m about
 * the position. */
GLISS_API int32_t gliss_hand_tick_tool(gliss_hand* hand, const double position[3],
                                       const double rotation[4], double force[3], double torque[3]);
/* The same at a time since any start, ns: so a rate of its own, a late tick and one that was left
 * out change no law of friction, damping, viscosity and settle. velocity: that of the device, m/s,
 * for damping and viscosity; NULL: it is measured. rotation NULL: the device does not turn; torque
 * NULL: not wanted. */
GLISS_API int32_t gliss_hand_tick_at(gliss_hand* hand, int64_t time_ns, const double position[3],
                                     const double* velocity, const double* rotation,
                                     double force[3], double* torque);
/* The contact of the last tick with an object, by the HIP of an index. */
GLISS_API int32_t gliss_hand_contact(const gliss_hand* hand, size_t hip, size_t object,
                                     gliss_contact* out);
/* Moves an object to where the next tick finds it. */
GLISS_API int32_t gliss_hand_move(gliss_hand* hand, size_t object, const double rotation[4],
                                  const double position[3]);

/* ---- The guard between a force and a device ---- */

#define GLISS_GUARD_START 0u
#define GLISS_GUARD_RUN 1u
#define GLISS_GUARD_HOLD 2u
#define GLISS_GUARD_RAMP 3u
#define GLISS_GUARD_SAFE 4u

/* max_force (N) and max_rate (N/s) of what goes out; others are as in the C++ library
 * (gliss/device/guard.h). */
GLISS_API int32_t gliss_guard_create(double max_force, double max_rate, gliss_guard** out);
/* The same of a device that turns: max_torque (N m) and max_torque_rate (N m/s) as well. */
GLISS_API int32_t gliss_guard_create_tool(double max_force, double max_rate, double max_torque,
                                          double max_torque_rate, gliss_guard** out);
GLISS_API void gliss_guard_release(gliss_guard* guard);
/* A tick at a time since any start, ns, of a force that answers a position that was measured at
 * another: writes the force that may go to the device, and the state. */
GLISS_API int32_t gliss_guard_step(gliss_guard* guard, int64_t now_ns, int64_t measured_ns,
                                   const double wanted[3], double force[3], uint32_t* state);
/* The same of a device that turns: a force and a torque. */
GLISS_API int32_t gliss_guard_step_tool(gliss_guard* guard, int64_t now_ns, int64_t measured_ns,
                                        const double wanted[3], const double wanted_torque[3],
                                        double force[3], double torque[3], uint32_t* state);
/* From the next step on the force falls to zero, and the guard is safe: the device reports a fault
 * (is_fault), or somebody wants an end. */
GLISS_API int32_t gliss_guard_trip(gliss_guard* guard, int32_t is_fault);
/* Why the last step did not pass the force on as it was wanted, as "late input": the trip's reason
 * until gliss_guard_engage. "none" where it did. The text lasts for ever. */
GLISS_API const char* gliss_guard_reason(const gliss_guard* guard);
/* Leads out of GLISS_GUARD_SAFE; 2 where the guard does not permit it yet. */
GLISS_API int32_t gliss_guard_engage(gliss_guard* guard);

#ifdef __cplusplus
}
#endif

#endif
