// The motion in the log: range, speeds, accelerations, strokes, rows after a reversal.
#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

/// Counts strokes longer than the hysteresis, and the rows soon after each reversal.
void count_strokes(const std::vector<double>& x, double hysteresis, double near, Coverage& c,
                   std::vector<double>& rows_near) {
  std::size_t low = 0;
  std::size_t high = 0;
  int direction = 0;
  std::vector<std::size_t> turns;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (x[k] >= x[high]) high = k;
    if (x[k] <= x[low]) low = k;
    if (direction <= 0 && x[k] - x[low] > hysteresis) {
      if (direction != 0) turns.push_back(low);
      direction = 1;
      high = k;
      ++c.strokes;
    } else if (direction >= 0 && x[high] - x[k] > hysteresis) {
      if (direction != 0) turns.push_back(high);
      direction = -1;
      low = k;
      ++c.strokes;
    }
  }
  c.reversals += turns.size();
  for (const std::size_t turn : turns) {
    std::size_t k = turn;
    while (k < x.size() && std::abs(x[k] - x[turn]) < near) ++k;
    rows_near.push_back(static_cast<double>(k - turn));
  }
}

/// Mean velocities over windows of this time, half a window apart, over all rows of the tables.
std::vector<double> velocities_over(const std::vector<Table>& tables, double window) {
  std::vector<double> out;
  for (const Table& m : tables) {
    if (m.rows() < kFewestRows) continue;
    const auto w = std::max<std::size_t>(2, static_cast<std::size_t>(window / m.sample_time));
    for (std::size_t k = 0; k + w < m.rows(); k += w / 2)
      out.push_back((m.x[k + w] - m.x[k]) / (static_cast<double>(w) * m.sample_time));
  }
  return out;
}

double usual_top(const std::vector<double>& velocities) {
  std::vector<double> speeds;
  for (const double v : velocities) speeds.push_back(std::abs(v));
  return speeds.empty() ? 0.0 : stats::thinned_quantile(std::move(speeds), 0.99);
}

/// The same with windows as long as the position needs to tell a speed that counts as motion, and no longer than a stroke takes.
std::vector<double> window_velocities(const std::vector<Table>& tables, const Sampling& s) {
  constexpr double kShortest = 0.02;        // [s]
  constexpr double kShareOfFastest = 3e-3;  // what counts as motion
  constexpr double kSame = 0.95;            // of the top speed: less, and a window is longer than a stroke
  const double step = 3.0 * std::max(s.x_noise, s.x_quantum_large);
  double window = kShortest;
  std::vector<double> out = velocities_over(tables, window);
  for (int tries = 0; tries < 7 && step / window > kShareOfFastest * usual_top(out); ++tries) {
    window *= 2.0;
    std::vector<double> longer = velocities_over(tables, window);
    if (longer.empty() || usual_top(longer) < kSame * usual_top(out)) break;
    out = std::move(longer);
  }
  return out;
}

/// Replaces velocities, and speeds without their sign, where there are windows.
void take_window_velocities(const std::vector<Table>& tables, const Sampling& s,
                            std::vector<double>& velocities, std::vector<double>& speeds) {
  std::vector<double> means = window_velocities(tables, s);
  if (means.empty()) return;
  velocities = std::move(means);
  speeds.clear();
  for (const double v : velocities) speeds.push_back(std::abs(v));
}

}  // namespace

/// Marks standstill at both ends.
void mark_rest(Table& m, double resolution) {
  const double play = std::max(3.0 * resolution, 1e-12);
  std::size_t last = m.rows();
  while (last > 0 && std::abs(m.x[last - 1] - m.x.back()) <= play) --last;
  std::size_t first = 0;
  while (first < m.rows() && std::abs(m.x[first] - m.x.front()) <= play) ++first;
  if (first >= m.rows()) return;  // the axis never moved: no mark
  for (std::size_t k = 0; k < first; ++k) m.mark[k] |= kAtRest;
  for (std::size_t k = last; k < m.rows(); ++k) m.mark[k] |= kAtRest;
}

Coverage cover(const std::vector<Table>& tables, const Sampling& s, const std::string& unit) {
  Coverage c;
  c.x_min = c.f_min = std::numeric_limits<double>::infinity();
  c.x_max = c.f_max = -c.x_min;
  std::vector<double> speeds;
  std::vector<double> velocities;
  std::vector<double> accelerations;
  std::vector<double> short_of_breakaway;
  const double presliding = turning(unit) ? 1e-3 : 50e-6;
  std::size_t moving = 0;
  std::size_t forward = 0;
  for (const Table& m : tables) {
    for (std::size_t k = 0; k < m.rows(); ++k) {
      c.x_min = std::min(c.x_min, m.x[k]);
      c.x_max = std::max(c.x_max, m.x[k]);
      c.f_min = std::min(c.f_min, m.f[k]);
      c.f_max = std::max(c.f_max, m.f[k]);
    }
  }
  constexpr std::size_t kMost = 40000;
  std::size_t rows = 0;
  bool sampled = false;
  for (const Table& m : tables) rows += m.rows();
  for (const Table& m : tables) {
    if (m.rows() < kFewestRows) continue;
    const auto share =
        static_cast<std::size_t>(static_cast<double>(m.rows()) *
                                 std::min(1.0, static_cast<double>(kMost) / static_cast<double>(rows)));
    Record record;
    record.sample_time = m.sample_time;
    constexpr std::size_t kParts = 8;
    const std::size_t length = std::max(kFewestRows, share / kParts);
    std::vector<std::size_t> firsts{0};
    const bool all = length * kParts >= m.rows();
    if (!all) {
      for (std::size_t i = 1; i < kParts; ++i) firsts.push_back(i * (m.rows() - length) / (kParts - 1));
    }
    sampled = sampled || !all;
    for (const std::size_t first : firsts) {
      const Table part = slice(m, first, all ? m.rows() : first + length);
      record.t = part.t;
      record.x = part.x;
      record.f = part.f;
      record.loop = Loop::kClosed;
      const Motion motion = reconstruct(record);
      for (std::size_t k = 0; k < motion.rows(); ++k) {
        if (!motion.valid(k)) continue;
        velocities.push_back(motion.v[k]);
        speeds.push_back(std::abs(motion.v[k]));
        accelerations.push_back(std::abs(motion.a[k]));
      }
    }
  }
  const double hysteresis = std::max({std::min(20.0 * s.x_noise, 0.05 * (c.x_max - c.x_min)),
                                      3.0 * s.x_quantum_large, 2e-3 * (c.x_max - c.x_min)});
  for (const Table& m : tables) count_strokes(m.x, hysteresis, presliding, c, short_of_breakaway);
  if (speeds.empty()) return c;
  // Eight parts of a long log may miss its fastest strokes, or all that go forward.
  if (sampled) take_window_velocities(tables, s, velocities, speeds);
  c.v_max = std::max(0.0, stats::thinned_quantile(velocities, 0.999));
  c.v_min = std::min(0.0, stats::thinned_quantile(velocities, 0.001));
  c.a_max = stats::thinned_quantile(accelerations, 0.995);
  const double limit = 0.003 * stats::thinned_quantile(speeds, 0.99);
  std::vector<double> sliding;
  for (std::size_t k = 0; k < speeds.size(); ++k) {
    if (speeds[k] <= limit) continue;
    ++moving;
    sliding.push_back(speeds[k]);
    if (velocities[k] > 0.0) ++forward;
  }
  c.slowest = sliding.empty() ? 0.0 : stats::thinned_quantile(sliding, 0.02);
  c.moving = static_cast<double>(moving) / static_cast<double>(speeds.size());
  c.forward = moving > 0 ? static_cast<double>(forward) / static_cast<double>(moving) : 0.0;
  if (!short_of_breakaway.empty())
    c.rows_presliding = static_cast<std::size_t>(stats::thinned_quantile(short_of_breakaway, 0.5));
  return c;
}

}  // namespace stribeck::ident::log::parts
