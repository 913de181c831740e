#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/laps.hpp>
#include <stribeck/ident/circle/minimum_zone.hpp>
#include <stribeck/ident/circle/radial_error.hpp>

namespace stribeck::ident::circle {
namespace {

/// A sector without samples may hide a quadrant.
constexpr std::size_t kSectors = 36;
constexpr std::size_t kSector = 360 / kSectors;
/// A radius that differs by more than this from the intended one belongs to another circle or another unit.
constexpr double kRadius = 0.2;

struct CirclePoint {
  double x = 0.0;
  double y = 0.0;
};

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw std::invalid_argument(text.str());
}

[[noreturn]] void no_circle() { refuse("the positions are no circle"); }

/// Least squares of x² + y² = 2·c_x·x + 2·c_y·y + k; points relative to their mean.
CirclePoint algebraic_centre(std::span<const CirclePoint> points) {
  double uu = 0.0;
  double uv = 0.0;
  double vv = 0.0;
  double ud = 0.0;
  double vd = 0.0;
  for (const CirclePoint& p : points) {
    const double d = 0.5 * (p.x * p.x + p.y * p.y);
    uu += p.x * p.x;
    uv += p.x * p.y;
    vv += p.y * p.y;
    ud += p.x * d;
    vd += p.y * d;
  }
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-9 * (uu + vv) * (uu + vv))) no_circle();
  return {(ud * vv - vd * uv) / det, (vd * uu - ud * uv) / det};
}

/// Distances of the points from a centre: mean, sum of squares about the mean, and the step of Gauss–Newton.
struct Distances {
  double mean = 0.0;
  double squares = 0.0;
  CirclePoint step;
};

Distances distances(std::span<const CirclePoint> points, const CirclePoint& centre) {
  const double n = static_cast<double>(points.size());
  Distances d;
  CirclePoint direction;
  const auto each = [&](auto&& f) {
    for (const CirclePoint& p : points) {
      const double x = p.x - centre.x;
      const double y = p.y - centre.y;
      const double r = std::hypot(x, y);
      // A point at the centre has no direction.
      const double inverse = r > 0.0 ? 1.0 / r : 0.0;
      f(r, inverse * x, inverse * y);
    }
  };
  each([&](double r, double ux, double uy) {
    d.mean += r / n;
    direction.x += ux / n;
    direction.y += uy / n;
  });
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double xr = 0.0;
  double yr = 0.0;
  each([&](double r, double ux, double uy) {
    const double e = r - d.mean;
    const double x = ux - direction.x;
    const double y = uy - direction.y;
    d.squares += e * e;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    xr += x * e;
    yr += y * e;
  });
  const double det = xx * yy - xy * xy;
  if (!(det > 0.0)) no_circle();
  d.step = {(xr * yy - yr * xy) / det, (yr * xx - xr * xy) / det};
  return d;
}

/// Of the rows up to the last whole lap: a part of a lap that is travelled twice would pull the centre to its side.
LeastSquaresCircle circle_of_whole_laps(std::span<const double> x, std::span<const double> y) {
  const LeastSquaresCircle all = least_squares_circle(x, y);
  std::vector<double> turned{0.0};
  const auto angle = [&](std::size_t i) { return std::atan2(y[i] - all.y, x[i] - all.x); };
  for (std::size_t i = 1; i < x.size(); ++i)
    turned.push_back(turned.back() + std::remainder(angle(i) - angle(i - 1), 2.0 * kPi));
  const double whole = whole_laps(std::abs(turned.back()));
  if (whole == 0.0) return all;
  std::size_t rows = 0;
  while (rows < x.size() && std::abs(turned[rows]) <= whole) ++rows;
  return least_squares_circle(x.first(rows), y.first(rows));
}

}  // namespace

LeastSquaresCircle least_squares_circle(std::span<const double> x, std::span<const double> y) {
  constexpr int kMostSteps = 200;
  constexpr int kMostHalvings = 20;
  constexpr double kAtRest = 1e-12;  // as a share of the size of the points
  constexpr double kStraight = 1e4;  // a centre farther away than this belongs to a straight line
  const double n = static_cast<double>(x.size());
  CirclePoint mean;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean.x += x[i] / n;
    mean.y += y[i] / n;
  }
  std::vector<CirclePoint> points(x.size());
  double size = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    points[i] = {x[i] - mean.x, y[i] - mean.y};
    size = std::max(size, std::hypot(points[i].x, points[i].y));
  }
  CirclePoint centre = algebraic_centre(points);
  Distances at = distances(points, centre);
  for (int k = 0; k < kMostSteps; ++k) {
    if (std::hypot(at.step.x, at.step.y) <= kAtRest * size) break;
    double share = 1.0;
    bool lower = false;
    for (int h = 0; h < kMostHalvings && !lower; ++h, share *= 0.5) {
      const CirclePoint tried{centre.x + share * at.step.x, centre.y + share * at.step.y};
      const Distances there = distances(points, tried);
      lower = there.squares < at.squares;
      if (!lower) continue;
      centre = tried;
      at = there;
    }
    if (!lower) break;  // no further decrease, to rounding
    if (!(std::hypot(centre.x, centre.y) < kStraight * size)) no_circle();
  }
  return {mean.x + centre.x, mean.y + centre.y, at.mean};
}

CircleTest circle_test(const CircleSamples& s, double radius, double glitch_travel) {
  const std::size_t n = s.x.size();
  const bool commanded = !s.command_x.empty();
  if (n < CircleTest::kFewest) refuse("too few samples, expected at least ", CircleTest::kFewest);
  if (s.y.size() != n || (commanded && (s.command_x.size() != n || s.command_y.size() != n)))
    throw std::invalid_argument("columns of different length");
  CircleTest t;
  t.radius = radius;
  const LeastSquaresCircle fitted = circle_of_whole_laps(s.x, s.y);
  const LeastSquaresCircle centre = commanded ? circle_of_whole_laps(s.command_x, s.command_y) : fitted;
  t.centre_x = centre.x;
  t.centre_y = centre.y;
  // Of no use to say of another circle which way it turns.
  if (std::abs(centre.radius - radius) > kRadius * radius)
    refuse("a circle with a radius of ", centre.radius * 1e3, " mm, expected ", radius * 1e3,
           " mm within a fifth");

  double turned = 0.0;
  double least_turned = 0.0;
  double most_turned = 0.0;
  std::array<bool, kSectors> seen{};
  for (std::size_t i = 0; i < n; ++i) {
    const double x = s.x[i] - t.centre_x;
    const double y = s.y[i] - t.centre_y;
    const double angle = std::atan2(y, x);
    t.angle.push_back(angle < 0.0 ? angle + 2.0 * kPi : angle);
    t.error.push_back(std::hypot(x, y) - radius);
    if (i > 0) turned += std::remainder(t.angle[i] - t.angle[i - 1], 2.0 * kPi);
    least_turned = std::min(least_turned, turned);
    most_turned = std::max(most_turned, turned);
    seen[std::min(static_cast<std::size_t>(t.angle[i] / (2.0 * kPi) * kSectors), kSectors - 1)] = true;
  }
  t.counter_clockwise = turned > 0.0;
  t.revolutions = std::abs(turned) / (2.0 * kPi);
  constexpr double kWhole = 0.98 * 2.0 * kPi;
  if (std::abs(turned) < kWhole && most_turned - least_turned >= kWhole)
    refuse("both directions of travel, expected one");
  if (std::abs(turned) < kWhole)
    refuse("an arc of ", std::round((most_turned - least_turned) * 180.0 / kPi),
           " deg, expected at least one revolution");
  for (std::size_t k = 0; k < kSectors; ++k) {
    if (!seen[k])
      refuse("no sample from ", k * kSector, " to ", (k + 1) * kSector,
             " deg, expected some in every such sector");
  }
  t.circular_deviation = minimum_zone(s.x, s.y, {fitted.x, fitted.y}).width;

  const double window = std::acos(std::max(0.0, 1.0 - glitch_travel / radius));
  double square = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double e = std::abs(t.error[i]);
    t.max_error = std::max(t.max_error, e);
    square += e * e;
    // Since the last quadrant, in the direction of motion.
    const double from_start = t.counter_clockwise ? t.angle[i] : 2.0 * kPi - t.angle[i];
    if (std::fmod(from_start, 0.5 * kPi) <= window) t.quadrant_glitch = std::max(t.quadrant_glitch, e);
  }
  t.rms = std::sqrt(square / static_cast<double>(n));
  return t;
}

}  // namespace stribeck::ident::circle
