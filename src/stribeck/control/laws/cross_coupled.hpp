#pragma once
/// Cross-coupled control: PD on each axis, and PID on the contour error across the path, given to all axes together.
///
///   a = r̈ − k_v ė − k_p e − Σ_j n_j·(w_p ε_j + w_d ε̇_j + w_i ∫ε_j dt)       F = m·a + F_friction + load + d̂
///   ε_j = n_jᵀe,   ε̇_j = ṅ_jᵀe + n_jᵀė          n_j: the directions across the path, rows 1… of the frame
///
///   e = x − r [m]; k_p, w_p [1/s²], k_v, w_d [1/s], w_i [1/s³]; ε linearised contour error [m], its sides as in the glossary.
///   On a straight stretch with equal axes: along s² + k_v s + k_p, across s³ + (k_v + w_d)s² + (k_p + w_p)s + w_i.
///   Stable for any fixed direction, axes equal or not: w_i < (k_p/c + w_p)(k_v + c·w_d), with the smallest k_p, k_v, for every
///   c in (0, 1]: stable(). (An eigenvector u obeys a cubic with uᵀK_p u, uᵀK_v u and c = Σ(n_jᵀu)²; Routh on it.) Not known for
///   a frame that turns as fast as the loop is.
///
/// In Koren's form the coupling has its own gains and the axes keep theirs; contouring.hpp changes the gains of the axes.
/// The integrals stop while any axis is limited. A single axis has no direction across: PD.
/// Source: Koren 1980, doi:10.1115/1.3149612; Koren, Lo 1991, doi:10.1016/S0007-8506(07)62009-5.
/// Not modelled: curvature of the path in ε (Koren and Lo's variable gains); the error is eₜ²κ/2.
/// Real time: safe; the constructor configure only.

#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/control/setup.hpp>

namespace stribeck::control {

template <std::size_t N>
class CrossCoupled;

struct CrossCoupledParams {
  template <std::size_t N>
  using Controller = CrossCoupled<N>;
  static constexpr std::string_view kKind = "cross-coupled";
  static constexpr std::string_view kLabel = "cross-coupled control";

  PerAxis kp{1600.0};
  PerAxis kv{80.0};
  double contour_kp = 2000.0;
  double contour_ki = 20000.0;
  double contour_kv = 40.0;
  ErrorRate error_rate = ErrorRate::kDifferenceOfError;

  static constexpr auto fields() {
    using P = CrossCoupledParams;
    return std::tuple{
        field("kp", &P::kp, quantity("1/s2", "1/s2").positive(),
              "proportional gains, one per axis; the last one applies to the others too")
            .or_default(),
        field("kv", &P::kv, quantity("1/s", "1/s").positive(), "derivative gains, in the same order")
            .or_default(),
        field("contour_kp", &P::contour_kp, quantity("1/s2", "1/s2").not_negative(),
              "proportional gain on the contour error, added to kp across the path")
            .or_default(),
        field("contour_ki", &P::contour_ki, quantity("1/s3", "1/s3").not_negative(),
              "integral gain on the contour error")
            .or_default(),
        field("contour_kv", &P::contour_kv, quantity("1/s", "1/s").not_negative(),
              "derivative gain on the contour error, added to kv across the path")
            .or_default(),
        field("error_rate", &P::error_rate, kErrorRateHelp).or_default()};
  }

  template <class Report>
  void validate(Report&& report) const {
    if (!stable())
      report("contour_ki",
             "expected less than (kp + contour_kp)·(kv + contour_kv), or less with unequal axes: the loop "
             "would be unstable");
  }

  /// Whether it is stable in continuous time, for any fixed direction of the path.
  [[nodiscard]] bool stable() const noexcept {
    double p = kp.empty() ? 0.0 : kp[0];
    double v = kv.empty() ? 0.0 : kv[0];
    for (const double k : kp) p = min_of(p, k);
    for (const double k : kv) v = min_of(v, k);
    if (!(p > 0.0 && v > 0.0)) return false;
    // (k_p/c + w_p)(k_v + c·w_d) is smallest at c = √(k_p k_v/(w_p w_d)), or at the border.
    const double c = sqrt(min_of(1.0, p * v / max_of(contour_kp * contour_kv, p * v)));
    return contour_ki < (p / c + contour_kp) * (v + c * contour_kv);
  }
  /// Whether it is stable when sampled with this period [s], on a straight stretch; exact where the axes have equal gains.
  [[nodiscard]] constexpr bool stable(double period) const noexcept {
    const auto p = spread<kMostAxes>(kp);
    const auto v = spread<kMostAxes>(kv);
    for (std::size_t n = 0; n < kMostAxes; ++n) {
      if (!sampled_loop_stable(p[n], v[n], 0.0, period)) return false;
      if (!sampled_loop_stable(p[n] + contour_kp, v[n] + contour_kv, contour_ki, period)) return false;
    }
    return true;
  }
};

template <std::size_t N>
class CrossCoupled {
 public:
  using Params = CrossCoupledParams;
  struct State : Common<N>::State {
    Vec<double, N> contour_error;  ///< of the last step, in the frame; the first, along the path, stays 0 [m]
    Vec<double, N> integral;       ///< of it [m·s]
  };

  CrossCoupled(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, params.error_rate),
        kp_(spread<N>(params.kp)),
        kv_(spread<N>(params.kv)),
        contour_kp_(params.contour_kp),
        contour_ki_(params.contour_ki),
        contour_kv_(params.contour_kv),
        limit_(setup.force_limit) {}

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  Vec<double, N> step(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    if (!common_.begin(s, r, measured)) return s.force;
    const Vec<double, N> e = common_.error(s);
    const Vec<double, N> rate = common_.rate(s);
    Vec<double, N> wanted;
    for (std::size_t i = 0; i < N; ++i) wanted[i] = r.acceleration[i] - kv_[i] * rate[i] - kp_[i] * e[i];
    Vec<double, N> integral;
    for (std::size_t j = 1; j < N; ++j) {
      const double error = dot(r.frame[j], e);
      const double error_rate = dot(r.frame_rate[j], e) + dot(r.frame[j], rate);
      s.contour_error[j] = error;
      integral[j] = s.integral[j] + common_.period() * error;
      const double pull = contour_kp_ * error + contour_kv_ * error_rate + contour_ki_ * integral[j];
      wanted = wanted - pull * r.frame[j];
    }
    const Vec<double, N> force = common_.finish(s, r, wanted);
    bool limited = false;
    for (std::size_t i = 0; i < N; ++i) limited = limited || !(abs(force[i]) < limit_[i]) || s.cut[i];
    if (!limited) s.integral = integral;
    return force;
  }

 private:
  Common<N> common_;
  Vec<double, N> kp_;
  Vec<double, N> kv_;
  double contour_kp_;
  double contour_ki_;
  double contour_kv_;
  Vec<double, N> limit_;
};

}  // namespace stribeck::control
