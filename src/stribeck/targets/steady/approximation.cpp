#include <algorithm>
#include <cmath>

#include <stribeck/targets/steady/approximation.hpp>

namespace stribeck::targets {

namespace {

constexpr int kSamples = 400;       // of one direction
constexpr int kSamplesOfTerm = 60;  // around a term of the map
constexpr double kReach = 3.0;      // widths of a term to either side

struct Samples {
  std::vector<double> speed;
  std::vector<double> force;   ///< against the motion, positive
  std::vector<double> weight;  ///< length of the range that the sample stands for
};

/// Directions +1, −1; 0: the mean of both.
Samples samples_of(const Axis& axis, double direction) {
  Samples s;
  s.speed = telling_speeds(axis);
  for (std::size_t i = 0; i < s.speed.size(); ++i) {
    const double v = s.speed[i];
    const double up = axis.friction(v);
    const double down = -axis.friction(-v);
    s.force.push_back(direction > 0.0 ? up : direction < 0.0 ? down : 0.5 * (up + down));
    const double before = i > 0 ? s.speed[i - 1] : v;
    const double after = i + 1 < s.speed.size() ? s.speed[i + 1] : v;
    s.weight.push_back(0.5 * (after - before));
  }
  return s;
}

double mean(const Samples& s, const std::vector<double>& of) {
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    sum += s.weight[i] * of[i];
    weights += s.weight[i];
  }
  return sum / weights;
}

double slope_through_zero(const Samples& s) {
  double vf = 0.0;
  double vv = 0.0;
  for (std::size_t i = 0; i < s.speed.size(); ++i) {
    vf += s.weight[i] * s.speed[i] * s.force[i];
    vv += s.weight[i] * s.speed[i] * s.speed[i];
  }
  return std::max(vf / vv, 0.0);
}

Line line_through(const Samples& s) {
  const double v0 = mean(s, s.speed);
  const double f0 = mean(s, s.force);
  double vf = 0.0;
  double vv = 0.0;
  for (std::size_t i = 0; i < s.speed.size(); ++i) {
    vf += s.weight[i] * (s.speed[i] - v0) * (s.force[i] - f0);
    vv += s.weight[i] * (s.speed[i] - v0) * (s.speed[i] - v0);
  }
  Line line{0.0, vf / vv};
  // What rounding leaves of a slope is none.
  if (std::abs(line.viscous) * s.speed.back() < 1e-9 * std::abs(f0)) line.viscous = 0.0;
  line.level = f0 - line.viscous * v0;
  if (line.viscous < 0.0) return {std::max(f0, 0.0), 0.0};
  if (line.level < 0.0) return {0.0, slope_through_zero(s)};
  return line;
}

std::vector<Corner> points_of(const Samples& s, std::size_t points) {
  return nearest_polyline(s.speed, s.force, points - 1).corners;
}

}  // namespace

std::vector<double> telling_speeds(const Axis& axis) {
  std::vector<double> out;
  const double range = axis.fastest - axis.slowest;
  for (int i = 0; i <= kSamples; ++i) {
    const double share = static_cast<double>(i) / kSamples;
    out.push_back(axis.slowest + range * share * share);
  }
  const auto around = [&](double centre, double width) {
    for (int i = -kSamplesOfTerm; i <= kSamplesOfTerm; ++i) {
      const double v = std::abs(centre) + kReach * width * i / kSamplesOfTerm;
      if (v > axis.slowest && v < axis.fastest) out.push_back(v);
    }
  };
  std::visit(
      [&]<class Map>(const Map& map) {
        if constexpr (std::is_same_v<Map, friction::Conventional<double>>) {
          if (map.stribeck) around(0.0, map.stribeck->v0);
        } else {
          for (const auto* branch : {&map.positive, &map.negative}) {
            for (const auto& term : branch->gaussians) around(term.b, term.c);
          }
        }
      },
      axis.model.friction.steady);
  std::sort(out.begin(), out.end());
  // Two speeds that are almost the same make a step out of rounding.
  const auto same = [&](double x, double y) { return y - x < 1e-9 * axis.fastest; };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
  return out;
}

Line nearest_line(const Axis& axis) { return line_through(samples_of(axis, 0.0)); }
Line nearest_line(const Axis& axis, double direction) { return line_through(samples_of(axis, direction)); }

std::vector<Corner> nearest_points(const Axis& axis, std::size_t points) {
  return points_of(samples_of(axis, 0.0), points);
}
std::vector<Corner> nearest_points(const Axis& axis, std::size_t points, double direction) {
  return points_of(samples_of(axis, direction), points);
}

double interpolated(const std::vector<Corner>& points, double speed) noexcept {
  if (speed <= points.front().x) return points.front().y;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (speed > points[i].x) continue;
    const Corner& a = points[i - 1];
    const Corner& b = points[i];
    return a.y + (b.y - a.y) * (speed - a.x) / (b.x - a.x);
  }
  return points.back().y;
}

double signed_force(double speed_force, double v) noexcept {
  return v > 0.0 ? speed_force : v < 0.0 ? -speed_force : 0.0;
}

}  // namespace stribeck::targets
