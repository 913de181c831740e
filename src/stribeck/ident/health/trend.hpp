#pragma once
/// Trend of a repeated measurement: its scatter, slow drift, and steps.
///
///   y_i = μ(t_i) + noise       μ: straight pieces with jumps between them, found by their posterior probability
///
///   piece     level and slope have Gaussian priors: the level ± 50 % of `scale`, the slope ± 0.2 % of `scale` per day. A season of
///             ± 10 % a year has at most 0.17 % per day, so that it is slow drift, not a step
///   pieces    each border between two measurements is a change with probability kChange; the likeliest division is found
///             exactly by dynamic programming, and the probability of each border by summing over all divisions (Fearnhead)
///   scatter   from differences of measurements one and three apart, so that steps and drift do not count; widened where
///             neighbours are correlated; pulled towards 1 % of `scale` as by four measurements. Below six measurements: 1 %, or that of the
///             measurement itself
///   outliers  a value beyond 3.5 times the scatter from the median of its five neighbours is moved there: a change needs three
///             measurements before it is believed
///   pending   the last one or two measurements, all beyond the step limit and 3.5 times the scatter from the median of the five before:
///             too few for a step, and worth another test
///   warmth    where every test has a temperature, at least 20 tests over 3 K: the slope by temperature from differences between tests
///             two days to a month apart, in which those across a step count little, is taken off
///
/// A border is a step when its probability within a week is at least kSure and its jump is three times its standard deviation; otherwise
/// only the drift changes there. False alarms, and the days until a change is found: tools/health.
///
/// Source: Fearnhead 2006, doi:10.1007/s11222-006-8450-8.
/// Not modelled: scatter that changes; outliers in groups of three and more.
/// Real time: no. Errors: none; fewer than three readings have no trend.

#include <cstddef>
#include <optional>
#include <stribeck/core/numbers.hpp>
#include <vector>

namespace stribeck::ident::health {

struct Reading {
  double day = 0.0;
  double value = 0.0;
  double half_width = 0.0;    ///< 95 %
  double temperature = kNaN;  ///< [°C]; NaN: not known
};

struct TrendOptions {
  double scale = 1.0;       ///< what counts as 100 %, in the unit of the values
  double step_limit = 0.1;  ///< smallest step that matters, as a share of the scale
  double drift_limit = 0.25;
};

/// Chance that a measurement begins a new piece.
inline constexpr double kChange = 1e-4;
/// Least probability of a step that is reported.
inline constexpr double kSure = 0.98;

struct Step {
  double day = 0.0;       ///< of the first measurement after it
  double earliest = 0.0;  ///< 95 % interval of that day
  double latest = 0.0;
  double change = 0.0;      ///< in the unit of the values
  double half_width = 0.0;  ///< 95 %
  double probability = 0.0;
  bool beyond_limit = false;
  bool undone = false;  ///< a later step took back at least half of it
  bool restores =
      false;  ///< takes an earlier step back, so that the number is within its limit of what it was before

  /// Whether it lasts, is beyond its limit, and is no return to what was.
  [[nodiscard]] bool matters() const noexcept { return beyond_limit && !undone && !restores; }
};

/// The newest measurements differ, and are too few to be a step.
struct Pending {
  std::size_t tests = 0;
  double change = 0.0;  ///< of their mean, from the median of those before, in the unit of the values
};

struct FittedPoint {
  double day = 0.0;
  double value = 0.0;
  double half_width = 0.0;  ///< 95 %, of μ
};

struct Trend {
  std::vector<Step> steps;         ///< in order of time
  std::vector<FittedPoint> curve;  ///< at every reading
  std::vector<double> values;      ///< readings less the effect of temperature
  double drift_limit = 0.25;       ///< of the options
  double reference = kNaN;  ///< μ in the middle of the first readings, at most ten and before the first step
  double now = kNaN;        ///< μ at the last reading
  double drift_half_width = kNaN;  ///< 95 %, of now − reference
  double slope = 0.0;              ///< of the last piece, per day
  double scatter = kNaN;           ///< standard deviation of one measurement
  double per_degree = kNaN;        ///< effect of temperature that was taken off; NaN: none
  bool stepped = false;            ///< a step beyond its limit that was not undone and restores nothing
  bool drifted = false;            ///< now is beyond the drift limit with 95 % confidence
  std::optional<Pending> pending{};

  [[nodiscard]] bool changed() const noexcept { return stepped || drifted; }
  [[nodiscard]] bool known() const noexcept { return !curve.empty(); }
};

/// Readings ascend in time.
Trend trend_of(const std::vector<Reading>& readings, const TrendOptions& options);

}  // namespace stribeck::ident::health
