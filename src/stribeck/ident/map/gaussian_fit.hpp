#pragma once
/// Least squares of one branch of the Gaussian-augmented map on bins of velocity.
///
///   min Σ w_k·(F_k − η0 − η1·u_k − Σ a_i·exp(−((u_k − b_i)/c_i)²))²
///
///   u = |v|/v_max in (0, 1], F against the motion [N], w rows of the bin
///
/// The force depends on v alone, so bins lose nothing and cost a hundredth of the rows. η0, η1, a_i are eliminated (variable
/// projection, Kaufman's Jacobian); b_i, c_i are found by Levenberg–Marquardt (ceres::TinySolver) inside bounds. Every number of
/// terms gets starts of two kinds, the same in every run: the best smaller fit with a term added where, over a grid of centres
/// and widths, it explains most; and centres and widths spread over the range. Most starts are given up after a few steps; the
/// best are finished. The search goes on from the best fit to its neighbours: a term, or a pair that nearly cancels, is placed
/// anew where it explains most; dips in a high level are replaced by bells on a low one.
///
/// η0 and η1 are held near the straight line through the bins, because wide terms can take their place: η0 or F − η1·v could
/// then have the wrong sign. A weak pull of the heights to zero prevents terms of thousands of newtons that cancel; its share
/// of the cost is below the noise.
///
/// A fit is kept when it is physical (FitSettings): no centre below the first bin, where nothing was measured and a
/// term would be free to take any value; from rest to the end of the range no more than `most_force`, no term of more than
/// `most_height`, and F − η1·v opposing the motion. The pulls are made firmer until that holds.
///
/// Source: Golub, Pereyra 1973, doi:10.1137/0710036; Kaufman 1975, doi:10.1007/BF01932995.
/// A Stribeck part of exponent 1, a·exp(−u/c), stands beside the terms: fit_centred() fits it too.
/// Not modelled: other exponents.
/// Real time: no.

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace stribeck::ident::map {

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
  bool centred = false;      ///< one term with b = 0, not fitted: a Stribeck part
  double cost = 0.0;         ///< Σ w·residual² [N²]
  bool exponential = false;  ///< the centred term is a·exp(−u/c): a Stribeck part of exponent 1

  [[nodiscard]] double force(double u) const noexcept;
  [[nodiscard]] std::size_t parameters() const noexcept { return 2 + (centred ? 2 : 3 * terms.size()); }
  /// What the choice of a map counts: a Stribeck part of exponent 1 has one more, see static_fit.hpp.
  [[nodiscard]] std::size_t complexity() const noexcept { return parameters() + (exponential ? 1 : 0); }
  /// ∂force/∂(η0, η1, a1, b1, c1, a2, …); centred: ∂force/∂(η0, η1, a1, c1).
  void gradient(double u, double* out) const noexcept;
};

struct FitSettings {
  double noise = 1.0;         ///< standard deviation of one row [N]: the unit of the stopping rule
  double height_scale = 1e5;  ///< heights beyond it are pulled back [N]
  double slope_scale = 1e5;   ///< deviations of η0, η1 from the straight line beyond it are pulled back [N]
  int polished = 3;           ///< number of places tried for each added term
  int scattered = 96;         ///< further starts with centres and widths spread over the range
  bool exchange = true;       ///< terms of the best fit are taken out and set anew until it gets no better
  double narrowest = 0.015;   ///< bound of c [-]
  double lowest_centre = -0.6;  ///< bound of b [-]: the first bin, where a term may not be centred below it
  double most_force = std::numeric_limits<double>::infinity();   ///< of the branch anywhere from rest on [N]
  double most_height = std::numeric_limits<double>::infinity();  ///< of a term within the range [N]
  unsigned first_start = 1;  ///< of the sequence of scattered starts: another number, other starts
};

/// The fit without terms: the straight line.
BranchFit fit_line(const Bins& bins, const FitSettings& settings);

/// One term more than `before`, which is one of the starts. Absent where the bins do not determine more parameters.
/// `also`: a fit of as many terms to nearly the same data, used as one more start.
std::optional<BranchFit> fit_one_more(const Bins& bins, const BranchFit& before, const FitSettings& settings,
                                      const BranchFit* also = nullptr);

/// Fits with 0 … most terms, each started from the one before; element n has n terms.
std::vector<BranchFit> fit_ladder(const Bins& bins, int most, const FitSettings& settings);

/// Exponent of a Stribeck part.
enum class Exponent { kOne = 1, kTwo = 2 };

/// η0 + η1·u + a·exp(−(u/c)^exponent): a Stribeck part that may rise or fall, as narrow as the slowest bins show. Absent where the
/// bins do not determine it.
std::optional<BranchFit> fit_centred(const Bins& bins, const FitSettings& settings, Exponent exponent);

/// Widths of a Stribeck part that are tried, of equal ratio: from what the slowest rows show to a part of the range of speed.
/// Empty where the rows have nearly one speed.
std::vector<double> stribeck_widths(double slowest, double fastest);

/// Parts of a·exp(−u/c), u ≥ 0, as terms around rest: error at most 0.8 % of a, none at rest.
std::vector<FitTerm> as_gaussians(const FitTerm& exponential);

/// Joins neighbouring bins until about `wanted` are left.
Bins joined(const Bins& bins, std::size_t wanted);

}  // namespace stribeck::ident::map
