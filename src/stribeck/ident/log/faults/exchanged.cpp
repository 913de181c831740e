// A position that leads its reference: the two columns are exchanged.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

/// r − x = lag·v + constant, over all rows.
struct Following {
  double lag = 0.0;          ///< time by which the position follows [s]
  double correlation = 0.0;  ///< of following error and speed
};

Following following_of(const std::vector<Table>& tables) {
  double n = 0.0, se = 0.0, sv = 0.0, see = 0.0, svv = 0.0, sev = 0.0;
  for (const Table& m : tables) {
    for (std::size_t k = 1; k + 1 < m.rows(); ++k) {
      const double v = (m.r[k + 1] - m.r[k - 1] + m.x[k + 1] - m.x[k - 1]) / (4.0 * m.sample_time);
      const double e = m.r[k] - m.x[k];
      n += 1.0, se += e, sv += v, see += e * e, svv += v * v, sev += e * v;
    }
  }
  if (n < 100.0) return {};
  const double ee = see - se * se / n, vv = svv - sv * sv / n, ev = sev - se * sv / n;
  if (!(ee > 0.0) || !(vv > 0.0)) return {};
  return {ev / vv, ev / std::sqrt(ee * vv)};
}

double noise_of(const std::vector<Table>& tables, std::vector<double> Table::*column) {
  std::vector<double> noises;
  for (const Table& m : tables) {
    if (m.rows() >= kFewestRows) noises.push_back(position_noise(sample_of(m.*column, 20000)));
  }
  return noises.empty() ? 0.0 : stats::median(std::move(noises));
}

}  // namespace

void mend_exchanged(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("exchanged") || tables.front().r.empty() || tables.front().x.empty()) return;
  const Following f = following_of(tables);
  const double T = tables.front().sample_time;
  // A drive that is fed forward may lead a little; not by rows, and not in proportion to its speed.
  if (f.lag > -1.5 * T || f.correlation > -0.9) return;
  const double x_noise = noise_of(tables, &Table::x);
  const double r_noise = noise_of(tables, &Table::r);
  const bool by_noise = r_noise > 2.0 * x_noise;
  if (!by_noise) {
    notes.add_all(
        "exchanged", tables.front().source, false,
        fmt::format(
            "the position comes {:.4g} ms before its reference, in proportion to the speed: the two "
            "columns may be exchanged; then mass and friction are wrong (give them with --map x=… r=…)",
            -1e3 * f.lag),
        {f.lag});
    return;
  }
  for (Table& m : tables) std::swap(m.x, m.r);
  notes.add_all(
      "exchanged", tables.front().source, true,
      fmt::format("the column of the position comes {:.4g} ms before that of the reference, and only "
                  "the latter has the noise of an encoder: the two were exchanged; changed back",
                  -1e3 * f.lag),
      {f.lag, x_noise, r_noise});
}

}  // namespace stribeck::ident::log::parts
