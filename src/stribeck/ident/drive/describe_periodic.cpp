#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/unbalance.hpp>
#include <stribeck/ident/drive/describe.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {
namespace {

/// Middle of the travel that the records cover [m].
double middle_of(const AlignedLog& log) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const log::Record& record : log.records) {
    const auto [least, most] = std::minmax_element(record.x.begin(), record.x.end());
    low = std::min(low, *least), high = std::max(high, *most);
  }
  return 0.5 * (low + high);
}

/// Half width of the interval of a phase at position zero: the rows tell it in the middle of their travel, and from there the period
/// carries it.
double carried(double half, const PeriodicColumns& term, double middle) {
  const Interval& period = term.period_interval;
  const double of_period = 0.5 * (period.high - period.low);
  if (!std::isfinite(of_period)) return half;
  return std::hypot(half, 2.0 * kPi * middle / (term.period * term.period) * of_period);
}

}  // namespace

void add_periodic(Result& result, const Found& found, Notes& notes) {
  const std::vector<PeriodicColumns>& periodic = found.terms.periodic;
  if (periodic.empty()) return;
  result.model += " + periodic";
  const bool turns = found.log.records.front().turns();
  const auto add = [&](std::string name, double value, const std::string& unit, const std::string& shown,
                       Interval interval, bool told) {
    result.parameters.push_back({std::move(name), value, unit, shown, interval.low, interval.high,
                                 told && std::isfinite(interval.high)});
  };
  const std::string& force = result.force_unit;
  const double middle = middle_of(found.log);
  std::vector<friction::Eccentric<double>> weight;
  for (std::size_t n = 0; n < periodic.size(); ++n) {
    const auto i = static_cast<Index>(found.terms.first_periodic() + 2 * n);
    const double s = found.fit.value(i), c = found.fit.value(i + 1);
    // s·sin + c·cos = A·sin(· − φ)
    const double amplitude = std::hypot(s, c);
    const double phase = std::atan2(-c, s);
    VectorXd along = found.intervals.zero(), across = along;
    along(i) = s / amplitude, along(i + 1) = c / amplitude;
    across(i) = c / (amplitude * amplitude);
    across(i + 1) = -s / (amplitude * amplitude);
    const double half = found.intervals.factor * found.intervals.error_of(along);
    const double turn = found.intervals.factor * found.intervals.error_of(across);
    const double at_zero = carried(turn, periodic[n], middle);
    const Interval size{amplitude - half, amplitude + half}, angle{phase - at_zero, phase + at_zero};
    const bool told = at_zero < 0.5 * kPi;
    const friction::Eccentric<double> term{amplitude, periodic[n].period, phase, periodic[n].form};
    if (turns && friction::is_unbalance(term)) {
      add("unbalance", amplitude, force, force, size, half < amplitude);
      add("unbalance_hangs_at", phase, "m", "mm", angle, told);
      weight.push_back(term);
      continue;
    }
    const std::string tail = "_" + std::to_string(result.friction.eccentric.size() + 1);
    add("periodic_amplitude" + tail, amplitude, force, force, size, half < amplitude);
    add("periodic_period" + tail, periodic[n].period, "m", "mm", periodic[n].period_interval, true);
    add("periodic_phase" + tail, phase, "rad", "rad", angle, told);
    result.friction.eccentric.push_back(term);
  }
  if (!result.friction.eccentric.empty())
    notes.warn("the phase of the periodic terms belongs to the homing position of this log");
  for (const auto& term : weight) result.friction.eccentric.push_back(term);
}

}  // namespace stribeck::ident::drive
