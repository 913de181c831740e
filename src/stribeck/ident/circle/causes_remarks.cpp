#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <tuple>

namespace stribeck::ident::circle {
namespace {

/// Whether the spikes of an axis keep their time or their travel from feed to feed.
void compare_feeds(const std::vector<QuadrantPeak>& peaks, int axis, const CauseRows& rows,
                   std::vector<std::string>& remarks) {
  const double radius = rows.radius;
  const std::string& name = rows.axes[static_cast<std::size_t>(axis)];
  double slow = HUGE_VAL;
  double fast = 0.0;
  for (const QuadrantPeak& p : peaks) {
    slow = std::min(slow, p.feed);
    fast = std::max(fast, p.feed);
  }
  double angle_slow = 0.0;
  double angle_fast = 0.0;
  int count_slow = 0;
  int count_fast = 0;
  for (const QuadrantPeak& p : peaks) {
    if (p.axis != axis) continue;
    if (p.feed == slow) angle_slow += p.delay, ++count_slow;
    if (p.feed == fast) angle_fast += p.delay, ++count_fast;
  }
  if (count_slow == 0 || count_fast == 0) return;
  angle_slow /= count_slow;
  angle_fast /= count_fast;
  const double time = std::log(angle_fast / fast / (angle_slow / slow));
  const double travel = std::log((1.0 - std::cos(angle_fast)) / (1.0 - std::cos(angle_slow)));
  const std::string tops = fmt::format(
      "tops at {:.1f} ms and {:.1f} µm of travel at {:.0f} mm/min, at {:.1f} ms and {:.1f} µm at {:.0f} mm/min",
      1e3 * angle_slow * radius / slow, 1e6 * radius * (1.0 - std::cos(angle_slow)), 6e4 * slow,
      1e3 * angle_fast * radius / fast, 1e6 * radius * (1.0 - std::cos(angle_fast)), 6e4 * fast);
  if (std::abs(time) < 0.5 * std::abs(travel)) {
    remarks.push_back(fmt::format(
        "spikes of {}: {}: the delay is the same at both feeds: backlash that closes late, or whose compensation comes late",
        name, tops));
  } else if (std::abs(travel) < 0.5 * std::abs(time)) {
    remarks.push_back(fmt::format(
        "spikes of {}: {}: the distance is the same at both feeds: friction before sliding", name, tops));
  } else {
    remarks.push_back(fmt::format(
        "spikes of {}: {}: neither delay nor distance is the same at both feeds: friction and backlash cannot be distinguished",
        name, tops));
  }
}

/// Rows in a second; NaN: no times.
double row_rate(const std::vector<CircleMotion>& motions) {
  for (const CircleMotion& m : motions) {
    for (const CircleRun& r : m.runs) {
      if (r.time.size() > 1 && r.time.back() > r.time.front())
        return static_cast<double>(r.time.size() - 1) / (r.time.back() - r.time.front());
    }
  }
  return std::nan("");
}

bool is_found(const std::vector<Cause>& causes, CauseKind kind) {
  return std::any_of(causes.begin(), causes.end(), [&](const Cause& c) { return c.kind == kind && c.found; });
}

/// What a measurement of this kind does not hold.
void add_remarks_on_instrument(const CauseRows& rows, const CauseFit& fit,
                               const std::vector<CircleMotion>& motions, std::vector<std::string>& out) {
  const bool times = std::any_of(motions.begin(), motions.end(), [](const CircleMotion& m) {
    return std::any_of(m.runs.begin(), m.runs.end(), [](const CircleRun& r) { return !r.time.empty(); });
  });
  if (times && !tells_vibration(motions, fit.window()))
    out.emplace_back(
        "too few rows between the reversals to look for a vibration: sample faster, or measure with a lower feed or a larger radius");
  if (!times)
    out.emplace_back(
        "no times: a vibration cannot be looked for, and run-in and run-out are only known by the spacing of the rows");
  if (!rows.feeds_known)
    out.emplace_back(
        "the feed is not known (--feed \"1000 mm/min\"): times of the peaks and of the servo mismatch cannot be stated");
  if (std::all_of(motions.begin(), motions.end(), [](const CircleMotion& m) { return m.ball_bar; })) {
    out.emplace_back(
        "a ball-bar measures the distance from its centre: an error along the circle cannot be seen");
  } else if (!std::all_of(motions.begin(), motions.end(), [](const CircleMotion& m) { return m.scale; })) {
    out.emplace_back(
        "positions of a motor encoder hold no backlash, lateral play, squareness or straightness: these need a "
        "ball-bar, a grid encoder or linear scales");
  }
}

/// How far the circle moves from lap to lap: centre and radius of the differences between rows one turn apart.
struct LapDrift {
  double centre = 0.0;  ///< in a lap [m]
  double radius = 0.0;  ///< in a lap [m]
  double error = 0.0;   ///< standard error of either [m]
};

/// From all runs of two laps and more.
std::optional<LapDrift> drift_of_laps(const CauseRows& rows, const CauseFit& fit) {
  constexpr std::size_t kFewest = 360;
  std::map<std::tuple<int, int, long>, double> cells;  // run, lap, step within the lap
  const double steps = std::floor(2.0 * kPi / rows.step);
  const auto cell = [&](const CauseRow& r) {
    const double within = r.angle - 2.0 * kPi * std::floor(r.angle / (2.0 * kPi));
    return std::min(std::floor(within / rows.step), steps - 1.0);
  };
  std::vector<std::array<double, 2>> differences;  // angle, change in a lap
  for (const CauseRow& r : rows.rows) {
    const auto k = static_cast<long>(cell(r));
    if (const auto before = cells.find({r.run, r.lap - 1, k}); before != cells.end())
      differences.push_back({r.angle, r.error - before->second});
    cells[{r.run, r.lap, k}] = r.error;
  }
  if (differences.size() < kFewest) return std::nullopt;
  Eigen::MatrixXd X(static_cast<Eigen::Index>(differences.size()), 3);
  Eigen::VectorXd y(X.rows());
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const auto& [angle, change] = differences[static_cast<std::size_t>(i)];
    X.row(i) << 1.0, std::cos(angle), std::sin(angle);
    y(i) = change;
  }
  const Eigen::MatrixXd inverse = stats::inverse(stats::gram(X));
  const Eigen::VectorXd c = inverse * (X.transpose() * y);
  // Neighbours resemble each other: as if ten rows were one.
  constexpr double kAlike = 10.0;
  const double variance = std::max(fit.variance, (y - X * c).squaredNorm() / static_cast<double>(y.size()));
  return LapDrift{std::hypot(c(1), c(2)), c(0), std::sqrt(kAlike * variance * inverse.diagonal().maxCoeff())};
}

void remark_on_drift(const CauseRows& rows, const CauseFit& fit, std::vector<std::string>& out) {
  constexpr double kLeast = 0.5e-6;
  constexpr double kSure = 4.0;
  const std::optional<LapDrift> drift = drift_of_laps(rows, fit);
  if (!drift) return;
  const auto counts = [&](double size) { return std::abs(size) > std::max(kLeast, kSure * drift->error); };
  if (!counts(drift->centre) && !counts(drift->radius)) return;
  out.push_back(fmt::format(
      "the laps do not lie on each other: from one lap to the next the centre moves by {:.2g} µm and the radius by {:+.2g} µm (the "
      "machine warms up, or the instrument or its magnet slips): the causes are means over the laps; repeat the measurement when it "
      "stands still",
      1e6 * drift->centre, 1e6 * drift->radius));
}

}  // namespace

std::vector<std::string> remarks_on(const CauseRows& rows, const CauseFit& fit,
                                    const std::vector<Cause>& causes, const std::vector<QuadrantPeak>& peaks,
                                    const std::vector<CircleMotion>& motions, bool commanded) {
  std::vector<std::string> out;
  if (!rows.both_directions)
    out.emplace_back(
        rows.own_encoder
            ? "one direction of travel: scale mismatch cannot be distinguished from lateral play; measure the other direction too"
            : "one direction of travel: squareness cannot be distinguished from servo mismatch, nor scale mismatch from lateral play; "
              "measure the other direction too");
  if (!rows.feeds_differ &&
      (is_found(causes, CauseKind::kRadius) || is_found(causes, CauseKind::kScaleMismatch)))
    out.emplace_back(
        "one feed: a radius and a scale mismatch that come from the lag of the drives cannot be distinguished from those of the "
        "scales; measure at a second feed, at least twice as fast, and give both logs with --together");
  if (rows.arcs)
    out.emplace_back(
        "an arc: the centre, the scales and the squareness are known less well than from a whole circle, the bow of a guide is not looked for, and what "
        "happens in the missing part is not seen");
  for (const std::size_t axis : {0U, 1U}) {
    if (fit.windows[axis] > kBroad)
      out.push_back(fmt::format(
          "what {0} does behind its reversals reaches over {1:.0f} degrees and more: a part of its spikes may be stated as backlash of {0}, scale mismatch or radius; an axis that sticks and slips all along looks like this too, and then both axes seem to have spikes: look at its error over time",
          rows.axes[axis], fit.windows[axis] * 180.0 / kPi));
  }
  for (const int axis : {0, 1}) {
    const bool found = std::any_of(causes.begin(), causes.end(), [&](const Cause& c) {
      return c.kind == CauseKind::kReversalSpike && c.axis == axis && c.found;
    });
    if (found &&
        std::all_of(peaks.begin(), peaks.end(),
                    [&](const QuadrantPeak& p) {
                      return p.axis != axis || p.in_play || std::abs(p.height) < 2.0 * p.half_width_95;
                    }) &&
        std::any_of(peaks.begin(), peaks.end(),
                    [&](const QuadrantPeak& p) { return p.axis == axis && p.in_play; }))
      out.push_back(fmt::format(
          "spikes of {} have their top where the axis crosses its play, between rows or hidden by it: they are at least as high as stated; "
          "more rows, or a larger feed, show more of them",
          rows.axes[static_cast<std::size_t>(axis)]));
  }
  if (is_found(causes, CauseKind::kReversalSpike)) {
    if (!rows.feeds_differ) {
      out.emplace_back(
          "one feed: a spike of friction cannot be distinguished from backlash that closes late; measure at a second feed and "
          "give both logs with --together");
    } else {
      for (const int axis : {0, 1}) {
        for (const Cause& c : causes) {
          if (c.kind == CauseKind::kReversalSpike && c.axis == axis && c.found)
            compare_feeds(peaks, axis, rows, out);
        }
      }
    }
  }
  if (is_found(causes, CauseKind::kStraightness))
    out.emplace_back(
        "a bow of a guide cannot be distinguished from a scale whose error grows with the square of the travel");
  if (is_found(causes, CauseKind::kRadius) && !rows.own_encoder)
    out.emplace_back(
        "a radius cannot be distinguished from an error of the instrument's length, unless that was calibrated");
  if (const double rate = row_rate(motions); is_found(causes, CauseKind::kVibration) && std::isfinite(rate))
    out.push_back(fmt::format(
        "rows at {:.4g} Hz tell vibrations up to {:.4g} Hz: one that is faster shows at a lower frequency",
        rate, 0.5 * rate));
  if (!commanded)
    out.emplace_back("without a commanded circle (--map rx=…, ry=…) an offset of the centre cannot be seen");
  remark_on_drift(rows, fit, out);
  add_remarks_on_instrument(rows, fit, motions, out);
  return out;
}

}  // namespace stribeck::ident::circle
