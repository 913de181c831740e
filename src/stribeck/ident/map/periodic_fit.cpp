#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/periodic_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::map::periodic {

double damping(const Data& data, const Group& g, double f) {
  constexpr double kLeast = 0.2;  // less is more of the low-pass than of the force
  const double mean = std::max(0.0, 1.0 - 0.5 * std::pow(2.0 * kPi * f, 2.0) * g.spread);
  if (data.passed == nullptr) return mean;
  const double passed = data.passed(g.blur * f);
  return passed < kLeast ? 0.0 : mean * passed;
}

namespace {

/// Weighted sine and cosine of a term, not projected.
void waves(const Data& data, const Line& line, Eigen::Ref<MatrixXd> out) {
  for (std::size_t i = 0; i < data.groups.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const Group& g = data.groups[i];
    const double angle = 2.0 * kPi * line.f * (g.x - data.middle);
    const double w = data.root(k) * damping(data, g, line.f) * (line.form == kReversing ? g.sign : 1.0);
    const double s = std::sin(angle),
                 c = std::cos(angle);  // of one value: the compiler asks for both at once
    out(k, 0) = w * s;
    out(k, 1) = w * c;
  }
}

/// ∂/∂f of a term, projected, from its waves.
void slope_of(const Data& data, const Line& line, const Eigen::Ref<const MatrixXd>& waves,
              Eigen::Ref<VectorXd> out) {
  for (std::size_t i = 0; i < data.groups.size(); ++i) {
    const auto k = static_cast<Index>(i);
    out(k) = 2.0 * kPi * (data.groups[i].x - data.middle) * (line.a * waves(k, 1) - line.b * waves(k, 0));
  }
  project(data, out);
}

/// Gauss–Newton step of the periods. X: sines and cosines, then slopes; `gram` that of the first.
VectorXd slope_step(const MatrixXd& X, const MatrixXd& gram, const std::vector<Line>& lines,
                    const VectorXd& e) {
  const Index first = gram.rows(), count = X.cols() - first;
  MatrixXd all(X.cols(), X.cols());
  all.topLeftCorner(first, first) = gram;
  all.bottomRows(count) = stats::cross(X.rightCols(count), X);
  hold_exact(lines, all, first, 1);
  return stats::solve_ldlt(all, X.transpose() * e).tail(count);
}

}  // namespace

void columns(const Data& data, const Line& line, Eigen::Ref<MatrixXd> out, bool slope) {
  waves(data, line, out.leftCols(2));
  if (slope) slope_of(data, line, out.leftCols(2), out.col(2));
  for (Index j = 0; j < 2; ++j) project(data, out.col(j));
}

void hold_exact(const std::vector<Line>& lines, MatrixXd& gram, Index first, Index stride) {
  for (std::size_t j = 0; j < lines.size(); ++j) {
    if (!lines[j].exact) continue;
    const Index k = first + static_cast<Index>(j) * stride;
    gram.row(k).setZero();
    gram.col(k).setZero();
    gram(k, k) = 1.0;
  }
}

bool refine(const Data& data, double tolerance, std::vector<Line>& lines, VectorXd& e) {
  const auto n = static_cast<Index>(data.groups.size());
  const auto count = static_cast<Index>(lines.size());
  e = data.e;
  if (lines.empty()) return true;
  constexpr int kIterations = 12;
  MatrixXd X(n, 3 * count), plain(n, 2 * count);  // sines and cosines of all terms, then their slopes
  const bool exact = std::all_of(lines.begin(), lines.end(), [](const Line& line) { return line.exact; });
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    // First the amplitudes at these periods, then one step of the periods.
    for (Index j = 0; j < count; ++j)
      waves(data, lines[static_cast<std::size_t>(j)], plain.middleCols(2 * j, 2));
    auto B = X.leftCols(2 * count);
    B = plain;
    for (Index i = 0; i < 2 * count; ++i) project(data, B.col(i));
    const MatrixXd gram = stats::cross(B, B);
    const VectorXd theta = stats::solve_ldlt(gram, B.transpose() * data.e);
    if (!theta.allFinite()) return false;
    for (Index j = 0; j < count; ++j) {
      lines[static_cast<std::size_t>(j)].a = theta(2 * j);
      lines[static_cast<std::size_t>(j)].b = theta(2 * j + 1);
    }
    e = data.e;
    e.noalias() -= B * theta;
    if (iteration == kIterations || exact) break;
    for (Index j = 0; j < count; ++j)
      slope_of(data, lines[static_cast<std::size_t>(j)], plain.middleCols(2 * j, 2), X.col(2 * count + j));
    const VectorXd step = slope_step(X, gram, lines, e);
    if (!step.allFinite()) return false;
    double largest = 0.0;
    for (Index j = 0; j < count; ++j) {
      Line& line = lines[static_cast<std::size_t>(j)];
      if (line.exact) continue;
      const double limit = 0.2 / data.length;
      const double d = std::clamp(step(j), -limit, limit);
      line.f += d;
      largest = std::max(largest, std::abs(d) * data.length);
      if (std::abs(line.f - line.start) > 1.0 / data.length || !(line.f > 0.0)) return false;
    }
    if (largest < tolerance) break;
  }
  return true;
}

}  // namespace stribeck::ident::map::periodic
