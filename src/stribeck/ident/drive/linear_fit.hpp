#pragma once
/// The linear terms (mass, periodic terms, shift), with one free friction value in every bin of speed.
///
///   f − lag = Σ θ_j·c_j + F(bin) + e        c: acceleration, sine and cosine of each periodic term, ḟ
///
/// Only deviations from the mean of each bin are used, so friction does not affect the linear terms (Robinson 1988). An instrument
/// (motion.hpp) multiplies in place of the acceleration, and the change of force that the reference asks for in place of ḟ: the
/// noise of both columns would bias the estimate. The mean that remains in each bin is the map without a model.
///
/// A second pass uses the curve of the first fit: it removes the slope within each bin and makes an instrument of a
/// programmed force.
///
/// Inside ident only. Real time: no.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <stribeck/friction/eccentric.hpp>
#include <stribeck/ident/drive/rows.hpp>
#include <stribeck/ident/map/drive_rows.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::drive {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

/// A term periodic in position; it has two columns.
struct PeriodicColumns {
  double period = 1.0;  ///< [m]
  friction::EccentricForm form = friction::EccentricForm::kAdditive;
  Interval period_interval;
  /// The cosine and sine columns of each record, through the window that the force has passed.
  std::vector<std::vector<double>> sine, cosine;
};

/// The linear terms of the model. Columns: acceleration unless the mass is known, periodic terms, shift.
struct Terms {
  std::optional<double> known_mass;  ///< [kg]
  std::vector<PeriodicColumns> periodic;
  bool shift = false;

  [[nodiscard]] std::size_t first_periodic() const noexcept { return known_mass ? 0 : 1; }
  [[nodiscard]] std::size_t count() const noexcept {
    return first_periodic() + 2 * periodic.size() + (shift ? 1 : 0);
  }
  /// Fills the columns of row i. Returns the force less that of a known mass and less the lag [N].
  double fill(const AlignedLog& log, const Rows& rows, std::size_t i, double* c) const;
};

/// Index of each sum among the sums of one bin.
struct SumsLayout {
  std::size_t terms = 0;

  [[nodiscard]] std::size_t mass_instrument() const noexcept { return terms; }
  [[nodiscard]] std::size_t shift_instrument() const noexcept { return terms + 1; }
  [[nodiscard]] std::size_t force_beside_curve() const noexcept { return terms + 2; }
  [[nodiscard]] std::size_t force() const noexcept { return terms + 3; }
  /// The columns above: they have products with each other.
  [[nodiscard]] std::size_t columns() const noexcept { return terms + 4; }
  [[nodiscard]] std::size_t rows() const noexcept { return terms + 4; }
  [[nodiscard]] std::size_t speed() const noexcept { return terms + 5; }
  [[nodiscard]] std::size_t size() const noexcept { return terms + 6; }
};

/// Sums over the rows of one bin.
class BinSums {
 public:
  BinSums(const SumsLayout& layout, const double* sums) : layout_(layout), sums_(sums) {}

  [[nodiscard]] double column(std::size_t j) const noexcept { return sums_[j]; }
  [[nodiscard]] double mass_instrument() const noexcept { return sums_[layout_.mass_instrument()]; }
  [[nodiscard]] double shift_instrument() const noexcept { return sums_[layout_.shift_instrument()]; }
  [[nodiscard]] double force() const noexcept { return sums_[layout_.force()]; }
  [[nodiscard]] double rows() const noexcept { return sums_[layout_.rows()]; }
  [[nodiscard]] double speed() const noexcept { return sums_[layout_.speed()]; }
  [[nodiscard]] Eigen::Map<const VectorXd> first(std::size_t count) const {
    return {sums_, static_cast<Index>(count)};
  }

 private:
  SumsLayout layout_;
  const double* sums_;
};

/// Sums over rows, by block of motion and bin of speed, not centred.
struct Sums {
  SumsLayout layout;
  std::size_t blocks = 0;
  std::array<std::size_t, map::kSides> bins{};
  std::vector<MatrixXd> products;  ///< products of the columns with each other, by block
  std::array<std::vector<double>, map::kSides> by_block;  ///< by side: block, bin, layout
  std::array<std::vector<double>, map::kSides> total;     ///< by side: bin, layout

  [[nodiscard]] BinSums of(std::size_t side, std::size_t bin) const {
    return {layout, &total[side][bin * layout.size()]};
  }
  [[nodiscard]] BinSums of(std::size_t side, std::size_t block, std::size_t bin) const {
    return {layout, &by_block[side][(block * bins[side] + bin) * layout.size()]};
  }
};

struct LinearFit {
  VectorXd value;                  ///< θ
  std::vector<VectorXd> held_out;  ///< θ without each block
  std::vector<std::size_t>
      multiplier;               ///< for each column, the index of the column that multiplies the residual
  MatrixXd moments;             ///< multipliers with columns, about the means of the bins
  MatrixXd instrument_moments;  ///< multipliers with multipliers
  Sums sums;
  std::array<map::BinCurve, map::kSides> curve;  ///< friction over the bins, the load included
  double mass = 0.0;                             ///< [kg]
  double plain_mass = 0.0;                       ///< by ordinary least squares [kg]
  double load = 0.0;                             ///< [N], where friction is small beside it; otherwise 0
  bool mass_by_acceleration =
      false;  ///< the acceleration was used because its instrument hardly correlates with it
};

/// `before`: the fit of the first pass; null in the first pass, which has no instrument.
LinearFit solve(const AlignedLog& log, const Rows& rows, const Terms& terms,
                const LinearFit* before = nullptr);

/// Residual of the force of row i [N]; `columns` has room for all terms.
double residual_of(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                   std::size_t i, std::vector<double>& columns);

/// Multiplier of the residual in place of the acceleration. In open loop: the programmed force less friction, divided by the
/// mass; otherwise Motion's instrument [m/s²].
double mass_instrument(const AlignedLog& log, const Rows& rows, const LinearFit& fit, std::size_t i);
/// Multiplier in place of `change`, the column of the shift [N].
double shift_instrument(const AlignedLog& log, const Rows& rows, std::size_t i, double change);

}  // namespace stribeck::ident::drive
