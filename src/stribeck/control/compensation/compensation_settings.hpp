#pragma once
/// The settings of a compensation (compensation.hpp), with the same ranges and rules in controller files, in the C interface and
/// in HAL. A new one is a member and a field here.
///
///   Each   double: settings of one axis;  PerAxis: of a controller, one value per axis
///
/// Real time: configure only. Errors: validate() says which settings contradict each other.

#include <array>
#include <optional>
#include <stribeck/control/compensation/friction_rls.hpp>
#include <stribeck/control/compensation/reversal_feedforward.hpp>
#include <stribeck/control/tracking_error.hpp>
#include <stribeck/core/fields.hpp>
#include <string_view>
#include <utility>

namespace stribeck::control {

enum class Observer { kNone, kDisturbance, kKalman, kAdaptive };

/// How friction is fed forward.
enum class Feedforward { kNone, kSteady, kDynamic, kReversal };

}  // namespace stribeck::control

template <>
struct stribeck::EnumNames<stribeck::control::Observer> {
  static constexpr std::array names{
      std::pair{stribeck::control::Observer::kNone, std::string_view{"none"}},
      std::pair{stribeck::control::Observer::kDisturbance, std::string_view{"disturbance"}},
      std::pair{stribeck::control::Observer::kKalman, std::string_view{"kalman"}},
      std::pair{stribeck::control::Observer::kAdaptive, std::string_view{"adaptive"}}};
};

template <>
struct stribeck::EnumNames<stribeck::control::Feedforward> {
  static constexpr std::array names{
      std::pair{stribeck::control::Feedforward::kNone, std::string_view{"none"}},
      std::pair{stribeck::control::Feedforward::kSteady, std::string_view{"steady"}},
      std::pair{stribeck::control::Feedforward::kDynamic, std::string_view{"dynamic"}},
      std::pair{stribeck::control::Feedforward::kReversal, std::string_view{"reversal"}}};
};

namespace stribeck::control {

/// Range of an observer's poles. Above 1e5 1/s no control period can resolve them.
inline constexpr Quantity kObserverPole = quantity("1/s", "1/s").positive().at_most(1e5);

/// Whether the rate is available: "observed" is the velocity of the Kalman observer.
constexpr bool rate_is_known(ErrorRate rate, Observer observer) noexcept {
  return rate != ErrorRate::kObserved || observer == Observer::kKalman;
}
inline constexpr std::string_view kRateIsUnknown =
    "observed is the velocity of the Kalman observer: needs observer = \"kalman\"";

template <class Each>
struct CompensationSettings {
  Feedforward feedforward = Feedforward::kNone;
  Observer observer = Observer::kNone;  ///< the observer whose estimate is added
  /// Both poles of the disturbance observer, or the bandwidth of the Kalman observer [1/s].
  double observer_pole = 20.0;
  /// Kalman: random walk of the disturbance [N²/s]; absent: computed from the bandwidth observer_pole.
  std::optional<double> disturbance_density{};
  Each adaptive_gain{20.0};  ///< K_c of adaptive friction [1/s]
  AdaptationParams adaptation{};
  ReversalParams reversal{};

  static constexpr auto fields() {
    using S = CompensationSettings;
    return std::tuple{
        field("feedforward", &S::feedforward,
              "how friction is fed forward: none, steady (as in the thesis), dynamic or reversal")
            .or_default(),
        field("observer", &S::observer, "whose estimate is added: none, disturbance, kalman or adaptive")
            .or_default(),
        field("observer_pole", &S::observer_pole, kObserverPole,
              "both poles of the disturbance observer, or the bandwidth of the Kalman observer")
            .or_default()
            .when(
                [](const S& s) {
                  return s.observer == Observer::kDisturbance ||
                         (s.observer == Observer::kKalman && !s.disturbance_density);
                },
                "goes with observer = \"disturbance\" or (without disturbance_density) \"kalman\""),
        field(
            "disturbance_density", &S::disturbance_density, quantity("N2/s", "N2/s").positive(),
            "Kalman observer: density of the random walk of the disturbance; left out: the one that gives the bandwidth observer_pole")
            .or_default()
            .when([](const S& s) { return s.observer == Observer::kKalman; },
                  "goes with observer = \"kalman\""),
        field("adaptive_gain", &S::adaptive_gain, quantity("1/s", "1/s").positive(),
              "gain of adaptive friction; of a list one per axis, the last one for the rest")
            .or_default()
            .when([](const S& s) { return s.observer == Observer::kAdaptive; },
                  "goes with observer = \"adaptive\""),
        field("adaptation", &S::adaptation,
              "correct the friction model on line; needs feedforward = \"dynamic\" or \"reversal\"")
            .or_default(),
        field("reversal", &S::reversal, "how friction builds up after a reversal")
            .or_default()
            .when([](const S& s) { return s.feedforward == Feedforward::kReversal; },
                  "goes with feedforward = \"reversal\"")};
  }

  /// Whether friction is fed forward over the coming hold, which needs a model with a level.
  [[nodiscard]] constexpr bool looks_ahead() const noexcept {
    return feedforward == Feedforward::kDynamic || feedforward == Feedforward::kReversal;
  }

  template <class Report>
  void validate(Report&& report) const {
    if (adaptation.enabled && !looks_ahead())
      report("adaptation", "corrects the feed-forward: needs feedforward = \"dynamic\" or \"reversal\"");
  }
};

}  // namespace stribeck::control
