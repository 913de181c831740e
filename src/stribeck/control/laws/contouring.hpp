#pragma once
/// Contouring control: feedback in the frame that moves along the path, so that the error along the path and the errors across
/// it have separate gains.
///
///   F = M·{ r̈ − R·(K_v ė_l + K_p e_l + R̈ᵀe_w + 2Ṙᵀė_w) } + F_friction + load + d̂
///   e_w = x − r,   e_l = Rᵀe_w,   ė_l = Ṙᵀe_w + Rᵀė_w,   R = [t n b …]
///
///   K_p [1/s²], K_v [1/s] diagonal, along (t) and across (n, b, …) the path; M = diag(m) [kg].
///   Closed loop, masses and friction known: ë_l + K_v ė_l + K_p e_l = 0; stable for all K_p, K_v > 0 in continuous time.
///
/// Any number of axes. With two it is (3.8) with the correction that θ̇²e_w has no I (docs/corrections-to-the-thesis.md); with
/// one it is PD. Limits, observers and inputs that are not finite: as in setup.hpp.
/// Source: thesis (3.6)–(3.8), (4.5).
/// Real time: safe; the constructor configure only.

#include <stribeck/control/setup.hpp>

namespace stribeck::control {

template <std::size_t N>
class Contouring;

struct ContouringParams {
  template <std::size_t N>
  using Controller = Contouring<N>;
  static constexpr std::string_view kKind = "contouring";
  static constexpr std::string_view kLabel = "contouring control";

  PerAxis kp{1600.0};
  PerAxis kv{80.0};
  ErrorRate error_rate = ErrorRate::kDifferenceOfError;

  static constexpr auto fields() {
    return std::tuple{
        field(
            "kp", &ContouringParams::kp, quantity("1/s2", "1/s2").positive(),
            "proportional gains, along the path first, then across it; the last one applies to the others too")
            .or_default(),
        field("kv", &ContouringParams::kv, quantity("1/s", "1/s").positive(),
              "derivative gains, in the same order")
            .or_default(),
        field("error_rate", &ContouringParams::error_rate, kErrorRateHelp).or_default()};
  }

  /// Parameters for double poles along and across the path [rad/s].
  static constexpr ContouringParams critical(double along, double across) noexcept {
    ContouringParams p;
    p.kp = {along * along, across * across};
    p.kv = {2.0 * along, 2.0 * across};
    return p;
  }
};

/// The feedback alone: −R·(K_v ė_l + K_p e_l + R̈ᵀe_w + 2Ṙᵀė_w) [m/s²].
template <std::size_t N>
class ContouringFeedback {
 public:
  ContouringFeedback(const PerAxis& kp, const PerAxis& kv) noexcept
      : kp_(spread<N>(kp)), kv_(spread<N>(kv)) {}

  /// For tracking errors [m] and their rates [m/s] at a point of the path.
  Vec<double, N> operator()(const path::PathPoint<N>& r, const Vec<double, N>& e,
                            const Vec<double, N>& rate) const noexcept {
    const Vec<double, N> local = r.frame * e;
    const Vec<double, N> turned = r.frame_rate * e;   // Ṙᵀe
    const Vec<double, N> seen = r.frame_rate * rate;  // Ṙᵀė
    const Vec<double, N> local_rate = turned + r.frame * rate;
    const Vec<double, N> bent = r.frame_acceleration * e;
    Vec<double, N> inside;
    for (std::size_t i = 0; i < N; ++i)
      inside[i] = kv_[i] * local_rate[i] + kp_[i] * local[i] + bent[i] + 2.0 * seen[i];
    return -1.0 * to_machine(r.frame, inside);
  }

 private:
  Vec<double, N> kp_;
  Vec<double, N> kv_;
};

template <std::size_t N>
class Contouring {
 public:
  using Params = ContouringParams;
  using State = typename Common<N>::State;

  Contouring(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, params.error_rate), feedback_(params.kp, params.kv) {}

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  Vec<double, N> step(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    if (!common_.begin(s, r, measured)) return s.force;
    return common_.finish(s, r, r.acceleration + feedback_(r, common_.error(s), common_.rate(s)));
  }

 private:
  Common<N> common_;
  ContouringFeedback<N> feedback_;
};

}  // namespace stribeck::control
