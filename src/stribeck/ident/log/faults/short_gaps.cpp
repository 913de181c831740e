// A few rows that are missing in the time stamps too: put in again where the motion goes on across the gap.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/faults/faults.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

constexpr double kOffGrid = 0.25;    // of a row, by which a gap may differ from whole rows
constexpr double kMostShare = 0.05;  // of the rows; where more is missing, the record is not bridged
constexpr double kExactGrid =
    0.02;  // of a row, by which stamps may be off whole rows that count them exactly
constexpr double kMostOfGrid = 0.5;      // of the rows, where the stamps count them exactly
constexpr double kLeastOfMissing = 0.5;  // of the travel of the missing rows
constexpr double kResolutions = 4.0;
constexpr double kMostlyTrue = 0.8;  // of the gaps, which the motion must have

/// A gap before row `next`: `steps` rows later than the row before.
struct ShortGap {
  std::size_t next = 0;
  std::size_t steps = 0;
};

/// Whether two rows on either side follow each other without a gap.
bool regular_around(const Table& m, std::size_t next, double T) {
  return m.t[next - 1] - m.t[next - 2] < 1.5 * T && m.t[next + 1] - m.t[next] < 1.5 * T;
}

/// Whether all stamps are whole numbers of rows apart, as where a counter of the control is the time: any number of rows may be missing.
bool counts_rows(const Table& m, double T) {
  for (std::size_t k = 1; k < m.rows(); ++k) {
    const double steps = (m.t[k] - m.t[k - 1]) / T;
    if (!(steps > 0.5) || std::abs(steps - std::round(steps)) > kExactGrid) return false;
  }
  return true;
}

/// Whether the position goes on as if rows were missing. Where only the clock jumped, it takes one step in place of several.
bool motion_goes_on(const Table& m, double T, const ShortGap& gap, double resolution) {
  const std::vector<double>& y = m.x;
  const std::size_t k = gap.next;
  const double before = (y[k - 1] - y[k - 2]) * T / (m.t[k - 1] - m.t[k - 2]);
  const double after = (y[k + 1] - y[k]) * T / (m.t[k + 1] - m.t[k]);
  const auto steps = static_cast<double>(gap.steps);
  const double off = std::abs(y[k] - y[k - 1] - 0.5 * steps * (before + after));
  const double missing = 0.5 * (steps - 1.0) * std::abs(before + after);
  return off <=
         std::max({kLeastOfMissing * missing, steps * std::abs(after - before), kResolutions * resolution});
}

std::vector<ShortGap> short_gaps(const Table& m, double T, bool exact) {
  const double resolution = quantum(m.x);
  std::vector<ShortGap> out;
  std::size_t uneven = 0, on_grid = 0;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    const double steps = (m.t[k] - m.t[k - 1]) / T;
    if (std::abs(steps - 1.0) > kOffGrid) ++uneven;
    if (steps < 1.5 || steps > static_cast<double>(kMostLost) + 1.5) continue;
    const ShortGap gap{k, static_cast<std::size_t>(std::lround(steps))};
    if (std::abs(steps - std::round(steps)) > kOffGrid || k < 2 || k + 1 >= m.rows()) continue;
    if (!exact && !regular_around(m, k, T)) continue;
    ++on_grid;
    if (motion_goes_on(m, T, gap, resolution)) out.push_back(gap);
  }
  // Rows at uneven times, or stamps that are rounded: the gaps are in the stamps, not in the rows.
  const bool regular = exact || static_cast<double>(uneven) <= kMostShare * static_cast<double>(m.rows());
  if (!regular || static_cast<double>(out.size()) < kMostlyTrue * static_cast<double>(on_grid)) out.clear();
  return out;
}

/// Values of one column with the missing ones put in: on a cubic, or on a straight line.
std::vector<double> filled(const std::vector<double>& t, const std::vector<double>& y,
                           const std::vector<ShortGap>& gaps, bool smooth) {
  std::vector<double> out;
  if (y.empty()) return out;
  auto gap = gaps.begin();
  for (std::size_t k = 0; k < y.size(); ++k) {
    if (gap != gaps.end() && gap->next == k) {
      const auto steps = static_cast<double>(gap->steps);
      for (std::size_t i = 1; i < gap->steps; ++i) {
        const auto at = static_cast<double>(i);
        out.push_back(smooth ? on_cubic({t[k - 2], t[k - 1], t[k], t[k + 1]},
                                        {y[k - 2], y[k - 1], y[k], y[k + 1]},
                                        t[k - 1] + (t[k] - t[k - 1]) * at / steps)
                             : y[k - 1] + (y[k] - y[k - 1]) * at / steps);
      }
      ++gap;
    }
    out.push_back(y[k]);
  }
  return out;
}

}  // namespace

double on_cubic(const std::array<double, 4>& t, const std::array<double, 4>& y, double at) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < 4; ++j) {
      if (j != i) weight *= (at - t[j]) / (t[i] - t[j]);
    }
    sum += weight * (y[i] - y[1]);
  }
  return y[1] + sum;
}

void bridge_short_gaps(Table& m, Sampling& sampling, Notes& notes) {
  // Without a position nothing tells lost rows from a pause of the clock.
  if (m.x.empty() || m.rows() < kFewestRows || !notes.wanted("gap")) return;
  const double T = median_step(m.t);
  if (!(T > 0.0)) return;
  const bool exact = counts_rows(m, T);
  const std::vector<ShortGap> gaps = short_gaps(m, T, exact);
  std::size_t missing = 0;
  for (const ShortGap& g : gaps) missing += g.steps - 1;
  const double most = exact ? kMostOfGrid : kMostShare;
  if (missing == 0 || static_cast<double>(missing) > most * static_cast<double>(m.rows())) return;
  notes.add(
      "gap", m, gaps.front().next, true,
      fmt::format(
          "a gap of {:.4g} s before this row (the rows are {:.4g} s apart){}; the missing rows are put in between "
          "their neighbours, and not fitted",
          m.t[gaps.front().next] - m.t[gaps.front().next - 1], T,
          gaps.size() == 1
              ? ""
              : fmt::format(", the first of {} short ones with {} rows in all", gaps.size(), missing)),
      {static_cast<double>(gaps.size()), static_cast<double>(missing)});
  sampling.gaps += gaps.size();
  Table out;
  out.source = m.source;
  out.run = m.run;
  out.gap_before = m.gap_before;
  out.sample_time = m.sample_time;
  out.t = filled(m.t, m.t, gaps, false);
  out.x = filled(m.t, m.x, gaps, true);
  out.r = filled(m.t, m.r, gaps, true);
  out.v = filled(m.t, m.v, gaps, false);
  out.f = filled(m.t, m.f, gaps, false);
  auto gap = gaps.begin();
  for (std::size_t k = 0; k < m.rows(); ++k) {
    if (gap != gaps.end() && gap->next == k) {
      out.row.insert(out.row.end(), gap->steps - 1, m.row[k - 1]);
      out.mark.insert(out.mark.end(), gap->steps - 1, kRepairedRow);
      ++gap;
    }
    out.row.push_back(m.row[k]);
    out.mark.push_back(m.mark[k]);
  }
  m = std::move(out);
}

}  // namespace stribeck::ident::log::parts
