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
constexpr double kRevolution = 0.98 * 2.0 * kPi;

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

/// Angles about a centre that go on from lap to lap within each part of the record; parts are put one behind the other.
struct Turned {
  std::vector<double> angle{0.0};  ///< from the first row [rad]
  double arc = 0.0;                ///< the longest one between two turning points of a part
  std::size_t from = 0;            ///< row at which that arc begins, counter-clockwise
};

Turned turned_about(const CircleSamples& s, std::span<const double> x, std::span<const double> y,
                    const CirclePoint& c) {
  Turned out;
  const auto angle = [&](std::size_t i) { return std::atan2(y[i] - c.y, x[i] - c.x); };
  std::size_t lowest = 0;
  double most = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const bool other = !s.part.empty() && s.part[i] != s.part[i - 1];
    const double step = other ? 0.0 : std::remainder(angle(i) - angle(i - 1), 2.0 * kPi);
    out.angle.push_back(out.angle.back() + step);
    if (other || out.angle[i] < out.angle[lowest]) lowest = i;
    most = other ? out.angle[i] : std::max(most, out.angle[i]);
    if (most - out.angle[lowest] <= out.arc) continue;
    out.arc = most - out.angle[lowest];
    out.from = lowest;
  }
  return out;
}

/// Of the rows up to the last whole lap: a part of a lap that is travelled twice would pull the centre to its side.
LeastSquaresCircle circle_of_whole_laps(const CircleSamples& s, std::span<const double> x,
                                        std::span<const double> y) {
  const LeastSquaresCircle all = least_squares_circle(x, y);
  const Turned turned = turned_about(s, x, y, {all.x, all.y});
  if (turned.arc < kRevolution) return all;
  const double whole = whole_laps(std::abs(turned.angle.back()));
  std::size_t rows = 0;
  while (rows < x.size() && std::abs(turned.angle[rows]) <= whole) ++rows;
  return rows < CircleTest::kFewest ? all : least_squares_circle(x.first(rows), y.first(rows));
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
  const LeastSquaresCircle fitted = circle_of_whole_laps(s, s.x, s.y);
  const LeastSquaresCircle centre = commanded ? circle_of_whole_laps(s, s.command_x, s.command_y) : fitted;
  t.centre_x = centre.x;
  t.centre_y = centre.y;
  // Of no use to say of another circle which way it turns.
  if (std::abs(centre.radius - radius) > kRadius * radius)
    refuse("a circle with a radius of ", centre.radius * 1e3, " mm, expected ", radius * 1e3,
           " mm within a fifth");

  std::array<bool, kSectors> seen{};
  for (std::size_t i = 0; i < n; ++i) {
    const double x = s.x[i] - t.centre_x;
    const double y = s.y[i] - t.centre_y;
    const double angle = std::atan2(y, x);
    t.angle.push_back(angle < 0.0 ? angle + 2.0 * kPi : angle);
    t.error.push_back(std::hypot(x, y) - radius);
    seen[std::min(static_cast<std::size_t>(t.angle[i] / (2.0 * kPi) * kSectors), kSectors - 1)] = true;
  }
  const auto [inside, outside] = std::minmax_element(t.error.begin(), t.error.end());
  const double most = std::max(-*inside, *outside);
  if (most > kRadius * radius) refuse("rows up to ", most * 1e3, " mm off a circle of ", radius * 1e3, " mm");
  const Turned turned = turned_about(s, s.x, s.y, {t.centre_x, t.centre_y});
  const double all = std::abs(turned.angle.back());
  t.counter_clockwise = turned.angle.back() > 0.0;
  t.revolutions = all / (2.0 * kPi);
  if (turned.arc < kLeastArc)
    refuse("an arc of ", std::round(turned.arc * 180.0 / kPi), " deg, expected at least ",
           std::round(kLeastArc * 180.0 / kPi), " deg, better a revolution");
  if (all < std::min(turned.arc, kRevolution) - kSector * kPi / 180.0)
    refuse("both directions of travel, expected one");
  // A gap hides what is in it; an arc has one.
  for (std::size_t k = 0; k < kSectors; ++k) {
    const double from = static_cast<double>(k * kSector) * kPi / 180.0 - t.angle[turned.from];
    const double behind = from - 2.0 * kPi * std::floor(from / (2.0 * kPi));
    const bool travelled = turned.arc >= kRevolution || behind + kSector * kPi / 180.0 < turned.arc;
    if (travelled && !seen[k])
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
