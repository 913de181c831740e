#pragma once
/// Tracking error e = x − r of one axis and its rate, from samples.
///
///   difference of the error   ė_k = (e_k − e_{k−1})/T             as the laws are written
///   late                      ė_k = (x_k − x_{k−1})/T − ṙ(k)      half a sample late
///   observed                  ė_k = v̂_k − ṙ(k)                    v̂ from the Kalman observer, which the caller sets
///
/// On a circle the late form adds a constant radius error a·T/ω.
/// The late form is kept for comparison only. The first sample has ė = 0.
/// Real time: safe.

#include <array>
#include <string_view>
#include <utility>

#include <stribeck/core/fields.hpp>

namespace stribeck::control {

enum class ErrorRate { kDifferenceOfError, kLate, kObserved };

/// Help text of the setting error_rate, the same for every law that has it.
inline constexpr std::string_view kErrorRateHelp =
    "rate of the tracking error: difference-of-error (of the last two samples), late (differenced encoder "
    "position less the exact reference velocity; for comparison), or observed (velocity of the Kalman "
    "observer, which it needs)";

struct TrackingError {
  double e = 0.0;         ///< [m]
  double rate = 0.0;      ///< [m/s]
  double velocity = 0.0;  ///< backward difference of the encoder [m/s]
  double position = 0.0;  ///< last encoder position [m]
  bool started = false;

  void update(double measured, double reference, double reference_velocity, double period,
              ErrorRate form) noexcept {
    const double error = measured - reference;
    if (started) {
      velocity = (measured - position) / period;
      rate = form != ErrorRate::kLate ? (error - e) / period : velocity - reference_velocity;
    }
    e = error;
    position = measured;
    started = true;
  }
};

}  // namespace stribeck::control

template <>
struct stribeck::EnumNames<stribeck::control::ErrorRate> {
  static constexpr std::array names{
      std::pair{stribeck::control::ErrorRate::kDifferenceOfError, std::string_view{"difference-of-error"}},
      std::pair{stribeck::control::ErrorRate::kLate, std::string_view{"late"}},
      std::pair{stribeck::control::ErrorRate::kObserved, std::string_view{"observed"}}};
};
