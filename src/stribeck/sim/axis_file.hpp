#pragma once
/// The content of an axis file: the identified model of an axis and, where the control sees the motor and the table does not follow
/// at once, the lost motion between both.
/// Real time: no.

#include <stribeck/control/compensation/lost_motion_params.hpp>
#include <stribeck/friction/axis_model.hpp>

namespace stribeck::sim {

struct AxisFile {
  friction::AxisModel model;
  std::optional<control::LostMotionParams> lost_motion;

  static constexpr auto fields() {
    return std::tuple{
        embedded(&AxisFile::model),
        field("lost_motion", &AxisFile::lost_motion,
              "backlash and wind-up between motor and table, for a loop over the motor; left out: none")
            .or_default()};
  }
};

}  // namespace stribeck::sim
