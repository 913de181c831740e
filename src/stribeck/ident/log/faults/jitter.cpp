// Time stamps that jitter, as those that a computer gives to rows when they arrive.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

constexpr std::size_t kStepsLookedAt = 50000;
constexpr std::size_t kRowsAround = 21;  // rows, either way
constexpr double kNoneMissing =
    0.5;  // steps by which the stamps behind a row go on later, at most, if none is missing

/// By how many steps the stamps from row k on are later than those before it.
double later_from(const std::vector<double>& t, double step, std::size_t k) {
  const auto expected = [&](std::size_t from, std::size_t to) {
    std::vector<double> at;
    for (std::size_t i = from; i < to; ++i)
      at.push_back(t[i] / step + static_cast<double>(k) - static_cast<double>(i));
    return stats::median(std::move(at));
  };
  return expected(k, std::min(t.size(), k + kRowsAround)) - expected(k - std::min(k, kRowsAround), k);
}

/// Share of the deviation of the stamps from even ones that the motion shows. With d the deviation [rows], in second differences:
///
///   x[k+1] − 2·x[k] + x[k−1] = β·ẋ[k]·(d[k+1] − 2·d[k] + d[k−1]) + …        β = 0 even, β = 1 taken at the stamps
///
/// `number`: of each row, where some are missing between them.
bool rows_are_even(const Table& m, const std::vector<double>& number, double step) {
  constexpr double kCertain = 0.15;  // two standard errors of β
  constexpr std::size_t kClear = 5;  // rows
  const std::vector<double>& y = m.motion();
  double uy = 0.0, uu = 0.0, yy = 0.0, rows = 0.0;
  for (std::size_t k = 1; k + 1 < m.rows(); ++k) {
    // Near a missing row, whose place may be off by some.
    const std::size_t from = k - std::min(k, kClear), to = std::min(m.rows() - 1, k + kClear);
    if (number[to] - number[from] != static_cast<double>(to - from)) continue;
    const double bend = (m.t[k + 1] - m.t[k]) - (m.t[k] - m.t[k - 1]);
    const double u = 0.5 * (y[k + 1] - y[k - 1]) * bend / step;
    const double seen = (y[k + 1] - y[k]) - (y[k] - y[k - 1]);
    uy += u * seen, uu += u * u, yy += seen * seen, rows += 1.0;
  }
  if (!(uu > 0.0)) return false;
  const double share = uy / uu;
  const double left = std::max(0.0, yy - share * uy) / rows;
  return share < 0.5 && 2.0 * std::sqrt(left / uu) < kCertain;
}

/// The same for rows of which none is missing.
bool rows_are_even(const Table& m, double step) {
  std::vector<double> number(m.rows());
  std::iota(number.begin(), number.end(), 0.0);
  return rows_are_even(m, number, step);
}

/// Stamps that a computer gives to rows when they arrive may come in the wrong order by a part of a step. Where all of them jitter, such a
/// stamp is put right behind the one before; one among stamps that are even is an error and stays.
void put_in_order(Table& m) {
  constexpr double kMostBack = 0.5;  // steps
  constexpr double kBehind = 1e-3;   // steps
  bool any = false;
  for (std::size_t k = 1; k < m.rows(); ++k) any = any || m.t[k] < m.t[k - 1];
  if (!any) return;
  const double T = median_step(m.t);
  if (!(T > 0.0) || usual_jitter(m.t, T) < kLeastJitter) return;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] < m.t[k - 1] && m.t[k - 1] - m.t[k] < kMostBack * T) m.t[k] = m.t[k - 1] + kBehind * T;
  }
}

/// A row that is missing moves all stamps behind it by a step, jitter does not: where the stamps behind go on as those before, a late one is
/// put back to where no gap begins.
void put_late_back(Table& m, double T) {
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (!(m.t[k] - m.t[k - 1] > kGap * T) || !(later_from(m.t, T, k) < kNoneMissing)) continue;
    m.t[k] = std::max(std::nextafter(m.t[k - 1], m.t[k]), m.t[k - 1] + 0.99 * kGap * T);
  }
}

/// Where a row is missing, among these: at the step of the position that is much longer than those beside it; else, as at rest, at the
/// longest step of the stamps.
std::size_t missing_before(const std::vector<double>& y, const std::vector<double>& t, std::size_t from,
                           std::size_t to) {
  constexpr double kTwice = 1.5;  // of the steps beside it
  std::size_t by_time = from, by_motion = from;
  double longest = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    if (t[i] - t[i - 1] > t[by_time] - t[by_time - 1]) by_time = i;
    if (i < 2 || i + 1 >= y.size()) continue;
    const double beside = 0.5 * (std::abs(y[i - 1] - y[i - 2]) + std::abs(y[i + 1] - y[i]));
    const double share = beside > 0.0 ? std::abs(y[i] - y[i - 1]) / beside : 0.0;
    if (share > longest) longest = share, by_motion = i;
  }
  return longest > kTwice ? by_motion : by_time;
}

/// Number of each row, counted with those that are missing before it.
std::vector<double> numbered(const Table& m, double T) {
  constexpr double kLonger = 1.15;     // steps, of a row behind a missing one
  constexpr std::size_t kNearby = 16;  // rows
  const std::vector<double>&t = m.t, &y = m.motion();
  std::vector<double> missing(t.size(),
                              0.0);  // before each row; rows not yet looked at count as the last one that was
  double now = 0.0;
  const auto later = [&](std::size_t k) {
    std::vector<double> before, behind;
    for (std::size_t i = k - std::min(k, kRowsAround); i < k; ++i)
      before.push_back(t[i] / T - static_cast<double>(i) - missing[i]);
    for (std::size_t i = k; i < std::min(t.size(), k + kRowsAround); ++i)
      behind.push_back(t[i] / T - static_cast<double>(i) - now);
    return stats::median(std::move(behind)) - stats::median(std::move(before));
  };
  for (std::size_t k = 1, next = 1; k < t.size(); ++k) {
    missing[k] = now;
    if (!(t[k] - t[k - 1] > kLonger * T) || !(later(k) >= kNoneMissing)) continue;
    const std::size_t at =
        missing_before(y, t, std::max(next, k - std::min(k, kNearby)), std::min(t.size(), k + kNearby));
    for (std::size_t i = k; i < at; ++i) missing[i] = now;
    const double rows = std::max(1.0, std::round(later(std::max(at, k))));
    now += rows;
    // Where a missing row was placed some rows too late, those between must not be taken for another one.
    const std::size_t on = std::min(t.size() - 1, std::max(at, k) + kRowsAround / 2);
    for (std::size_t i = at; i <= on; ++i) missing[i] = now;
    k = on;
    next = at + 1;
  }
  for (std::size_t k = 0; k < t.size(); ++k) missing[k] += static_cast<double>(k);
  return missing;
}

/// Gives the rows the times of their numbers, where some are missing and the others were taken evenly.
bool restamp_by_number(Table& m, double T, Notes& notes) {
  constexpr double kMostMissing = 0.1;  // of the rows
  constexpr double kMostOff = 1.0;      // rows, of nearly all stamps
  const std::vector<double> number = numbered(m, T);
  const auto rows = static_cast<double>(m.rows());
  const double missing = number.back() - (rows - 1.0);
  if (missing < 1.0 || missing > kMostMissing * rows || !rows_are_even(m, number, T)) return false;
  const auto middle = [&](std::size_t from) {
    std::vector<double> of;
    for (std::size_t i = from; i < from + kRowsAround; ++i) of.push_back(m.t[i] - T * number[i]);
    return stats::median(std::move(of));
  };
  const std::size_t last = m.rows() - kRowsAround;
  const double begin = middle(0);
  const double step = T + (middle(last) - begin) / std::max(1.0, number[last] - number[0]);
  std::vector<double> off;
  for (std::size_t k = 0; k < m.rows(); ++k) off.push_back(std::abs(m.t[k] - begin - step * number[k]));
  const double worst = *std::max_element(off.begin(), off.end());
  if (!(stats::thinned_quantile(std::move(off), 0.99) < kMostOff * step) || !notes.wanted("jitter"))
    return false;
  for (std::size_t k = 0; k < m.rows(); ++k) m.t[k] = begin + step * number[k];
  notes.add(
      "jitter", m, 0, true,
      fmt::format(
          "the time stamps jitter by up to {:.3g} % of a step, but the motion is that of equally spaced rows, of which {:.0f} are "
          "missing: rows of {:.6g} s assumed",
          100.0 * worst / step, missing, step),
      {worst / step, missing});
  return true;
}

}  // namespace

double usual_jitter(const std::vector<double>& t, double step) {
  std::vector<double> off;
  const std::size_t stride = std::max<std::size_t>(1, t.size() / kStepsLookedAt);
  for (std::size_t k = 1; k < t.size(); k += stride) off.push_back(std::abs((t[k] - t[k - 1]) / step - 1.0));
  return stats::thinned_quantile(std::move(off), 0.9);
}

double largest_off_line(const std::vector<double>& t) {
  const double T = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  double worst = 0.0;
  for (std::size_t k = 0; k < t.size(); ++k)
    worst = std::max(worst, std::abs(t[k] - t.front() - T * static_cast<double>(k)));
  return worst;
}

bool taken_evenly(const Table& part) {
  constexpr double kMostOff = 1.0;  // rows: beyond it rows may be missing
  const double T = (part.t.back() - part.t.front()) / static_cast<double>(part.rows() - 1);
  if (part.rows() < kFewestRows || largest_off_line(part.t) > kMostOff * T) return false;
  return rows_are_even(part, T);
}

void mend_jittering_stamps(Table& m, Notes& notes) {
  put_in_order(m);
  if (m.rows() < 4 * kRowsAround) return;
  const double T = median_step(m.t);
  if (!(T > 0.0) || !(usual_jitter(m.t, T) > kLeastJitter)) return;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] < m.t[k - 1]) return;
  }
  if (restamp_by_number(m, T, notes) || !notes.wanted("jitter")) return;
  // Rows that were taken at their stamps keep them, late ones too.
  if (rows_are_even(m, T)) put_late_back(m, T);
}

}  // namespace stribeck::ident::log::parts
