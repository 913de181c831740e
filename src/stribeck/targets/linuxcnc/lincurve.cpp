#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <stribeck/ident/shown.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/linuxcnc/lincurve.hpp>

namespace stribeck::targets::linuxcnc {

namespace {

constexpr std::size_t kPoints = 16;
/// Half the width of the jump at zero [machine units/s]: far below any real velocity.
constexpr double kZero = 1e-6;
/// Samples of the curve on each side, closer together towards zero, where it bends.
constexpr int kSamples = 500;
/// Number of samples added between two samples where the first table has a corner.
constexpr int kFiner = 16;

double steady_level(const friction::AxisModel& model, double v) {
  return std::visit([&](const auto& map) { return friction::steady_force(map, v, 0.0); },
                    model.friction.steady);
}

/// The curve on one side (+1, −1), in ascending velocity.
struct Side {
  std::vector<double> v;  ///< [machine units/s]
  std::vector<double> force;
};

/// The same with finer samples around the corners of a table.
Side side_of(const friction::AxisModel& model, double fastest, double unit, double sign,
             const std::vector<Corner>& corners = {}) {
  const double range = fastest / unit - kZero;
  const auto speed = [&](double i) { return kZero + range * (i / kSamples) * (i / kSamples); };
  std::set<double> speeds;
  for (int i = 0; i <= kSamples; ++i) speeds.insert(speed(i));
  for (const Corner& c : corners) {
    if (sign * c.x <= 0.0) continue;
    const double at = kSamples * std::sqrt(std::clamp((std::abs(c.x) - kZero) / range, 0.0, 1.0));
    const double first = std::floor(at) - 1.0;
    for (int k = 1; k < 3 * kFiner; ++k) {
      const double i = first + static_cast<double>(k) / kFiner;
      if (i > 0.0 && i < kSamples && k % kFiner != 0) speeds.insert(speed(i));
    }
  }
  Side s;
  for (const double v : speeds) s.v.push_back(sign * v);
  if (sign < 0.0) std::reverse(s.v.begin(), s.v.end());
  for (const double v : s.v) s.force.push_back(steady_level(model, v * unit));
  return s;
}

/// Tables for both sides with the same largest error, as small as this number of pieces permits, to a thousandth.
std::vector<Corner> nearest_corners(const Side& negative, const Side& positive, std::size_t pieces) {
  double high = 0.0;
  for (const Side* s : {&negative, &positive}) {
    const auto [least, most] = std::minmax_element(s->force.begin(), s->force.end());
    high = std::max(high, *most - *least);
  }
  // A straight line has no error to halve.
  const double smallest = 1e-7 * high;
  double low = 0.0;
  std::vector<Corner> best;
  while (best.empty() || high - low > std::max(1e-3 * high, smallest)) {
    const double tolerance = best.empty() ? high : 0.5 * (low + high);
    const auto below = polyline_within(negative.v, negative.force, tolerance, pieces);
    const auto above = polyline_within(positive.v, positive.force, tolerance, pieces);
    if (below && above && below->corners.size() + above->corners.size() <= pieces + 2) {
      high = tolerance;
      best = below->corners;
      best.insert(best.end(), above->corners.begin(), above->corners.end());
    } else {
      low = tolerance;
    }
  }
  return best;
}

double square_error(const Side& s, const Polyline& table) {
  double sum = 0.0;
  const auto error = [&](std::size_t i) { return table.at(s.v[i]) - s.force[i]; };
  for (std::size_t i = 1; i < s.v.size(); ++i) {
    const double a = error(i - 1);
    const double b = error(i);
    sum += (s.v[i] - s.v[i - 1]) * (a * a + a * b + b * b) / 3.0;
  }
  return sum;
}

}  // namespace

Lincurve best_lincurve(const friction::AxisModel& model, double fastest, double unit) {
  constexpr std::size_t kPieces = kPoints - 2;
  const auto side = [&](double sign, const std::vector<Corner>& corners = {}) {
    return side_of(model, fastest, unit, sign, corners);
  };
  const std::vector<Corner> first = nearest_corners(side(-1.0), side(1.0), kPieces);
  const Side negative = side(-1.0, first);
  const Side positive = side(1.0, first);
  Lincurve out;
  out.table.corners = nearest_corners(negative, positive, kPieces);
  // Numbers as HAL will read them.
  for (Corner& c : out.table.corners) {
    c.x = with_digits(c.x, 9);
    c.y = with_digits(c.y, 9);
  }
  for (const Side* s : {&negative, &positive}) {
    for (std::size_t i = 0; i < s->v.size(); ++i)
      out.max_error = std::max(out.max_error, std::abs(out.table.at(s->v[i]) - s->force[i]));
  }
  // Corners lie between samples.
  for (const Corner& c : out.table.corners)
    out.max_error = std::max(out.max_error, std::abs(c.y - steady_level(model, c.x * unit)));
  out.table.largest_error = out.max_error;
  out.rms_error = std::sqrt((square_error(negative, out.table) + square_error(positive, out.table)) /
                            (2.0 * (fastest / unit - kZero)));
  return out;
}

std::string lincurve_words(const Lincurve& table, const friction::AxisModel& model, std::string_view unit) {
  double periodic = 0.0;
  for (const auto& term : model.friction.eccentric) periodic += term.amplitude;
  std::string out = fmt::format(
      "{} points from {:.6g} to {:.6g} {}: {} N largest deviation from the steady curve, RMS {} N",
      table.table.corners.size(), table.table.corners.front().x, table.table.corners.back().x, unit,
      report::significant(table.max_error, 3), report::significant(table.rms_error, 3));
  std::vector<std::string> missing;
  if (periodic > 0.0)
    missing.push_back(fmt::format("{} N periodic in position", report::significant(periodic, 3)));
  if (const auto& spring = model.friction.spring)
    missing.push_back("a spring of " +
                      ident::Shown("m", "N", unit.starts_with("deg")).force_per_length(spring->stiffness));
  if (!model.friction.places.empty()) missing.emplace_back("what differs along the travel");
  if (friction::has_pre_sliding(model.friction.dynamics))
    missing.emplace_back("pre-sliding: the force jumps at a reversal");
  if (!missing.empty()) out += "; not in it: " + report::joined(missing, ", ");
  return out;
}

std::string lincurve_lines(const std::string& name, const Lincurve& table) {
  std::string out;
  for (std::size_t i = 0; i < table.table.corners.size(); ++i) {
    const Corner& c = table.table.corners[i];
    out += fmt::format("setp {0}.x-val-{1:02} {2:.9g}\nsetp {0}.y-val-{1:02} {3:.9g}\n", name, i, c.x, c.y);
  }
  return out;
}

}  // namespace stribeck::targets::linuxcnc
