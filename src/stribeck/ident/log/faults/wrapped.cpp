// Positions that begin again at each turn or at each period of a counter.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log::parts {
namespace {

/// The period and the rows at which a column begins again.
struct Wraps {
  double period = 0.0;
  std::vector<std::size_t> rows;
};

/// Rows with a new value: a held value stands between them.
std::vector<std::size_t> new_rows(const std::vector<double>& y) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < y.size(); ++k) {
    if (k == 0 || y[k] != y[k - 1]) out.push_back(k);
  }
  return out;
}

/// Steps over more than half of the range, each against the motion before and after it, all by the same period.
Wraps find_wraps(const std::vector<double>& y) {
  Wraps none;
  if (y.size() < kFewestRows) return none;
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  const double range = *high - *low;
  const std::vector<std::size_t> rows = new_rows(y);
  if (!(range > 0.0) || rows.size() < kFewestRows) return none;
  const auto step = [&](std::size_t i) { return y[rows[i]] - y[rows[i - 1]]; };
  const auto large = [&](std::size_t i) { return std::abs(step(i)) > 0.5 * range; };
  Wraps found;
  std::vector<double> periods;
  std::size_t against = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (!large(i)) continue;
    found.rows.push_back(rows[i]);
    // An axis at rest on the seam goes to and fro over it.
    const bool alone = i > 1 && i + 1 < rows.size() && !large(i - 1) && !large(i + 1);
    const double usual = alone ? 0.5 * (step(i - 1) + step(i + 1)) : 0.0;
    periods.push_back(std::abs(step(i) - usual));
    if (alone && usual * step(i) < 0.0 && step(i - 1) * step(i + 1) > 0.0) ++against;
  }
  constexpr std::size_t kFewest = 2;
  if (against < kFewest) return none;
  found.period = stats::median(periods);
  const bool same = std::all_of(periods.begin(), periods.end(),
                                [&](double p) { return std::abs(p - found.period) < 0.03 * found.period; });
  return same && found.period > 0.9 * range ? found : none;
}

void unwrap(std::vector<double>& y, const Wraps& wraps) {
  double turns = 0.0;
  std::size_t next = 0;
  double before = y.front();
  for (std::size_t k = 0; k < y.size(); ++k) {
    const double now = y[k];
    if (next < wraps.rows.size() && wraps.rows[next] == k) {
      turns += now < before ? 1.0 : -1.0;
      ++next;
    }
    before = now;
    y[k] = now + turns * wraps.period;
  }
}

}  // namespace

void unwrap_positions(std::vector<RawLog>& runs, Notes& notes) {
  if (!notes.wanted("wrapped")) return;
  constexpr double kTurn = 2.0 * kPi;
  for (RawLog& log : runs) {
    Wraps x = find_wraps(log.x.y);
    if (x.rows.empty()) continue;
    const double turns = std::round(x.period / kTurn);
    if (turning(log.position_unit) && turns > 0.0 && std::abs(x.period - turns * kTurn) < 0.02 * x.period)
      x.period = turns * kTurn;
    unwrap(log.x.y, x);
    Wraps r = find_wraps(log.r.y);
    const bool both = !r.rows.empty() && std::abs(r.period - x.period) < 0.03 * x.period;
    if (both) {
      r.period = x.period;
      unwrap(log.r.y, r);
    }
    notes.add_all(
        "wrapped", log.source, true,
        fmt::format("the position{} again after each {} ({} times): a wrapped count; made "
                    "continuous",
                    both ? " and the reference begin" : " begins", notes.travel(x.period), x.rows.size()),
        {x.period, static_cast<double>(x.rows.size())});
  }
}

}  // namespace stribeck::ident::log::parts
