#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/circularity.hpp>
#include <stribeck/ident/circle/minimum_zone.hpp>

namespace stribeck::ident::circle {
namespace {

struct Track {
  std::vector<double> x;
  std::vector<double> y;

  void add(const CircleSamples& s, std::size_t first, std::size_t last) {
    x.insert(x.end(), s.x.begin() + first, s.x.begin() + last);
    y.insert(y.end(), s.y.begin() + first, s.y.begin() + last);
  }
  [[nodiscard]] Centre middle() const {
    const LeastSquaresCircle c = least_squares_circle(x, y);
    return {c.x, c.y};
  }
  [[nodiscard]] double deviation() const { return minimum_zone(x, y, middle()).width; }
};

std::size_t rows_of_whole_laps(const CircleRun& run) {
  const double turn = whole_laps(2.0 * kPi * run.revolutions);
  std::size_t rows = 0;
  while (rows < run.angle.size() && std::abs(run.angle[rows] - run.angle.front()) <= turn) ++rows;
  return rows;
}

LapTest lap_test(const CircleSamples& s, const CircleRun& run, std::size_t first, std::size_t last) {
  LapTest lap;
  double square = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    lap.max_error = std::max(lap.max_error, std::abs(run.error[i]));
    square += run.error[i] * run.error[i];
  }
  lap.rms = std::sqrt(square / static_cast<double>(last - first));
  Track track;
  track.add(s, run.first + first, run.first + last);
  lap.circular_deviation = track.deviation();
  return lap;
}

void add_laps(DirectionTest& d, const CircleSamples& s, const CircleRun& run) {
  std::size_t first = 0;
  for (std::size_t i = 1; i <= run.lap.size(); ++i) {
    if (i < run.lap.size() && run.lap[i] == run.lap[first]) continue;
    const double turned = std::abs(run.angle[i - 1] - run.angle[first]);
    if (i - first >= CircleTest::kFewest && turned >= 0.98 * 2.0 * kPi * std::min(run.revolutions, 1.0))
      d.laps.push_back(lap_test(s, run, first, i));
    first = i;
  }
}

/// Mean radius over steps of the angle; a step without samples lies on the line between its neighbours, which are at most ten degrees
/// apart; else NaN.
std::vector<double> mean_path(const CircleSamples& s, const CircleMotion& motion, bool counter_clockwise,
                              const Centre& c, std::size_t steps) {
  std::vector<double> sum(steps, 0.0);
  std::vector<double> count(steps, 0.0);
  for (const CircleRun& run : motion.runs) {
    if (run.counter_clockwise != counter_clockwise) continue;
    for (std::size_t i = run.first; i < run.last; ++i) {
      const double angle = std::atan2(s.y[i] - c.y, s.x[i] - c.x);
      const double place =
          (angle < 0.0 ? angle + 2.0 * kPi : angle) / (2.0 * kPi) * static_cast<double>(steps);
      const std::size_t k = std::min(static_cast<std::size_t>(place), steps - 1);
      sum[k] += std::hypot(s.x[i] - c.x, s.y[i] - c.y);
      count[k] += 1.0;
    }
  }
  std::vector<double> path(steps);
  for (std::size_t k = 0; k < steps; ++k) {
    if (count[k] > 0.0) {
      path[k] = sum[k] / count[k];
      continue;
    }
    std::size_t before = 1;
    while (before < steps && count[(k + steps - before) % steps] == 0.0) ++before;
    std::size_t after = 1;
    while (after < steps && count[(k + after) % steps] == 0.0) ++after;
    if (36 * (before + after) > steps + 36) {
      path[k] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const std::size_t b = (k + steps - before) % steps;
    const std::size_t a = (k + after) % steps;
    const double share = static_cast<double>(before) / static_cast<double>(before + after);
    path[k] = (1.0 - share) * sum[b] / count[b] + share * sum[a] / count[a];
  }
  return path;
}

void add_hysteresis(CircularTest& t, const CircleSamples& s, const CircleMotion& motion, const Centre& c) {
  constexpr std::size_t kSteps = 1440;
  std::size_t fewest = kSteps;
  for (const CircleRun& run : motion.runs) {
    const double per_turn = static_cast<double>(run.angle.size()) / run.revolutions;
    fewest = std::min(fewest, std::max<std::size_t>(static_cast<std::size_t>(per_turn), 36));
  }
  const std::vector<double> one = mean_path(s, motion, true, c, fewest);
  const std::vector<double> other = mean_path(s, motion, false, c, fewest);
  // Arcs need not have an angle in common: then there is none.
  for (std::size_t k = 0; k < fewest; ++k) {
    const double h = std::abs(one[k] - other[k]);
    if (!std::isfinite(h) || (t.hysteresis && h <= *t.hysteresis)) continue;
    t.hysteresis = h;
    t.hysteresis_angle = 2.0 * kPi * (static_cast<double>(k) + 0.5) / static_cast<double>(fewest);
  }
}

}  // namespace

CircularTest circular_test(const CircleSamples& s, const CircleMotion& motion) {
  CircularTest t;
  Track both, whole;
  for (const CircleRun& run : motion.runs) {
    both.add(s, run.first, run.last);
    whole.add(s, run.first, run.first + rows_of_whole_laps(run));
    const bool known = std::any_of(t.directions.begin(), t.directions.end(), [&](const DirectionTest& d) {
      return d.counter_clockwise == run.counter_clockwise;
    });
    if (!known) t.directions.push_back({run.counter_clockwise, 0.0, -HUGE_VAL, HUGE_VAL, {}});
  }
  for (DirectionTest& d : t.directions) {
    Track track;
    for (const CircleRun& run : motion.runs) {
      if (run.counter_clockwise != d.counter_clockwise) continue;
      track.add(s, run.first, run.last);
      add_laps(d, s, run);
      for (const double e : run.error) {
        d.radial_max = std::max(d.radial_max, e);
        d.radial_min = std::min(d.radial_min, e);
      }
    }
    d.circular_deviation = track.deviation();
  }
  const LeastSquaresCircle circle = least_squares_circle(whole.x, whole.y);
  t.mean_radial_deviation = circle.radius - motion.radius;
  if (t.directions.size() < 2) return t;
  t.bidirectional = minimum_zone(both.x, both.y, {circle.x, circle.y}).width;
  add_hysteresis(t, s, motion, {circle.x, circle.y});
  return t;
}

}  // namespace stribeck::ident::circle
