#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/lost_motion/lost_motion_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::lost_motion {
namespace {

/// Half the length of each of the three boxes [s]: they pass what changes within some ten milliseconds.
constexpr double kBox = 4e-3;
/// Least length of a stretch, in reaches of the low-pass: what is shorter than it shows nothing.
constexpr int kLeast = 6;

double smallest_step(const std::vector<double>& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < x.size(); ++k) {
    const double d = std::abs(x[k] - x[k - 1]);
    if (d > 1e-12 && d < least) least = d;
  }
  return std::isfinite(least) ? least : 0.0;
}

/// Rows of the turning points, by a hysteresis of h.
std::vector<std::size_t> turning_points(const std::vector<double>& x, double h) {
  std::vector<std::size_t> turns;
  std::size_t low = 0;
  std::size_t high = 0;
  int direction = 0;
  for (std::size_t k = 1; k < x.size(); ++k) {
    if (x[k] > x[high]) high = k;
    if (x[k] < x[low]) low = k;
    if (direction >= 0 && x[k] < x[high] - h) {
      turns.push_back(high);
      direction = -1;
      low = k;
    } else if (direction <= 0 && x[k] > x[low] + h) {
      turns.push_back(low);
      direction = 1;
      high = k;
    }
    if (direction > 0) low = k;
    if (direction < 0) high = k;
  }
  return turns;
}

struct Stroke {
  std::size_t run, first, last;
  int direction;
};

std::vector<Stroke> strokes_of(const std::vector<Positions>& runs) {
  std::vector<Stroke> all;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::vector<double>& x = runs[r].motor;
    if (x.size() < 16) continue;
    const auto [low, high] = std::minmax_element(x.begin(), x.end());
    std::vector<std::size_t> turns =
        turning_points(x, std::max((*high - *low) / 500.0, 8.0 * smallest_step(x)));
    turns.push_back(x.size() - 1);
    std::size_t from = 0;
    for (const std::size_t to : turns) {
      if (to > from + 8) all.push_back({r, from, to, x[to] > x[from] ? 1 : -1});
      from = to;
    }
  }
  return all;
}

double filtered(const std::vector<double>& x, std::size_t row, const Smoothing& s) {
  double sum = 0.0;
  for (std::size_t i = 0; i < s.weights.size(); ++i)
    sum += s.weights[i] * x[row + i - static_cast<std::size_t>(s.reach)];
  return sum;
}

/// A force that is commanded at a row acts until the next one: at the instant of the row, half of it and half of the one before.
double force_at(const Positions& p, std::size_t row, const Smoothing& s) {
  return 0.5 * (filtered(p.force, row, s) + filtered(p.force, row - 1, s));
}

/// Force, acceleration and velocity while motor and table slide together: farther than `clear` from the last reversal.
std::vector<std::array<double, 3>> rows_together(const std::vector<Positions>& runs, double clear) {
  std::vector<std::array<double, 3>> rows;
  for (const Stroke& s : strokes_of(runs)) {
    const Positions& p = runs[s.run];
    const Smoothing w = smoothing_for(p.sample_time);
    const auto reach = static_cast<std::size_t>(w.reach);
    std::size_t k = s.first;
    while (k < s.last && std::abs(p.motor[k] - p.motor[s.first]) < clear) ++k;
    const double T = p.sample_time;
    for (k = std::max(k + reach, reach + 2); k + reach + 1 < s.last; k += reach) {
      const double before = filtered(p.motor, k - 1, w);
      const double now = filtered(p.motor, k, w);
      const double after = filtered(p.motor, k + 1, w);
      rows.push_back(
          {force_at(p, k, w), (after - 2.0 * now + before) / (T * T), (after - before) / (2.0 * T)});
    }
  }
  return rows;
}

/// Rows from `from` up to `to`, with what the low-pass needs before and after them.
Stretch cut(const Positions& p, std::size_t from, std::size_t to, int direction) {
  const Smoothing s = smoothing_for(p.sample_time);
  const Smoothing fine = s.fine();
  const double T = p.sample_time;
  const auto inner = static_cast<Eigen::Index>(to - from);
  const auto n = inner + 2 * s.reach;
  const std::size_t raw = from - static_cast<std::size_t>(s.reach);
  Stretch one;
  one.direction = direction;
  one.sample_time = T;
  for (auto* column : {&one.difference, &one.position, &one.speed, &one.motor, &one.velocity})
    column->resize(n);
  one.acceleration.resize(inner);
  one.force.resize(inner);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::size_t row = raw + static_cast<std::size_t>(k);
    one.difference(k) = p.motor[row] - p.scale[row];
    one.position(k) = p.scale[row];
    one.motor(k) = filtered(p.motor, row, fine);
    one.speed(k) = (filtered(p.scale, row + 1, fine) - filtered(p.scale, row - 1, fine)) / (2.0 * T);
    one.velocity(k) = (filtered(p.motor, row + 1, fine) - filtered(p.motor, row - 1, fine)) / (2.0 * T);
  }
  for (Eigen::Index k = 0; k < inner; ++k) {
    const std::size_t row = from + static_cast<std::size_t>(k);
    one.acceleration(k) =
        (filtered(p.motor, row + 1, s) - 2.0 * filtered(p.motor, row, s) + filtered(p.motor, row - 1, s)) /
        (T * T);
    one.force(k) = p.force.empty() ? 0.0 : force_at(p, row, s);
  }
  return one;
}

/// Difference, position, velocity and direction where a stroke goes at constant speed, so that the motor pulls the table: while the axis
/// brakes hard, the table pushes the motor from the other side of the play. One vector for each stroke.
using Row = std::array<double, 4>;
std::vector<std::vector<Row>> steady_rows(const std::vector<Positions>& runs, double clear) {
  constexpr double kOfFastest = 0.5;   // of the stroke
  constexpr double kSteadyFor = 0.05;  // [s]: speed may change by a tenth in this time
  std::vector<std::vector<Row>> all;
  for (const Stroke& s : strokes_of(runs)) {
    const Positions& p = runs[s.run];
    const Smoothing w = smoothing_for(p.sample_time);
    const auto reach = static_cast<std::size_t>(w.reach);
    const double T = p.sample_time;
    std::vector<Row> rows;
    std::vector<double> acceleration;
    double fastest = 0.0;
    for (std::size_t k = std::max(s.first, reach + 1); k + reach + 1 < s.last; k += reach) {
      if (std::abs(p.motor[k] - p.motor[s.first]) < clear) continue;
      const double before = filtered(p.motor, k - 1, w), now = filtered(p.motor, k, w),
                   after = filtered(p.motor, k + 1, w);
      const double v = (after - before) / (2.0 * T);
      rows.push_back({now - filtered(p.scale, k, w), p.scale[k], v, static_cast<double>(s.direction)});
      acceleration.push_back((after - 2.0 * now + before) / (T * T));
      fastest = std::max(fastest, std::abs(v));
    }
    std::vector<Row> steady;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double v = rows[i][2];
      if (v * s.direction > kOfFastest * fastest &&
          std::abs(acceleration[i]) * kSteadyFor < 0.1 * std::abs(v))
        steady.push_back(rows[i]);
    }
    if (!steady.empty()) all.push_back(std::move(steady));
  }
  return all;
}

/// Offset, scale error, delay, half the lost motion and its change along the travel, from the strokes that `part` has; and the share of
/// the direction's column that the others do not explain.
struct SlidingFit {
  double half = 0.0;
  double told = 0.0;
  double scale_error = 0.0;
};
SlidingFit fit_sliding(const std::vector<std::vector<Row>>& strokes, double middle, const Part& part) {
  constexpr Eigen::Index kDirection = 4;  // the last column
  std::vector<Row> rows;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    if (part.has(i)) rows.insert(rows.end(), strokes[i].begin(), strokes[i].end());
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  if (n < 10) return {};
  Eigen::MatrixXd X(n, 5);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& r = rows[static_cast<std::size_t>(i)];
    X.row(i) << 1.0, r[1] - middle, r[2], r[3] * (r[1] - middle), r[3];
    y(i) = r[0];
  }
  const stats::LeastSquares solved = stats::least_squares(X, y);
  if (solved.rank < 5) return {};
  const Eigen::MatrixXd others = X.leftCols(kDirection);
  const Eigen::VectorXd column = X.col(kDirection);
  const Eigen::VectorXd left = column - others * stats::least_squares(others, column).x;
  return {solved.x(kDirection), left.squaredNorm() / column.squaredNorm(), solved.x(1)};
}

}  // namespace

Smoothing Smoothing::fine() const {
  const int j = std::max(1, reach / 9);
  return {3 * j, log::box_weights(j)};
}

Smoothing smoothing_for(double sample_time) {
  const int j = std::max(1, static_cast<int>(std::lround(kBox / sample_time)));
  return {3 * j, log::box_weights(j)};
}

Sliding find_sliding(const std::vector<Positions>& runs) {
  Sliding out;
  std::vector<std::array<double, 4>> rows;  // difference, position, velocity, direction
  const std::vector<Stroke> strokes = strokes_of(runs);
  for (const Stroke& s : strokes) {
    const Positions& p = runs[s.run];
    // The outer fifths hold what follows a reversal.
    const std::size_t fifth = (s.last - s.first) / 5;
    for (std::size_t k = s.first + fifth + 1; k + fifth + 1 < s.last; ++k) {
      rows.push_back({p.motor[k] - p.scale[k], p.scale[k],
                      (p.scale[k + 1] - p.scale[k - 1]) / (2.0 * p.sample_time),
                      static_cast<double>(s.direction)});
    }
  }
  if (strokes.size() < 2 || rows.size() < 50) return out;
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd X(n, 5);
  Eigen::VectorXd y(n);
  double middle = 0.0;
  for (const auto& r : rows) middle += r[1] / static_cast<double>(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& r = rows[static_cast<std::size_t>(i)];
    X.row(i) << 1.0, r[1] - middle, r[2], r[3], r[3] * (r[1] - middle);
    y(i) = r[0];
  }
  const stats::LeastSquares solved = stats::least_squares(X, y);
  if (solved.rank < 5) return out;
  out.known = true;
  out.scale_error = solved.x(1);
  out.offset = solved.x(0) - solved.x(1) * middle;
  out.half = solved.x(3);
  double motor = 0.0;
  double scale = 0.0;
  for (const Positions& p : runs) {
    motor = std::max(motor, 1e6 * smallest_step(p.motor));
    scale = std::max(scale, 1e6 * smallest_step(p.scale));
  }
  out.rounding_motor = motor * motor / 12.0;
  out.rounding_difference = out.rounding_motor + scale * scale / 12.0;
  return out;
}

std::optional<WhileSliding> total_while_sliding(const std::vector<Positions>& runs, const Sliding& sliding) {
  constexpr std::size_t kFewestStrokes = 4;
  constexpr int kMostGroups = 11;  // odd: strokes of both directions in each
  constexpr double kTold = 0.05;   // of one speed alone, a delay of an encoder looks like lost motion
  const std::vector<std::vector<Row>> strokes = steady_rows(runs, 4.0 * std::abs(sliding.half) + 100e-6);
  if (strokes.size() < kFewestStrokes) return {};
  double middle = 0.0, count = 0.0;
  for (const auto& rows : strokes) {
    for (const Row& r : rows) middle += r[1], count += 1.0;
  }
  middle /= count;
  const SlidingFit all = fit_sliding(strokes, middle, {});
  if (all.told < kTold) return {};
  const int groups = std::min(kMostGroups, static_cast<int>(strokes.size()));
  std::vector<double> without;
  for (int g = 0; g < groups; ++g) {
    const SlidingFit one = fit_sliding(strokes, middle, {groups, g});
    if (one.told < kTold) return {};
    without.push_back(2.0 * one.half);
  }
  return WhileSliding{{2.0 * all.half, jackknife_half_width(without)}, all.scale_error};
}

void find_shape(const std::vector<Positions>& runs, Sliding& sliding) {
  constexpr double kSlowest = 0.2e-3;
  constexpr double kFastest = 25e-3;
  const auto rows = rows_together(runs, 4.0 * std::max(0.0, sliding.half) + 30e-6);
  if (rows.size() < 30) return;
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd X(n, 5);
  Eigen::VectorXd y(n);
  double least = std::numeric_limits<double>::infinity();
  for (double speed = kSlowest; speed < kFastest; speed *= 1.25) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& r = rows[static_cast<std::size_t>(i)];
      const double side = r[2] > 0.0 ? 1.0 : -1.0;
      X.row(i) << 1.0, r[1], side, side * std::exp(-std::abs(r[2]) / speed), r[2];
      y(i) = r[0];
    }
    const stats::LeastSquares solved = stats::least_squares(X, y);
    const double left = (X * solved.x - y).squaredNorm();
    const double slow = solved.x(2) + solved.x(3);
    if (solved.rank < 5 || !(left < least) || !(slow > 0.0)) continue;
    least = left;
    sliding.stribeck = speed;
    sliding.fallen = solved.x(3) / slow;
    sliding.viscous = solved.x(4) / slow;
    sliding.friction = slow;
  }
}

std::vector<Stretch> find_stretches(const std::vector<Positions>& runs, const Sliding& sliding) {
  std::vector<Stretch> out;
  const double lost = 2.0 * std::max(0.0, sliding.half);
  const double before = 0.5 * lost + 20e-6;
  const double after = 1.6 * lost + 25e-6;
  const std::vector<Stroke> strokes = strokes_of(runs);
  for (std::size_t i = 1; i < strokes.size(); ++i) {
    const Stroke& last = strokes[i - 1];
    const Stroke& next = strokes[i];
    if (last.run != next.run || last.last != next.first) continue;
    const Positions& p = runs[next.run];
    const double turn = p.motor[next.first];
    // The table must have slid on both sides.
    if (std::abs(p.motor[last.first] - turn) < before + after ||
        std::abs(p.motor[next.last] - turn) < before + after)
      continue;
    std::size_t from = next.first;
    std::size_t to = next.first;
    while (from > last.first && std::abs(p.motor[from] - turn) < before) --from;
    while (to < next.last && std::abs(p.motor[to] - turn) < after) ++to;
    const int reach = smoothing_for(p.sample_time).reach;
    const auto margin = static_cast<std::size_t>(2 * reach + 2);
    if (from < margin || to + margin >= p.motor.size()) continue;
    if (to - from < static_cast<std::size_t>(kLeast * reach)) continue;
    out.push_back(cut(p, from, to, next.direction));
  }
  return out;
}

}  // namespace stribeck::ident::lost_motion
