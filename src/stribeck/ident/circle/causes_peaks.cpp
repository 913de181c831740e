#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <tuple>

namespace stribeck::ident::circle {
namespace {

/// The rest behind one reversal of one axis in one direction at one feed: mean over laps, over the angle behind the reversal.
struct Profile {
  std::vector<double> mean;                 ///< NaN: no samples
  std::vector<std::vector<double>> by_lap;  ///< of each passing; NaN: none
};

/// Run group (direction and feed) and border.
using PeakPlace = std::tuple<double, double, int>;

std::map<PeakPlace, Profile> profiles(const CauseRows& rows, const std::vector<double>& rest) {
  const auto cells = static_cast<std::size_t>(0.5 * kPi / rows.step) + 1;
  const double none = std::numeric_limits<double>::quiet_NaN();
  // Runs whose feeds agree to a twentieth are one group.
  const auto group = [&](const CauseRow& row) {
    return std::isfinite(row.feed) ? std::round(20.0 * std::log(row.feed)) : 0.0;
  };
  using Passing = std::pair<int, long>;  // run and quarter
  std::map<PeakPlace, std::map<Passing, std::vector<double>>> passings;
  std::set<Passing>
      begins;  // quarters in which a run begins: whether the axis has reversed there is not seen
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const CauseRow& row = rows.rows[i];
    const auto quarter = static_cast<long>(std::floor(row.direction * row.angle / (0.5 * kPi)));
    if (i == 0 || row.run != rows.rows[i - 1].run) begins.insert({row.run, quarter});
    auto& lap = passings[{-row.direction, group(row), last_border(row)}][{row.run, quarter}];
    if (lap.empty()) lap.assign(cells, none);
    lap[std::min(static_cast<std::size_t>(after_reversal(row) / rows.step), cells - 1)] = rest[i];
  }
  std::map<PeakPlace, Profile> out;
  for (const auto& [place, laps] : passings) {
    Profile& p = out[place];
    p.mean.assign(cells, none);
    for (const bool all : {false, true}) {
      if (!p.by_lap.empty()) break;  // a passing at a begin counts where there is no other
      for (const auto& [which, lap] : laps)
        if (all || !begins.contains(which)) p.by_lap.push_back(lap);
    }
    for (std::size_t k = 0; k < cells; ++k) {
      double sum = 0.0;
      int count = 0;
      for (const auto& lap : p.by_lap) {
        if (!std::isfinite(lap[k])) continue;
        sum += lap[k];
        ++count;
      }
      if (count > 0) p.mean[k] = sum / count;
    }
  }
  return out;
}

/// Mean over three neighbours that exist.
std::vector<double> smoothed(const std::vector<double>& v) {
  std::vector<double> out(v.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < v.size(); ++k) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t j = k > 0 ? k - 1 : 0; j < std::min(k + 2, v.size()); ++j) {
      if (!std::isfinite(v[j])) continue;
      sum += v[j];
      ++count;
    }
    if (count > 0) out[k] = sum / count;
  }
  return out;
}

/// Range of steps round the top that are beyond a share of it.
std::pair<std::size_t, std::size_t> beyond(const std::vector<double>& v, std::size_t top, double share) {
  std::size_t low = top;
  std::size_t high = top;
  while (low > 0 && v[low - 1] / v[top] > share) --low;
  while (high + 1 < v.size() && v[high + 1] / v[top] > share) ++high;
  return {low, high};
}

/// Largest value of the parabola through the steps round the top: less noise than one step, no loss of height by smoothing.
double height_at(const std::vector<double>& mean, const std::vector<double>& smooth, std::size_t top) {
  const auto [low, high] = beyond(smooth, top, 0.8);
  std::vector<std::pair<double, double>> points;
  for (std::size_t k = low; k <= high; ++k) {
    if (std::isfinite(mean[k]))
      points.emplace_back(static_cast<double>(k) - static_cast<double>(top), mean[k]);
  }
  if (points.size() < 5) return std::abs(mean[top]) > std::abs(smooth[top]) ? mean[top] : smooth[top];
  Eigen::MatrixXd X(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::VectorXd y(X.rows());
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const auto& [at, value] = points[static_cast<std::size_t>(i)];
    X.row(i) << 1.0, at, at * at;
    y(i) = value;
  }
  const Eigen::VectorXd c = stats::least_squares(X, y).x;
  const double at = c(2) * y(y.size() / 2) < 0.0 ? -0.5 * c(1) / c(2) : 0.0;
  if (at < points.front().first || at > points.back().first) return smooth[top];
  return c(0) + c(1) * at + c(2) * at * at;
}

/// Whether the rest behind a reversal is that of an axis that crosses its play: off by the play at first, and less and less. A peak is
/// larger than the play, or rises only after the reversal.
bool stands_still(const std::vector<double>& smooth, std::size_t end, double play) {
  constexpr double kBeyondPlay = 1.1;
  constexpr double kRise = 0.5;
  double first = std::numeric_limits<double>::quiet_NaN();
  double most = 0.0;
  for (std::size_t k = 0; k < end; ++k) {
    if (!std::isfinite(smooth[k])) continue;
    if (!std::isfinite(first)) first = std::abs(smooth[k]);
    most = std::max(most, std::abs(smooth[k]));
  }
  return !(most > kBeyondPlay * play) && !(most > kRise * play && first < kRise * most);
}

QuadrantPeak peak_of(const PeakPlace& place, const Profile& p, const CauseRows& rows, double window,
                     const Crossing& crossing) {
  constexpr double kLeast = 10.0 * kPi / 180.0;
  const std::vector<double> smooth = smoothed(p.mean);
  const auto within =
      std::min(static_cast<std::size_t>(std::max(window, kLeast) / rows.step), smooth.size() - 1);
  // One step more than the play: the smoothing reaches that far.
  std::size_t begin =
      crossing.angle > 0.0 ? std::min(static_cast<std::size_t>(crossing.angle / rows.step) + 2, within) : 0;
  if (begin > 0 && !stands_still(smooth, begin, crossing.play)) begin = 0;
  std::size_t top = begin;
  for (std::size_t k = begin; k <= within; ++k) {
    if (std::isfinite(smooth[k]) && !(std::abs(smooth[k]) <= std::abs(smooth[top]))) top = k;
  }
  QuadrantPeak peak;
  peak.counter_clockwise = std::get<0>(place) < 0.0;
  peak.axis = std::get<2>(place) % 2;
  peak.angle = 0.5 * kPi * std::get<2>(place);
  peak.laps = static_cast<int>(p.by_lap.size());
  peak.height = height_at(p.mean, smooth, top);
  peak.delay = (static_cast<double>(top) + 0.5) * rows.step;
  const auto [low, high] = beyond(smooth, top, 0.5);
  peak.width = static_cast<double>(high - low + 1) * rows.step;
  // Scatter where no peak is.
  double square = 0.0;
  int count = 0;
  for (std::size_t k = within + 1; k + 8 < smooth.size(); ++k) {
    if (!std::isfinite(smooth[k])) continue;
    square += smooth[k] * smooth[k];
    ++count;
  }
  peak.half_width_95 = count > 0 ? 1.96 * std::sqrt(square / count) : HUGE_VAL;
  // Over laps: each lap's mean round the top.
  double sum = 0.0;
  double squares = 0.0;
  int laps = 0;
  for (const auto& lap : p.by_lap) {
    double of_lap = 0.0;
    int steps = 0;
    for (std::size_t k = low; k <= high; ++k) {
      if (!std::isfinite(lap[k])) continue;
      of_lap += lap[k];
      ++steps;
    }
    if (steps == 0) continue;
    of_lap /= steps;
    sum += of_lap;
    squares += of_lap * of_lap;
    ++laps;
  }
  peak.repeatability = laps > 1 ? std::sqrt(std::max(0.0, (squares - sum * sum / laps) / (laps - 1)))
                                : std::numeric_limits<double>::quiet_NaN();
  return peak;
}

/// RMS of the rest where no peak is, over all runs; infinite: nowhere.
double rest_beside_peaks(const CauseRows& rows, const std::vector<double>& rest, const Windows& windows) {
  double square = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const auto axis = static_cast<std::size_t>(last_border(rows.rows[i]) % 2);
    if (after_reversal(rows.rows[i]) < windows[axis] || !std::isfinite(rest[i])) continue;
    square += rest[i] * rest[i];
    ++count;
  }
  return count > 0 ? std::sqrt(square / count) : HUGE_VAL;
}

/// Whether the angle behind a reversal was travelled: an arc begins anywhere in its quadrant.
bool covers_reversal(const Profile& p, double step) {
  constexpr double kBehind = 10.0 * kPi / 180.0;
  const auto all = std::clamp<std::size_t>(static_cast<std::size_t>(kBehind / step), 1, p.mean.size());
  const auto there = std::count_if(p.mean.begin(), p.mean.begin() + static_cast<std::ptrdiff_t>(all),
                                   [](double v) { return std::isfinite(v); });
  return 4 * static_cast<std::size_t>(there) >= all;
}

}  // namespace

std::vector<QuadrantPeak> quadrant_peaks(const CauseRows& rows, const std::vector<double>& rest,
                                         const Windows& windows, const std::array<Crossing, 2>& crossing) {
  std::map<double, std::pair<double, int>> feeds;
  for (const CauseRow& row : rows.rows) {
    if (!std::isfinite(row.feed)) continue;
    auto& [sum, count] = feeds[std::round(20.0 * std::log(row.feed))];
    sum += row.feed;
    ++count;
  }
  std::vector<QuadrantPeak> out;
  for (const auto& [place, profile] : profiles(rows, rest)) {
    if (!covers_reversal(profile, rows.step)) continue;
    const auto axis = static_cast<std::size_t>(std::get<2>(place) % 2);
    QuadrantPeak peak = peak_of(place, profile, rows, windows[axis], crossing[axis]);
    // An arc that ends within the play shows no peak.
    if (!std::isfinite(peak.height)) continue;
    out.push_back(peak);
    // An arc may end within the window.
    if (!std::isfinite(out.back().half_width_95))
      out.back().half_width_95 = 1.96 * rest_beside_peaks(rows, rest, windows);
    const auto feed = feeds.find(std::get<1>(place));
    out.back().feed = feed == feeds.end() ? std::numeric_limits<double>::quiet_NaN()
                                          : feed->second.first / feed->second.second;
  }
  return out;
}

}  // namespace stribeck::ident::circle
