#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <stribeck/ident/circle/feed_groups.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <tuple>
#include <utility>

namespace stribeck::ident::circle {
namespace {

/// The rest behind one reversal of one axis in one direction at one feed: mean over laps, over the angle behind the reversal.
struct Profile {
  std::vector<double> mean;  ///< NaN: no samples
  std::vector<Passing> passings;
  std::vector<std::vector<double>> by_lap;  ///< of each passing; NaN: none
};

/// Run group (direction and feed) and border.
using PeakPlace = std::tuple<double, double, int>;

std::map<PeakPlace, Profile> profiles(const CauseRows& rows, const std::vector<double>& rest,
                                      const FeedGroups& feeds) {
  const auto cells = static_cast<std::size_t>(0.5 * kPi / rows.step) + 1;
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::map<PeakPlace, std::map<Passing, std::vector<double>>> passings;
  std::set<Passing>
      begins;  // quarters in which a run begins: whether the axis has reversed there is not seen
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const CauseRow& row = rows.rows[i];
    const auto quarter = static_cast<long>(std::floor(row.direction * row.angle / (0.5 * kPi)));
    if (i == 0 || row.run != rows.rows[i - 1].run) begins.insert({row.run, quarter});
    auto& lap = passings[{-row.direction, feeds.of(row.feed), last_border(row)}][{row.run, quarter}];
    if (lap.empty()) lap.assign(cells, none);
    lap[std::min(static_cast<std::size_t>(after_reversal(row) / rows.step), cells - 1)] = rest[i];
  }
  std::map<PeakPlace, Profile> out;
  for (const auto& [place, laps] : passings) {
    Profile& p = out[place];
    p.mean.assign(cells, none);
    for (const bool all : {false, true}) {
      if (!p.by_lap.empty()) break;  // a passing at a begin counts where there is no other
      for (const auto& [which, lap] : laps) {
        if (!all && begins.contains(which)) continue;
        p.passings.push_back(which);
        p.by_lap.push_back(lap);
      }
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

constexpr std::size_t kResolved = 5;  // steps beyond four fifths of the top: none of its height is lost

struct Top {
  double height = 0.0;
  double at = 0.0;        ///< [steps]
  std::size_t steps = 0;  ///< beyond four fifths of it
};

/// Largest value of the parabola through the steps round the top: less noise than one step, no loss of height by smoothing.
Top top_at(const std::vector<double>& mean, const std::vector<double>& smooth, std::size_t top) {
  const auto [low, high] = beyond(smooth, top, 0.8);
  const double middle = static_cast<double>(top);
  std::vector<std::pair<double, double>> points;
  for (std::size_t k = low; k <= high; ++k) {
    if (std::isfinite(mean[k])) points.emplace_back(static_cast<double>(k) - middle, mean[k]);
  }
  if (points.size() < kResolved) {
    const double height = std::abs(mean[top]) > std::abs(smooth[top]) ? mean[top] : smooth[top];
    return {height, middle + 0.5, points.size()};
  }
  Eigen::MatrixXd X(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::VectorXd y(X.rows());
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const auto& [at, value] = points[static_cast<std::size_t>(i)];
    X.row(i) << 1.0, at, at * at;
    y(i) = value;
  }
  const Eigen::VectorXd c = stats::least_squares(X, y).x;
  const double at = c(2) * y(y.size() / 2) < 0.0 ? -0.5 * c(1) / c(2) : 0.0;
  if (at < points.front().first || at > points.back().first)
    return {smooth[top], middle + 0.5, points.size()};
  return {c(0) + c(1) * at + c(2) * at * at, middle + 0.5 + at, points.size()};
}

/// Where the largest value is, of `first` to `last`.
std::size_t largest(const std::vector<double>& v, std::size_t first, std::size_t last) {
  std::size_t top = first;
  for (std::size_t k = first; k <= last; ++k) {
    if (std::isfinite(v[k]) && !(std::abs(v[k]) <= std::abs(v[top]))) top = k;
  }
  return top;
}

/// Radial error of an axis that stands still while it crosses its play, beyond that of one that has crossed it.
struct Standing {
  double play = 0.0;
  double radius = 0.0;
  [[nodiscard]] double at(double behind) const {
    return -std::max(0.0, play - radius * (1.0 - std::cos(behind)));
  }
};

struct FinePeak {
  double height = 0.0;
  double half_width = 0.0;
  double at = 0.0;     ///< angle behind the reversal [rad]
  double width = 0.0;  ///< at half height [rad]; NaN: reaches over the samples
};

/// Standard deviation of a sample, from the median second difference of neighbours: the flanks of a peak are no noise.
double noise_of(const std::vector<PassingSamples::Sample>& samples) {
  constexpr double kOfMedian = 0.6053;  // 1/(0.6745·√6)
  std::vector<double> bends;
  for (std::size_t i = 2; i < samples.size(); ++i) {
    if (samples[i].goes_on && samples[i - 1].goes_on)
      bends.push_back(std::abs(samples[i].rest - 2.0 * samples[i - 1].rest + samples[i - 2].rest));
  }
  return bends.empty() ? HUGE_VAL : kOfMedian * stats::median(std::move(bends));
}

/// The peak of samples of which few are on it: in each passing the parabola through the largest one and its neighbours; where it is the
/// first or the last one, half of what it falls to its only neighbour is not known. Absent where noise decides which is the largest.
std::optional<FinePeak> peak_of_few(const std::vector<PassingSamples::Sample>& samples,
                                    const Standing& standing, double noise) {
  constexpr double kOfFall = 0.1;  // to the next sample: what the top may be higher by, at least
  constexpr double kClear = 8.0;   // standard deviations of a sample
  std::vector<double> value;
  for (const auto& s : samples) value.push_back(s.rest - standing.at(s.behind));
  const auto most = std::max_element(value.begin(), value.end(),
                                     [](double a, double b) { return std::abs(a) < std::abs(b); });
  const double side = *most < 0.0 ? -1.0 : 1.0;
  double n = 0.0, sum = 0.0, squares = 0.0, at = 0.0, fall = 0.0;
  for (std::size_t first = 0, last = 0; first < value.size(); first = last) {
    for (last = first + 1; last < value.size() && samples[last].goes_on;) ++last;
    std::size_t top = first;
    for (std::size_t i = first; i < last; ++i) top = side * value[i] > side * value[top] ? i : top;
    if (last - first < 2 || !(side * value[top] > kClear * noise)) return std::nullopt;
    if (top == first || top + 1 == last) {
      const double here = side * value[top], next = side * value[top == first ? top + 1 : top - 1];
      n += 1.0, sum += here, squares += here * here, fall += 0.5 * (here - next), at += samples[top].behind;
      continue;
    }
    const double before = side * value[top - 1], here = side * value[top], behind = side * value[top + 1];
    const double bend = 2.0 * here - before - behind;
    const double off = bend > 0.0 ? 0.5 * (behind - before) / bend : 0.0;  // in rows
    // Between the sample and the vertex of the parabola: a spike that falls slowly has its top below that.
    const double above = 0.125 * (behind - before) * off;
    n += 1.0, sum += here + above, squares += (here + above) * (here + above);
    fall += std::max(above, kOfFall * (here - std::max(before, behind)));
    at += samples[top].behind + off * (samples[top].behind - samples[top - 1].behind);
  }
  const double mean = sum / n;
  const double scatter = n > 1.0 ? std::sqrt(std::max(0.0, (squares / n - mean * mean) / (n - 1.0))) : 0.0;
  const double half = std::hypot(1.96 * std::max(noise / std::sqrt(n), scatter), fall / n);
  return FinePeak{side * mean, half, at / n, std::numeric_limits<double>::quiet_NaN()};
}

/// The peak of samples, on steps as fine as its top needs and the samples allow; absent: they are no finer than `step`.
std::optional<FinePeak> fine_peak(const std::vector<PassingSamples::Sample>& samples, double from, double to,
                                  double step, const Standing& standing) {
  constexpr std::size_t kFewest = 8;
  if (samples.size() < kFewest) return std::nullopt;
  const auto passings =
      std::count_if(samples.begin(), samples.end(), [](const auto& s) { return !s.goes_on; });
  const double spacing = (to - from) * static_cast<double>(passings) / static_cast<double>(samples.size());
  const double noise = noise_of(samples);
  std::optional<FinePeak> out;
  for (double cell = 0.5 * step; cell >= spacing; cell *= 0.5) {
    const auto cells = static_cast<std::size_t>(std::ceil((to - from) / cell));
    std::vector<double> mean(cells, 0.0);
    std::vector<int> count(cells, 0);
    for (const auto& s : samples) {
      const auto k = std::min(static_cast<std::size_t>((s.behind - from) / cell), cells - 1);
      mean[k] += s.rest - standing.at(s.behind);
      ++count[k];
    }
    for (std::size_t k = 0; k < cells; ++k)
      mean[k] = count[k] > 0 ? mean[k] / count[k] : std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> smooth = smoothed(mean);
    const std::size_t at = largest(smooth, 0, cells - 1);
    if (!std::isfinite(smooth[at])) return std::nullopt;
    const Top top = top_at(mean, smooth, at);
    const auto [low, high] = beyond(smooth, at, 0.5);
    const bool whole = (low > 0 || from == 0.0) && high + 1 < cells;
    const double in_cell = static_cast<double>(samples.size()) / static_cast<double>(cells);
    // The vertex of a parabola through n points has 9/4 of the variance of their mean.
    const double points = top.steps < kResolved ? 1.0 : static_cast<double>(top.steps) / 2.25;
    double half_width = 1.96 * noise / std::sqrt(in_cell * points);
    // The largest of finer steps is larger by their noise: they must show more than that.
    constexpr double kMore = 1.5;  // half widths
    if (out && std::abs(top.height) - std::abs(out->height) < kMore * half_width) continue;
    if (top.steps < kResolved) {
      // Between two steps the top may be higher by what it falls to its neighbours.
      const double next =
          std::min(at > 0 && std::isfinite(mean[at - 1]) ? std::abs(mean[at - 1]) : HUGE_VAL,
                   at + 1 < cells && std::isfinite(mean[at + 1]) ? std::abs(mean[at + 1]) : HUGE_VAL);
      half_width = std::hypot(half_width,
                              0.5 * std::max(0.0, std::abs(top.height) - (std::isfinite(next) ? next : 0.0)));
    }
    out = {top.height, half_width, from + top.at * cell,
           whole ? static_cast<double>(high - low + 1) * cell : std::numeric_limits<double>::quiet_NaN()};
    if (top.steps >= kResolved) break;
  }
  return out;
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

/// Whether an axis that has play stands still right behind the reversal: there it is off by its play, whatever rises behind it. A line
/// through the first samples, as many as its error needs, is followed back to the reversal.
bool stands_at_first(std::vector<PassingSamples::Sample> samples, const Standing& standing) {
  constexpr double kMost = 0.7;      // of the play is left
  constexpr double kCertain = 0.15;  // of the play: standard error of the value at the reversal
  constexpr std::size_t kFewest = 8;
  const double per_play = noise_of(samples) / standing.play;
  std::erase_if(samples, [&](const auto& s) { return -standing.at(s.behind) < kMost * standing.play; });
  std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.behind < b.behind; });
  const double needed = std::max(static_cast<double>(kFewest), std::pow(2.0 * per_play / kCertain, 2));
  if (static_cast<double>(samples.size()) > needed) samples.resize(static_cast<std::size_t>(needed));
  double n = 0.0, x = 0.0, xx = 0.0, y = 0.0, xy = 0.0;
  for (const auto& s : samples)
    n += 1.0, x += s.behind, xx += s.behind * s.behind, y += s.rest, xy += s.behind * s.rest;
  const double determinant = n * xx - x * x;
  if (samples.size() < kFewest || !(determinant > 1e-6 * n * xx)) return false;
  return (xx * y - x * xy) / determinant < -0.5 * standing.play;
}

/// The peak behind one reversal.
class PeakSearch {
 public:
  PeakSearch(const PeakPlace& place, const Profile& profile, const CauseRows& rows,
             const PassingSamples& samples, double window, const Crossing& crossing)
      : place_(place), p_(profile), rows_(rows), samples_(samples), crossing_(crossing) {
    constexpr double kLeast = 10.0 * kPi / 180.0;
    smooth_ = smoothed(p_.mean);
    within_ = std::min(static_cast<std::size_t>(std::max(window, kLeast) / rows.step), smooth_.size() - 1);
    look_at_crossing();
  }

  [[nodiscard]] QuadrantPeak peak() const {
    const std::size_t top = largest(smooth_, begin_, within_);
    QuadrantPeak peak;
    peak.counter_clockwise = std::get<0>(place_) < 0.0;
    peak.axis = std::get<2>(place_) % 2;
    peak.angle = 0.5 * kPi * std::get<2>(place_);
    peak.laps = static_cast<int>(p_.by_lap.size());
    const Top rough = top_at(mean_, smooth_, top);
    peak.height = rough.height;
    peak.delay = (static_cast<double>(top) + 0.5) * rows_.step;
    const auto [low, high] = beyond(smooth_, top, 0.5);
    peak.width = static_cast<double>(high - low + 1) * rows_.step;
    peak.half_width_95 = scatter();
    peak.repeatability = repeatability(low, high);
    if (rough.steps < kResolved && std::abs(peak.height) > 2.0 * peak.half_width_95) {
      const std::size_t first = top > begin_ + kBeside ? top - kBeside : begin_;
      take(fine(static_cast<double>(first) * rows_.step, static_cast<double>(top + 1 + kBeside) * rows_.step),
           peak);
      take(few(), peak);
    }
    const bool tail = begin_ > 0 && top <= begin_ + 1 && std::abs(peak.height) > 2.0 * peak.half_width_95;
    if (in_play_ && std::abs(in_play_->height) > std::abs(peak.height) &&
        (beyond_play_ || (tail && in_play_->height * peak.height > 0.0))) {
      take(in_play_, peak);
      const auto at = std::min(static_cast<std::size_t>(in_play_->at / rows_.step), smooth_.size() - 1);
      peak.repeatability = repeatability(at, at);
    } else if ((tail && top == begin_) || (unsure_ && peak.delay < crossing_.angle)) {
      // It falls from its first step on: the top was where the axis stood still.
      constexpr double kUnseen = 0.45;
      peak.in_play = true;
      peak.half_width_95 =
          std::max(peak.half_width_95, std::min(kUnseen * std::abs(peak.height), crossing_.play));
    }
    peak.before = before(top, peak);
    return peak;
  }

 private:
  static constexpr std::size_t kBeside = 2;  // steps

  /// Where the axis crosses its play: what stands still explains is taken off, or the peak is looked for behind it.
  void look_at_crossing() {
    mean_ = p_.mean;
    if (!(crossing_.angle > 0.0)) return;
    // One step more than the play: the smoothing reaches that far.
    const std::size_t begin = std::min(static_cast<std::size_t>(crossing_.angle / rows_.step) + 2, within_);
    const auto end = static_cast<std::size_t>(std::get<2>(place_) / 2);
    const Standing standing{crossing_.stands ? std::max(0.0, crossing_.at_ends[end]) : 0.0, rows_.radius};
    const double to = static_cast<double>(begin) * rows_.step;
    if (standing.play > 0.0 && stands_at_first(samples_.of(p_.passings, 0.0, to), standing)) {
      standing_ = standing;
      for (std::size_t k = 0; k < mean_.size(); ++k)
        mean_[k] -= standing_.at((static_cast<double>(k) + 0.5) * rows_.step);
      smooth_ = smoothed(mean_);
      begin_ = begin;
      constexpr double kBeyondPlay = 0.5;
      in_play_ = fine(0.0, to);
      if (in_play_ && !(std::abs(in_play_->height) > 2.0 * std::max(in_play_->half_width, scatter())))
        in_play_.reset();
      beyond_play_ = in_play_ && std::abs(in_play_->height) > kBeyondPlay * standing_.play;
    } else if (stands_still(smooth_, begin, crossing_.play)) {
      begin_ = begin;
    } else {
      unsure_ = standing.play > 0.0;
    }
  }

  /// The largest value of the other sign before step `top`; NaN where it is not a lobe of its own.
  [[nodiscard]] double before(std::size_t top, const QuadrantPeak& peak) const {
    constexpr double kShare = 0.4;  // of the height
    double most = 0.0;
    for (std::size_t k = begin_; k < top; ++k) {
      if (smooth_[k] * peak.height < 0.0 && std::abs(smooth_[k]) > std::abs(most)) most = smooth_[k];
    }
    const bool stands_out =
        std::abs(most) > std::max(kShare * std::abs(peak.height), 2.0 * peak.half_width_95);
    return stands_out ? most : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] std::optional<FinePeak> fine(double from, double to) const {
    return fine_peak(samples_.of(p_.passings, from, to), from, to, rows_.step, standing_);
  }
  /// Where samples are so far apart that a narrow peak has few of them.
  [[nodiscard]] std::optional<FinePeak> few() const {
    constexpr double kFar = 0.25;  // steps
    const double from = static_cast<double>(begin_) * rows_.step;
    const double to = static_cast<double>(within_ + 1) * rows_.step;
    const std::vector<PassingSamples::Sample> samples = samples_.of(p_.passings, from, to);
    const auto most = (to - from) / (kFar * rows_.step) * static_cast<double>(p_.passings.size());
    if (samples.empty() || static_cast<double>(samples.size()) > most) return std::nullopt;
    return peak_of_few(samples, standing_, scatter() / 1.96);
  }
  static void take(const std::optional<FinePeak>& fine, QuadrantPeak& peak) {
    if (!fine || std::abs(fine->height) < std::abs(peak.height)) return;
    peak.height = fine->height;
    peak.half_width_95 = std::max(peak.half_width_95, fine->half_width);
    peak.delay = fine->at;
    if (std::isfinite(fine->width)) peak.width = fine->width;
  }
  /// 1.96 standard deviations where no peak is.
  [[nodiscard]] double scatter() const {
    double square = 0.0;
    int count = 0;
    for (std::size_t k = within_ + 1; k + 8 < smooth_.size(); ++k) {
      if (!std::isfinite(smooth_[k])) continue;
      square += smooth_[k] * smooth_[k];
      ++count;
    }
    return count > 0 ? 1.96 * std::sqrt(square / count) : HUGE_VAL;
  }
  /// Standard deviation over laps, of each lap's mean round the top.
  [[nodiscard]] double repeatability(std::size_t low, std::size_t high) const {
    double sum = 0.0;
    double squares = 0.0;
    int laps = 0;
    for (const auto& lap : p_.by_lap) {
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
    return laps > 1 ? std::sqrt(std::max(0.0, (squares - sum * sum / laps) / (laps - 1)))
                    : std::numeric_limits<double>::quiet_NaN();
  }

  const PeakPlace& place_;
  const Profile& p_;
  const CauseRows& rows_;
  const PassingSamples& samples_;
  const Crossing& crossing_;
  std::vector<double> mean_;
  std::vector<double> smooth_;
  std::size_t begin_ = 0;
  std::size_t within_ = 0;
  Standing standing_;
  std::optional<FinePeak> in_play_;  ///< a peak where the axis crosses its play
  bool beyond_play_ = false;         ///< it is larger than half of the play
  bool unsure_ = false;              ///< whether the axis stands still while it crosses its play
};

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

/// Whether the angle behind a reversal was travelled, from its first degree on: an arc begins anywhere in its quadrant.
bool covers_reversal(const Profile& p, double step) {
  constexpr double kBehind = 10.0 * kPi / 180.0, kFirst = kPi / 180.0;
  const auto first = std::clamp<std::size_t>(static_cast<std::size_t>(kFirst / step), 3, p.mean.size());
  if (std::none_of(p.mean.begin(), p.mean.begin() + static_cast<std::ptrdiff_t>(first),
                   [](double v) { return std::isfinite(v); }))
    return false;
  const auto all = std::clamp<std::size_t>(static_cast<std::size_t>(kBehind / step), 1, p.mean.size());
  const auto there = std::count_if(p.mean.begin(), p.mean.begin() + static_cast<std::ptrdiff_t>(all),
                                   [](double v) { return std::isfinite(v); });
  return 4 * static_cast<std::size_t>(there) >= all;
}

}  // namespace

std::vector<QuadrantPeak> quadrant_peaks(const CauseRows& rows, const std::vector<double>& rest,
                                         const PassingSamples& samples, const Windows& windows,
                                         const std::array<Crossing, 2>& crossing) {
  const FeedGroups feeds(rows);
  std::vector<QuadrantPeak> out;
  for (const auto& [place, profile] : profiles(rows, rest, feeds)) {
    if (!covers_reversal(profile, rows.step)) continue;
    const auto axis = static_cast<std::size_t>(std::get<2>(place) % 2);
    const QuadrantPeak peak = PeakSearch(place, profile, rows, samples, windows[axis], crossing[axis]).peak();
    // An arc that ends within the play shows no peak.
    if (!std::isfinite(peak.height)) continue;
    out.push_back(peak);
    // An arc may end within the window.
    if (!std::isfinite(out.back().half_width_95))
      out.back().half_width_95 = 1.96 * rest_beside_peaks(rows, rest, windows);
    out.back().feed = feeds.mean(std::get<1>(place));
  }
  return out;
}

}  // namespace stribeck::ident::circle
