#pragma once
/// A force that grows with the position: a cable chain, a hose, bellows, a gas spring that balances a weight.
///
///   F = k·(x − x0)   from ≤ x ≤ to, against +x, at standstill too; beyond, the force at the nearer end
///
///   k         stiffness [N/m]; below 0: the force pushes further the further the axis is
///   x0        position at which the spring exerts no force [m]
///   from, to  where the straight line ends [m]; absent: nowhere. Identified: the travel of the log, and as far again on either side
///
/// Beside a load only k and load − k·x0 act: an identified spring has the middle of the travel as its x0, and the load is that at x0.
/// On a rotary axis k is in N m/rad, see unbalance.hpp for the radius.
///
/// Not modelled: a force that is no straight line over the position; hysteresis of the spring, which belongs to friction. With lost
/// motion (plant) the spring acts on motor and table in the shares of the friction. Supervision knows the load alone.
/// Real time: safe.

#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/scalar.hpp>

namespace stribeck::friction {

struct Spring {
  double stiffness = 0.0;        ///< k [N/m]
  double zero_at = 0.0;          ///< x0 [m]
  std::optional<double> from{};  ///< [m]
  std::optional<double> to{};    ///< [m]

  static constexpr auto fields() {
    return std::tuple{
        field("stiffness", &Spring::stiffness, quantity("N/m", "N/mm"), "force per position"),
        field("zero_at", &Spring::zero_at, quantity("m", "mm"),
              "position at which the spring exerts no force; the load is that of the axis there"),
        field("from", &Spring::from, quantity("m", "mm"),
              "below this position the force stays; left out: nowhere")
            .or_default(),
        field("to", &Spring::to, quantity("m", "mm"),
              "above this position the force stays; left out: nowhere")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (!(lowest() < highest())) report("to", "must be above from");
  }

  [[nodiscard]] double lowest() const noexcept { return from.value_or(-kFar); }
  [[nodiscard]] double highest() const noexcept { return to.value_or(kFar); }
  /// [N]
  template <Real T>
  [[nodiscard]] T at(const T& x) const noexcept {
    return T(stiffness) * (clamp_to(x, T(lowest()), T(highest())) - T(zero_at));
  }

 private:
  static constexpr double kFar = 1e6;  ///< [m]: farther than any axis goes
};

}  // namespace stribeck::friction
