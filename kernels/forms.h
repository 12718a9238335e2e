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
FN patch_point evaluate_valence(GLOBAL scalar* domain, control_data control, uint form, int n,
                                real xi, real eta) {
  if (form != FORM_CURVED) {
    if (IS_VALENCE(n, 4)) return evaluate_quad(control, form, xi, eta);
    if (IS_VALENCE(n, 3)) return blend_sides(domain, control, form, 3, xi, eta);
  }
  if (IS_VALENCE(n, 5)) return blend_sides(domain, control, form, 5, xi, eta);
#ifndef GLISS_PACKED
  if (HAS_VALENCE(MANY_SIDES) && n > UNROLLED_VALENCE)
    return blend_sides(domain, control, form, n, xi, eta);
#endif
  if (HAS_VALENCE(6)) return blend_sides(domain, control, form, UNROLLED_VALENCE, xi, eta);
  return evaluate_quad(control, form, xi, eta);  // of no valence that there is
}

FN_LARGE patch_point evaluate_form(GLOBAL scalar* domain, control_data control, uint form, int n,
                                   real xi, real eta) {
  if (IS_FORM(form, FORM_BEZIER))
    return IS_VALENCE(n, 3) ? gregory_triangle(domain, control, xi, eta)
                            : gregory_quad(control, xi, eta);
  if (IS_FORM(form, FORM_SEXTIC)) return sextic_triangle(domain, control, xi, eta);
  if (IS_FORM(form, FORM_CURVED)) return evaluate_valence(domain, control, FORM_CURVED, n, xi, eta);
#ifndef GLISS_PACKED
  if (IS_FORM(form, FORM_TABLE))
    return evaluate_table(domain, control, (int)(form >> 8), n, xi, eta);
#endif
  if (IS_FORM(form, FORM_RIBBON)) return evaluate_valence(domain, control, FORM_RIBBON, n, xi, eta);
  if (HAS_FORM(FORM_PAPER)) return evaluate_valence(domain, control, FORM_PAPER, n, xi, eta);
  return gregory_quad(control, xi, eta);  // of no form that there is
}
