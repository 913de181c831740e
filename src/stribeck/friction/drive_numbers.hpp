#pragma once
/// Numbers of a drive from its data sheet, as force and travel of the axis. `identify` and `commission` copy them from the machine file into the
/// axis file, so that an export need not be told them again.
///
///   force of one per cent    F₁ = rated_force/100           all motors of the axis at 1 % of their rated torque
///   force of one ampere      force_per_ampere               one ampere in each motor
///
/// A rotary axis is carried at a radius of 1 m: N stands for N m, mm for mrad.
/// Real time: safe.

#include <optional>
#include <stribeck/core/fields.hpp>

namespace stribeck::friction {

struct DriveNumbers {
  std::optional<double> rated_force{};         ///< [N]
  std::optional<double> force_per_ampere{};    ///< [N/A]
  std::optional<double> travel_per_turn{};     ///< [m]
  std::optional<int> motors{};                 ///< absent: one
  std::optional<double> encoder_resolution{};  ///< [m]

  static constexpr auto fields() {
    using D = DriveNumbers;
    return std::tuple{
        field("rated_force", &D::rated_force, quantity("N", "N").positive(),
              "force on the axis with every motor at 100 % of its rated torque; left out: not known")
            .or_default(),
        field("force_per_ampere", &D::force_per_ampere, quantity("N/A", "N/A").positive(),
              "force on the axis with one ampere in every motor; left out: not known")
            .or_default(),
        field("travel_per_turn", &D::travel_per_turn, quantity("m", "mm").positive(),
              "travel of the axis per turn of the motor; left out: not known, or a linear motor")
            .or_default(),
        field("motors", &D::motors, pure_number().at_least(1.0).at_most(8.0),
              "motors that drive the axis together; left out: one")
            .or_default(),
        field("encoder_resolution", &D::encoder_resolution, quantity("m", "nm").positive(),
              "step of the encoder on the axis; left out: not known")
            .or_default()};
  }

  /// Whether it says anything.
  [[nodiscard]] bool any() const noexcept {
    return rated_force || force_per_ampere || travel_per_turn || motors || encoder_resolution;
  }
};

}  // namespace stribeck::friction
