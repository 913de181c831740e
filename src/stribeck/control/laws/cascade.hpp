#pragma once
/// The cascade of a numerical control: a P controller of position around a PI controller of velocity, with velocity and
/// acceleration feed-forward.
///
///   v_c = K_v·(r − x) + c_v·ṙ
///   F = m·{ K_p·(v_c − v) + (K_p/T_n)·∫(v_c − v)dt + c_a·r̈ } + F_friction + load + d̂
///
///   K_v [1/s] position gain (the Kv factor: 16.7 1/s is 1 m/min per mm), K_p [1/s] velocity gain, T_n [s] integral time,
///   c_v, c_a [1] shares of feed-forward, v velocity from the encoder's difference [m/s], m mass of the model [kg].
///   Closed loop, mass known: s³ + K_p s² + K_p(K_v + 1/T_n)s + K_p K_v/T_n. With c_v = 0 an axis at constant speed lags by
///   ṙ/K_v, as in controls without feed-forward; with c_v = c_a = 1 it is PID with k_v = K_p, k_p = K_p(K_v + 1/T_n),
///   k_i = K_p K_v/T_n.
///   Stable (Routh): K_p > K_v/(1 + K_v T_n), all positive; sampled: stable(period), from sampled_loop.hpp.
///
/// ṙ has the same delay as v, as differences of set positions have (error_rate: difference-of-error), or is exact (late). The
/// integral is kept from winding up as in pid.hpp.
/// Source: Altintas, Verl, Brecher, Uriarte, Pritschow 2011, Machine tool feed drives, doi:10.1016/j.cirp.2011.05.010.
/// Not modelled: cycles of velocity and current shorter than that of position; filters of the set values.
/// Real time: safe; the constructor configure only.

#include <limits>
#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/control/setup.hpp>

namespace stribeck::control {

template <std::size_t N>
class Cascade;

struct CascadeParams {
  template <std::size_t N>
  using Controller = Cascade<N>;
  static constexpr std::string_view kKind = "cascade";
  static constexpr std::string_view kLabel = "cascade P-PI";

  PerAxis position_gain{20.0};
  PerAxis velocity_gain{80.0};
  PerAxis integral_time{0.1};
  double velocity_feedforward = 1.0;
  double acceleration_feedforward = 1.0;
  ErrorRate error_rate = ErrorRate::kDifferenceOfError;

  static constexpr auto fields() {
    using P = CascadeParams;
    return std::tuple{
        field("position_gain", &P::position_gain, quantity("1/s", "1/s").positive(),
              "gains of the position loops (Kv factor), one per axis; the last one applies to the others too")
            .or_default(),
        field("velocity_gain", &P::velocity_gain, quantity("1/s", "1/s").positive(),
              "gains of the velocity loops, in the same order")
            .or_default(),
        field("integral_time", &P::integral_time, quantity("s", "ms").positive(),
              "integral times of the velocity loops, in the same order")
            .or_default(),
        field("velocity_feedforward", &P::velocity_feedforward, pure_number().not_negative().at_most(1.0),
              "share of the reference velocity that is fed forward")
            .or_default(),
        field("acceleration_feedforward", &P::acceleration_feedforward,
              pure_number().not_negative().at_most(1.0),
              "share of the reference acceleration that is fed forward")
            .or_default(),
        field(
            "error_rate", &P::error_rate,
            "velocity fed forward: as late as the measured one (difference-of-error), or exact (late); observed: exact, and the velocity "
            "of the Kalman observer in place of the measured one")
            .or_default()};
  }

  template <class Report>
  void validate(Report&& report) const {
    if (!stable())
      report("velocity_gain",
             "expected more than position_gain/(1 + position_gain·integral_time) on each axis: the loop "
             "would be unstable");
  }

  /// Whether it is stable in continuous time.
  [[nodiscard]] constexpr bool stable() const noexcept {
    return each([](double position, double velocity, double time) {
      return position > 0.0 && time > 0.0 && velocity * (1.0 + position * time) > position;
    });
  }
  /// Whether it is stable when sampled with this period [s].
  [[nodiscard]] constexpr bool stable(double period) const noexcept {
    return each([&](double position, double velocity, double time) {
      return sampled_loop_stable(velocity * (position + 1.0 / time), velocity, velocity * position / time,
                                 period);
    });
  }

 private:
  template <class F>
  [[nodiscard]] constexpr bool each(F holds) const noexcept {
    const auto p = spread<kMostAxes>(position_gain);
    const auto v = spread<kMostAxes>(velocity_gain);
    const auto t = spread<kMostAxes>(integral_time);
    for (std::size_t n = 0; n < kMostAxes; ++n) {
      if (!holds(p[n], v[n], t[n])) return false;
    }
    return true;
  }
};

template <std::size_t N>
class Cascade {
 public:
  using Params = CascadeParams;
  struct State : Common<N>::State {
    Vec<double, N> velocity_error;  ///< v_c − v of the last step [m/s]
    Vec<double, N> integral;        ///< of v_c − v [m]
  };

  Cascade(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, params.error_rate),
        position_gain_(spread<N>(params.position_gain)),
        velocity_gain_(spread<N>(params.velocity_gain)),
        velocity_share_(params.velocity_feedforward),
        acceleration_share_(params.acceleration_feedforward),
        observed_(params.error_rate == ErrorRate::kObserved),
        limit_(setup.force_limit) {
    const auto time = spread<N>(params.integral_time, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < N; ++i) integral_gain_[i] = velocity_gain_[i] / time[i];
  }

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  Vec<double, N> step(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    if (!common_.begin(s, r, measured)) return s.force;
    Vec<double, N> integral;
    Vec<double, N> wanted;
    for (std::size_t i = 0; i < N; ++i) {
      const double rate = s.error[i].rate;
      const double velocity = observed_ ? rate + r.velocity[i] : s.error[i].velocity;
      const double reference_velocity = observed_ ? r.velocity[i] : velocity - rate;
      const double commanded = velocity_share_ * reference_velocity - position_gain_[i] * s.error[i].e;
      s.velocity_error[i] = commanded - velocity;
      const double most = limit_[i] / (common_.mass(i) * integral_gain_[i]);
      integral[i] = clamp_to(s.integral[i] + common_.period() * s.velocity_error[i], -most, most);
      wanted[i] = velocity_gain_[i] * s.velocity_error[i] + integral_gain_[i] * integral[i] +
                  acceleration_share_ * r.acceleration[i];
    }
    const Vec<double, N> force = common_.finish(s, r, wanted);
    for (std::size_t i = 0; i < N; ++i) {
      if ((abs(force[i]) < limit_[i] && !s.cut[i]) || force[i] * s.velocity_error[i] < 0.0)
        s.integral[i] = integral[i];
    }
    return force;
  }

 private:
  Common<N> common_;
  Vec<double, N> position_gain_;
  Vec<double, N> velocity_gain_;
  Vec<double, N> integral_gain_;
  double velocity_share_;
  double acceleration_share_;
  bool observed_;
  Vec<double, N> limit_;
};

}  // namespace stribeck::control
