#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/drive/relaxation.hpp>
#include <utility>

namespace stribeck::ident::drive {

namespace {

constexpr std::size_t kMostRows = 40000;  // around reversals: enough for a single number
constexpr std::size_t kFewestRows = 20;
constexpr double kFinest = 0.01;  // resolution of ln σ0

/// A row around a reversal.
struct RowNear {
  std::size_t record, at;
  int side;
  double travel;  // since the row before, in the direction of motion [m]
  double level;   // of friction [N]
  bool fresh;     // the row before is not in the list
  bool judged;
};

/// Rows from a window before each reversal to `near` after it, and one more window that is not judged.
std::vector<RowNear> rows_near_reversals(const std::vector<log::Motion>& motions, const Level& level,
                                         double near) {
  std::vector<RowNear> rows;
  for (std::size_t r = 0; r < motions.size(); ++r) {
    const log::Motion& m = motions[r];
    const auto reach = static_cast<std::size_t>(m.reach);
    std::size_t last = 0;
    const auto add = [&](std::size_t k, double travel, bool fresh, bool judged) {
      const int side = m.direction[k] > 0 ? 0 : 1;
      rows.push_back({r, k, side, travel, level(side, std::abs(m.v[k])), fresh, judged});
      last = k;
    };
    // Before the first movement the state of the bristle is not known.
    for (std::size_t j = 1; j < m.reversals.size(); ++j) {
      const std::size_t at = m.reversals[j];
      std::size_t k = std::max(last + 1, at > 2 * reach ? at - 2 * reach : 1);
      for (; k < m.rows(); ++k) {
        if (k > at && (m.distance[k] > near || m.stretch[k] > m.stretch[at])) break;
        const double travel =
            m.stretch[k] == m.stretch[k - 1] ? m.distance[k] - m.distance[k - 1] : m.distance[k];
        add(k, travel, k != last + 1 || rows.empty(), m.valid(k) && k >= at);
      }
      for (std::size_t tail = 0; tail < reach && k < m.rows(); ++tail, ++k) {
        if (m.stretch[k] != m.stretch[k - 1]) break;
        add(k, m.distance[k] - m.distance[k - 1], k != last + 1, false);
      }
      if (rows.size() > kMostRows) break;
    }
  }
  return rows;
}

/// The window of each record: the weight of a row in its neighbours.
std::vector<std::vector<double>> windows_of(const std::vector<log::Motion>& motions) {
  std::vector<std::vector<double>> out;
  for (const log::Motion& m : motions) {
    const auto half = static_cast<std::size_t>(m.reach - 1);
    std::vector<double> impulse(std::max<std::size_t>(4 * half + 1, 64), 0.0);
    const std::size_t centre = impulse.size() / 2;
    impulse[centre] = 1.0;
    const std::vector<double> w = log::smooth_like(m, impulse);
    out.emplace_back(w.begin() + static_cast<std::ptrdiff_t>(centre - half),
                     w.begin() + static_cast<std::ptrdiff_t>(centre + half + 1));
  }
  return out;
}

/// Mean squared residual around the reversals, over σ0.
class RelaxationCost {
 public:
  RelaxationCost(const std::vector<log::Motion>& motions, const Level& level, double mass, double load,
                 std::vector<RowNear> rows)
      : motions_(motions),
        level_(level),
        mass_(mass),
        load_(load),
        rows_(std::move(rows)),
        windows_(windows_of(motions)),
        friction_(rows_.size()) {}

  double operator()(double sigma0) {
    simulate(sigma0);
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const RowNear& p = rows_[i];
      if (!p.judged) continue;
      const std::vector<double>& w = windows_[p.record];
      const std::size_t half = w.size() / 2;
      if (i < half || i + half >= rows_.size() || rows_[i - half].at + half != p.at ||
          rows_[i + half].at != p.at + half)
        continue;
      double smooth = 0.0;
      for (std::size_t j = 0; j < w.size(); ++j) smooth += w[j] * friction_[i + j - half];
      const log::Motion& m = motions_[p.record];
      const double e = m.f[p.at] - load_ - mass_ * m.a[p.at] -
                       level_.viscous[static_cast<std::size_t>(p.side)] * m.v[p.at] - smooth;
      sum += e * e;
      ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::infinity();
  }

 private:
  void simulate(double sigma0) {
    double force = 0.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const RowNear& p = rows_[i];
      const double target = map::kDirection[static_cast<std::size_t>(p.side)] * p.level;
      if (p.fresh) force = target;
      force = target + (force - target) * std::exp(-sigma0 * std::max(0.0, p.travel) / p.level);
      friction_[i] = force;
    }
  }

  const std::vector<log::Motion>& motions_;
  const Level& level_;
  double mass_, load_;
  std::vector<RowNear> rows_;
  std::vector<std::vector<double>> windows_;
  std::vector<double> friction_;  // of each row
};

}  // namespace

Relaxation find_relaxation(const std::vector<log::Motion>& motions, const Level& level, double mass,
                           double load, double near) {
  std::vector<RowNear> rows = rows_near_reversals(motions, level, near);
  if (rows.size() < kFewestRows) return {};
  RelaxationCost cost_of(motions, level, mass, load, std::move(rows));
  const auto cost = [&](double log_sigma0) { return cost_of(std::exp(log_sigma0)); };
  const double g = std::max(level(0, 0.0), level(1, 0.0));
  // Tries relaxation lengths from a thousandth of the first guess to a third of it.
  const double lowest = std::log(g / (near / 3.0));
  const double highest = std::log(g / (near / 1000.0));
  constexpr int kCoarse = 12;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kCoarse; ++i) {
    const double c = cost(lowest + (highest - lowest) * i / kCoarse);
    if (c < least) least = c, best = i;
  }
  double lo = lowest + (highest - lowest) * std::max(0, best - 1) / kCoarse;
  double hi = lowest + (highest - lowest) * std::min(kCoarse, best + 1) / kCoarse;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double p = hi - golden * (hi - lo), q = lo + golden * (hi - lo);
  double cp = cost(p), cq = cost(q);
  while (hi - lo > kFinest) {
    if (cp < cq) {
      hi = q, q = p, cq = cp, p = hi - golden * (hi - lo), cp = cost(p);
    } else {
      lo = p, p = q, cp = cq, q = lo + golden * (hi - lo), cq = cost(q);
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
        // At its beginning the bristle is deflected to the other side by the stretch before.
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
