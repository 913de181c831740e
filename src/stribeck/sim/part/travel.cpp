#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/sim/part/travel.hpp>

namespace stribeck::sim {
namespace {

/// Central differences, as for a controller whose reference is a table and whose frame is differentiated numerically.
template <std::size_t N>
void difference_frames(std::vector<path::PathPoint<N>>& points, double period) {
  std::vector<Mat<double, N>> rt;
  rt.reserve(points.size());
  for (const auto& p : points) rt.push_back(p.frame);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Mat<double, N>& before = rt[k > 0 ? k - 1 : k];
    const Mat<double, N>& after = rt[k + 1 < rt.size() ? k + 1 : k];
    for (std::size_t i = 0; i < N; ++i) {
      points[k].frame_rate[i] = (0.5 / period) * (after[i] - before[i]);
      points[k].frame_acceleration[i] =
          (1.0 / (period * period)) * ((after[i] - rt[k][i]) - (rt[k][i] - before[i]));
    }
  }
}

/// Directions of the feed and across the path, in axes: the force on every axis from a force of 1 N along each direction.
template <std::size_t N, class C>
std::array<Vec<double, N>, 2> cutting_directions(const C& curve, const path::PathPoint<N>& r) {
  if constexpr (path::ToolPath<C>) {
    const auto tip = path::derivatives<1>(path::TipPath<C>{curve}, r.phi)[1];
    const auto feed = (1.0 / norm(tip)) * tip;
    return {path::to_axes(curve.table, r.position, feed),
            path::to_axes(curve.table, r.position, path::cross(curve.direction(r.phi), feed))};
  } else if constexpr (N > 1) {
    return {r.frame[0], r.frame[1]};
  } else {
    return {Vec<double, 1>{{sign(r.velocity[0])}}, {}};
  }
}

}  // namespace

const PartSummary* Travel::part() const {
  return std::visit(
      [](const auto& p) -> const PartSummary* {
        if constexpr (requires { p.part; }) {
          return &p.part->summary;
        } else {
          return nullptr;
        }
      },
      path);
}

double Travel::duration() const { return part() != nullptr ? part()->duration : law().duration(); }

double Travel::constant_speed() const {
  return pace == path::Pace::kSpeed && part() == nullptr ? speed : std::numeric_limits<double>::quiet_NaN();
}

std::string Travel::pace_in_words() const {
  if (part() != nullptr)
    return std::isfinite(feed) ? fmt::format("up to {:.6g} mm/s", feed * 1e3) : "its programmed feed";
  if (pace == path::Pace::kRate) return fmt::format("one lap in {:.4g} s", lap() / speed);
  return fmt::format("{:.6g} mm/s", speed * 1e3);
}

namespace {

/// Samples a part from its first move to the end of its last one.
template <std::size_t N>
void sample_part(const Part<N>& part, double period, Route<N>& route) {
  // Sub-steps are chosen on this much of a long program.
  constexpr double kLongEnough = 60.0;
  route.scored_to = part.summary.duration;
  route.first_lap = std::min(part.summary.duration, kLongEnough);
  route.lap = std::numeric_limits<double>::quiet_NaN();
  const auto ticks = static_cast<std::size_t>(std::ceil(part.summary.duration / period)) + 1;
  route.points.reserve(ticks);
  PartMotion<N> motion(part);
  for (std::size_t k = 0; k < ticks; ++k) route.points.push_back(motion.at(static_cast<double>(k) * period));
}

}  // namespace

template <std::size_t N>
Route<N> sample(const Travel& travel, double period) {
  Route<N> route;
  route.path = travel.path;
  if (travel.part() != nullptr) {
    if constexpr (N == 2 || N == 3) sample_part(*std::get<PartPath<N>>(travel.path).part, period, route);
    for (const auto& p : route.points)
      route.size = std::max(route.size, norm(p.position - route.points.front().position));
    return route;
  }
  const path::SpeedLaw law = travel.law();
  route.scored_from = travel.run_in + travel.settle_laps * travel.lap() / travel.speed;
  route.scored_to = travel.run_in + law.cruise_time();
  route.first_lap = travel.run_in + travel.lap() / travel.speed;
  std::visit(
      [&](const auto& curve) {
        using C = std::decay_t<decltype(curve)>;
        if constexpr (C::kAxes == N) {
          route.lap = curve.closed() ? curve.period() : std::numeric_limits<double>::quiet_NaN();
          path::Reference<C> reference(curve, law, travel.pace, travel.frame);
          route.points.reserve(static_cast<std::size_t>(law.duration() / period) + 2);
          while (!reference.finished()) {
            route.points.push_back(reference.point());
            reference.advance(period);
          }
          if (travel.cutting) {
            route.cutting.reserve(route.points.size());
            for (std::size_t k = 0; k < route.points.size(); ++k) {
              const auto [feed, across] = cutting_directions<N>(curve, route.points[k]);
              const auto force = travel.cutting->mean_over(static_cast<double>(k) * period, period);
              route.cutting.push_back(force[0] * feed + force[1] * across);
            }
          }
        }
      },
      travel.path);
  if (travel.frame_derivatives == FrameDerivatives::kDifferenced) difference_frames(route.points, period);
  for (const auto& p : route.points)
    route.size = std::max(route.size, norm(p.position - route.points.front().position));
  return route;
}

template Route<1> sample<1>(const Travel&, double);
template Route<2> sample<2>(const Travel&, double);
template Route<3> sample<3>(const Travel&, double);
template Route<5> sample<5>(const Travel&, double);

}  // namespace stribeck::sim
