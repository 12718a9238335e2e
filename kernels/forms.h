// A patch by its form and valence.

// There is code for these forms and valences: those that a device's surface has, else all. A
// compiler takes a minute for all. Form bit 8: parts may overlap. Valence bit MANY_SIDES:
// so many sides and more.
#ifndef GLISS_FORMS
#define GLISS_FORMS 319u
#define GLISS_VALENCES 248u
#endif
#define HAS_FORM(form) (GLISS_FORMS >> (form)&1u)
#define HAS_VALENCE(n) (GLISS_VALENCES >> (n)&1u)
#define IS_FORM(form, which) (HAS_FORM(which) && ((form)&255u) == (which))
#define IS_VALENCE(n, which) (HAS_VALENCE(which) && (n) == (which))

// The forms that blend sides. `form` and, but for the last, `n` are known when this is compiled.
FN patch_point blend_sides(GLOBAL scalar* domain, control_data control, uint form, int n, real xi,
                           real eta) {
  return form == FORM_CURVED ? curved_patch(domain, control, n, xi, eta)
                             : evaluate(domain, control, form, n, xi, eta);
}
// True if a patch has so many sides that loops over them are not unrolled; these are never packed.
FN int has_many_sides(int n) {
#ifdef GLISS_PACKED
  (void)n;
  return 0;
#else
  return HAS_VALENCE(MANY_SIDES) && n > UNROLLED_VALENCE;
#endif
}
// Each form has functions of its own for each valence, since GCC gives out registers badly in very
// large ones: hexagons took twice the time. On devices evaluate_form has all of them.
#ifdef __OPENCL_C_VERSION__
#define FN_BLEND FN
#else
#define FN_BLEND FN_APART
#endif
#define BLEND(name, patch)                                                               \
  FN_BLEND patch_point name(GLOBAL scalar* domain, control_data control, int n, real xi, \
                            real eta) {                                                  \
    (void)domain;                                                                        \
    (void)n;                                                                             \
    return patch;                                                                        \
  }
#define BLENDS(name, form)                                                                     \
  BLEND(name##_3, blend_sides(domain, control, form, 3, xi, eta))                              \
  BLEND(name##_4, evaluate_quad(control, form, xi, eta))                                       \
  BLEND(name##_5, blend_sides(domain, control, form, 5, xi, eta))                              \
  BLEND(name##_6, blend_sides(domain, control, form, UNROLLED_VALENCE, xi, eta))               \
  BLEND(name##_many, blend_sides(domain, control, form, n, xi, eta))                           \
  FN patch_point name(GLOBAL scalar* domain, control_data control, int n, real xi, real eta) { \
    if (form != FORM_CURVED) {                                                                 \
      if (IS_VALENCE(n, 4)) return name##_4(domain, control, n, xi, eta);                      \
      if (IS_VALENCE(n, 3)) return name##_3(domain, control, n, xi, eta);                      \
    }                                                                                          \
    if (IS_VALENCE(n, 5)) return name##_5(domain, control, n, xi, eta);                        \
    if (has_many_sides(n)) return name##_many(domain, control, n, xi, eta);                    \
    if (HAS_VALENCE(6)) return name##_6(domain, control, n, xi, eta);                          \
    return name##_4(domain, control, n, xi, eta); /* of no valence that there is */            \
  }
BLENDS(blend_of_sides, FORM_PAPER)
BLENDS(blend_of_ribbons, FORM_RIBBON)
BLENDS(blend_of_curved, FORM_CURVED)

FN_LARGE patch_point evaluate_form(GLOBAL scalar* domain, control_data control, uint form, int n,
                                   real xi, real eta) {
  EVALUATES;
  if (IS_FORM(form, FORM_BEZIER))
    return IS_VALENCE(n, 3) ? gregory_triangle(domain, control, xi, eta)
                            : gregory_quad(control, xi, eta);
  if (IS_FORM(form, FORM_SEXTIC)) return sextic_triangle(domain, control, xi, eta);
  if (IS_FORM(form, FORM_CURVED)) return blend_of_curved(domain, control, n, xi, eta);
#ifndef GLISS_PACKED
  if (IS_FORM(form, FORM_TABLE))
    return evaluate_table(domain, control, (int)(form >> 8), n, xi, eta);
#endif
  if (IS_FORM(form, FORM_RIBBON)) return blend_of_ribbons(domain, control, n, xi, eta);
  if (HAS_FORM(FORM_PAPER)) return blend_of_sides(domain, control, n, xi, eta);
  return gregory_quad(control, xi, eta);  // of no form that there is
}
