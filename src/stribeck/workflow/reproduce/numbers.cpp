#include <algorithm>
#include <cmath>
#include <utility>

#include <stribeck/ident/stats/uncertainty.hpp>
#include <stribeck/workflow/reproduce/numbers.hpp>
#include <stribeck/workflow/reproduce/printed_tables.hpp>

namespace stribeck::workflow::reproduction {

namespace {

/// Mean of both directions; the half width of the interval does not shrink, because both errors may have the same cause.
Estimate mean_of(const Estimate& a, const Estimate& b) {
  return {0.5 * (a.value + b.value),
          {0.5 * (a.interval.low + b.interval.low), 0.5 * (a.interval.high + b.interval.high)}};
}

}  // namespace

double force_of(const friction::SteadyVariant& map, double v) {
  return std::visit([v](const auto& m) { return friction::steady_force(m, v); }, map);
}

Line line_through(const std::vector<SpeedAndForce>& points) {
  std::array<double, 2> n{}, v{}, f{};
  const auto side = [](const SpeedAndForce& p) { return p.speed > 0.0 ? 0U : 1U; };
  for (const SpeedAndForce& p : points) {
    n[side(p)] += 1.0;
    v[side(p)] += p.speed;
    f[side(p)] += p.force;
  }
  double vv = 0.0, vf = 0.0, left = 0.0;
  for (unsigned i : {0U, 1U}) {
    v[i] /= n[i];
    f[i] /= n[i];
  }
  for (const SpeedAndForce& p : points) {
    vv += (p.speed - v[side(p)]) * (p.speed - v[side(p)]);
    vf += (p.speed - v[side(p)]) * (p.force - f[side(p)]);
  }
  Line line;
  line.slope = vf / vv;
  for (const SpeedAndForce& p : points) {
    const double e = p.force - f[side(p)] - line.slope * (p.speed - v[side(p)]);
    left += e * e;
  }
  const double freedom = static_cast<double>(points.size()) - 3.0;
  const double half = ident::stats::student_factor(freedom) * std::sqrt(left / freedom);
  line.slope_half = half / std::sqrt(vv);
  for (unsigned i : {0U, 1U}) {
    line.level[i] = (i == 0 ? 1.0 : -1.0) * (f[i] - line.slope * v[i]);
    line.level_half[i] = half * std::sqrt(1.0 / n[i] + v[i] * v[i] / vv);
  }
  return line;
}

std::vector<SpeedAndForce> means_of(const ident::methods::Jog& jog) {
  std::vector<SpeedAndForce> points;
  for (const ident::map::SteadyRun& r : jog.runs) points.push_back({r.speed, r.force});
  return points;
}

/// The same line through Table 2.3 at the same speeds: the values that Tables 2.1 and 2.2 would have if they described the
/// same friction.
Line line_through_print(std::vector<SpeedAndForce> points, const std::string& axis) {
  const friction::SteadyVariant map = printed_map(axis);
  for (SpeedAndForce& p : points) p.force = force_of(map, p.speed);
  return line_through(points);
}

Estimate estimate(const ident::Result& r, std::string_view name, double scale) {
  const ident::Parameter* p = r.find(name);
  if (p == nullptr) return {};
  Estimate e{p->value * scale, {p->ci_low * scale, p->ci_high * scale}};
  if (scale < 0.0) std::swap(e.interval.low, e.interval.high);
  return e;
}

Estimate plus_minus(double value, double half) { return {value, {value - half, value + half}}; }

Conventional conventional_of(const ident::Result& r) {
  if (std::isfinite(estimate(r, "alpha0").value)) {
    return {estimate(r, "alpha0"), estimate(r, "alpha1"), estimate(r, "alpha2", 1.0 / kKilo),
            estimate(r, "v0", 1.0 / kMilli)};
  }
  Conventional c;
  c.alpha0 = mean_of(estimate(r, "eta0_positive"), estimate(r, "eta0_negative", -1.0));
  c.alpha2 = mean_of(estimate(r, "eta1_positive", 1.0 / kKilo), estimate(r, "eta1_negative", 1.0 / kKilo));
  c.v0 = mean_of(estimate(r, "gaussian_1_c_positive", 1.0 / kMilli),
                 estimate(r, "gaussian_1_c_negative", 1.0 / kMilli));
  const Estimate rise =
      mean_of(estimate(r, "gaussian_1_a_positive"), estimate(r, "gaussian_1_a_negative", -1.0));
  // The sum is as uncertain as the curve at its slow end, which is less than either part.
  double half = kNaN;
  for (const ident::CurvePoint& p : r.curve) {
    if (p.velocity > 0.0) {
      half = 0.5 * (p.ci_high - p.ci_low);
      break;
    }
  }
  c.alpha1 = plus_minus(c.alpha0.value + rise.value, half);
  return c;
}

/// The curve and its interval at a velocity, interpolated linearly between its points.
Estimate curve_at(const ident::Result& r, double v) {
  for (std::size_t i = 1; i < r.curve.size(); ++i) {
    const ident::CurvePoint& a = r.curve[i - 1];
    const ident::CurvePoint& b = r.curve[i];
    if (v < a.velocity || v > b.velocity || (a.velocity < 0.0) != (b.velocity < 0.0)) continue;
    const double share = (v - a.velocity) / (b.velocity - a.velocity);
    const auto between = [share](double x, double y) { return (1.0 - share) * x + share * y; };
    const double half = 0.5 * between(a.ci_high - a.ci_low, b.ci_high - b.ci_low);
    return plus_minus(force_of(r.friction.steady, v), half);
  }
  return {force_of(r.friction.steady, v), {}};
}

/// Largest difference over 0.5–9.5 mm/s of one direction.
Deviation deviation(const ident::Result& r, const std::string& axis, double direction) {
  const friction::SteadyVariant map = printed_map(axis);
  Deviation most;
  for (int i = 10; i <= 190; ++i) {
    const double v = direction * 0.05 * i * kMilli;
    const double print = force_of(map, v);
    const double d = std::abs(force_of(r.friction.steady, v) - print);
    most.force = std::max(most.force, d);
    most.percent = std::max(most.percent, 100.0 * d / std::abs(print));
  }
  return most;
}

}  // namespace stribeck::workflow::reproduction
