#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/residual/residual_parts.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::residual {
namespace {

constexpr std::size_t kFewestStrokes = 6;
constexpr std::size_t kFewestInStroke = 8;  // rows
constexpr double kWorthStep = 0.08;         // of friction
constexpr double kBetterThanDrift = 0.6;    // of what a straight line over time leaves
constexpr double kSteps = 5.0;         // deviations of a stroke's mean, divided by the root of their number
constexpr double kWorthSpread = 0.03;  // of friction
constexpr double kOrdered = 0.9;       // rank correlation of speed with time
constexpr double kSpeedsDiffer = 2.0;  // fastest stroke over slowest one

/// Mean of one stroke.
struct Stroke {
  int record = 0;
  double t = 0.0, speed = 0.0, extra = 0.0;  ///< middle [s], mean [m/s], friction beyond the model [N]
  double sign = 1.0;
  double rows = 0.0;
};

std::vector<Stroke> strokes_of(const Rows& rows) {
  std::vector<Stroke> all;
  int now = -1;
  for (const Row& r : rows.rows) {
    if (r.stretch != now || all.empty()) {
      all.push_back({r.record, 0.0, 0.0, 0.0, r.sign, 0.0});
      now = r.stretch;
    }
    Stroke& s = all.back();
    s.t += r.t, s.speed += std::abs(r.v), s.extra += r.sign * r.e, s.rows += 1.0;
  }
  std::erase_if(all, [](const Stroke& s) { return s.rows < kFewestInStroke; });
  for (Stroke& s : all) s.t /= s.rows, s.speed /= s.rows, s.extra /= s.rows;
  return all;
}

/// What is left of the strokes' means, without that of each direction, which is a load.
void without_load(std::vector<Stroke>& strokes) {
  double sum[2] = {0.0, 0.0}, n[2] = {0.0, 0.0};
  for (const Stroke& s : strokes) sum[s.sign > 0.0 ? 0 : 1] += s.extra, n[s.sign > 0.0 ? 0 : 1] += 1.0;
  for (Stroke& s : strokes) s.extra -= sum[s.sign > 0.0 ? 0 : 1] / n[s.sign > 0.0 ? 0 : 1];
}

/// Sum of squares about a straight line over a course of time, one value for each stroke.
double about_line(const std::vector<Stroke>& s, const std::vector<double>& course) {
  const auto n = static_cast<double>(s.size());
  double t = 0.0, y = 0.0, tt = 0.0, ty = 0.0, yy = 0.0;
  for (std::size_t k = 0; k < s.size(); ++k) t += course[k], y += s[k].extra;
  t /= n, y /= n;
  for (std::size_t k = 0; k < s.size(); ++k) {
    const double dt = course[k] - t, dy = s[k].extra - y;
    tt += dt * dt, ty += dt * dy, yy += dy * dy;
  }
  return tt > 0.0 ? yy - ty * ty / tt : yy;
}

/// The least about time itself, and about an end that is approached: what warms up is quick at first.
double about_drift(const std::vector<Stroke>& s) {
  std::vector<double> course;
  for (const Stroke& k : s) course.push_back(k.t);
  const double begin = course.front(), span = course.back() - begin;
  double least = about_line(s, course);
  for (const double share : {0.05, 0.1, 0.2, 0.4}) {
    for (std::size_t k = 0; k < s.size(); ++k) course[k] = std::exp(-(s[k].t - begin) / (share * span));
    if (span > 0.0) least = std::min(least, about_line(s, course));
  }
  return least;
}

void find_step(std::vector<Stroke> s, const Rows& rows, Diagnosis& out) {
  if (s.size() < kFewestStrokes) return;
  without_load(s);
  double all = 0.0;
  for (const Stroke& k : s) all += k.extra;
  double before = 0.0, best = 0.0;
  std::size_t at = 0;
  const auto n = static_cast<double>(s.size());
  for (std::size_t i = 1; i < s.size(); ++i) {
    before += s[i - 1].extra;
    const double a = static_cast<double>(i), b = n - a;
    if (a < 2.0 || b < 2.0) continue;
    const double gain = std::pow(before / a - (all - before) / b, 2.0) * a * b / n;
    if (gain > best) best = gain, at = i;
  }
  if (at == 0) return;
  double square = 0.0;
  for (const Stroke& k : s) square += std::pow(k.extra - all / n, 2.0);
  const double left = square - best;
  const double a = static_cast<double>(at), b = n - a;
  const double step = std::sqrt(best * n / (a * b));
  const double deviation = std::sqrt(std::max(left, 0.0) / (n - 2.0) * n / (a * b));
  if (step < kWorthStep * rows.friction || step < kSteps * deviation ||
      left > kBetterThanDrift * about_drift(s))
    return;
  double first = 0.0;
  for (std::size_t i = 0; i < at; ++i) first += s[i].extra;
  const bool rose = first / a < (all - first) / b;
  out.warnings.push_back(fmt::format(
      "friction {} suddenly by {} ({} % of it) at {:.4g} s of {}: no warming up; something changed (lubrication, a clamp, a cover, the load): identify the parts before and after as logs of their own",
      rose ? "rose" : "fell", rows.shown().force(step), digits(100.0 * step / rows.friction, 2),
      0.5 * (s[at - 1].t + s[at].t), rows.records[static_cast<std::size_t>(s[at].record)]->source));
}

std::vector<double> ranks(const std::vector<double>& y) {
  std::vector<std::size_t> order(y.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return y[a] < y[b]; });
  std::vector<double> rank(y.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
  return rank;
}

/// Every speed once, from slow to fast or back: what changes in time looks like friction over speed.
void find_order(const std::vector<Stroke>& s, Diagnosis& out) {
  if (s.size() < kFewestStrokes) return;
  std::vector<double> speed;
  for (const Stroke& k : s) speed.push_back(k.speed);
  const auto [low, high] = std::minmax_element(speed.begin(), speed.end());
  if (!(*high > kSpeedsDiffer * *low)) return;
  const std::vector<double> r = ranks(speed);
  const double mean = 0.5 * (static_cast<double>(r.size()) - 1.0);
  double xy = 0.0, xx = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double x = static_cast<double>(i) - mean;
    xy += x * (r[i] - mean), xx += x * x;
  }
  if (std::abs(xy / xx) < kOrdered) return;
  out.cannot_tell.push_back(fmt::format(
      "whether friction changed during the log (warming up): the speeds were run in order, {}, each in one go, so that a change in time is taken for friction over speed; run them in mixed order, or the first ones again at the end",
      xy > 0.0 ? "from slow to fast" : "from fast to slow"));
}

/// Friction of each log beside the mean of all.
void compare_logs(const std::vector<Stroke>& strokes, const Rows& rows, Diagnosis& out) {
  std::map<std::string, std::vector<double>> by_log;
  std::vector<std::string> order;
  for (const Stroke& s : strokes) {
    const std::string& source = rows.records[static_cast<std::size_t>(s.record)]->source;
    auto& list = by_log[source];
    if (list.empty()) order.push_back(source);
    list.push_back(s.extra);
  }
  if (order.size() < 2) return;
  std::string words;
  double least = kInfinity, most = -kInfinity, noise = 0.0;
  for (const std::string& source : order) {
    const std::vector<double>& list = by_log[source];
    const auto n = static_cast<double>(list.size());
    const double mean = std::accumulate(list.begin(), list.end(), 0.0) / n;
    double square = 0.0;
    for (const double y : list) square += (y - mean) * (y - mean);
    if (n >= 2.0) noise = std::max(noise, std::sqrt(square / (n - 1.0) / n));
    least = std::min(least, mean), most = std::max(most, mean);
    words += fmt::format("{}{} {:+.2g} %", words.empty() ? "" : ", ", source, 100.0 * mean / rows.friction);
  }
  if (most - least < kWorthSpread * rows.friction || most - least < 4.0 * noise) return;
  out.warnings.push_back(fmt::format(
      "the logs differ in friction by {} ({}): other days, temperatures or loads; the result is their mean and its intervals do not hold for each of them",
      rows.shown().force(most - least), words));
}

}  // namespace

void find_changes(const Rows& rows, Diagnosis& out) {
  const std::vector<Stroke> strokes = strokes_of(rows);
  std::map<int, std::vector<Stroke>> by_record;
  for (const Stroke& s : strokes) by_record[s.record].push_back(s);
  for (const auto& [record, list] : by_record) find_step(list, rows, out);
  find_order(strokes, out);
  compare_logs(strokes, rows, out);
}

}  // namespace stribeck::ident::residual
