// A patch by its form.

// Up to this valence loops over the sides are unrolled, and patches can be packed.
#define UNROLLED_VALENCE 6

FN patch_point evaluate_valence(GLOBAL scalar* domain, control_data control, uint form, int n,
                                real xi, real eta) {
  if (n == 4) return evaluate_quad(control, form, xi, eta);
  if (n == 3) return evaluate(domain, control, form, 3, xi, eta);
  if (n == 5) return evaluate(domain, control, form, 5, xi, eta);
#ifndef GLISS_PACKED
  if (n > UNROLLED_VALENCE) return evaluate(domain, control, form, n, xi, eta);
#endif
  return evaluate(domain, control, form, UNROLLED_VALENCE, xi, eta);
}

FN patch_point evaluate_curved(GLOBAL scalar* domain, control_data control, int n, real xi,
                               real eta) {
  if (n == 5) return curved_patch(domain, control, 5, xi, eta);
#ifndef GLISS_PACKED
  if (n > UNROLLED_VALENCE) return curved_patch(domain, control, n, xi, eta);
#endif
  return curved_patch(domain, control, UNROLLED_VALENCE, xi, eta);
}

// Which forms there are code for: those that a device's surface has, else all. Bit 8: parts may
// overlap.
#ifndef GLISS_FORMS
#define GLISS_FORMS 319u
#endif
#define IS_FORM(form, which) ((GLISS_FORMS >> (which)&1u) && ((form)&255u) == (which))

FN_LARGE patch_point evaluate_form(GLOBAL scalar* domain, control_data control, uint form, int n,
                                   real xi, real eta) {
  if (IS_FORM(form, FORM_BEZIER))
    return n == 4 ? gregory_quad(control, xi, eta) : gregory_triangle(domain, control, xi, eta);
  if (IS_FORM(form, FORM_SEXTIC)) return sextic_triangle(domain, control, xi, eta);
  if (IS_FORM(form, FORM_CURVED)) return evaluate_curved(domain, control, n, xi, eta);
#ifndef GLISS_PACKED
  if (IS_FORM(form, FORM_TABLE))
    return evaluate_table(domain, control, (int)(form >> 8), n, xi, eta);
#endif
  if (IS_FORM(form, FORM_RIBBON)) return evaluate_valence(domain, control, FORM_RIBBON, n, xi, eta);
  return evaluate_valence(domain, control, FORM_PAPER, n, xi, eta);
}
