#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/log/mixed_runs.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log {

namespace {

/// One run at a nearly constant speed.
struct Run {
  const Record* record = nullptr;
  double speed = 0.0;     ///< [m/s], magnitude
  double duration = 0.0;  ///< [s]
};

/// Mean force of a run between two positions, counted from its start in its direction; NaN where it has no rows there.
double mean_between(const Record& r, double from, double to, int direction) {
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t k = 0; k < r.x.size(); ++k) {
    const double x = direction * r.x[k];
    if (x < from || x > to) continue;
    sum += r.f[k];
    ++n;
  }
  return n < 8 ? kNaN : sum / static_cast<double>(n);
}

/// Steady runs of one direction, ordered by speed.
std::vector<Run> steady(const std::vector<Record>& records, int direction) {
  std::vector<Run> runs;
  for (const Record& r : records) {
    const std::size_t n = r.x.size();
    if (n < 50) continue;
    constexpr std::size_t kParts = 20;
    std::vector<double> speeds;
    for (std::size_t i = 0; i < kParts; ++i) {
      const std::size_t a = i * (n - 1) / kParts;
      const std::size_t b = (i + 1) * (n - 1) / kParts;
      speeds.push_back(direction * (r.x[b] - r.x[a]) / (r.t[b] - r.t[a]));
    }
    const double middle = stats::thinned_quantile(speeds, 0.5);
    if (!(middle > 0.0)) continue;
    std::size_t near = 0;
    for (const double v : speeds) near += std::abs(v / middle - 1.0) < 0.3 ? 1 : 0;
    if (near * 10 < kParts * 6) continue;
    runs.push_back({&r, middle, r.t.back() - r.t.front()});
  }
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.speed < b.speed; });
  return runs;
}

/// Force of run b less that of run a over their common positions, in the direction of the motion.
double step_between(const Run& a, const Run& b, int direction) {
  const auto range = [&](const Record& r) {
    const auto [low, high] = std::minmax_element(r.x.begin(), r.x.end());
    const double from = direction > 0 ? *low : -*high;
    const double to = direction > 0 ? *high : -*low;
    return std::pair{from, to};
  };
  const auto [af, at] = range(*a.record);
  const auto [bf, bt] = range(*b.record);
  const double from = std::max(af, bf);
  const double to = std::min(at, bt);
  if (!(to > from)) return kNaN;
  // Without the beginning, where the axis still accelerates.
  const double skip = 0.15 * (to - from);
  return direction * (mean_between(*b.record, from + skip, to, direction) -
                      mean_between(*a.record, from + skip, to, direction));
}

}  // namespace

std::vector<Finding> warn_of_mixed_runs(const std::vector<Record>& records) {
  std::vector<Finding> found;
  constexpr std::size_t kFewestRuns = 6;
  for (const int direction : {1, -1}) {
    const std::vector<Run> runs = steady(records, direction);
    if (runs.size() < kFewestRuns) continue;
    std::vector<double> steps(runs.size(), kNaN);  // step before run i
    std::vector<double> sizes;
    for (std::size_t i = 1; i < runs.size(); ++i) {
      steps[i] = step_between(runs[i - 1], runs[i], direction);
      if (std::isfinite(steps[i])) sizes.push_back(std::abs(steps[i]));
    }
    if (sizes.size() < kFewestRuns - 1) continue;
    for (std::size_t i = 2; i + 2 < runs.size(); ++i) {
      if (!std::isfinite(steps[i])) continue;
      // All runs below must differ from all runs above in how they were recorded.
      double low[2] = {1e300, 1e300};
      double high[2] = {0.0, 0.0};
      double t_low[2] = {1e300, 1e300};
      double t_high[2] = {0.0, 0.0};
      for (std::size_t j = 0; j < runs.size(); ++j) {
        const std::size_t side = j < i ? 0 : 1;
        low[side] = std::min(low[side], runs[j].duration);
        high[side] = std::max(high[side], runs[j].duration);
        t_low[side] = std::min(t_low[side], runs[j].record->sample_time);
        t_high[side] = std::max(t_high[side], runs[j].record->sample_time);
      }
      const bool alike = i >= 3 && high[0] < 1.2 * low[0];
      const bool duration = alike && (low[0] > 2.0 * high[1] || low[1] > 2.0 * high[0]);
      const bool sampling = t_high[0] < 1.01 * t_low[0] && t_high[1] < 1.01 * t_low[1] &&
                            (t_low[0] > 1.02 * t_high[1] || t_low[1] > 1.02 * t_high[0]);
      if (!duration && !sampling) continue;
      std::vector<double> near;
      for (std::size_t j = 1; j < runs.size(); ++j) {
        if (j != i && std::isfinite(steps[j]) && j + 6 > i && j < i + 6) near.push_back(std::abs(steps[j]));
      }
      const double usual = stats::thinned_quantile(near, 0.5);
      std::vector<double> forces;
      for (const double f : runs[i].record->f) forces.push_back(std::abs(f));
      const double level = stats::thinned_quantile(forces, 0.5);
      if (!(std::abs(steps[i]) > 2.5 * usual) || std::abs(steps[i]) < 0.05 * level) continue;
      const Record& a = *runs[i - 1].record;
      const Record& b = *runs[i].record;
      const Shown shown(b);
      const std::string here =
          fmt::format("v {} 0: {} between {} and {}, elsewhere about {}", direction > 0 ? ">" : "<",
                      shown.force(steps[i]), shown.speed(runs[i - 1].speed), shown.speed(runs[i].speed),
                      shown.force(usual));
      const std::vector<double> numbers{
          static_cast<double>(i),        runs[i - 1].speed, runs[i].speed, steps[i], usual,
          static_cast<double>(direction)};
      if (!found.empty()) {
        found.front().text += "; " + here;
        found.front().values.insert(found.front().values.end(), numbers.begin(), numbers.end());
        break;
      }
      found.push_back(
          {"mixed-runs",
           fmt::format(
               "the runs up to {} ({} of {:.3g} to {:.3g} s, {:.4g} s between rows) and from {} on ({} of {:.3g} to {:.3g} s, {:.4g} s) were taken in different ways, and the friction at the same places jumps between them: they were probably recorded on different days. Identify them separately; otherwise the difference is taken for friction at low speed. ",
               a.source, i, low[0], high[0], t_high[0], b.source, runs.size() - i, low[1], high[1],
               t_high[1]) +
               here,
           0, 0.0, false, numbers});
      break;
    }
  }
  return found;
}

}  // namespace stribeck::ident::log
