#pragma once
/// Least squares of one branch of the Gaussian-augmented map on bins of velocity.
///
///   min Σ w_k·(F_k − η0 − η1·u_k − Σ a_i·exp(−((u_k − b_i)/c_i)²))²
///
///   u = |v|/v_max in (0, 1], F against the motion [N], w rows of the bin
///
/// The force depends on v alone, so bins lose nothing and cost a hundredth of the rows. η0, η1, a_i are
/// eliminated (variable projection, Kaufman's Jacobian); b_i, c_i are found by Levenberg–Marquardt
/// (ceres::TinySolver) inside bounds. Every number of terms gets starts of two kinds, the same in every run:
/// a term added to the best smaller fit where, over a grid of centres and widths, it explains most; and
/// centres and widths spread over the range. Most are given up after a few steps; the best are finished.
///
/// η0 and η1 are held near the straight line through the bins, since wide terms can take their part: without
/// that, η0 or F − η1·v may leave the sign of the motion. A weak pull of the heights to zero keeps cancelling
/// terms of thousands of newtons out; its share of the cost is below the noise.
///
/// Source: Golub, Pereyra 1973, doi:10.1137/0710036; Kaufman 1975, doi:10.1007/BF01932995.
/// Not modelled: bounds on the heights.
/// Real time: no.

#include <cstddef>
#include <vector>

namespace stribeck::ident {

/// Means over bins, in the direction of motion: u ascending in (0, 1], force positive against the motion.
struct Bins {
  std::vector<double> u;       ///< [-]
  std::vector<double> force;   ///< [N]
  std::vector<double> weight;  ///< number of rows

  [[nodiscard]] std::size_t size() const noexcept { return u.size(); }
};

struct FitTerm {
  double a = 0.0;  ///< [N]
  double b = 0.0;  ///< [-]
  double c = 1.0;  ///< [-]
};

struct BranchFit {
  double eta0 = 0.0;  ///< [N]
  double eta1 = 0.0;  ///< [N] per unit of u
  std::vector<FitTerm> terms;
  double cost = 0.0;  ///< Σ w·residual² [N²]

  [[nodiscard]] double force(double u) const noexcept;
  [[nodiscard]] std::size_t parameters() const noexcept { return 2 + 3 * terms.size(); }
  /// ∂force/∂(η0, η1, a1, b1, c1, a2, …).
  void gradient(double u, double* out) const noexcept;
};

struct FitSettings {
  double noise = 1.0;         ///< standard deviation of one row [N]: the unit of the stopping rule
  double height_scale = 1e5;  ///< heights beyond it are pulled back [N]
  double slope_scale = 1e5;   ///< deviations of η0, η1 from the straight line beyond it are pulled back [N]
  int polished = 3;           ///< places that are tried for each added term
  int scattered = 16;         ///< further starts with centres and widths spread over the range
  double narrowest = 0.015;   ///< bound of c [-]
};

/// Fits with 0 … most terms, each started from the one before; element n has n terms. Stops early when the
/// bins do not carry more parameters.
std::vector<BranchFit> fit_ladder(const Bins& bins, int most, const FitSettings& settings);

/// One fit from the terms of `start`, on bins of nearly the same data, joined to about 80: for held-out
/// errors.
BranchFit refine(const Bins& bins, const BranchFit& start, const FitSettings& settings);

}  // namespace stribeck::ident
