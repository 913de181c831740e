#pragma once
/// Tells the person who maintains the machine how friction has changed since commissioning, as adaptation estimates it.
///
///   level    λ = (ψ₊ + ψ₋)/2 − 1       viscous χ − 1       break-away distance (1 + λ)/ρ − 1       shares of the identified model
///   trend    (λ_fast − λ_slow)/(τ_slow − τ_fast) [1/s], first-order averages over 10 s and 100 s of motion
///   verdict  by λ against 10 and 25 % and three standard deviations, given only if one standard deviation of λ is below 10 %; if λ is unchanged, by a delay
///            above one period, viscous friction above 25 % or a mass above 15 %, each beyond three standard deviations. Viscous
///            friction counts only if it is known to 20 %: slow motion holds little of it, and moves the estimate at random
///   shape    λ and χ − 1 of opposite sign, both beyond two standard deviations: no machine changes like that; the map lacks
///            the speeds of this motion
///
/// Time counts only while the axis moves and the level is known to 10 %, so that the first convergence of the estimate is not taken for a trend. A
/// trend that lowers the level by 2 % within 100 s, and by more than three standard deviations, is reported as falling friction.
/// The messages recommend no maintenance, because within one run a change of the machine looks like an error of the model. Two things
/// tell them apart: a model that was verified at these speeds, and the trend of repeated tests (ident/health).
/// Source: none; the limits are Stribeck's own.
/// Not modelled: the cause (lubrication, preload, covers and temperature look alike in a force). The break-away distance is not
/// used in the verdict, because a vibrating loop distorts it. An error of the identified model looks like a change.
/// Real time: safe.

#include <limits>
#include <stribeck/control/compensation/friction_rls.hpp>

namespace stribeck::control {

enum class DriftVerdict {
  kNotYet,
  kAsCommissioned,
  kWarmingUp,
  kMore,
  kMuchMore,
  kLess,
  kMuchLess,
  kMoreViscous,
  kLessViscous,
  kAnotherMass,
  kAnotherDelay,
  kAnotherShape
};

constexpr std::string_view describe(DriftVerdict v) noexcept {
  switch (v) {
    case DriftVerdict::kNotYet:
      return "too little motion yet to tell";
    case DriftVerdict::kAsCommissioned:
      return "as commissioned";
    case DriftVerdict::kWarmingUp:
      return "friction fell during this run, as it does while an axis warms up";
    case DriftVerdict::kMore:
      return "more friction than in the model: verify it with a log of these speeds, then compare with earlier tests (stribeck health)";
    case DriftVerdict::kMuchMore:
      return "much more friction than in the model: it does not hold here, or the axis has changed; identify with a log of these speeds";
    case DriftVerdict::kLess:
      return "less friction than in the model: verify it with a log of these speeds, then compare with earlier tests (stribeck health)";
    case DriftVerdict::kMuchLess:
      return "much less friction than in the model: it does not hold here, or the axis has changed; identify with a log of these speeds";
    case DriftVerdict::kMoreViscous:
      return "friction rises more with speed than in the model: verify it with a log of these speeds";
    case DriftVerdict::kLessViscous:
      return "friction rises less with speed than in the model: verify it with a log of these speeds";
    case DriftVerdict::kAnotherMass:
      return "another mass than in the model: a workpiece, or a mass that was not well identified";
    case DriftVerdict::kAnotherDelay:
      return "the force acts later or earlier than the axis file says: identify again";
    case DriftVerdict::kAnotherShape:
      return "the model does not hold at these speeds: identify there";
  }
  return "unknown";
}

/// State of one axis, as shares of the identified values.
struct Drift {
  double level = 0.0;
  double level_deviation = 0.0;  ///< standard deviation
  double positive = 0.0;         ///< level for v > 0
  double negative = 0.0;
  double viscous = 0.0;
  double break_away = 0.0;  ///< distance
  double mass = 0.0;
  double delay = 0.0;  ///< beyond the assumed one [s]
  double viscous_deviation = 0.0;
  double break_away_deviation = 0.0;
  double mass_deviation = 0.0;
  double delay_deviation = 0.0;  ///< [s]
  double trend =
      std::numeric_limits<double>::quiet_NaN();  ///< of the level [1/s]; NaN: too little motion yet
  DriftVerdict verdict = DriftVerdict::kNotYet;
};

class DriftMonitor {
 public:
  struct State {
    double fast = 0.0;
    double slow = 0.0;
    double moved = 0.0;  ///< time in motion [s]
  };

  /// One period of `dt` [s].
  static void step(State& s, const FrictionRls::State& a, bool moving, double dt) noexcept {
    if (!moving || !a.informed || level_deviation_of(a) > kUnsure) return;
    const double level = level_of(a);
    s.moved += dt;
    // Until there is enough data, the average over all of it.
    s.fast += dt / min_of(kFast, s.moved) * (level - s.fast);
    s.slow += dt / min_of(kSlow, s.moved) * (level - s.slow);
  }

  static Drift report(const State& s, const FrictionRls::State& a, double period) noexcept {
    using A = FrictionRls;
    Drift d;
    d.positive = a.theta[A::kPositive];
    d.negative = a.theta[A::kNegative];
    d.level = level_of(a);
    d.level_deviation = level_deviation_of(a);
    d.viscous = a.theta[A::kViscous];
    d.break_away = (1.0 + d.level) / (1.0 + a.theta[A::kStiffness]) - 1.0;
    d.mass = a.theta[A::kMass];
    d.delay = a.theta[A::kDelay] * period;
    d.viscous_deviation = a.deviation[A::kViscous];
    d.break_away_deviation = a.deviation[A::kStiffness] * (1.0 + d.level) /
                             ((1.0 + a.theta[A::kStiffness]) * (1.0 + a.theta[A::kStiffness]));
    d.mass_deviation = a.deviation[A::kMass];
    d.delay_deviation = a.deviation[A::kDelay] * period;
    if (s.moved > kSlow) d.trend = (s.fast - s.slow) / (kSlow - kFast);
    if (!a.informed || d.level_deviation > kUnsure) return d;
    const double watch = max_of(kWatch, kSure * d.level_deviation);
    const double act = max_of(kAct, kSure * d.level_deviation);
    const bool slope_known = d.viscous_deviation < kUnsureViscous;
    const bool shape = slope_known && d.level * d.viscous < 0.0 &&
                       abs(d.level) > kLikely * d.level_deviation &&
                       abs(d.viscous) > max_of(kViscous, kLikely * d.viscous_deviation);
    const bool delay = abs(d.delay) > max_of(period, kSure * d.delay_deviation);
    const bool viscous = slope_known && abs(d.viscous) > max_of(kViscous, kSure * d.viscous_deviation);
    const bool mass = abs(d.mass) > max_of(kMass, kSure * d.mass_deviation);
    const bool falling = d.trend * kSlow < -max_of(kWarming, kSure * d.level_deviation);
    d.verdict = falling                    ? DriftVerdict::kWarmingUp
                : shape                    ? DriftVerdict::kAnotherShape
                : d.level > act            ? DriftVerdict::kMuchMore
                : d.level > watch          ? DriftVerdict::kMore
                : d.level < -act           ? DriftVerdict::kMuchLess
                : d.level < -watch         ? DriftVerdict::kLess
                : delay                    ? DriftVerdict::kAnotherDelay
                : viscous && d.viscous > 0 ? DriftVerdict::kMoreViscous
                : viscous                  ? DriftVerdict::kLessViscous
                : mass                     ? DriftVerdict::kAnotherMass
                                           : DriftVerdict::kAsCommissioned;
    return d;
  }

 private:
  static double level_of(const FrictionRls::State& a) noexcept {
    return 0.5 * (a.theta[FrictionRls::kPositive] + a.theta[FrictionRls::kNegative]);
  }
  static double level_deviation_of(const FrictionRls::State& a) noexcept {
    using A = FrictionRls;
    return 0.5 * sqrt(max_of(a.p[A::kPositive][A::kPositive] + a.p[A::kNegative][A::kNegative] +
                                 2.0 * a.p[A::kPositive][A::kNegative],
                             0.0));
  }

  static constexpr double kFast = 10.0;          ///< [s]
  static constexpr double kSlow = 100.0;         ///< [s]
  static constexpr double kUnsure = 0.1;         ///< standard deviation of the level
  static constexpr double kUnsureViscous = 0.2;  ///< the same of viscous friction
  static constexpr double kWatch = 0.1;          ///< change of the level
  static constexpr double kAct = 0.25;           ///< change of the level from which the user must act
  static constexpr double kWarming = 0.02;       ///< fall of the level within kSlow
  static constexpr double kViscous = 0.25;       ///< change of viscous friction
  static constexpr double kMass = 0.15;          ///< share of the mass
  static constexpr double kSure = 3.0;           ///< limit in standard deviations
  static constexpr double kLikely = 2.0;         ///< the same where two parameters contradict each other
};

}  // namespace stribeck::control
