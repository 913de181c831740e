#pragma once
/// The terms that are linear, mass, periodic terms and shift, with friction of every bin of speed free.
///
///   f − lag = Σ θ_j·c_j + F(bin) + e        c: acceleration, sine and cosine of each periodic term, ḟ
///
/// Deviations from the mean of each bin leave the linear terms alone (Robinson 1988). The acceleration is
/// multiplied with an instrument in its place (motion.hpp), ḟ with the change of the force that the reference
/// asks for; the noise of both would bias the estimate. What remains over the bins is the map without a model.
///
/// To solve a second time, with the curve of the fit before, takes slopes within a bin out and makes an
/// instrument of a programmed force.
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

/// A term periodic in position: two columns.
struct PeriodicColumns {
  double period = 1.0;  ///< [m]
  friction::EccentricForm form = friction::EccentricForm::kAdditive;
  Interval period_interval;
  /// Of each record, through the window that the force has passed.
  std::vector<std::vector<double>> sine, cosine;
};

/// Which linear terms there are. Columns: acceleration unless the mass is known, periodic terms, shift.
struct Terms {
  std::optional<double> known_mass;  ///< [kg]
  std::vector<PeriodicColumns> periodic;
  bool shift = false;

  [[nodiscard]] std::size_t first_periodic() const noexcept { return known_mass ? 0 : 1; }
  [[nodiscard]] std::size_t count() const noexcept {
    return first_periodic() + 2 * periodic.size() + (shift ? 1 : 0);
  }
  /// Columns of row i; returns the force that is left when a known mass and the lag are taken off [N].
  double fill(const AlignedLog& log, const Rows& rows, std::size_t i, double* c) const;
};

/// Where a sum stands among the sums of one bin.
struct SumsLayout {
  std::size_t terms = 0;

  [[nodiscard]] std::size_t mass_instrument() const noexcept { return terms; }
  [[nodiscard]] std::size_t shift_instrument() const noexcept { return terms + 1; }
  [[nodiscard]] std::size_t force_beside_curve() const noexcept { return terms + 2; }
  [[nodiscard]] std::size_t force() const noexcept { return terms + 3; }
  /// Columns that have products with each other: those above.
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
  std::vector<MatrixXd> products;                         ///< of the columns with each other, by block
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
  VectorXd value;                       ///< θ
  std::vector<VectorXd> held_out;       ///< θ without each block
  std::vector<std::size_t> multiplier;  ///< column that multiplies the residual in place of each column
  MatrixXd moments;                     ///< multipliers with columns, about the means of the bins
  MatrixXd instrument_moments;          ///< multipliers with multipliers
  Sums sums;
  std::array<map::BinCurve, map::kSides> curve;  ///< friction over the bins, the load included
  double mass = 0.0;                             ///< [kg]
  double plain_mass = 0.0;                       ///< by ordinary least squares [kg]
  double load = 0.0;                             ///< [N], where friction is small beside it, else 0
  bool mass_by_acceleration = false;             ///< the instrument hardly moves with the acceleration
};

/// `before`: the fit of the pass before; none in the first pass, which has no instrument either.
LinearFit solve(const AlignedLog& log, const Rows& rows, const Terms& terms,
                const LinearFit* before = nullptr);

/// What is left of the force of row i [N]; `columns` has room for all terms.
double residual_of(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                   std::size_t i, std::vector<double>& columns);

/// What multiplies the residual in the place of the acceleration: the programmed force less friction over the
/// mass in open loop, else Motion's instrument [m/s²].
double mass_instrument(const AlignedLog& log, const Rows& rows, const LinearFit& fit, std::size_t i);
/// The same in the place of `change`, the column of the shift [N].
double shift_instrument(const AlignedLog& log, const Rows& rows, std::size_t i, double change);

}  // namespace stribeck::ident::drive
