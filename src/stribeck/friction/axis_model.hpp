#pragma once
/// The parameters of an axis that a compensator may know: the result of an identification, the content of an axis file.
///
///   f_u = m·a + F_friction(v, x) + load            load: gravity and the like [N], positive against +x
///
/// Real time: safe.

#include <optional>
#include <stribeck/friction/drive_loop.hpp>
#include <stribeck/friction/model.hpp>

namespace stribeck::friction {

struct AxisModel {
  double mass = 0.0;  ///< equivalent mass, reflected inertia included [kg]
  double load = 0.0;  ///< [N]
  Model friction;
  std::optional<double>
      delay{};  ///< from the command of a force to the beginning of its hold [s]; absent: not known
  std::optional<DriveLoop> drive_loop{};  ///< absent: the drive takes the force itself as its command

  /// The delay, or none where it is not known [s].
  [[nodiscard]] double delay_or_none() const noexcept { return delay.value_or(0.0); }

  static constexpr auto fields() {
    return std::tuple{
        field("mass", &AxisModel::mass, quantity("kg", "N s2/mm").positive(),
              "equivalent mass, reflected inertia included"),
        field("load", &AxisModel::load, quantity("N", "N"),
              "constant force against the positive direction, e.g. weight")
            .or_default(),
        field(
            "delay", &AxisModel::delay, quantity("s", "ms").not_negative(),
            "computation delay: from the sample to the instant at which its force begins to act; left out: not known, controllers count "
            "with none")
            .or_default(),
        field("friction", &AxisModel::friction, "friction of the axis"),
        field("drive_loop", &AxisModel::drive_loop,
              "velocity or position loop that the drive closes itself; left out: it takes a force")
            .or_default()};
  }
};

}  // namespace stribeck::friction
