// Single wild values of the force to which the motion does not answer.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log::parts {
namespace {

constexpr std::size_t kBefore = 2;  // rows in which the motion may answer
constexpr std::size_t kAfter = 10;
constexpr double kWild = 10.0;  // times what 93 % of the samples stand off their neighbours
constexpr double kShareOfRange = 0.75;
constexpr double kWildZero = 5.0;  // the same for exact zeros
constexpr std::size_t kFewestZeros = 3;
constexpr std::size_t kFewestRows = 200;  // that show what is usual

double off(const std::vector<double>& f, std::size_t k) { return f[k] - 0.5 * (f[k - 1] + f[k + 1]); }

double bend(const std::vector<double>& x, std::size_t k) {
  return std::abs(x[k + 1] - 2.0 * x[k] + x[k - 1]);
}

/// Rows in which the axis moves; a log may be one of an axis that stands most of the time, with a force that is quiet then.
std::vector<std::vector<std::uint8_t>> moving_rows(const std::vector<Table>& tables) {
  constexpr std::size_t kReach = 20;  // rows on either side
  constexpr double kMoves = 5.0;      // times the usual second difference
  std::vector<double> bends;
  for (const Table& m : tables) {
    for (std::size_t k = 1; k + 1 < m.rows(); ++k) bends.push_back(bend(m.x, k));
  }
  const double least = bends.empty() ? 0.0 : kMoves * stats::thinned_quantile(bends, 0.5);
  std::vector<std::vector<std::uint8_t>> out;
  for (const Table& m : tables) {
    std::vector<std::uint8_t>& moves = out.emplace_back(m.rows(), std::uint8_t{0});
    for (std::size_t k = kReach; k + kReach < m.rows(); ++k)
      moves[k] = std::abs(m.x[k + kReach] - m.x[k - kReach]) > least ? 1 : 0;
  }
  return out;
}

struct Limits {
  double off = 0.0;   ///< of the force
  double zero = 0.0;  ///< of the neighbours of a value of exactly zero, which is a lost one
  double bend = 0.0;  ///< second difference of the position that is usual
};

Limits limits_of(const std::vector<Table>& tables) {
  std::vector<double> offs;
  std::vector<double> bends;
  std::vector<double> all;
  std::vector<std::vector<std::uint8_t>> counts = moving_rows(tables);
  std::size_t rows = 0, moving = 0;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    rows += tables[i].rows();
    moving += static_cast<std::size_t>(std::count(counts[i].begin(), counts[i].end(), std::uint8_t{1}));
  }
  if (moving < kFewestRows) {
    for (auto& count : counts) std::fill(count.begin(), count.end(), std::uint8_t{1});
    moving = rows;
  }
  const std::size_t stride = std::max<std::size_t>(1, moving / 40000);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Table& m = tables[i];
    for (std::size_t k = 1; k + 1 < m.rows(); k += stride) {
      if (counts[i][k] == 0) continue;
      all.push_back(m.f[k]);
      offs.push_back(std::abs(off(m.f, k)));
      bends.push_back(bend(m.x, k));
    }
  }
  if (offs.size() < kFewestRows) return {};
  const double range = stats::quantile(all, 0.98) - stats::quantile(all, 0.02);
  const double usual = stats::quantile(std::move(offs), 0.93);
  return {std::max(kWild * usual, kShareOfRange * range), kWildZero * usual,
          stats::quantile(std::move(bends), 0.99)};
}

/// A single row of exactly zero between neighbours of one sign that are clear of it: a value that the bus or the logger lost.
bool is_lost(const Table& m, std::size_t k, const Limits& limits) {
  if (m.f[k] != 0.0) return false;
  const auto [least, most] = std::minmax(m.f[k - 1], m.f[k + 1]);
  return least > limits.zero || most < -limits.zero;
}

/// None where there are so few that they may be chance.
std::vector<std::pair<Table*, std::size_t>> lost_values(std::vector<Table>& tables, const Limits& limits) {
  std::vector<std::pair<Table*, std::size_t>> found;
  for (Table& m : tables) {
    for (std::size_t k = 1; k + 1 < m.rows(); ++k) {
      if (is_lost(m, k, limits)) found.emplace_back(&m, k);
    }
  }
  if (found.size() < kFewestZeros) found.clear();
  return found;
}

/// The acceleration around row k is one that often occurs.
bool motion_is_even(const Table& m, std::size_t k, double usual) {
  const std::size_t first = k > kBefore ? k - kBefore : 1;
  const std::size_t last = std::min(k + kAfter, m.rows() - 2);
  for (std::size_t i = std::max<std::size_t>(1, first); i <= last; ++i) {
    if (bend(m.x, i) > 1.5 * usual) return false;
  }
  return true;
}

}  // namespace

void mend_force_spikes(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("spike") || tables.front().x.empty()) return;
  const Limits limits = limits_of(tables);
  if (!(limits.off > 0.0) || !(limits.bend > 0.0)) return;
  std::size_t rows = 0;
  std::vector<std::pair<Table*, std::size_t>> found = lost_values(tables, limits);
  const bool zeros = !found.empty();
  for (Table& m : tables) {
    rows += m.rows();
    for (std::size_t k = 1; k + 1 < m.rows(); ++k) {
      if (zeros && is_lost(m, k, limits)) continue;
      const double height = off(m.f, k);
      if (std::abs(height) <= limits.off) continue;
      if (std::abs(m.f[k + 1] - m.f[k - 1]) > 0.3 * std::abs(height)) continue;
      if (motion_is_even(m, k, limits.bend)) found.emplace_back(&m, k);
    }
  }
  if (found.empty() || found.size() * 50 > rows) return;
  const auto [table, row] = found.front();
  const double value = table->f[row];
  for (const auto& [m, k] : found) {
    m->f[k] = 0.5 * (m->f[k - 1] + m->f[k + 1]);
    m->mark[k] |= kRepairedRow;
  }
  notes.add("spike", *table, row, true,
            fmt::format("the force is {:.6g} between neighbours of {:.6g}, and the motion does not answer: "
                        "disturbed{}; replaced by its neighbours",
                        value, table->f[row],
                        found.size() > 1 ? fmt::format(", the first of {} such samples", found.size()) : ""),
            {value, table->f[row], static_cast<double>(found.size())});
}

}  // namespace stribeck::ident::log::parts
