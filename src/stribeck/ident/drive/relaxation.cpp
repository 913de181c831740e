#include <cmath>
#include <stribeck/ident/drive/relaxation.hpp>

namespace stribeck::ident::drive {

Relaxation find_relaxation(const std::vector<log::Motion>& motions, const Level& level, double mass,
                           double load, double near) {
  struct Near {
    std::size_t record, at;
    int side;
    double way;  // since the row before, in the direction of motion [m]
    double g;    // [N]
    bool fresh;  // the row before is not in the list
    bool judged;
  };
  std::vector<Near> rows;
  for (std::size_t r = 0; r < motions.size(); ++r) {
    const log::Motion& m = motions[r];
    if (m.reversals.size() < 2) continue;
    const auto reach = static_cast<std::size_t>(m.reach);
    std::size_t last = 0;
    for (std::size_t j = 0; j < m.reversals.size(); ++j) {
      const std::size_t at = m.reversals[j];
      // Before the first movement the state of the bristle is not known.
      if (j == 0) continue;
      std::size_t k = std::max(last + 1, at > 2 * reach ? at - 2 * reach : 1);
      for (; k < m.rows(); ++k) {
        if (k > at && (m.distance[k] > near || m.stretch[k] > m.stretch[at])) break;
        const int side = m.direction[k] > 0 ? 0 : 1;
        const double way =
            m.stretch[k] == m.stretch[k - 1] ? m.distance[k] - m.distance[k - 1] : m.distance[k];
        rows.push_back({r, k, side, way, level(side, std::abs(m.v[k])), k != last + 1 || rows.empty(),
                        m.valid(k) && k >= at});
        last = k;
      }
      for (std::size_t tail = 0; tail < reach && k < m.rows(); ++tail, ++k) {
        const int side = m.direction[k] > 0 ? 0 : 1;
        if (m.stretch[k] != m.stretch[k - 1]) break;
        rows.push_back({r, k, side, m.distance[k] - m.distance[k - 1], level(side, std::abs(m.v[k])),
                        k != last + 1, false});
        last = k;
      }
      if (rows.size() > 40000) break;
    }
  }
  if (rows.size() < 20) return {};
  std::vector<std::vector<double>> weights;
  for (const log::Motion& m : motions) {
    // A row of the window: what one row gives to its neighbours.
    const auto half = static_cast<std::size_t>(m.reach - 1);
    std::vector<double> impulse(std::max<std::size_t>(4 * half + 1, 64), 0.0);
    const std::size_t centre = impulse.size() / 2;
    impulse[centre] = 1.0;
    const std::vector<double> w = log::smooth_like(m, impulse);
    weights.emplace_back(w.begin() + static_cast<std::ptrdiff_t>(centre - half),
                         w.begin() + static_cast<std::ptrdiff_t>(centre + half + 1));
  }
  std::vector<double> model(rows.size());
  auto cost = [&](double sigma0) {
    double force = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Near& p = rows[i];
      const double target = map::kDirection[static_cast<std::size_t>(p.side)] * p.g;
      if (p.fresh) force = target;
      force = target + (force - target) * std::exp(-sigma0 * std::max(0.0, p.way) / p.g);
      model[i] = force;
    }
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Near& p = rows[i];
      if (!p.judged) continue;
      const log::Motion& m = motions[p.record];
      const std::size_t half = weights[p.record].size() / 2;
      if (i < half || i + half >= rows.size() || rows[i - half].at + half != p.at ||
          rows[i + half].at != p.at + half)
        continue;
      const std::vector<double>& w = weights[p.record];
      double smooth = 0.0;
      for (std::size_t j = 0; j < w.size(); ++j) smooth += w[j] * model[i + j - half];
      const double e = m.f[p.at] - load - mass * m.a[p.at] -
                       level.viscous[static_cast<std::size_t>(p.side)] * m.v[p.at] - smooth;
      sum += e * e;
      ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : 0.0;
  };
  const double g = std::max(level(0, 0.0), level(1, 0.0));
  // Relaxation lengths from a thousandth of the pilot distance to a third of it.
  const double lowest = std::log(g / (near / 3.0));
  const double highest = std::log(g / (near / 1000.0));
  constexpr int kCoarse = 12;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  double costs[kCoarse + 1];
  for (int i = 0; i <= kCoarse; ++i) {
    costs[i] = cost(std::exp(lowest + (highest - lowest) * i / kCoarse));
    if (costs[i] < least) least = costs[i], best = i;
  }
  double lo = lowest + (highest - lowest) * std::max(0, best - 1) / kCoarse;
  double hi = lowest + (highest - lowest) * std::min(kCoarse, best + 1) / kCoarse;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double p = hi - golden * (hi - lo), q = lo + golden * (hi - lo);
  double cp = cost(std::exp(p)), cq = cost(std::exp(q));
  while (hi - lo > 0.01) {
    if (cp < cq) {
      hi = q, q = p, cq = cp, p = hi - golden * (hi - lo), cp = cost(std::exp(p));
    } else {
      lo = p, p = q, cp = cq, q = lo + golden * (hi - lo), cq = cost(std::exp(q));
    }
  }
  const double sigma0 = std::exp(0.5 * (lo + hi));
  return {sigma0, g / sigma0};
}

void find_lag(const std::vector<log::Motion>& motions, const Level& level, const Relaxation& relaxation,
              map::Rows& rows) {
  std::size_t i = 0;
  for (std::size_t r = 0; r < motions.size(); ++r) {
    const log::Motion& m = motions[r];
    double force = 0.0;
    bool fresh = true;
    for (std::size_t k = 1; k < m.rows(); ++k) {
      const int side = m.direction[k] > 0 ? 0 : 1;
      const double target = level(side, std::abs(m.v[k]));
      if (m.stretch[k] != m.stretch[k - 1]) {
        // Deflected the other way by the end of the stretch before.
        force = fresh ? target : -force;
      }
      if (fresh) force = target, fresh = false;
      const double way = m.stretch[k] == m.stretch[k - 1] ? m.distance[k] - m.distance[k - 1] : m.distance[k];
      const double y = relaxation.sigma0 * std::max(0.0, way) / target;
      force = target + (force - target) * std::exp(-y);
      if (i < rows.size() && rows.record[i] == static_cast<int>(r) && rows.at[i] == k) {
        rows.lag[i] = map::kDirection[static_cast<std::size_t>(side)] * (force - target);
        ++i;
      }
    }
  }
}

}  // namespace stribeck::ident::drive
