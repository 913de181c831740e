#pragma once
/// Gaussian-augmented friction, one parameter set for each direction.
///
///   F(v) = η0 + η1·v + Σ a_i·exp(−((v − b_i)/c_i)²)      of the branch of sgn v
///
///   η0 [N], η1 viscous [N·s/m], a_i height [N], b_i centre [m/s], c_i width [m/s]
///
/// Branches are signed as printed in Table 2.3: for v < 0, η0, a_i and b_i are negative (η0 = −768.6 N) and
/// nothing is multiplied by sgn v again.
///
/// A model knows the velocities that it was identified on. Outside them the Gaussian sum keeps its value at the border and only
/// η1·v continues; otherwise a term that peaks outside would add thousands of newtons.
///
/// Source: thesis (2.32), Table 2.3.
/// Not modelled: pre-sliding; dependence on position and load.
/// Real time: safe; one exp per term.

#include <array>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/friction/steady.hpp>

namespace stribeck::friction {

template <Real T>
struct GaussianTerm {
  T a{0.0};
  T b{0.0};
  T c{1.0};

  /// a·exp(−((v − b)/c)²)
  [[nodiscard]] T value(const T& v) const noexcept {
    const T d = (v - b) / c;
    return a * exp(-(d * d));
  }

  static constexpr auto fields() {
    return std::tuple{field("a", &GaussianTerm::a, quantity("N", "N"), "height"),
                      field("b", &GaussianTerm::b, quantity("m/s", "mm/s"), "centre"),
                      field("c", &GaussianTerm::c, quantity("m/s", "mm/s").positive(), "width")};
  }
};

inline constexpr std::size_t kMaxGaussians = 6;

template <Real T>
struct GaussianBranch {
  T eta0{0.0};
  T eta1{0.0};
  FixedVector<GaussianTerm<T>, kMaxGaussians> gaussians;

  static constexpr auto fields() {
    return std::tuple{
        field("eta0", &GaussianBranch::eta0, quantity("N", "N"),
              "nominal Coulomb force, signed: negative for v < 0"),
        field("eta1", &GaussianBranch::eta1, quantity("N s/m", "N s/mm"), "nominal viscous coefficient"),
        field("gaussians", &GaussianBranch::gaussians, "terms of the sum, at most six").or_default()};
  }

  [[nodiscard]] GaussianBranch scaled(const T& factor) const noexcept {
    GaussianBranch b{eta0 * factor, eta1 * factor, gaussians};
    for (auto& term : b.gaussians) term.a = term.a * factor;
    return b;
  }
};

template <Real T>
struct Gaussian {
  static constexpr std::string_view kKind = "gaussian";

  GaussianBranch<T> positive;
  GaussianBranch<T> negative;
  std::array<double, 2> velocity_range{};  ///< identified range [m/s], lowest < 0 < highest

  static constexpr auto fields() {
    return std::tuple{field("velocity_range", &Gaussian::velocity_range, quantity("m/s", "mm/s"),
                            "velocities the model was identified on: lowest (< 0), highest (> 0)"),
                      field("positive", &Gaussian::positive, "branch for v ≥ 0"),
                      field("negative", &Gaussian::negative, "branch for v < 0")};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (!(velocity_range[0] < 0 && velocity_range[1] > 0)) {
      report("velocity_range", "expected a lowest velocity below zero and a highest above zero");
      return;
    }
    // The level of a hysteresis must be positive at every velocity.
    for (int i = 0; i <= 200; ++i) {
      const double share = i / 200.0;
      for (const double v : {share * velocity_range[0], share * velocity_range[1]}) {
        const auto p = parts(T(v), T(0.0));
        if (!(value_of(p.level) > 0)) {
          report(v < 0 ? "negative" : "positive",
                 "friction without its viscous part must oppose motion at every velocity of the range");
          return;
        }
      }
    }
  }

  [[nodiscard]] Gaussian scaled(const T& factor) const noexcept {
    return {positive.scaled(factor), negative.scaled(factor), velocity_range};
  }
  [[nodiscard]] Gaussian viscous_alone() const noexcept {
    return {{T(0.0), positive.eta1, {}}, {T(0.0), negative.eta1, {}}, velocity_range};
  }
  [[nodiscard]] T viscous_coefficient(double side) const noexcept {
    return side < 0.0 ? negative.eta1 : positive.eta1;
  }
  [[nodiscard]] constexpr std::optional<std::array<double, 2>> identified_range() const noexcept {
    return velocity_range;
  }

  [[nodiscard]] SteadyParts<T> parts(const T& v, const T&) const noexcept {
    const auto backward = v < T(0.0);
    const T border = clamp_to(v, T(velocity_range[0]), T(velocity_range[1]));
    T sum = select(backward, negative.eta0, positive.eta0);
    const std::size_t n = positive.gaussians.size() > negative.gaussians.size() ? positive.gaussians.size()
                                                                                : negative.gaussians.size();
    const GaussianTerm<T> none{};
    for (std::size_t i = 0; i < n; ++i) {
      const GaussianTerm<T>& p = i < positive.gaussians.size() ? positive.gaussians[i] : none;
      const GaussianTerm<T>& m = i < negative.gaussians.size() ? negative.gaussians[i] : none;
      const GaussianTerm<T> term{select(backward, m.a, p.a), select(backward, m.b, p.b),
                                 select(backward, m.c, p.c)};
      sum = sum + term.value(border);
    }
    return {select(backward, -sum, sum), select(backward, negative.eta1, positive.eta1) * v, T(0.0)};
  }
};

}  // namespace stribeck::friction
