#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/methods/position_map_parts.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::methods::position_map {
namespace {

constexpr int kTerms = 4;
/// The rise towards standstill must lie within this share of the largest speed.
constexpr double kFastestRise = 0.35;
constexpr int kRiseSteps = 24;
constexpr double kWeakInstrument = 0.1;

/// A function of position, through the same window and means as all columns.
template <class Function>
VectorXd of_position(const Rows& rows, Function&& function) {
  std::vector<std::vector<double>> columns;
  for (std::size_t r = 0; r < rows.motions.size(); ++r) {
    std::vector<double> c((*rows.records)[r].x.size());
    for (std::size_t k = 0; k < c.size(); ++k) c[k] = function((*rows.records)[r].x[k] - rows.middle);
    columns.push_back(log::smooth_like(rows.motions[r], c));
  }
  return rows.mean_of(columns);
}

VectorXd signed_as(const Rows& rows, const Term& term, VectorXd column) {
  return term.reversing ? VectorXd(column.cwiseProduct(rows.s)) : column;
}

VectorXd rise_column(const Rows& rows, double v0) {
  return rows.s.array() * (-(rows.v.array() / v0).square()).exp();
}

/// Least squares by scaled normal equations.
VectorXd normal(const MatrixXd& X, const VectorXd& y) {
  const VectorXd scale = X.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
  const MatrixXd gram = scale.asDiagonal() * stats::gram(X) * scale.asDiagonal();
  return scale.asDiagonal() * stats::solve_shortest(gram, scale.asDiagonal() * (X.transpose() * y));
}

/// First stage: replaces the measured acceleration by its projection on the instrument and the other columns.
void project_acceleration(const Rows& rows, Fit& fit) {
  MatrixXd Z = fit.X;
  Z.col(0) = rows.instrument;
  const VectorXd c = normal(Z, rows.a);
  const VectorXd projected = Z * c;
  VectorXd rest = fit.X.rightCols(fit.X.cols() - 1) * normal(fit.X.rightCols(fit.X.cols() - 1), rows.a);
  const double own = (rows.a - rest).squaredNorm();
  fit.weak = !((projected - rest).squaredNorm() > kWeakInstrument * own);
  if (!fit.weak) fit.W.col(0) = projected;
}

void take_amplitudes(const Fit& fit, std::vector<Term>& terms) {
  for (std::size_t j = 0; j < terms.size(); ++j) {
    terms[j].a = fit.theta(fit.term(j));
    terms[j].b = fit.theta(fit.term(j) + 1);
  }
}

}  // namespace

VectorXd rise_slope(const Rows& rows, double v0) {
  return rise_column(rows, v0).array() * 2.0 * rows.v.array().square() / (v0 * v0 * v0);
}

VectorXd term_slope(const Rows& rows, const Term& term) {
  const double w = 2.0 * kPi * term.f;
  return signed_as(rows, term, of_position(rows, [&](double u) {
                     return 2.0 * kPi * u * (term.a * std::cos(w * u) - term.b * std::sin(w * u));
                   }));
}

Fit solve(const Rows& rows, const Shape& shape, const Nonlinear& nonlinear) {
  Fit fit;
  fit.shape = shape;
  const std::size_t terms = shape.periodic ? nonlinear.terms.size() : 0;
  const Index p = fit.term(terms);
  MatrixXd& X = fit.X;
  X.resize(rows.y.size(), p);
  if (shape.mass) X.col(0) = rows.a;
  X.col(fit.coulomb()) = rows.s;
  X.col(fit.viscous()) = rows.v;
  if (shape.load) X.col(fit.load()).setOnes();
  if (shape.asymmetric) X.col(fit.asymmetric()) = rows.v.cwiseAbs();
  if (shape.rise) X.col(fit.rise()) = rise_column(rows, nonlinear.v0);
  for (std::size_t j = 0; j < terms; ++j) {
    const double w = 2.0 * kPi * nonlinear.terms[j].f;
    X.col(fit.term(j)) =
        signed_as(rows, nonlinear.terms[j], of_position(rows, [&](double u) { return std::sin(w * u); }));
    X.col(fit.term(j) + 1) =
        signed_as(rows, nonlinear.terms[j], of_position(rows, [&](double u) { return std::cos(w * u); }));
  }
  fit.W = X;
  if (shape.mass) project_acceleration(rows, fit);
  fit.theta = normal(fit.W, rows.y);
  fit.e = rows.y - X * fit.theta;
  return fit;
}

double find_rise(const Rows& rows, const Shape& shape, const Nonlinear& nonlinear) {
  const double low = std::log(1.2 * rows.slowest);
  const double high = std::log(kFastestRise * rows.top);
  if (!(high > low)) return nonlinear.v0;
  const auto cost = [&](double at, const MatrixXd& Q, const VectorXd& e) {
    // This column alone, against the residual of the others.
    const VectorXd c = rise_column(rows, std::exp(at));
    const VectorXd own = c - Q * (Q.transpose() * c);
    const double power = own.squaredNorm();
    if (!(power > 1e-9 * c.squaredNorm())) return 0.0;
    return -std::pow(own.dot(e), 2.0) / power;
  };
  Shape others = shape;
  others.rise = false;
  const Fit fit = solve(rows, others, nonlinear);
  const MatrixXd Q = stats::orthonormal_columns(fit.X);
  const VectorXd e = rows.y - Q * (Q.transpose() * rows.y);
  double best = low;
  double least = std::numeric_limits<double>::infinity();
  const double step = (high - low) / kRiseSteps;
  for (int i = 0; i <= kRiseSteps; ++i) {
    const double c = cost(low + i * step, Q, e);
    if (c < least) least = c, best = low + i * step;
  }
  double left = std::max(low, best - step);
  double right = std::min(high, best + step);
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 24; ++i) {
    const double a = right - kGolden * (right - left);
    const double b = left + kGolden * (right - left);
    (cost(a, Q, e) < cost(b, Q, e) ? right : left) = cost(a, Q, e) < cost(b, Q, e) ? b : a;
  }
  return std::exp(0.5 * (left + right));
}

map::PeriodicResult search(const Rows& rows, const Fit& fit, const PositionMapOptions& given) {
  // The part of the terms found before is added back.
  VectorXd e = fit.e;
  if (fit.shape.periodic) {
    for (std::size_t j = 0; j < fit.terms(); ++j)
      e += fit.X.middleCols(fit.term(j), 2) * fit.theta.segment(fit.term(j), 2);
  }
  map::PeriodicRows left;
  left.shown = Shown(rows.records->front());
  for (std::size_t i = 0; i < rows.groups.size(); ++i) {
    left.x.push_back(rows.x(static_cast<Index>(i)));
    left.e.push_back(e(static_cast<Index>(i)));
    left.direction.push_back(rows.groups[i].sign > 0.0 ? 1 : -1);
    left.record.push_back(rows.groups[i].record);
    left.at.push_back(rows.groups[i].first);
  }
  map::PeriodicOptions options;
  options.most = given.most_terms.value_or(kTerms);
  options.turn = given.turn.value_or(0.0);
  return map::find_periodic(left, options);
}

Fit refine(const Rows& rows, const Shape& shape, bool exact, Nonlinear& nonlinear) {
  Fit fit = solve(rows, shape, nonlinear);
  if (!shape.periodic) return fit;
  for (int iteration = 0; iteration < 8; ++iteration) {
    take_amplitudes(fit, nonlinear.terms);
    if (exact) break;
    MatrixXd X(fit.W.rows(), fit.W.cols() + static_cast<Index>(nonlinear.terms.size()));
    X.leftCols(fit.W.cols()) = fit.W;
    for (std::size_t j = 0; j < nonlinear.terms.size(); ++j)
      X.col(fit.W.cols() + static_cast<Index>(j)) = term_slope(rows, nonlinear.terms[j]);
    const VectorXd step = normal(X, fit.e).tail(static_cast<Index>(nonlinear.terms.size()));
    double largest = 0.0;
    for (std::size_t j = 0; j < nonlinear.terms.size(); ++j) {
      const double d = std::clamp(step(static_cast<Index>(j)), -0.1 / rows.length, 0.1 / rows.length);
      nonlinear.terms[j].f += d;
      largest = std::max(largest, std::abs(d) * rows.length);
    }
    fit = solve(rows, shape, nonlinear);
    if (largest < 1e-7) break;
  }
  take_amplitudes(fit, nonlinear.terms);
  return fit;
}

}  // namespace stribeck::ident::methods::position_map
