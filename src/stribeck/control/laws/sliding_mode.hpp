#pragma once
/// Sliding-mode contouring control with a switching gain that follows the error.
///
///   s = ė_l + λ e_l  (4.9)     w = R(λṘᵀe_w + λRᵀė_w + R̈ᵀe_w + 2Ṙᵀė_w)  (in 4.12)
///   f = M̂(q̈_d − w) + f̂_f + ĝ − M̂·R·(A s + diag(φ(s))·k)  (4.12), (4.13)
///   k = γ + h̄  (4.19)                                printed:     h̄ = |Rᵀ|·M̄⁻¹·(m̃ ∘ |q̈_d − w| + f̄)  (4.18)
///   k = (I − D̄)⁻¹(γ + h̄ + D̄ A|s|)                     sufficient:  D̄ = |Rᵀ|·diag(m̃/(m̂ − m̃))·|R|
///   adaptive, in place of γ + h̄:                         k̇ = G|s|·sgn(|s| − c_k·k·T),   k(0) = γ,   γ_least ≤ k ≤ γ_most
///   φ(s)   sign: sgn s (4.14, printed) · boundary-layer: sat(s/Φ) · tanh: tanh(s/Φ)
///   super-twisting, in place of A s + φ(s)k:   1.5·√(c k |s|)·sgn s + z,   ż = 1.1·c·k·sgn s,   |z| ≤ k
///
///   λ, A [1/s], γ, k, z [m/s²], Φ, s [m/s] in (t, n, b, …); m̃ [kg] bound of the mass's error, f̄ [N] bound of the errors of
///   friction and load, in (x, y, z, …); M̄⁻¹ = 1/(m̂ − m̃); c [1/s] how fast what k bounds may change.
///   Stable (dV/dt ≤ −sᵀAs − |s|ᵀγ, V = sᵀs/2) for the sufficient gain with sgn, |m̂ − m| ≤ m̃, |errors of force| ≤ f̄. It exists
///   while the spectral radius of D̄ is below 1, in every frame if Σ m̃/(m̂ − m̃) < 1 (sufficient_gain_exists); beyond, where a
///   frame has none, γ + h̄ + D̄A|s| is taken. docs/theory/sliding-mode.md: proofs, and what the printed gain lacks.
///   Adaptive: needs no bounds; falls to what the disturbance needs; rests while a force is limited.
/// Not modelled: sampling. Between two ticks s moves by up to 2kT, which is the chattering.
/// Source: thesis (4.9)–(4.19), corrected; Levant 1993, doi:10.1080/00207179308923053 (super-twisting); Plestan, Shtessel,
/// Brégeault, Poznyak 2010, doi:10.1080/00207179.2010.501385 (adaptive gain).
/// Real time: safe; the constructor configure only.

#include <stribeck/control/setup.hpp>
#include <stribeck/core/unrolled.hpp>

namespace stribeck::control {

enum class Switching { kSign, kBoundaryLayer, kTanh, kSuperTwisting };
enum class SwitchingGain { kPrinted, kSufficient, kAdaptive };

}  // namespace stribeck::control

template <>
struct stribeck::EnumNames<stribeck::control::Switching> {
  static constexpr std::array names{
      std::pair{stribeck::control::Switching::kSign, std::string_view{"sign"}},
      std::pair{stribeck::control::Switching::kBoundaryLayer, std::string_view{"boundary-layer"}},
      std::pair{stribeck::control::Switching::kTanh, std::string_view{"tanh"}},
      std::pair{stribeck::control::Switching::kSuperTwisting, std::string_view{"super-twisting"}}};
};
template <>
struct stribeck::EnumNames<stribeck::control::SwitchingGain> {
  static constexpr std::array names{
      std::pair{stribeck::control::SwitchingGain::kPrinted, std::string_view{"printed"}},
      std::pair{stribeck::control::SwitchingGain::kSufficient, std::string_view{"sufficient"}},
      std::pair{stribeck::control::SwitchingGain::kAdaptive, std::string_view{"adaptive"}}};
};

namespace stribeck::control {

template <std::size_t N>
class SlidingMode;

struct SlidingModeParams {
  template <std::size_t N>
  using Controller = SlidingMode<N>;
  static constexpr std::string_view kKind = "sliding-mode";
  static constexpr std::string_view kLabel = "sliding-mode contouring control";

  PerAxis lambda{20.0, 40.0};
  PerAxis a{10.0, 20.0};
  PerAxis gamma{10e-3, 20e-3};
  PerAxis mass_bound{100.0};
  PerAxis force_bound{0.0};
  Switching switching = Switching::kSign;
  double boundary = 1e-3;
  double disturbance_rate = 20.0;
  SwitchingGain gain = SwitchingGain::kPrinted;
  double growth = 3000.0;
  double layer = 2.0;
  PerAxis gamma_least{1e-3};
  PerAxis gamma_most{100e-3};
  ErrorRate error_rate = ErrorRate::kDifferenceOfError;

  static constexpr auto fields() {
    using P = SlidingModeParams;
    constexpr auto kWithLayer = [](const P& p) {
      return p.switching == Switching::kBoundaryLayer || p.switching == Switching::kTanh;
    };
    constexpr auto kBounded = [](const P& p) { return p.gain != SwitchingGain::kAdaptive; };
    constexpr auto kReaches = [](const P& p) {
      return p.switching != Switching::kSuperTwisting || p.gain == SwitchingGain::kSufficient;
    };
    constexpr auto kAdapts = [](const P& p) { return p.gain == SwitchingGain::kAdaptive; };
    constexpr std::string_view kGoesWithAdaptive = "goes with gain = \"adaptive\"";
    constexpr std::string_view kGoesWithBounds = "goes with gain = \"printed\" or \"sufficient\"";
    return std::tuple{
        field(
            "lambda", &P::lambda, quantity("1/s", "1/s").positive(),
            "slope of the surface, along the path first, then across it; the last one applies to the others too")
            .or_default(),
        field("a", &P::a, quantity("1/s", "1/s").not_negative(),
              "gain towards the surface, in the same order")
            .or_default()
            .when(kReaches,
                  "goes with every switching but super-twisting, and there with gain = \"sufficient\""),
        field("gamma", &P::gamma, quantity("m/s2", "mm/s2").not_negative(),
              "constant part of the switching gain, in the same order")
            .or_default(),
        field("mass_bound", &P::mass_bound, quantity("kg", "N s2/mm").not_negative(),
              "bound of the error of the mass, per axis")
            .or_default()
            .when(kBounded, kGoesWithBounds),
        field("force_bound", &P::force_bound, quantity("N", "N").not_negative(),
              "bound of the error of friction and load, per axis")
            .or_default()
            .when(kBounded, kGoesWithBounds),
        field("switching", &P::switching, "sign, boundary-layer, tanh or super-twisting").or_default(),
        field("boundary", &P::boundary, quantity("m/s", "mm/s").positive(),
              "width of the boundary layer, or of tanh")
            .or_default()
            .when(kWithLayer, "goes with switching = \"boundary-layer\" or \"tanh\""),
        field("disturbance_rate", &P::disturbance_rate, quantity("1/s", "1/s").positive(),
              "super-twisting: how fast the disturbance may change, in its bounds per time")
            .or_default()
            .when([](const P& p) { return p.switching == Switching::kSuperTwisting; },
                  "goes with switching = \"super-twisting\""),
        field("gain", &P::gain, "switching gain: printed, sufficient for the proof, or adaptive")
            .or_default(),
        field("growth", &P::growth, quantity("1/s2", "1/s2").positive(),
              "adaptive: how fast the gain follows the distance from the surface")
            .or_default()
            .when(kAdapts, kGoesWithAdaptive),
        field("layer", &P::layer, pure_number().positive(),
              "adaptive: |s| at which the gain does not change, in gains times control periods")
            .or_default()
            .when(kAdapts, kGoesWithAdaptive),
        field("gamma_least", &P::gamma_least, quantity("m/s2", "mm/s2").positive(),
              "adaptive: least switching gain, along the path first, then across it")
            .or_default()
            .when(kAdapts, kGoesWithAdaptive),
        field("gamma_most", &P::gamma_most, quantity("m/s2", "mm/s2").positive(),
              "adaptive: greatest switching gain, in the same order")
            .or_default()
            .when(kAdapts, kGoesWithAdaptive),
        field("error_rate", &P::error_rate, kErrorRateHelp).or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    const auto least = spread<kMostAxes>(gamma_least);
    const auto most = spread<kMostAxes>(gamma_most);
    for (std::size_t i = 0; i < kMostAxes; ++i) {
      if (least[i] > most[i]) return report("gamma_most", "expected at least gamma_least in each direction");
    }
  }
};

/// 1/(m̂ − m̃) [1/kg], for masses and their bounds [kg].
constexpr double least_mass_inverse(double mass, double bound) noexcept {
  return 1.0 / max_of(mass - bound, 1e-3 * mass);
}

/// Whether the sufficient gain exists in every frame. D̄ is symmetric and has no negative eigenvalue, so that none exceeds its
/// trace, and that is Σ_j m̃_j/(m̂_j − m̃_j) in any frame, since columns of R have length 1. Two equal axes reach it at 45°;
/// three reach 25/27 of it.
template <std::size_t N>
constexpr bool sufficient_gain_exists(const Vec<double, N>& mass, const Vec<double, N>& bound) noexcept {
  double trace = 0.0;
  for (std::size_t j = 0; j < N; ++j) trace += bound[j] * least_mass_inverse(mass[j], bound[j]);
  return trace < 1.0;
}

template <std::size_t N>
class SlidingMode {
 public:
  using Params = SlidingModeParams;
  struct State : Common<N>::State {
    Vec<double, N> surface;   ///< s of the last step [m/s]
    Vec<double, N> gain;      ///< k of the last step [m/s²]
    Vec<double, N> integral;  ///< z of super-twisting [m/s²]
    Vec<double, N> adapted;   ///< adaptive k for the next step, less γ [m/s²]
  };

  SlidingMode(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, params.error_rate),
        lambda_(spread<N>(params.lambda)),
        a_(spread<N>(params.a)),
        gamma_(spread<N>(params.gamma)),
        mass_bound_(spread<N>(params.mass_bound)),
        force_bound_(spread<N>(params.force_bound)),
        switching_(params.switching),
        inverse_boundary_(1.0 / params.boundary),
        disturbance_rate_(params.disturbance_rate),
        sufficient_(params.gain == SwitchingGain::kSufficient),
        adaptive_(params.gain == SwitchingGain::kAdaptive),
        growth_(params.growth),
        layer_(params.layer),
        least_(spread<N>(params.gamma_least)),
        most_(spread<N>(params.gamma_most)),
        force_limit_(setup.force_limit) {
    for (std::size_t i = 0; i < N; ++i)
      least_mass_inverse_[i] = least_mass_inverse(common_.mass(i), mass_bound_[i]);
  }

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  Vec<double, N> step(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    if (!common_.begin(s, r, measured)) return s.force;
    const Vec<double, N> acceleration = law(s, r, common_.error(s), common_.rate(s));
    return common_.finish(s, r, acceleration);
  }

  /// The law itself: commanded accelerations [m/s²], before mass, friction and limits, from tracking errors [m] and rates [m/s].
  Vec<double, N> law(State& s, const path::PathPoint<N>& r, const Vec<double, N>& e,
                     const Vec<double, N>& rate) const noexcept {
    const Vec<double, N> local = r.frame * e;
    const Vec<double, N> local_rate = r.frame_rate * e + r.frame * rate;
    const Vec<double, N> seen = r.frame_rate * rate;
    const Vec<double, N> bent = r.frame_acceleration * e;
    Vec<double, N> w;
    unrolled<N>([&](auto i) {
      s.surface[i] = local_rate[i] + lambda_[i] * local[i];
      w[i] = lambda_[i] * local_rate[i] + bent[i] + 2.0 * seen[i];
    });
    const Vec<double, N> wanted = r.acceleration - to_machine(r.frame, w);
    if (adaptive_) {
      for (std::size_t i = 0; i < N; ++i) s.gain[i] = clamp_to(gamma_[i] + s.adapted[i], least_[i], most_[i]);
    } else {
      s.gain = switching_gain(r.frame, wanted, s.surface);
    }
    const Vec<double, N> pull = reaching(s);
    if (adaptive_ && !limited(s)) adapt(s);
    return wanted - to_machine(r.frame, pull);
  }

  /// k [m/s²] for the accelerations q̈_d − w [m/s²] and the surface [m/s].
  [[nodiscard]] Vec<double, N> switching_gain(const Mat<double, N>& rt, const Vec<double, N>& wanted,
                                              const Vec<double, N>& surface) const noexcept {
    Mat<double, N> size;  // |Rᵀ|
    Vec<double, N> share;
    unrolled<N>([&](auto i) {
      unrolled<N>([&](auto j) { size[i][j] = abs(rt[i][j]); });
      share[i] = least_mass_inverse_[i] * (mass_bound_[i] * abs(wanted[i]) + force_bound_[i]);
    });
    const Vec<double, N> k = gamma_ + size * share;
    if (!sufficient_) return k;
    Vec<double, N> pull, relative;
    unrolled<N>([&](auto i) {
      pull[i] = a_[i] * abs(surface[i]);
      relative[i] = mass_bound_[i] * least_mass_inverse_[i];
    });
    return solved(coupling(size, relative), k, pull);
  }

  [[nodiscard]] bool sufficient_gain_exists() const noexcept {
    Vec<double, N> mass;
    for (std::size_t i = 0; i < N; ++i) mass[i] = common_.mass(i);
    return control::sufficient_gain_exists(mass, mass_bound_);
  }

 private:
  /// D̄ = |Rᵀ|·diag(m̃/(m̂ − m̃))·|R|.
  static Mat<double, N> coupling(const Mat<double, N>& size, const Vec<double, N>& relative) noexcept {
    Mat<double, N> d;
    unrolled<N>([&](auto i) {
      const Vec<double, N> scaled =
          Vec<double, N>::zip(size[i], relative, [](double r, double m) { return r * m; });
      unrolled<i + 1>([&](auto k) { d[i][k] = d[k][i] = dot(scaled, size[k]); });
    });
    return d;
  }

  /// x of (I − D̄)x = k + D̄·pull by Gauss elimination. I − D̄ is symmetric: it has an inverse, and that no negative element, if
  /// and only if all pivots are positive. Otherwise the right-hand side.
  static Vec<double, N> solved(const Mat<double, N>& d, const Vec<double, N>& k,
                               const Vec<double, N>& pull) noexcept {
    constexpr double kLeastPivot = 1e-6;
    const Vec<double, N> b = k + d * pull;
    Mat<double, N> m;
    unrolled<N>([&](auto i) { unrolled<N>([&](auto j) { m[i][j] = (i == j ? 1.0 : 0.0) - d[i][j]; }); });
    Vec<double, N> x = b;
    Vec<double, N> inverse;
    bool exists = true;
    unrolled<N>([&](auto c) {
      exists = exists && m[c][c] > kLeastPivot;
      inverse[c] = 1.0 / m[c][c];
      unrolled<N - 1 - c>([&](auto below) {
        constexpr std::size_t kRow = c + 1 + below;
        const double f = m[kRow][c] * inverse[c];
        unrolled<N - 1 - c>([&](auto right) { m[kRow][c + 1 + right] -= f * m[c][c + 1 + right]; });
        x[kRow] -= f * x[c];
      });
    });
    if (!exists) return b;
    unrolled<N>([&](auto up) {
      constexpr std::size_t kRow = N - 1 - up;
      unrolled<up>([&](auto right) { x[kRow] -= m[kRow][kRow + 1 + right] * x[kRow + 1 + right]; });
      x[kRow] *= inverse[kRow];
    });
    return x;
  }

  /// Whether the last force of an axis was limited: the surface then cannot be reached with any gain.
  bool limited(const State& s) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (abs(s.force[i]) >= force_limit_[i] || s.cut[i]) return true;
    }
    return false;
  }

  /// The gain for the next step.
  void adapt(State& s) const noexcept {
    const double period = common_.period();
    for (std::size_t i = 0; i < N; ++i) {
      const double x = abs(s.surface[i]);
      const double k = s.gain[i];
      const double rate = x > layer_ * k * period ? growth_ * x : -growth_ * x;
      s.adapted[i] = clamp_to(k + period * rate, least_[i], most_[i]) - gamma_[i];
    }
  }

  Vec<double, N> reaching(State& s) const noexcept {
    Vec<double, N> u;
    for (std::size_t i = 0; i < N; ++i) {
      const double x = s.surface[i];
      switch (switching_) {
        case Switching::kSign:
          u[i] = a_[i] * x + sign(x) * s.gain[i];
          break;
        case Switching::kBoundaryLayer:
          u[i] = a_[i] * x + clamp_to(x * inverse_boundary_, -1.0, 1.0) * s.gain[i];
          break;
        case Switching::kTanh:
          u[i] = a_[i] * x + tanh(x * inverse_boundary_) * s.gain[i];
          break;
        case Switching::kSuperTwisting: {
          const double k = s.gain[i];
          u[i] = 1.5 * sqrt(disturbance_rate_ * k * abs(x)) * sign(x) + s.integral[i];
          // The integral stands for the disturbance, which k bounds: a larger integral is only winding up.
          s.integral[i] =
              clamp_to(s.integral[i] + 1.1 * disturbance_rate_ * k * sign(x) * common_.period(), -k, k);
          break;
        }
      }
    }
    return u;
  }

  Common<N> common_;
  Vec<double, N> lambda_;
  Vec<double, N> a_;
  Vec<double, N> gamma_;
  Vec<double, N> mass_bound_;
  Vec<double, N> force_bound_;
  Vec<double, N> least_mass_inverse_;
  Switching switching_;
  double inverse_boundary_;
  double disturbance_rate_;
  bool sufficient_;
  bool adaptive_;
  double growth_;
  double layer_;
  Vec<double, N> least_;
  Vec<double, N> most_;
  Vec<double, N> force_limit_;
};

}  // namespace stribeck::control
