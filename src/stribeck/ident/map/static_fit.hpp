#pragma once
/// Families of steady friction fitted to bins of speed, and the choice among them on held-out motion.
///
///   symmetric           f = load + (α0 + (α1 − α0)·exp(−(v/v0)^δ))·sgn v + α2·v     δ = 2 or 1; with or without the exponential
///   by direction        f = η0± + η1±·v + Σ a_i·exp(−((v − b_i)/c_i)²)              0 … 6 terms, or one with b = 0:
///                                                                                 a Stribeck part, rising or falling,
///                                                                                 of exponent 2 or 1
///
/// In the symmetric family the load is half the sum of both directions. In the family by direction a load cannot be
/// distinguished from friction that differs between the directions; half the sum is taken for it only where a branch would
/// otherwise drive the motion.
///
/// Choice: every candidate is fitted with each block of motion left out in turn, from its own starts, and judged on that
/// block. Of the candidates within one standard error of the best (of paired differences over blocks) the one with the fewest
/// parameters is taken: first the number of terms of each direction, then the family. An exponent of 1 counts as one parameter
/// more, because it rises steeply below the slowest rows: where the log does not tell, 2 is kept. An improvement of less than 1 % of the
/// error does not count, because a programme that repeats itself makes the standard error almost zero; but one by a force of 1 % of
/// friction does, however large the noise is.
///
/// Source: Breiman, Friedman, Olshen, Stone 1984 (one standard error); thesis (2.9), (2.32).
/// Not modelled: exponents between 1 and 2, or beyond, in the Stribeck part.
/// Inside ident only. Real time: no.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <stribeck/ident/map/drive_rows.hpp>
#include <stribeck/ident/map/gaussian_fit.hpp>
#include <stribeck/ident/result.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::ident::map {

/// Friction at rest, of the largest one measured in the direction. Below the slowest rows the Stribeck part goes on rising, by a third
/// of what is seen at most: the level at rest is that of every reversal, and no row speaks against a value that is too high.
constexpr double kMostForce = 1.3;

/// Fastest bin of the slowest one: bins of a narrower range tell a level and a slope, no shape. A ripple of the drive would become one.
constexpr double kShapeRange = 1.5;

/// Sums over the rows of one block of motion, by bin; f against the motion.
struct BlockSums {
  std::vector<double> n, v, f, ff;
};

struct SideSums {
  Grid grid;
  std::vector<BlockSums> block;  ///< sums to fit
  std::vector<BlockSums> held;   ///< sums to judge on; empty: the same
};

struct StaticFit {
  enum class Family { kSymmetric, kSymmetricStribeck, kByDirection };
  Family family = Family::kByDirection;

  double load = 0.0;                   ///< [N]
  double coulomb = 0.0;                ///< α0 [N]
  double viscous = 0.0;                ///< α2 [N·s/m]
  double rise = 0.0;                   ///< α1 − α0 [N]
  double v0 = 1.0;                     ///< [m/s]
  Exponent exponent = Exponent::kTwo;  ///< δ of the symmetric Stribeck part

  std::array<BranchFit, kSides> branch;
  std::array<double, kSides> top{1.0, 1.0};  ///< speed at which u = 1 [m/s]

  /// Force against the motion [N], the load included.
  [[nodiscard]] double force(int side, double speed) const noexcept;
  [[nodiscard]] std::size_t parameters() const noexcept;
  /// What the choice counts: the parameters, and one for each Stribeck part of exponent 1.
  [[nodiscard]] std::size_t complexity() const noexcept;
  /// Index of the first parameter of a side, and their number; other parameters do not change that side.
  [[nodiscard]] std::pair<std::size_t, std::size_t> span(int side) const noexcept;
  /// ∂force/∂parameters of the span. Symmetric: load, α0, α2, rise, v0; by direction: BranchFit's.
  void gradient(int side, double speed, double* out) const noexcept;
  /// Takes a Gauss–Newton step of all parameters; widths and v0 change by no more than half. Returns the largest
  /// change in relation to the level of friction, or to the width.
  double move(const Eigen::VectorXd& step) noexcept;
  /// Whether friction opposes the motion over the whole range.
  [[nodiscard]] bool plausible() const noexcept;
  [[nodiscard]] std::string name() const;
};

/// Points of speed whose weighted forces are the force at rest of a straight line through them, from a fifth of `reach` on: the level of a
/// direction, whatever parameters share its slope.
struct LevelPoint {
  double speed = 0.0;   ///< [m/s]
  double weight = 0.0;  ///< sum 1
};
std::vector<LevelPoint> level_points(double reach);

struct StaticOptions {
  std::optional<int> terms;  ///< Gaussians of each direction; absent: chosen
  int most_terms = 6;
  bool symmetric = true;  ///< try the symmetric families
  bool weighted = false;  ///< a load is known to pull: it is taken out of the family by direction always
};

struct StaticChoice {
  StaticFit fit;
  std::vector<StaticFit> rivals;  ///< fits that predict held-out motion as well
  std::vector<StaticFit> simple;  ///< families of few parameters, fitted to all blocks
  std::vector<Candidate> candidates;
  double held_out_rms = std::numeric_limits<double>::quiet_NaN();  ///< [N]
  std::vector<double> block_loss;  ///< Σ residual² of the chosen fit, by block
  double tested = 0.0;             ///< number of rows that were judged
  double friction = 0.0;           ///< mean over both directions, for pick() [N]
};

/// The simplest within one standard error of the best, of paired differences over blocks, or within what does not count. loss: Σ residual²
/// by candidate and block; friction [N]: its size. Among candidates of as many parameters, which differ in an exponent, the better one where it
/// is better by three standard errors.
struct Picked {
  std::size_t chosen = 0;
  std::vector<char> equal;    ///< within one standard error of the best
  std::vector<double> rms;    ///< [N]
  std::vector<double> error;  ///< standard error of its difference from the best [N]
};
Picked pick(const std::vector<std::vector<double>>& loss, const std::vector<std::size_t>& complexity,
            const std::vector<std::size_t>& parameters, double rows, double friction);

StaticChoice choose_static(const std::array<SideSums, kSides>& sums, const StaticOptions& options);

}  // namespace stribeck::ident::map
