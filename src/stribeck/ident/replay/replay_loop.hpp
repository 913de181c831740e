#pragma once
/// The controller of replay_controller.hpp at work, row by row: on predicted positions in a replay, on the logged ones
/// in a check of the logged command.
///
/// Inside ident only. Real time: no.

#include <algorithm>
#include <cstddef>
#include <stribeck/ident/replay/replay.hpp>
#include <vector>

namespace stribeck::ident::replay {

/// Central differences of the reference, one-sided at the ends.
struct Reference {
  const std::vector<double>& r;
  double period;

  [[nodiscard]] double at(std::ptrdiff_t k) const {
    return r[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ssize(r) - 1))];
  }
  [[nodiscard]] double rate(std::ptrdiff_t k) const {
    const auto low = std::max<std::ptrdiff_t>(k - 1, 0);
    const auto high = std::min<std::ptrdiff_t>(k + 1, std::ssize(r) - 1);
    return (at(high) - at(low)) / (period * static_cast<double>(high - low));
  }
  [[nodiscard]] double second(std::ptrdiff_t k) const {
    if (k < 1 || k + 1 >= std::ssize(r)) return 0.0;
    return (at(k + 1) - 2.0 * at(k) + at(k - 1)) / (period * period);
  }
};

/// State of the controller: past positions and the integral.
class ControlLoop {
 public:
  ControlLoop(const ReplayController& c, const log::Record& record, const Start& start)
      : controller_(c), reference_{record.r, record.sample_time}, start_(start), first_force_(record.f[0]) {}

  double force(std::size_t row, const std::vector<double>& x) {
    const auto k = static_cast<std::ptrdiff_t>(row);
    const double raw = std::visit([&](const auto& law) { return ask(law, k, x); }, controller_.law);
    if (!controller_.limit) return raw;
    const double cut = std::clamp(raw, -*controller_.limit, *controller_.limit);
    if (cut != raw) integral_ = before_;
    return cut;
  }

 private:
  /// Predicted position; before the first row the axis is assumed to have moved at constant speed.
  [[nodiscard]] double position(std::ptrdiff_t k, const std::vector<double>& x) const {
    if (k >= 0) return x[static_cast<std::size_t>(k)];
    return start_.x + start_.v * reference_.period * static_cast<double>(k);
  }
  [[nodiscard]] double reference(std::ptrdiff_t k) const {
    if (k >= 0) return reference_.at(k);
    return reference_.at(0) + reference_.rate(0) * reference_.period * static_cast<double>(k);
  }

  double ask(const CascadeLaw& c, std::ptrdiff_t k, const std::vector<double>& x) {
    const double T = reference_.period;
    // The difference of two means over n rows equals that of their outermost rows.
    const double v = (position(k, x) - position(k - c.velocity_average, x)) / (T * c.velocity_average);
    const double w =
        c.position_gain * (reference(k) - position(k, x)) + c.velocity_feedforward * reference_.rate(k) - v;
    const double rest = c.velocity_gain * w + c.mass_feedforward * reference_.second(k);
    if (!c.integral_time) return rest;
    const double gain = c.velocity_gain / *c.integral_time;
    accumulate(k, w * T, (first_force_ - rest) / gain);
    return rest + gain * integral_;
  }
  double ask(const PdLaw& c, std::ptrdiff_t k, const std::vector<double>& x) {
    const double T = reference_.period;
    const double e = reference(k) - position(k, x);
    const double before = reference(k - 1) - position(k - 1, x);
    const double rest =
        c.stiffness * e + c.damping * (e - before) / T + c.mass_feedforward * reference_.second(k);
    if (!(c.integral > 0.0)) return rest;
    accumulate(k, e * T, (first_force_ - rest) / c.integral);
    return rest + c.integral * integral_;
  }
  void accumulate(std::ptrdiff_t k, double more, double begin) {
    before_ = k == 0 ? begin : integral_;
    integral_ = k == 0 ? begin : integral_ + more;
  }

  const ReplayController& controller_;
  Reference reference_;
  Start start_;
  double first_force_;
  double integral_ = 0.0;
  double before_ = 0.0;
};

}  // namespace stribeck::ident::replay
