#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <stribeck/sim/parallel.hpp>
#include <stribeck/targets/pulse/search.hpp>

namespace stribeck::targets {

namespace {

/// The part of a circle with a reversal of each axis.
constexpr double kPart = 0.6;
constexpr std::array kRadii{1.0, 0.5, 0.2};       ///< of the user's radius
constexpr std::array kFeeds{1.0, 0.7, 0.4, 0.2};  ///< of the user's feed
constexpr int kSections = 14;                     ///< of the amplitude's range: 0.1 % of it remains

/// An amplitude that is certainly too large: the force of the pulse is three times the jump of friction.
double too_large(const friction::AxisModel& axis, const control::CascadeParams& loop, double feed) {
  return 3.0 * jump_of_friction(axis, feed) / (axis.mass * loop.velocity_gain[0]);
}

/// What a good pulse makes small: the peak at the quadrant, and as much again the largest error of the lap, which a long pulse raises.
double cost(const CircleError& e) { return e.quadrant + e.largest; }

/// Best amplitude on a circle. The error is nearly a sum of a part that grows with the amplitude and one that does not; then its
/// largest values are convex in the amplitude, and their sum has one minimum.
PulseRow best_of(Circle& circle, double most, const PulseShape& shape) {
  const auto with = [&](double amplitude) {
    const Pulse pulse = shape(amplitude);
    return circle.with(std::array{pulse, pulse});
  };
  const auto error = [&](double amplitude) { return cost(with(amplitude)); };
  constexpr double kShare = 1.0 / std::numbers::phi;
  double low = 0.0;
  double high = most;
  double left = high - kShare * (high - low);
  double right = low + kShare * (high - low);
  double at_left = error(left);
  double at_right = error(right);
  for (int i = 0; i < kSections; ++i) {
    if (at_left < at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kShare * (high - low);
      at_left = error(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kShare * (high - low);
      at_right = error(right);
    }
  }
  PulseRow row;
  row.amplitude = at_left < at_right ? left : right;
  row.best = with(row.amplitude);
  row.cost = cost(row.best);
  return row;
}

}  // namespace

double jump_of_friction(const friction::AxisModel& axis, double feed) noexcept {
  const auto level = [&](double v) {
    return std::abs(std::visit([&](const auto& map) { return friction::steady_force(map, v, 0.0); },
                               axis.friction.steady));
  };
  return level(1e-3 * feed) + level(-1e-3 * feed);
}

std::vector<CircleError> try_pulse(const friction::AxisModel& axis, const sim::ControllerSpec& loop,
                                   double period, const std::vector<PulseRow>& rows, const Pulse& pulse) {
  const CircleAxes axes{machine_of({axis, axis}, period), {axis, axis}, loop};
  std::vector<CircleError> out(rows.size());
  sim::parallel_for(
      rows.size(), 0, [] { return 0; },
      [&](int, std::size_t i) {
        out[i] = Circle(axes, rows[i].radius, rows[i].feed, kPart).with(std::array{pulse, pulse});
      });
  return out;
}

PulseSearch search_pulses(const friction::AxisModel& axis, const sim::ControllerSpec& loop, double period,
                          double radius, double feed, const std::vector<PulseShape>& shapes) {
  const CircleAxes axes{machine_of({axis, axis}, period), {axis, axis}, loop};
  const control::CascadeParams& cascade = axes.cascade();
  const double most = too_large(axis, cascade, feed);
  const auto nothing = [] { return 0; };

  std::vector<PulseRow> tried(shapes.size());
  sim::parallel_for(shapes.size(), 0, nothing, [&](int, std::size_t i) {
    Circle circle(axes, radius, feed, kPart);
    tried[i] = best_of(circle, most, shapes[i]);
  });
  const auto best = std::min_element(tried.begin(), tried.end(),
                                     [](const PulseRow& a, const PulseRow& b) { return a.cost < b.cost; });
  PulseSearch found;
  found.shape = static_cast<std::size_t>(best - tried.begin());
  found.rows.resize(kRadii.size() * kFeeds.size());
  sim::parallel_for(found.rows.size(), 0, nothing, [&](int, std::size_t i) {
    const double r = radius * kRadii[i / kFeeds.size()];
    const double v = feed * kFeeds[i % kFeeds.size()];
    Circle circle(axes, r, v, kPart);
    PulseRow row = best_of(circle, most, shapes[found.shape]);
    row.radius = r;
    row.feed = v;
    row.acceleration = v * v / r;
    row.without = circle.without();
    found.rows[i] = row;
  });
  return found;
}

}  // namespace stribeck::targets
