#pragma once
/// PID control of each axis with mass and acceleration feed-forward.
///
///   F = m·(r̈ − k_v ė − k_p e − k_i ∫e dt) + F_friction + load + d̂          e = x − r
///
///   m mass of the model [kg], k_p [1/s²], k_v [1/s], k_i [1/s³], F force on the axis [N], positive towards +x.
///   Closed loop, mass known: s³ + k_v s² + k_p s + k_i. Stable (Routh): k_i < k_p k_v, all positive; sampled: stable(period),
///   from sampled_loop.hpp.
///
/// Against winding up: the integral part alone never commands more than force_limit, and it stops while the force is
/// limited and the error would drive it further (conditional integration). The integral includes the present sample.
/// Source: Åström, Hägglund 1995, PID Controllers, chapters 3.2 and 3.5.
/// Not modelled: with friction an integral hunts around standstill; give it friction feed-forward, or k_i = 0.
/// Real time: safe; the constructor configure only.

#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/control/setup.hpp>

namespace stribeck::control {

template <std::size_t N>
class Pid;

struct PidParams {
  template <std::size_t N>
  using Controller = Pid<N>;
  static constexpr std::string_view kKind = "pid";
  static constexpr std::string_view kLabel = "PID control";

  PerAxis kp{2700.0};
  PerAxis ki{27000.0};
  PerAxis kv{90.0};
  ErrorRate error_rate = ErrorRate::kDifferenceOfError;

  static constexpr auto fields() {
    return std::tuple{
        field("kp", &PidParams::kp, quantity("1/s2", "1/s2").positive(),
              "proportional gains, one per axis; the last one applies to the others too")
            .or_default(),
        field("ki", &PidParams::ki, quantity("1/s3", "1/s3").not_negative(),
              "integral gains, in the same order")
            .or_default(),
        field("kv", &PidParams::kv, quantity("1/s", "1/s").positive(), "derivative gains, in the same order")
            .or_default(),
        field("error_rate", &PidParams::error_rate, kErrorRateHelp).or_default()};
  }

  /// Parameters for a triple pole [rad/s].
  static constexpr PidParams triple(double omega) noexcept {
    PidParams p;
    p.kp = {3.0 * omega * omega};
    p.ki = {omega * omega * omega};
    p.kv = {3.0 * omega};
    return p;
  }

  template <class Report>
  void validate(Report&& report) const {
    if (!stable()) report("ki", "expected less than kp·kv on each axis: the loop would be unstable");
  }

  /// Whether it is stable in continuous time.
  [[nodiscard]] constexpr bool stable() const noexcept {
    return each([](double p, double i, double v) { return p > 0.0 && v > 0.0 && i >= 0.0 && i < p * v; });
  }
  /// Whether it is stable when sampled with this period [s].
  [[nodiscard]] constexpr bool stable(double period) const noexcept {
    return each([&](double p, double i, double v) { return sampled_loop_stable(p, v, i, period); });
  }

 private:
  template <class F>
  [[nodiscard]] constexpr bool each(F holds) const noexcept {
    const auto p = spread<kMostAxes>(kp);
    const auto i = spread<kMostAxes>(ki);
    const auto v = spread<kMostAxes>(kv);
    for (std::size_t n = 0; n < kMostAxes; ++n) {
      if (!holds(p[n], i[n], v[n])) return false;
    }
    return true;
  }
};

template <std::size_t N>
class Pid {
 public:
  using Params = PidParams;
  struct State : Common<N>::State {
    Vec<double, N> integral;  ///< of the tracking error [m·s]
  };

  Pid(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, params.error_rate),
        kp_(spread<N>(params.kp)),
        ki_(spread<N>(params.ki)),
        kv_(spread<N>(params.kv)),
        limit_(setup.force_limit) {}

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  Vec<double, N> step(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    if (!common_.begin(s, r, measured)) return s.force;
    const Vec<double, N> e = common_.error(s);
    const Vec<double, N> rate = common_.rate(s);
    Vec<double, N> integral;
    Vec<double, N> wanted;
    for (std::size_t i = 0; i < N; ++i) {
      const double most = limit_[i] / (common_.mass(i) * ki_[i]);  // infinite without a limit or without k_i
      integral[i] = clamp_to(s.integral[i] + common_.period() * e[i], -most, most);
      wanted[i] = r.acceleration[i] - kv_[i] * rate[i] - kp_[i] * e[i] - ki_[i] * integral[i];
    }
    const Vec<double, N> force = common_.finish(s, r, wanted);
    for (std::size_t i = 0; i < N; ++i) {
      // An error ahead of the reference reduces the force.
      if ((abs(force[i]) < limit_[i] && !s.cut[i]) || force[i] * e[i] > 0.0) s.integral[i] = integral[i];
    }
    return force;
  }

 private:
  Common<N> common_;
  Vec<double, N> kp_;
  Vec<double, N> ki_;
  Vec<double, N> kv_;
  Vec<double, N> limit_;
};

}  // namespace stribeck::control
