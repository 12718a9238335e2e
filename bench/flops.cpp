#include "bench/flops.h"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "gliss/build/patch_draft.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss::bench {
namespace {

// Operations that were asked for, each with the ones that its operands come from.
class Tape {
 public:
  enum Kind {
    kConstant,
    kUniform,
    kInput,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kNegate,
    kRoot,
    kFma
  };

  int constant(double value) { return number(kConstant, {}, value); }
  int uniform(std::size_t which) { return number(kUniform, {}, static_cast<double>(which)); }
  int input(std::size_t which) { return number(kInput, {}, static_cast<double>(which)); }
  int operation(Kind kind, int a, int b = -1, int c = -1) { return number(kind, {a, b, c}, 0); }

  // Counts the flops of all that the results need and that inputs decide.
  double flops(const std::vector<int>& results) const {
    std::vector<char> needed(nodes_.size(), 0);
    for (const int r : results) needed[static_cast<std::size_t>(r)] = 1;
    double sum = 0;
    for (std::size_t i = nodes_.size(); i-- > 0;) {  // operands come before
      const Node& node = nodes_[i];
      if (!needed[i] || !node.varies) continue;
      const bool is_free = node.kind == kInput || node.kind == kNegate;
      sum += node.kind == kFma ? 2 : is_free ? 0 : 1;
      for (const int from : node.from) {
        if (from >= 0) needed[static_cast<std::size_t>(from)] = 1;
      }
    }
    return sum;
  }

 private:
  struct Node {
    Kind kind;
    std::array<int, 3> from{-1, -1, -1};
    bool varies;
  };

  // The same operation on the same operands is one.
  int number(Kind kind, std::array<int, 3> from, double value) {
    if (kind == kAdd || kind == kMultiply || kind == kFma) {
      if (from[0] > from[1]) std::swap(from[0], from[1]);
    }
    const auto [at, is_new] =
        known_.try_emplace({kind, from, value}, static_cast<int>(nodes_.size()));
    if (is_new) {
      bool varies = kind == kInput;
      if (kind > kInput) {
        for (const int f : from)
          varies = varies || (f >= 0 && nodes_[static_cast<std::size_t>(f)].varies);
      }
      nodes_.push_back({kind, kind > kInput ? from : std::array{-1, -1, -1}, varies});
    }
    return at->second;
  }

  std::vector<Node> nodes_;
  std::map<std::tuple<Kind, std::array<int, 3>, double>, int> known_;
};

Tape* tape = nullptr;  // of the count under way

// A number that notes what becomes of it.
struct Counted {
  double value = 0;
  int node = -1;

  Counted() = default;
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  Counted(Number x) : value(static_cast<double>(x)), node(tape->constant(value)) {}
  Counted(double x, int n) : value(x), node(n) {}
  explicit operator int() const { return static_cast<int>(value); }
};

#define GLISS_COUNTED(OP, KIND)                                               \
  Counted operator OP(Counted a, Counted b) {                                 \
    return {a.value OP b.value, tape->operation(Tape::KIND, a.node, b.node)}; \
  }
GLISS_COUNTED(+, kAdd)
GLISS_COUNTED(-, kSubtract)
GLISS_COUNTED(*, kMultiply)
GLISS_COUNTED(/, kDivide)
#define GLISS_COMPARED(OP) \
  [[maybe_unused]] bool operator OP(Counted a, Counted b) { return a.value OP b.value; }
GLISS_COMPARED(<)
GLISS_COMPARED(>)
GLISS_COMPARED(<=)
GLISS_COMPARED(>=)
GLISS_COMPARED(==)
Counted operator-(Counted a) { return {-a.value, tape->operation(Tape::kNegate, a.node)}; }
Counted counted_fma(Counted a, Counted b, Counted c) {
  return {std::fma(a.value, b.value, c.value), tape->operation(Tape::kFma, a.node, b.node, c.node)};
}
Counted counted_root(Counted a) {
  return {std::sqrt(a.value), tape->operation(Tape::kRoot, a.node)};
}

// The bridge (kernels/real.h) casts to float or double before it calls these.
#define GLISS_SCALAR Counted
#define GLISS_LANES 1
#define float Counted
#define double Counted
#define __builtin_fmaf counted_fma
#define __builtin_fma counted_fma
#define __builtin_sqrtf counted_root
#define __builtin_sqrt counted_root
namespace counted {
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
#include "kernels/table.h"
#include "kernels/forms.h"
#include "kernels/build.h"
// clang-format on
}  // namespace counted
#undef float
#undef double
#undef __builtin_fmaf
#undef __builtin_fma
#undef __builtin_sqrtf
#undef __builtin_sqrt

// Corners [n][2][3] of a polygon on a sphere.
std::vector<double> polygon(std::uint32_t n) {
  std::vector<double> corners;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double angle = 2 * M_PI * k / n;
    const Eigen::Vector3d at(0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8);
    for (const double x : {at.x(), at.y(), at.z() - 0.8, at.x(), at.y(), at.z()})
      corners.push_back(x);
  }
  return corners;
}

// The same for all points; each a number of its own, whatever its value.
std::vector<Counted> as_uniform(const std::vector<double>& from, std::size_t first) {
  std::vector<Counted> to;
  for (const double x : from) to.push_back({x, tape->uniform(first + to.size())});
  return to;
}

}  // namespace

double flops_of_evaluate(std::uint32_t form, std::uint32_t n) {
  const Kernels<double>& k = kernels<double>();
  const std::vector<double> corners = polygon(n);
  std::vector<double> domain(k.domain_reals(n)), control(n * kSideReals);
  k.fill_domain(n, domain.data());
  double soundness = 0;
  k.build_patches(corners.data(), n, 1, control.data(), &soundness);
  if (form != kFormPaper) {
    std::vector<double> baked(k.control_reals(form, n));
    std::vector<char> used(n + 1, 0);
    used[n] = 1;
    take_to_form(corners.data(), {control.data(), kFormPaper, n}, form, make_valence_tables(used),
                 baked.data());
    control = baked;
  }
  Tape own;
  tape = &own;
  const std::vector<Counted> d = as_uniform(domain, 0), c = as_uniform(control, d.size());
  const Counted xi(0.11, own.input(0)), eta(0.07, own.input(1));
  const counted::patch_point p =
      counted::evaluate_form(d.data(), c.data(), form, static_cast<int>(n), xi, eta);
  std::vector<int> results;
  for (const counted::real3& v : {p.g, p.g_xi, p.g_eta})
    results.insert(results.end(), {v.x.node, v.y.node, v.z.node});
  return own.flops(results);
}

double flops_of_build(std::uint32_t n) {
  const std::vector<double> corners = polygon(n);
  Tape own;
  tape = &own;
  std::vector<Counted> inputs, control(n * kSideReals);
  for (const double x : corners) inputs.push_back({x, own.input(inputs.size())});
  for (std::uint32_t side = 0; side < n; ++side) {
    counted::store_side(inputs.data(), static_cast<int>(n), static_cast<int>(side),
                        &control[side * kSideReals]);
  }
  std::vector<int> results;
  for (const Counted& c : control) results.push_back(c.node);
  return own.flops(results);
}

}  // namespace gliss::bench
