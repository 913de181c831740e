#pragma once
/// The column of a log that gives the force (force, torque, current, voltage or percent) and its conversion to newtons.
/// Without --gain the drive of the machine file tells it; without that the values stay in the log's own unit ("A", "%", "V", "N m") and a note says so.
///
/// Real time: no.
/// Errors: InputError naming file, column or option.

#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/motion_columns.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct Effort {
  NamedColumn from;
  LogQuantity what = LogQuantity::kForce;
  io::Conversion conversion{};
  double factor = 1.0;     ///< applied after the conversion of the unit
  std::string unit = "N";  ///< of the result
  bool by_lead = false;    ///< a torque that --lead converts to a force
};

/// Kind of effort by its unit, whatever its name: a torque in percent is a percentage.
LogQuantity kind_by_unit(const std::string& unit, LogQuantity by_name);

/// The mapped column; else the one with the gain's unit; else the first of force, current, torque, percent, voltage.
Effort find_effort(const AxisColumns& columns, const MotionColumns& motion, const LogOptions& options,
                   std::vector<std::string>& notes);

}  // namespace stribeck::workflow
