#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <stribeck/core/scalar.hpp>
#include <stribeck/sim/metrics.hpp>
#include <stribeck/sim/radial_error.hpp>

namespace stribeck::sim {
namespace {

struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// Least squares of x² + y² = 2·c_x·x + 2·c_y·y + k about the mean.
Point least_squares_centre(std::span<const double> x, std::span<const double> y) {
  const double n = static_cast<double>(x.size());
  double mx = 0.0;
  double my = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  double uu = 0.0;
  double uv = 0.0;
  double vv = 0.0;
  double ud = 0.0;
  double vd = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = x[i] - mx;
    const double v = y[i] - my;
    const double d = 0.5 * (u * u + v * v);
    uu += u * u;
    uv += u * v;
    vv += v * v;
    ud += u * d;
    vd += v * d;
  }
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-9 * (uu + vv) * (uu + vv))) throw std::invalid_argument("the positions are no circle");
  return {mx + (ud * vv - vd * uv) / det, my + (vd * uu - ud * uv) / det};
}

}  // namespace

CircleTest circle_test(const CircleSamples& s, double radius) {
  const std::size_t n = s.x.size();
  const bool commanded = !s.command_x.empty();
  if (n < CircleTest::kFewest) throw std::invalid_argument("too few samples for a circle");
  if (s.y.size() != n || (commanded && (s.command_x.size() != n || s.command_y.size() != n)))
    throw std::invalid_argument("columns of different length");
  CircleTest t;
  t.radius = radius;
  const Point fitted = least_squares_centre(s.x, s.y);
  const Point centre = commanded ? least_squares_centre(s.command_x, s.command_y) : fitted;
  t.centre_x = centre.x;
  t.centre_y = centre.y;

  double way = 0.0;
  double nearest = HUGE_VAL;
  double furthest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = s.x[i] - t.centre_x;
    const double y = s.y[i] - t.centre_y;
    const double angle = std::atan2(y, x);
    t.angle.push_back(angle < 0.0 ? angle + 2.0 * kPi : angle);
    t.error.push_back(std::hypot(x, y) - radius);
    if (i > 0) way += std::remainder(t.angle[i] - t.angle[i - 1], 2.0 * kPi);
    const double r = std::hypot(s.x[i] - fitted.x, s.y[i] - fitted.y);
    nearest = std::min(nearest, r);
    furthest = std::max(furthest, r);
  }
  t.counter_clockwise = way > 0.0;
  t.revolutions = std::abs(way) / (2.0 * kPi);
  if (t.revolutions < 0.98) throw std::invalid_argument("less than a revolution");
  t.circular_deviation = furthest - nearest;

  const double window = std::acos(std::max(0.0, 1.0 - kGlitchTravel / radius));
  double square = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double e = std::abs(t.error[i]);
    t.max_error = std::max(t.max_error, e);
    square += e * e;
    // Since the last quadrant, in the direction of travel.
    const double turned = t.counter_clockwise ? t.angle[i] : 2.0 * kPi - t.angle[i];
    if (std::fmod(turned, 0.5 * kPi) <= window) t.quadrant_glitch = std::max(t.quadrant_glitch, e);
  }
  t.rms = std::sqrt(square / static_cast<double>(n));
  return t;
}

}  // namespace stribeck::sim
