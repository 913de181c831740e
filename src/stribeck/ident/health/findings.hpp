#pragma once
/// What the tests of an axis show together: a trend for each number, changes found in them, and likely causes.
///
/// Every force counts as a share of the friction level, which is the mean of both directions in the first test, Coulomb friction of
/// itself but at least of 0.3 of that level, viscous friction of itself where it is larger; a mass as a share of itself; a length of the circular test as a share of twice its first value, at least of 2 µm. Steps within a week of each other, in whichever numbers, are
/// one change; a step that does not count makes none. Its effect on every other number is the difference of the medians of three to ten tests before and after, as many as tell it best, less the slope
/// that both sides share; its interval holds that slope and the bend of a season (a slope of 0.2 % per day at most). A slow change is a
/// number that has left its drift limit, twice as wide for viscous friction without temperatures; its effect is that since the first tests.
///
/// Causes follow from the pattern alone (causes.cpp has the rules): several may fit, and none is proven.
/// Real time: no. Errors: none.

#include <array>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/health/measured.hpp>
#include <stribeck/ident/health/trend.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::ident::health {

/// Of a circle of two axes [m].
struct CircleMeasured {
  double radius = 0.0;
  double circular_deviation = 0.0;  ///< G(b), or G where only one direction was travelled
  double max_error = 0.0;
  std::optional<double> hysteresis{};  ///< H

  static constexpr auto fields() {
    using C = CircleMeasured;
    return std::tuple{
        field("radius", &C::radius, quantity("m", "mm").positive(), "commanded radius"),
        field("circular_deviation", &C::circular_deviation, quantity("m", "um").not_negative(),
              "circular deviation G(b) of both directions; G where there is one"),
        field("max_error", &C::max_error, quantity("m", "um").not_negative(), "largest contour error"),
        field("hysteresis", &C::hysteresis, quantity("m", "um").not_negative(), "circular hysteresis H")
            .or_default()};
  }
};

/// One test: of an axis, or of a circle.
struct HealthTest {
  double day = 0.0;           ///< days since 1970-01-01; a later test of the same day some thousandths more
  double temperature = kNaN;  ///< [°C]
  std::optional<Measured> axis{};
  std::optional<CircleMeasured> circle{};
};

enum class Number {
  kForward,
  kBackward,
  kCoulomb,
  kViscous,
  kOffset,
  kMass,
  kSpring,  ///< force at the end of the travel
  kUnbalance,
  kPlace,
  kPeriodic,
  kCircularDeviation,
  kHysteresis
};

struct Limits {
  double step = 0.1;
  double drift = 0.25;
};

struct Channel {
  Number number = Number::kForward;
  std::array<double, 2> at{};  ///< place: from, to [m]; periodic: period [m]
  double scale = 1.0;  ///< what counts as 100 % [N, kg or m]; viscous friction is shown as force at top speed
  std::vector<Reading> readings;
  Trend trend;
  bool rotary = false;  ///< of an axis that turns: carried at a radius of 1 m

  [[nodiscard]] double share(double value) const { return value / scale; }
};

/// How a number changed at a time.
struct Shift {
  std::size_t channel = 0;
  double share = 0.0;      ///< of the scale
  double deviation = 0.0;  ///< standard deviation, as a share
  bool counts =
      false;  ///< at least three standard deviations and 2 %, or the limit of a step where it is less
};

struct Cause {
  std::string what;
  std::string why;
  std::string next;
};

struct Change {
  bool slow = false;  ///< a drift beyond its limit; otherwise a step
  double day = 0.0;
  double earliest = 0.0;  ///< 95 %; of a step
  double latest = 0.0;
  double probability = 1.0;
  bool beyond_limit = false;
  bool undone = false;
  bool restores = false;       ///< takes an earlier step back, in all numbers that count
  bool restores_part = false;  ///< in its largest number, and others that count do not go back
  std::vector<Shift> shifts;   ///< one for each channel
  std::vector<Cause> causes;

  /// Whether it lasts, is beyond its limit, and is no return to what was.
  [[nodiscard]] bool matters() const noexcept {
    return beyond_limit && !undone && !restores && !restores_part;
  }
};

struct Health {
  std::vector<Channel> channels;
  std::vector<Change> changes;  ///< in order of time

  [[nodiscard]] bool changed() const noexcept {
    for (const Change& c : changes) {
      if (c.matters()) return true;
    }
    return false;
  }
};

/// Tests of one axis or of one circle, ascending in time, all of the same plan.
/// `rotary`: of an axis that turns, whose places are shown as angles.
Health health_of(const std::vector<HealthTest>& tests, const Limits& limits = {}, bool rotary = false);

/// The causes that fit a pattern of shifts, the likeliest first.
std::vector<Cause> causes_of(const std::vector<Channel>& channels, const std::vector<Shift>& shifts);

}  // namespace stribeck::ident::health

template <>
struct stribeck::EnumNames<stribeck::ident::health::Number> {
  using N = stribeck::ident::health::Number;
  static constexpr std::array names{std::pair{N::kForward, std::string_view{"forward"}},
                                    std::pair{N::kBackward, std::string_view{"backward"}},
                                    std::pair{N::kCoulomb, std::string_view{"coulomb"}},
                                    std::pair{N::kViscous, std::string_view{"viscous"}},
                                    std::pair{N::kOffset, std::string_view{"offset"}},
                                    std::pair{N::kMass, std::string_view{"mass"}},
                                    std::pair{N::kSpring, std::string_view{"spring"}},
                                    std::pair{N::kUnbalance, std::string_view{"unbalance"}},
                                    std::pair{N::kPlace, std::string_view{"place"}},
                                    std::pair{N::kPeriodic, std::string_view{"periodic"}},
                                    std::pair{N::kCircularDeviation, std::string_view{"circular-deviation"}},
                                    std::pair{N::kHysteresis, std::string_view{"hysteresis"}}};
};
