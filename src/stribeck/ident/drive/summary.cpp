#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/summary.hpp>

namespace stribeck::ident::drive {
namespace {

using Eigen::VectorXd;

/// A Stribeck part has faded above this share of the top speed.
constexpr double kFaded = 0.2;
/// Of the top speed: points of a curve lie closer below it.
constexpr double kKnee = 0.1;
constexpr int kLinePoints = 21;
/// Of the top speed of the other direction: a curve that ends before ends within the Stribeck part.
constexpr double kAlike = 0.25;
constexpr int kShownSpeeds = 9;
constexpr double kLargeRise = 0.8;   // of the friction; Stribeck parts of guides reach about half
constexpr double kUnlikeRise = 0.6;  // of the friction, between the directions
constexpr double kAsSlow = 5.0;      // the other direction was that slow, too

Figure sum_of(double a, const Figure& x, double b, const Figure& y) {
  return {a * x.value + b * y.value, a * x.slope + b * y.slope};
}

/// Whether the map is a straight line and one Stribeck part at most, which fades well within the range: then the line is known.
bool has_line(const map::StaticFit& map, std::size_t side) {
  constexpr double kWidest = 0.5;  // of the top speed
  using Family = map::StaticFit::Family;
  if (map.family == Family::kSymmetric) return true;
  if (map.family == Family::kSymmetricStribeck) return map.v0 <= kWidest * std::max(map.top[0], map.top[1]);
  const map::BranchFit& b = map.branch[side];
  return b.terms.empty() || (b.centred && b.terms.front().c <= kWidest);
}

/// Level at rest and slope of the straight line.
std::array<Figure, 2> line_of(const map::StaticFit& map, int side, const map::Grid& grid) {
  if (has_line(map, static_cast<std::size_t>(side))) {
    const double far =
        1e3 * std::max({grid.high, map.top[0], map.top[1]});  // nothing is left of a Stribeck part there
    const Figure near = friction_at(map, side, far), beyond = friction_at(map, side, 2.0 * far);
    return {sum_of(2.0, near, -1.0, beyond), sum_of(1.0 / far, beyond, -1.0 / far, near)};
  }
  const double from = std::max(grid.low, kFaded * grid.high);
  std::array<Figure, 2> out;
  const double middle = 0.5 * (from + grid.high);
  double squares = 0.0;
  for (int i = 0; i < kLinePoints; ++i)
    squares += std::pow((grid.high - from) * i / (kLinePoints - 1) + from - middle, 2.0);
  for (int i = 0; i < kLinePoints; ++i) {
    const double speed = from + (grid.high - from) * i / (kLinePoints - 1);
    const Figure f = friction_at(map, side, speed);
    const double slope = (speed - middle) / squares;
    const double level = 1.0 / kLinePoints - middle * slope;
    for (const auto& [k, weight] : {std::pair{std::size_t{0}, level}, std::pair{std::size_t{1}, slope}}) {
      out[k].value += weight * f.value;
      out[k].slope = i == 0 ? VectorXd(weight * f.slope) : VectorXd(out[k].slope + weight * f.slope);
    }
  }
  return out;
}

/// How far friction rises from its least value to the slowest speed of one direction.
struct Rise {
  double slow = 0.0, fast = 0.0;               ///< [m/s]
  double slow_friction = 0.0, friction = 0.0;  ///< [N]
  [[nodiscard]] double size() const { return slow_friction - friction; }
};

Rise rise_of(const map::StaticFit& map, int side, const map::Grid& grid) {
  Rise out{grid.low, grid.low, friction_at(map, side, grid.low).value, 0.0};
  out.friction = out.slow_friction;
  for (const double speed : curve_speeds(grid, kLinePoints)) {
    const double friction = friction_at(map, side, speed).value;
    if (friction < out.friction) out.fast = speed, out.friction = friction;
  }
  return out;
}

}  // namespace

Figure friction_at(const map::StaticFit& map, int side, double speed) {
  Figure out;
  out.value = map.force(side, speed) - map::kDirection[static_cast<std::size_t>(side)] * map.load;
  out.slope.resize(static_cast<Eigen::Index>(map.span(side).second));
  map.gradient(side, speed, out.slope.data());
  return out;
}

Summary summary_of(const map::StaticFit& map, int side, const map::Grid& grid) {
  const auto line = line_of(map, side, grid);
  const Figure& level = line[0];
  const Figure& viscous = line[1];
  Summary out{level, viscous, friction_at(map, side, 0.0), {}, std::nullopt};
  const auto s = static_cast<std::size_t>(side);
  out.line_seen = has_line(map, s) || map.top[s] >= kAlike * map.top[1 - s];
  out.rise = sum_of(1.0, out.at_rest, -1.0, level);
  if (!(out.rise.value > 0.0)) return out;
  const auto above = [&](double speed) {
    const Figure there = sum_of(1.0, level, speed, viscous);
    return sum_of(1.0, friction_at(map, side, speed), -1.0, there);
  };
  const double left = std::exp(-1.0);
  constexpr int kSteps = 400;
  const double step = grid.high / kSteps;
  double low = 0.0;
  while (low < grid.high && above(low + step).value > left * out.rise.value) low += step;
  if (!(low < grid.high)) return out;
  double high = low + step;
  for (int i = 0; i < 50; ++i) {
    const double speed = 0.5 * (low + high);
    (above(speed).value > left * out.rise.value ? low : high) = speed;
  }
  // Where the fall crosses the level: its shift follows from that of both.
  const double near = 1e-4 * grid.high;
  const double fall = (above(high + near).value - above(high - near).value) / (2.0 * near);
  if (!(fall < 0.0)) return out;
  const Figure crossing = sum_of(1.0, above(high), -left, out.rise);
  out.stribeck_speed = Figure{high, crossing.slope / -fall};
  return out;
}

std::optional<std::string> one_sided_rise(const map::StaticFit& map,
                                          const std::array<map::Grid, map::kSides>& grid,
                                          const Shown& shown) {
  if (!(grid[0].high > 0.0) || !(grid[1].high > 0.0)) return {};
  const std::array<Rise, map::kSides> rise{rise_of(map, 0, grid[0]), rise_of(map, 1, grid[1])};
  // A load that was taken for friction raises one direction and lowers the other: their mean is the friction.
  const double level = 0.5 * (rise[0].friction + rise[1].friction);
  const std::size_t s = rise[0].size() > rise[1].size() ? 0 : 1;
  const Rise& own = rise[s];
  if (!(level > 0.0) || !(own.size() > kLargeRise * level) ||
      !(own.size() - rise[1 - s].size() > kUnlikeRise * level) || grid[1 - s].low > kAsSlow * grid[s].low)
    return {};
  return fmt::format(
      "friction of the {} direction is {} at {} and {} at {}, and the other direction has no such rise: friction is seldom like "
      "that, but a force of the process (drilling, cutting, clamping) at slow feed is, and it would become part of the "
      "compensation: identify from motion without process",
      s == 0 ? "positive" : "negative", shown.force(own.slow_friction), shown.speed(own.slow),
      shown.force(own.friction), shown.speed(own.fast));
}

std::vector<double> shown_speeds(const map::Grid& grid) {
  std::vector<double> out;
  for (const double speed : curve_speeds(grid, kShownSpeeds)) {
    const double unit = std::pow(10.0, std::floor(std::log10(speed)) - 2.0);
    out.push_back(std::clamp(std::round(speed / unit) * unit, grid.low, grid.high));
  }
  return out;
}

std::vector<double> curve_speeds(const map::Grid& grid, int points) {
  const double knee = std::max(0.5 * grid.low, kKnee * grid.high);
  const double from = std::asinh(grid.low / knee), to = std::asinh(grid.high / knee);
  std::vector<double> out;
  for (int i = 0; i < points; ++i)
    out.push_back(std::clamp(knee * std::sinh(from + (to - from) * i / (points - 1)), grid.low, grid.high));
  out.front() = grid.low;
  out.back() = grid.high;
  return out;
}

std::pair<std::size_t, std::size_t> told_part(const std::vector<CurvePoint>& points) {
  constexpr double kMostOfFriction = 0.2;
  constexpr std::size_t kFewest = 10;
  const auto told = [&](std::size_t i) {
    return points[i].ci_high - points[i].ci_low <= 2.0 * kMostOfFriction * std::abs(points[i].friction);
  };
  std::size_t first = 0, last = points.size();
  while (first < last && !told(first)) ++first;
  while (last > first && !told(last - 1)) --last;
  return last - first < kFewest ? std::pair{std::size_t{0}, points.size()} : std::pair{first, last};
}

}  // namespace stribeck::ident::drive
