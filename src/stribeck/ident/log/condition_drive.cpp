// A drive that is switched off at an end of the log, and a force at the end of its range.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log::parts {
namespace {

double mean_of(const std::vector<double>& y, std::size_t first, std::size_t last) {
  double sum = 0.0;
  for (std::size_t k = first; k < last; ++k) sum += y[k];
  return sum / static_cast<double>(last - first);
}

/// Number of rows at the end with the drive switched off; 0: none.
std::size_t rows_without_drive(const std::vector<double>& x, const std::vector<double>& f, double& level,
                               double& rest) {
  const std::size_t n = x.size();
  const std::vector<double> some = sample_of(x, 20000);
  const double play = 20.0 * std::max(quantum(some), position_noise(some));
  std::size_t first = n;
  while (first > 0 && std::abs(x[first - 1] - x[n - 1]) <= play) --first;
  const std::size_t rows = n - first;
  constexpr std::size_t kShortest = 40;
  if (rows < kShortest || first == 0) return 0;
  const std::size_t tenth = rows / 10;
  rest = mean_of(f, n - tenth, n);
  // The hold level is the median of the part before the force leaves it.
  std::size_t last = n;
  double largest = 0.0;
  for (std::size_t k = first + tenth; k < n; ++k) largest = std::max(largest, std::abs(f[k] - rest));
  while (last > first && std::abs(f[last - 1] - rest) < 0.8 * largest) --last;
  if (last < first + tenth + 8 || n - last < kShortest / 4) return 0;
  level = stats::thinned_quantile(
      {f.begin() + static_cast<std::ptrdiff_t>(first + tenth), f.begin() + static_cast<std::ptrdiff_t>(last)},
      0.5);
  double spread = 0.0;
  for (std::size_t k = first + tenth; k < last; ++k) spread = std::max(spread, std::abs(f[k] - level));
  if (std::abs(rest) > 0.1 * std::abs(level) || spread > 0.3 * std::abs(level)) return 0;
  std::size_t down = last;
  while (down < n && std::abs(f[down] - rest) > 0.2 * std::abs(level - rest)) ++down;
  if ((down - last) * 3 > n - last) return 0;  // the force decreases slowly: a controller is active
  while (last > first && std::abs(f[last - 1] - level) > spread * 0.7) --last;
  return n - last;
}

}  // namespace

bool quiet(const std::vector<double>& column) {
  const std::vector<double> f = sample_of(column, 20000);
  std::vector<double> second;
  for (std::size_t k = 1; k + 1 < f.size(); ++k) second.push_back(std::abs(f[k + 1] - 2.0 * f[k] + f[k - 1]));
  const auto [low, high] = std::minmax_element(f.begin(), f.end());
  return stats::thinned_quantile(std::move(second), 0.75) < 1e-3 * (*high - *low);
}

void cut_drive_off(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("drive-off")) return;
  for (Table& m : tables) {
    if (m.rows() < kFewestRows || quiet(m.f)) continue;
    double level = 0.0;
    double rest = 0.0;
    const std::size_t end = rows_without_drive(m.x, m.f, level, rest);
    if (end > 0) {
      const std::size_t k = m.rows() - end;
      notes.add_range(
          "drive-off", m, k, m.rows() - 1, true,
          fmt::format(
              "at standstill the force falls from {:.4g} to {:.3g} and stays there: the drive is off or a brake holds; rows cut off",
              level, rest),
          {m.t[k], level, rest});
      const bool gap = m.gap_before;
      m = slice(m, 0, k);
      m.gap_before = gap;
    }
    // The start is handled as the end of the log read backwards.
    if (m.rows() < kFewestRows ||
        std::abs(m.f.front()) > 0.3 * stats::thinned_quantile(stats::magnitudes(sample_of(m.f, 2000)), 0.9))
      continue;
    const std::vector<double> x(m.x.rbegin(), m.x.rend());
    const std::vector<double> f(m.f.rbegin(), m.f.rend());
    const std::size_t begin = rows_without_drive(x, f, level, rest);
    if (begin > 0) {
      notes.add_range(
          "drive-off", m, 0, begin - 1, true,
          fmt::format(
              "at standstill the force is {:.3g} and then rises to {:.4g}: the drive is not yet on, or nothing is asked of it; rows cut off",
              rest, level),
          {m.t[begin - 1], level, rest});
      const bool gap = m.gap_before;
      m = slice(m, begin, m.rows());
      m.gap_before = gap;
    }
  }
}

namespace {

/// Rows [first, last) in which the force is exactly 0, though the axis sets out from rest and moves on: nothing of the drive moves it.
struct NoForce {
  std::size_t first = 0, last = 0;
};

std::vector<NoForce> moved_without_force(const Table& m) {
  constexpr double kShortest = 0.1;       // [s]
  constexpr std::size_t kFewestRun = 20;  // rows
  constexpr double kFromRest = 0.25;      // share of the way that the first fifth of the rows goes at most
  const std::vector<double> some = sample_of(m.motion(), 20000);
  const double play = 20.0 * std::max(quantum(some), position_noise(some));
  std::vector<NoForce> out;
  for (std::size_t k = 0; k < m.rows();) {
    std::size_t end = k;
    while (end < m.rows() && m.f[end] == 0.0) ++end;
    const std::size_t rows = end - k;
    if (rows >= kFewestRun && static_cast<double>(rows) * m.sample_time >= kShortest) {
      const double before = k > rows / 5 ? std::abs(m.x[k] - m.x[k - rows / 5]) : 0.0;
      const double way = std::abs(m.x[end - 1] - m.x[k]);
      if (way > play && before < kFromRest * way / 5.0) out.push_back({k, end});
    }
    k = std::max(end, k + 1);
  }
  return out;
}

}  // namespace

void cut_moved_without_drive(std::vector<Table>& tables, Notes& notes) {
  constexpr double kMostZero = 0.2;  // of the rows: more is a programme with pauses
  if (!notes.wanted("drive-off")) return;
  const std::string source = tables.empty() ? std::string() : tables.front().source;
  std::vector<Table> out;
  for (Table& m : tables) {
    const auto zeros = static_cast<double>(std::count(m.f.begin(), m.f.end(), 0.0));
    std::vector<NoForce> runs;
    if (!m.x.empty() && m.rows() >= kFewestRows && !quiet(m.f) &&
        zeros < kMostZero * static_cast<double>(m.rows()))
      runs = moved_without_force(m);
    if (runs.empty()) {
      out.push_back(std::move(m));
      continue;
    }
    std::size_t from = 0;
    const auto keep = [&](std::size_t to) {
      if (to < from + kFewestRows) return;
      out.push_back(slice(m, from, to));
      out.back().gap_before = m.gap_before || from > 0;
    };
    for (const NoForce& run : runs) {
      notes.add_range(
          "drive-off", m, run.first, run.last - 1, true,
          fmt::format(
              "the force is exactly 0 while the axis sets out and moves by {}: the drive is off, and somebody or a load moves the "
              "axis; rows cut off",
              notes.travel(std::abs(m.x[run.last - 1] - m.x[run.first]))),
          {m.t[run.first], m.t[run.last - 1]});
      keep(run.first);
      from = run.last;
    }
    keep(m.rows());
  }
  if (out.empty() && !tables.empty())
    throw Refused(fmt::format(
        "{}: the rows in which the force is exactly 0 while the axis moves leave no stretch of {} rows (switch the drive on and record "
        "again; or keep these rows with --keep drive-off)",
        source, kFewestRows));
  tables = std::move(out);
}

void find_saturation(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("saturated")) return;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Table& m : tables) {
    for (const double f : m.f) {
      low = std::min(low, f);
      high = std::max(high, f);
    }
  }
  if (!(low < high)) return;
  std::size_t longest_elsewhere = 1;
  std::size_t longest[2] = {0, 0};
  std::size_t at[2] = {0, 0};
  struct Place {
    Table* table = nullptr;
    std::size_t row = 0;
  } where[2];
  for (Table& m : tables) {
    std::size_t begin = 0;
    // An axis that sticks keeps the value of its force, which says nothing of one that is cut off. A programmed force keeps it in motion too.
    const bool any_run = m.x.empty() || quiet(m.f);
    const std::vector<double> some = sample_of(m.x, 20000);
    const double play = any_run ? 0.0 : 20.0 * std::max(quantum(some), position_noise(some));
    for (std::size_t k = 1; k <= m.rows(); ++k) {
      if (k < m.rows() && m.f[k] == m.f[begin]) continue;
      const std::size_t run = k - begin;
      const double f = m.f[begin];
      if (f == low || f == high) {
        const std::size_t side = f == high ? 1 : 0;
        at[side] += run > 1 ? run : 0;
        longest[side] = std::max(longest[side], run);
        if (run > 2 && where[side].table == nullptr) where[side] = {&m, begin};
      } else if (any_run || std::abs(m.x[k - 1] - m.x[begin]) > play) {
        longest_elsewhere = std::max(longest_elsewhere, run);
      }
      begin = k;
    }
  }
  for (const std::size_t side : {0, 1}) {
    // The constant stretches of a programmed force are no longer at its maximum than elsewhere.
    if (longest[side] < 6 || longest[side] < 3 * longest_elsewhere) continue;
    const double value = side == 1 ? high : low;
    notes.add(
        "saturated", *where[side].table, where[side].row, false,
        fmt::format(
            "the force is at its {} value {:.4g} in {} rows, up to {} in a row: the drive was at its "
            "limit (then this is the force) or the channel is cut off (then the result is biased); rows "
            "marked",
            side == 1 ? "largest" : "smallest", value, at[side], longest[side]),
        {value, static_cast<double>(at[side])});
    for (Table& m : tables) {
      for (std::size_t k = 0; k < m.rows(); ++k) {
        if (m.f[k] == value) m.mark[k] |= kAtLimit;
      }
    }
  }
}

}  // namespace stribeck::ident::log::parts
