/* A hand on a mesh in C: loads it, presses a point into it from above, and prints position and force, a line each.
 *
 *   cc -std=c99 hand.c $(pkg-config --cflags --libs gliss) -o hand && ./hand mesh.obj 0.001 */
#include <gliss/gliss_c.h>
#include <stdio.h>
#include <stdlib.h>

static int failed(const char* doing) {
  fprintf(stderr, "hand: %s: %s\n", doing, gliss_last_error());
  return 1;
}

int main(int count, char** words) {
  if (count != 3) {
    fprintf(stderr, "usage: hand MESH UNIT, the metres in one unit of the mesh\n");
    return 2;
  }
  gliss_options options = GLISS_OPTIONS_INIT;
  options.unit = atof(words[2]);
  gliss_surface* surface = NULL;
  if (gliss_surface_load(words[1], &options, &surface) != 0) return failed(words[1]);

  gliss_object object = gliss_object_init();
  object.surface = surface;
  object.friction_static = 0.5;
  object.friction_dynamic = 0.3;
  gliss_hand* hand = NULL;
  if (gliss_hand_create(&object, 1, NULL, 0, &hand) != 0) return failed("the hand");
  gliss_guard* guard = NULL;
  if (gliss_guard_create(3.3, 1000, &guard) != 0) return failed("the guard");

  double low[3], high[3];
  const double unit = gliss_surface_unit(surface);
  if (gliss_surface_bounds(surface, low, high) != 0) return failed("the bounds");
  double at[3] = {unit * (low[0] + high[0]) / 2, unit * (low[1] + high[1]) / 2, unit * high[2] + 1e-3};
  printf("z_m,wanted_N,sent_N,distance_m\n");
  for (int tick = 0; tick < 600; ++tick, at[2] -= 5e-6) {
    double wanted[3], force[3];
    gliss_contact contact;
    if (gliss_hand_tick(hand, at, wanted) != 0) return failed("a tick");
    const int64_t now = 1000000 * (int64_t)tick; /* ns; a device's clock */
    if (gliss_guard_step(guard, now, now, wanted, force, NULL) != 0) return failed("the guard");
    if (gliss_hand_contact(hand, 0, 0, &contact) != 0) return failed("the contact");
    if (tick % 50 == 0) printf("%.9g,%.9g,%.9g,%.9g\n", at[2], wanted[2], force[2], unit * contact.distance);
  }
  gliss_guard_release(guard);
  gliss_hand_release(hand);
  gliss_surface_release(surface);
  return 0;
}
