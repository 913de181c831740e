#include <fmt/format.h>
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
/// Steps of the simulation in one of several hundred runs: about a second.
constexpr double kMostWork = 1e7;

/// An amplitude that is certainly too large: the force of the pulse is three times the jump of friction.
double too_large(const friction::AxisModel& axis, const control::CascadeParams& loop, double feed) {
  return 3.0 * jump_of_friction(axis, feed) / (axis.mass * loop.velocity_gain[0]);
}

/// What a good pulse makes small: the peak at the quadrant; as much again the largest error of the lap, which a long pulse raises; and with
/// little weight the circular deviation, which grows where a pulse turns a part of the peak round.
double cost(const CircleError& e) { return e.quadrant + e.largest + 0.2 * e.deviation; }

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
        out[i] = Circle(axes, rows[i].radius, rows[i].feed, kPart, rows[i].substeps)
                     .with(std::array{pulse, pulse});
      });
  return out;
}

PulseSearch search_pulses(const friction::AxisModel& axis, const sim::ControllerSpec& loop, double period,
                          double radius, double feed, const std::vector<PulseShape>& shapes,
                          const SearchProgress& progress) {
  const CircleAxes axes{machine_of({axis, axis}, period), {axis, axis}, loop};
  const control::CascadeParams& cascade = axes.cascade();
  const double most = too_large(axis, cascade, feed);
  const auto nothing = [] { return 0; };

  const Circle own(axes, radius, feed, kPart);
  if (own.work() > kMostWork) {
    throw sim::Refused(fmt::format(
        "a circle of {:.4g} mm at {:.4g} mm/s takes {:.2g} steps of the simulation, {} in each period of {:.4g} ms, and the search runs hundreds of them: "
        "choose a faster one with --speed, or a smaller one with --size, or a longer --period",
        1e3 * radius, 1e3 * feed, own.work(), own.substeps(), 1e3 * period));
  }
  std::vector<PulseRow> tried(shapes.size());
  std::vector<PulseRow> rows(kRadii.size() * kFeeds.size());
  const auto tell = [&](std::size_t before) {
    return [&progress, before, all = tried.size() + rows.size()](std::size_t done, std::size_t) {
      if (progress) progress(before + done, all);
    };
  };
  const auto try_shape = [&](int, std::size_t i) {
    Circle circle(axes, radius, feed, kPart, own.substeps());
    tried[i] = best_of(circle, most, shapes[i]);
  };
  sim::parallel_for(shapes.size(), 0, nothing, try_shape, tell(0));
  const auto best = std::min_element(tried.begin(), tried.end(),
                                     [](const PulseRow& a, const PulseRow& b) { return a.cost < b.cost; });
  PulseSearch found;
  found.shape = static_cast<std::size_t>(best - tried.begin());
  std::vector<std::string> refused(rows.size());
  const auto try_circle = [&](int, std::size_t i) {
    const double share_of_radius = kRadii[i / kFeeds.size()];
    const double share_of_feed = kFeeds[i % kFeeds.size()];
    const double r = radius * share_of_radius;
    const double v = feed * share_of_feed;
    if (own.work() * share_of_radius / share_of_feed > kMostWork) {
      refused[i] =
          fmt::format("a circle of {:.4g} mm at {:.4g} mm/s takes too long to simulate", 1e3 * r, 1e3 * v);
      return;
    }
    try {
      Circle circle(axes, r, v, kPart);
      PulseRow row = best_of(circle, most, shapes[found.shape]);
      row.radius = r;
      row.feed = v;
      row.acceleration = v * v / r;
      row.without = circle.without();
      row.substeps = circle.substeps();
      rows[i] = row;
    } catch (const sim::Refused& e) {
      if (i == 0) throw;  // the user's own circle
      refused[i] = e.what();
    }
  };
  sim::parallel_for(rows.size(), 0, nothing, try_circle, tell(tried.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (refused[i].empty()) {
      found.rows.push_back(rows[i]);
    } else if (found.left_out++ == 0) {
      found.why = refused[i];
    }
  }
  return found;
}

}  // namespace stribeck::targets
