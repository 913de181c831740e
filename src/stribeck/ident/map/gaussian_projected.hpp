#pragma once
/// Least squares of a branch in which heights and straight line are eliminated (gaussian_fit.hpp): residuals and
/// derivatives depend on centres and widths alone.
///
///   p = (p_b1, p_c1, p_b2, …)      b and ln c are mapped from all real numbers into their bounds
///
/// Inside ident only. Real time: no.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/map/gaussian_fit.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <vector>

namespace stribeck::ident::map {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

// Centres may lie beyond the end of the range (Table 2.3 has one at 1.47 of it): the value at the border is held there.
inline constexpr double kHighestCentre = 1.7;
inline constexpr double kWidest = 2.0;
/// Largest slope of the straight line, as a share of the smallest friction divided by its speed.
inline constexpr double kMostViscous = 0.6;

inline constexpr int kMostTerms = 6;

/// Maps the bounds (lo, hi) to all real numbers and back.
inline double into(double p, double lo, double hi) { return lo + (hi - lo) / (1.0 + std::exp(-p)); }
inline double out_of(double x, double lo, double hi) {
  const double s = std::clamp((x - lo) / (hi - lo), 1e-6, 1.0 - 1e-6);
  return std::log(s / (1.0 - s));
}
inline double slope(double p, double lo, double hi) {
  const double s = 1.0 / (1.0 + std::exp(-p));
  return (hi - lo) * s * (1.0 - s);
}

/// Least squares with heights and straight line eliminated.
class Projected {
 public:
  Projected(const Bins& bins, int terms, const FitSettings& settings)
      : terms_(terms), settings_(settings), rows_(static_cast<Index>(bins.size())) {
    u_ = Eigen::Map<const VectorXd>(bins.u.data(), rows_);
    root_ = Eigen::Map<const VectorXd>(bins.weight.data(), rows_).cwiseSqrt() / settings.noise;
    // Rows below those of the bins: one for each pull, terms first, then η1 and η0.
    pulls_ = terms > 0 ? terms + 2 : 0;
    y_ = VectorXd::Zero(rows_ + pulls_);
    y_.head(rows_) = Eigen::Map<const VectorXd>(bins.force.data(), rows_).cwiseProduct(root_);
    design_ = MatrixXd::Zero(rows_ + pulls_, 2 + terms);
    design_.col(0).head(rows_) = root_;
    design_.col(1).head(rows_) = root_.cwiseProduct(u_);
    for (int i = 0; i < terms; ++i) design_(rows_ + i, 2 + i) = 1.0 / settings.height_scale;
    if (terms > 0) {
      const VectorXd line = stats::least_squares(design_.topLeftCorner(rows_, 2), y_.head(rows_)).x;
      double viscous = std::max(0.0, line(1));
      for (std::size_t k = 0; k < bins.size(); ++k)
        viscous = std::min(viscous, kMostViscous * bins.force[k] / bins.u[k]);
      design_(rows_ + terms, 1) = 1.0 / settings.slope_scale;
      y_(rows_ + terms) = viscous / settings.slope_scale;
      design_(rows_ + terms + 1, 0) = 1.0 / settings.slope_scale;
      y_(rows_ + terms + 1) = line(0) / settings.slope_scale;
    }
    prepare();
  }

  [[nodiscard]] int residuals() const { return static_cast<int>(rows_) + pulls_; }

  [[nodiscard]] int parameters() const { return 2 * terms_; }

  [[nodiscard]] double low_centre() const { return settings_.lowest_centre; }
  [[nodiscard]] double low_width() const { return std::log(settings_.narrowest); }
  [[nodiscard]] static double high_width() { return std::log(kWidest); }

  bool operator()(const double* p, double* residuals, double* jacobian) const {
    evaluate(p);
    Eigen::Map<VectorXd>(residuals, residual_.size()) = residual_;
    if (jacobian == nullptr) return true;
    Eigen::Map<MatrixXd> j(jacobian, residual_.size(), 2 * terms_);
    for (int i = 0; i < terms_; ++i) {
      const double c = width_[i];
      auto by_centre = j.col(2 * i), by_width = j.col(2 * i + 1);
      by_centre.tail(pulls_).setZero();
      by_width.tail(pulls_).setZero();
      const double by = -2.0 * linear_(2 + i) / c * slope(p[2 * i], low_centre(), kHighestCentre);
      by_centre.head(rows_).array() =
          by / c * design_.col(2 + i).head(rows_).array() * (u_.array() - centre_[i]);
      // c = exp(q): ∂c/∂q = c.
      const double ratio =
          slope(p[2 * i + 1], low_width(), high_width()) / slope(p[2 * i], low_centre(), kHighestCentre);
      by_width.head(rows_).array() = ratio * by_centre.head(rows_).array() * (u_.array() - centre_[i]);
      // Column by column: Eigen's general product first packs its operands, which costs more than these few columns.
      for (Index k = 0; k < thin_.cols(); ++k) {
        by_centre -= thin_.col(k).dot(by_centre) * thin_.col(k);
        by_width -= thin_.col(k).dot(by_width) * thin_.col(k);
      }
    }
    return true;
  }

  [[nodiscard]] BranchFit result(const double* p) const {
    evaluate(p);
    BranchFit fit;
    fit.eta0 = linear_(0);
    fit.eta1 = linear_(1);
    for (int i = 0; i < terms_; ++i) fit.terms.push_back({linear_(2 + i), centre_[i], width_[i]});
    fit.cost = residual_.head(rows_).squaredNorm() * settings_.noise * settings_.noise;
    return fit;
  }

  /// Reduction of the cost by a further term of this centre and width.
  [[nodiscard]] double gain(double centre, double width, const VectorXd& residual) const {
    VectorXd g = VectorXd::Zero(rows_ + pulls_);
    g.head(rows_) = column(centre, width);
    g -= thin_ * (thin_.transpose() * g).eval();
    const double along = g.dot(residual);
    const double pull = 1.0 / (settings_.height_scale * settings_.height_scale);
    return along * along / (g.squaredNorm() + pull);
  }
  [[nodiscard]] const VectorXd& residual(const double* p) const {
    evaluate(p);
    return residual_;
  }

 private:
  [[nodiscard]] VectorXd column(double centre, double width) const {
    return (root_.array() * (-((u_.array() - centre) / width).square()).exp()).matrix();
  }
  void evaluate(const double* p) const {
    // The solver asks for derivatives at the point whose residuals it has just asked for.
    if (fresh_ && std::equal(p, p + 2 * terms_, at_)) return;
    fresh_ = true;
    std::copy(p, p + 2 * terms_, at_);
    for (int i = 0; i < terms_; ++i) {
      centre_[i] = into(p[2 * i], low_centre(), kHighestCentre);
      width_[i] = std::exp(into(p[2 * i + 1], low_width(), high_width()));
      design_.col(2 + i).head(rows_) = column(centre_[i], width_[i]);
    }
    // Modified Gram–Schmidt: the pulls keep the columns independent enough, and it takes a fifth of the time of Householder's
    // form for so few columns. The first two columns never change.
    const Index n = design_.cols();
    for (Index j = kFixed; j < n; ++j) {
      thin_.col(j) = design_.col(j);
      for (Index i = 0; i < j; ++i) {
        const double along = thin_.col(i).dot(thin_.col(j));
        upper_(i, j) = along;
        thin_.col(j) -= along * thin_.col(i);
      }
      upper_(j, j) = thin_.col(j).norm();
      thin_.col(j) /= upper_(j, j);
    }
    residual_ = y_;
    for (Index j = 0; j < n; ++j) {
      linear_(j) = thin_.col(j).dot(residual_);
      residual_ -= linear_(j) * thin_.col(j);
    }
    for (Index j = n - 1; j >= 0; --j) {
      linear_(j) /= upper_(j, j);
      for (Index i = 0; i < j; ++i) linear_(i) -= upper_(i, j) * linear_(j);
    }
  }
  /// The orthogonal form of the columns that do not change.
  void prepare() {
    linear_.resize(design_.cols());
    thin_ = design_;
    upper_ = MatrixXd::Zero(design_.cols(), design_.cols());
    upper_(0, 0) = thin_.col(0).norm();
    thin_.col(0) /= upper_(0, 0);
    upper_(0, 1) = thin_.col(0).dot(thin_.col(1));
    thin_.col(1) -= upper_(0, 1) * thin_.col(0);
    upper_(1, 1) = thin_.col(1).norm();
    thin_.col(1) /= upper_(1, 1);
  }

  static constexpr Index kFixed = 2;
  int terms_;
  int pulls_ = 0;
  FitSettings settings_;
  Index rows_;
  VectorXd u_, root_, y_;
  mutable MatrixXd design_, thin_, upper_;
  mutable VectorXd linear_, residual_;
  mutable bool fresh_ = false;
  mutable double at_[2 * kMostTerms] = {};
  mutable double centre_[kMostTerms] = {};
  mutable double width_[kMostTerms] = {};
};

}  // namespace stribeck::ident::map
