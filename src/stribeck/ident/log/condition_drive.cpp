// A drive that is switched off at an end of the log, and a force at the end of its range.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/motion.hpp>
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
    for (std::size_t k = 1; k <= m.rows(); ++k) {
      if (k < m.rows() && m.f[k] == m.f[begin]) continue;
      const std::size_t run = k - begin;
      const double f = m.f[begin];
      if (f == low || f == high) {
        const std::size_t side = f == high ? 1 : 0;
        at[side] += run > 1 ? run : 0;
        longest[side] = std::max(longest[side], run);
        if (run > 2 && where[side].table == nullptr) where[side] = {&m, begin};
      } else {
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
