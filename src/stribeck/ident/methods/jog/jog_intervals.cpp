#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/methods/jog/jog_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::methods::jog {

Spread::Spread(const Fit& fit, const std::vector<Point>& points) {
  const auto n = static_cast<Index>(points.size());
  const auto p = static_cast<Index>(fit.parameters());
  MatrixXd J(n, p);
  double chi = 0.0;
  for (Index i = 0; i < n; ++i) {
    const Point& q = points[static_cast<std::size_t>(i)];
    J.row(i) = fit.gradient(q.v).transpose();
    chi += q.weight * std::pow(q.f - fit(q.v), 2.0);
  }
  VectorXd w(n), variance(n);
  for (Index i = 0; i < n; ++i) {
    const Point& q = points[static_cast<std::size_t>(i)];
    w(i) = q.weight;
    variance(i) = q.weight * q.weight * q.error * q.error;
  }
  scale_ = VectorXd::Ones(p);
  for (Index j = 0; j < p; ++j) {
    const double length = std::sqrt((w.array() * J.col(j).array().square()).sum());
    if (length > 0.0) scale_(j) = 1.0 / length;
  }
  J = J * scale_.asDiagonal();
  const MatrixXd normal = J.transpose() * w.asDiagonal() * J;
  const MatrixXd inverse = stats::pseudo_inverse(normal);
  const double freedom = static_cast<double>(n - p);
  if (freedom >= 1.0) {
    left_ = chi / freedom * inverse;
    factor_ = stats::student_factor(freedom);
  }
  means_ = inverse * J.transpose() * variance.asDiagonal() * J * inverse;
}

double Spread::half_width(const VectorXd& gradient) const {
  const VectorXd g = scale_.asDiagonal() * gradient;
  if (factor_ == 0.0) return std::numeric_limits<double>::quiet_NaN();
  return factor_ * std::sqrt(std::max({0.0, g.dot(left_ * g), g.dot(means_ * g)}));
}

void add_parameters(const Fit& fit, const Spread& spread, Result& r) {
  const auto add = [&](const std::string& name, double value, const char* unit, const char* shown,
                       const VectorXd& g) {
    const double half = spread.half_width(g);
    r.parameters.push_back({name, value, unit, shown, value - half, value + half, half < std::abs(value)});
  };
  const auto n = static_cast<Index>(fit.parameters());
  const auto unit = [&](std::size_t i, double sign_of = 1.0) {
    VectorXd g = VectorXd::Zero(n);
    g(static_cast<Index>(i)) = sign_of;
    return g;
  };
  if (fit.kind.symmetric()) {
    add("alpha0", fit.p[0], "N", "N", unit(0));
    if (fit.kind.family != Family::kLine) {
      add("alpha1", fit.p[0] + fit.p[3], "N", "N", unit(0) + unit(3));
    }
    add("alpha2", fit.p[1], "N s/m", "N s/mm", unit(1));
    if (fit.kind.family != Family::kLine) add("v0", fit.p[4], "m/s", "mm/s", unit(4));
    if (fit.kind.family == Family::kFreeStribeck) add("delta", fit.p[5], "1", "1", unit(5));
    return;
  }
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::string name = side == 0 ? "_positive" : "_negative";
    const double s = side == 0 ? 1.0 : -1.0;
    if (fit.kind.family == Family::kGaussians) {
      const map::BranchFit& b = fit.branch[side];
      const std::size_t at = side == 0 ? 0 : fit.branch[0].parameters();
      add("eta0" + name, s * b.eta0, "N", "N", unit(at, s));
      add("eta1" + name, b.eta1 / fit.top, "N s/m", "N s/mm", unit(at + 1, 1.0 / fit.top));
      for (std::size_t i = 0; i < b.terms.size(); ++i) {
        const std::string term = "gaussian_" + std::to_string(i + 1);
        add(term + "_a" + name, s * b.terms[i].a, "N", "N", unit(at + 2 + 3 * i, s));
        add(term + "_b" + name, s * b.terms[i].b * fit.top, "m/s", "mm/s", unit(at + 3 + 3 * i, s * fit.top));
        add(term + "_c" + name, b.terms[i].c * fit.top, "m/s", "mm/s", unit(at + 4 + 3 * i, fit.top));
      }
      continue;
    }
    add("eta0" + name, s * fit.p[2 * side], "N", "N", unit(2 * side, s));
    add("eta1" + name, fit.p[2 * side + 1], "N s/m", "N s/mm", unit(2 * side + 1));
    if (fit.kind.family == Family::kLines) continue;
    const std::size_t width = fit.kind.family == Family::kCommonStribeck ? 6 : 6 + side;
    add("gaussian_1_a" + name, s * fit.p[4 + side], "N", "N", unit(4 + side, s));
    add("gaussian_1_c" + name, fit.p[width], "m/s", "mm/s", unit(width));
  }
}

}  // namespace stribeck::ident::methods::jog
