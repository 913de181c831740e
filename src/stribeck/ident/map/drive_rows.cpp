#include <cmath>
#include <stribeck/ident/map/drive_rows.hpp>

namespace stribeck::ident::map {

void BinCurve::build(const Grid& g, const std::vector<double>& n, const std::vector<double>& sum_v,
                     const std::vector<double>& sum_f) {
  grid = g;
  speed.clear(), force.clear(), weight.clear();
  for (int b = 0; b < g.bins; ++b) {
    const auto i = static_cast<std::size_t>(b);
    if (n[i] <= 0.0) continue;
    speed.push_back(sum_v[i] / n[i]);
    force.push_back(sum_f[i] / n[i]);
    weight.push_back(n[i]);
  }
  next.assign(static_cast<std::size_t>(g.bins), static_cast<int>(speed.size()));
  for (int b = g.bins - 1, i = static_cast<int>(speed.size()); b >= 0; --b) {
    while (i > 0 && speed[static_cast<std::size_t>(i) - 1] > g.left(b)) --i;
    next[static_cast<std::size_t>(b)] = i;
  }
}

BinCurve::Line BinCurve::line() const {
  double n = 0, sv = 0, sf = 0, svv = 0, svf = 0;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    n += weight[i];
    sv += weight[i] * speed[i];
    sf += weight[i] * force[i];
    svv += weight[i] * speed[i] * speed[i];
    svf += weight[i] * speed[i] * force[i];
  }
  const double det = n * svv - sv * sv;
  Line l;
  l.slope = det > 0.0 ? (n * svf - sv * sf) / det : 0.0;
  l.level = (sf - l.slope * sv) / n;
  return l;
}

void Rows::reserve(std::size_t rows) {
  record.reserve(rows), at.reserve(rows), stretch.reserve(rows), side.reserve(rows), bin.reserve(rows);
  lag.reserve(rows);
}
void Rows::clear() { record.clear(), at.clear(), stretch.clear(), side.clear(), bin.clear(), lag.clear(); }

int peaks_of(const BinCurve& p) {
  const std::size_t n = p.speed.size();
  const double slope = p.line().slope;
  double highest = 0.0;
  for (const double f : p.force) highest = std::max(highest, std::abs(f));
  std::vector<double> rest(n);
  const double width = 0.02 * (p.speed.back() - p.speed.front());
  for (std::size_t i = 0; i < n; ++i) {
    double weight = 0, sum = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double d = (p.speed[j] - p.speed[i]) / width;
      if (std::abs(d) > 4.0) continue;
      const double w = p.weight[j] * std::exp(-0.5 * d * d);
      weight += w, sum += w * (p.force[j] - slope * p.speed[j]);
    }
    rest[i] = sum / weight;
  }
  // Of two neighbouring peaks the lower one counts only if it is clearly above the valley between them.
  const double stands_out = 0.01 * highest;
  int peaks = 0;
  double top = rest[0], valley = rest[0];
  bool rising = false;
  for (const double f : rest) {
    if (rising) {
      top = std::max(top, f);
      if (f < top - stands_out) ++peaks, rising = false, valley = f;
    } else {
      valley = std::min(valley, f);
      if (f > valley + stands_out) rising = true, top = f;
    }
  }
  return peaks + (rising ? 1 : 0);
}

}  // namespace stribeck::ident::map
