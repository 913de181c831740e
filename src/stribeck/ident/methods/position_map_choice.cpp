#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/methods/position_map_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <utility>

namespace stribeck::ident::methods::position_map {
namespace {

constexpr std::size_t kFewestBlocks = 6;

/// Block of each group: its pass; every block is halved until there are six.
std::vector<int> blocks(const Rows& rows) {
  std::vector<int> block(rows.groups.size());
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = rows.groups[i].block;
  std::size_t count = static_cast<std::size_t>(block.back()) + 1;
  while (count < kFewestBlocks) {
    std::vector<std::size_t> size(count, 0);
    for (const int b : block) ++size[static_cast<std::size_t>(b)];
    std::vector<std::size_t> seen(count, 0);
    for (int& b : block) {
      const auto k = static_cast<std::size_t>(b);
      b = 2 * b + (2 * seen[k]++ >= size[k] ? 1 : 0);
    }
    count *= 2;
  }
  return block;
}

/// Mean square residual of each block when the others are fitted.
std::vector<double> held_out(const Rows& all_rows, const Fit& fit, const std::vector<int>& block,
                             std::size_t count) {
  const Index p = fit.X.cols();
  const VectorXd scale = fit.X.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
  struct Sums {
    MatrixXd ww, xx;
    VectorXd wy, xy;
    double yy = 0.0;
    double rows = 0.0;
  };
  const auto empty = [p] {
    return Sums{MatrixXd::Zero(p, p), MatrixXd::Zero(p, p), VectorXd::Zero(p), VectorXd::Zero(p), 0.0, 0.0};
  };
  std::vector<Sums> part(count, empty());
  for (std::size_t first = 0; first < block.size();) {
    std::size_t last = first;
    while (last < block.size() && block[last] == block[first]) ++last;
    Sums& s = part[static_cast<std::size_t>(block[first])];
    const auto from = static_cast<Index>(first);
    const auto rows = static_cast<Index>(last - first);
    const MatrixXd X = fit.X.middleRows(from, rows) * scale.asDiagonal();
    const MatrixXd W = fit.W.middleRows(from, rows) * scale.asDiagonal();
    const auto y = all_rows.y.segment(from, rows);
    s.ww += stats::gram(W);
    s.xx += stats::gram(X);
    s.wy += W.transpose() * y;
    s.xy += X.transpose() * y;
    s.yy += y.squaredNorm();
    s.rows += static_cast<double>(rows);
    first = last;
  }
  Sums all = empty();
  for (const Sums& s : part) all.ww += s.ww, all.wy += s.wy;
  std::vector<double> cost;
  for (const Sums& s : part) {
    const VectorXd theta = stats::solve_shortest(all.ww - s.ww, all.wy - s.wy);
    const double square = s.yy - 2.0 * theta.dot(s.xy) + theta.dot(s.xx * theta);
    cost.push_back(s.rows > 0.0 ? std::max(0.0, square) / s.rows : 0.0);
  }
  return cost;
}

}  // namespace

Shape choose(const Rows& rows, const Shape& full, const Nonlinear& nonlinear, Result& result) {
  struct Tried {
    Shape shape;
    std::vector<double> cost;  // mean square residual of each block
    double mean = 0.0;
    double error = 0.0;
    int parameters = 0;
  };
  const std::vector<int> block = blocks(rows);
  const std::size_t count = static_cast<std::size_t>(*std::max_element(block.begin(), block.end())) + 1;
  std::vector<Tried> tried;
  for (const bool periodic : {false, true}) {
    for (const bool asymmetric : {false, true}) {
      for (const bool rise : {false, true}) {
        if ((periodic && !full.periodic) || (asymmetric && !full.asymmetric)) continue;
        Tried t;
        t.shape = full;
        t.shape.periodic = periodic;
        t.shape.asymmetric = asymmetric;
        t.shape.rise = rise;
        t.parameters = t.shape.count(nonlinear.terms.size());
        t.cost = held_out(rows, solve(rows, t.shape, nonlinear), block, count);
        for (const double c : t.cost) t.mean += c / static_cast<double>(count);
        tried.push_back(std::move(t));
      }
    }
  }
  const auto best = std::min_element(tried.begin(), tried.end(),
                                     [](const Tried& a, const Tried& b) { return a.mean < b.mean; });
  const Tried* chosen = &*best;
  for (Tried& t : tried) {
    double square = 0.0;
    for (std::size_t b = 0; b < count; ++b)
      square += std::pow(t.cost[b] - best->cost[b] - (t.mean - best->mean), 2.0);
    t.error = std::sqrt(square / static_cast<double>(count * (count - 1)));
    if (t.mean - best->mean <= t.error && t.parameters < chosen->parameters) chosen = &t;
  }
  for (const Tried& t : tried) {
    const double rms = std::sqrt(std::max(0.0, t.mean));
    Candidate c;
    c.name = t.shape.name();
    c.terms = t.shape.periodic ? static_cast<int>(nonlinear.terms.size()) : 0;
    c.parameters = t.parameters;
    c.held_out_rms = rms;
    c.standard_error = rms > 0.0 ? t.error / (2.0 * rms) : 0.0;
    c.chosen = &t == chosen;
    result.models.push_back(std::move(c));
    if (&t == chosen) result.held_out_rms = rms;
  }
  return chosen->shape;
}

}  // namespace stribeck::ident::methods::position_map
