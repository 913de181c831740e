#pragma once
/// Tracking error e = x − r of one axis and its rate, from samples.
///
///   difference of the error   ė_k = (e_k − e_{k−1})/T             as the laws are written
///   late                      ė_k = (x_k − x_{k−1})/T − ṙ(k)      half a sample late
///   observed                  ė_k = v̂_k − ṙ(k)                    v̂ from the Kalman observer, which the caller sets
///
/// On a circle the late form adds a constant radius error a·T/ω.
/// The late form is kept for comparison only. The first sample has ė = 0.
/// After n − 1 periods without a sample the differences are means over n periods. They are carried on to the last of these periods,
/// with the acceleration that they themselves show:  ė = ē + (n − 1)/(n + 1)·(ē − ė_before).
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
  bool moves = false;  ///< two samples have come: `velocity` and `rate` are known
  int missed = 0;      ///< periods without a sample since the last one

  /// The sample of this period [m], with its reference [m], [m/s].
  void update(double measured, double reference, double reference_velocity, double period,
              ErrorRate form) noexcept {
    const double error = measured - reference;
    if (started) {
      const double time = period * (missed + 1);
      velocity = at_the_end((measured - position) / time, velocity);
      rate = form != ErrorRate::kLate ? at_the_end((error - e) / time, rate) : velocity - reference_velocity;
      moves = true;
    }
    e = error;
    position = measured;
    started = true;
    missed = 0;
  }

 private:
  /// The mean over the last period, from that over all periods since the last sample and the value before them.
  [[nodiscard]] double at_the_end(double mean, double before) const noexcept {
    return missed == 0 || !moves ? mean : mean + missed / (missed + 2.0) * (mean - before);
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
