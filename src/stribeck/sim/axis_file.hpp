#pragma once
/// The content of an axis file: the identified model of an axis, the velocities on which it was identified and, where the control
/// sees the motor and the table does not follow at once, the lost motion between both; and what the machine file says of its drive.
/// Real time: no.

#include <algorithm>
#include <array>
#include <optional>
#include <stribeck/control/compensation/lost_motion_params.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/friction/drive_numbers.hpp>
#include <stribeck/friction/uncertainty.hpp>
#include <string>

namespace stribeck::sim {

struct AxisFile {
  std::optional<std::string> axis;  ///< its name
  /// Carried as a linear axis at a radius of 1 m: N stands for N m, kg for kg m2, mm for mrad; a file may also say N m, kg m2
  /// and deg. Left out: no.
  std::optional<bool> rotary;
  friction::AxisModel model;
  std::optional<control::LostMotionParams> lost_motion{};
  std::optional<friction::DriveNumbers> drive{};  ///< absent: not known
  std::optional<double> control_period{};  ///< of the control that moves the axis [s]; absent: not known
  std::optional<std::array<double, 2>>
      velocity_range{};  ///< [m/s] where the map of friction does not hold it
  std::optional<friction::ModelUncertainty> uncertainty{};

  static constexpr auto fields() {
    return std::tuple{
        field("axis", &AxisFile::axis, "name of the axis; left out: not known").or_default(),
        field(
            "rotary", &AxisFile::rotary,
            "the axis turns and is carried as a linear one at a radius of 1 m: N stands for N m, kg for kg m2 "
            "and mm for mrad; units of angles and torques count too")
            .or_default(),
        embedded(&AxisFile::model),
        field("lost_motion", &AxisFile::lost_motion,
              "backlash and wind-up between motor and table, for a loop over the motor; left out: none")
            .or_default(),
        field(
            "drive", &AxisFile::drive,
            "what the data sheets say of the drive, from the machine file, for exports; left out: not known")
            .or_default(),
        field("control_period", &AxisFile::control_period, quantity("s", "ms").positive().at_most(0.1),
              "period of the control that moves the axis, from the machine file; left out: not known")
            .or_default(),
        field("velocity_range", &AxisFile::velocity_range, quantity("m/s", "mm/s"),
              "velocities the model was identified on: lowest (< 0), highest (> 0); left out: unknown")
            .or_default()
            .when([](const AxisFile& f) { return !f.model.friction.identified_range(); },
                  "goes with a steady map that has no range of its own, i.e. conventional"),
        field("uncertainty", &AxisFile::uncertainty,
              "what the logs leave open of mass and friction, for studies; controllers make no use of it")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (velocity_range && !((*velocity_range)[0] < 0.0 && (*velocity_range)[1] > 0.0))
      report("velocity_range", "expected a lowest velocity below zero and a highest above zero");
  }

  /// Velocities the model was identified on [m/s]; absent: the file does not say it.
  [[nodiscard]] std::optional<std::array<double, 2>> range() const noexcept {
    const auto of_map = model.friction.identified_range();
    return of_map ? of_map : velocity_range;
  }
  /// The largest speed at which the model was identified in both directions [m/s]; absent: the file does not say it.
  [[nodiscard]] std::optional<double> identified_speed() const noexcept {
    const auto known = range();
    if (!known) return std::nullopt;
    return std::min(-(*known)[0], (*known)[1]);
  }
};

}  // namespace stribeck::sim
