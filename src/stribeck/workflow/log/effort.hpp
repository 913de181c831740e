#pragma once
/// The column of a log that stands for the force: force, torque, current, voltage or percent, and how its
/// values become newtons. Without a gain they stay in the log's own unit ("A", "%", "V", "N m") and a note says so.
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
  double factor = 1.0;     ///< after the conversion
  std::string unit = "N";  ///< of the result
  bool by_lead = false;    ///< a torque that --lead made a force
};

/// The mapped one; else that of the gain's unit; else the first there is, of force, current, torque, percent, voltage.
Effort find_effort(const AxisColumns& columns, const MotionColumns& motion, const std::string& gain,
                   std::vector<std::string>& notes);

}  // namespace stribeck::workflow
