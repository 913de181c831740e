#pragma once
/// The columns of an axis's motion: position, reference, velocity, commanded velocity, in metres or, where the
/// log has angles and no --lead is given, in radians.
///
/// Real time: no.
/// Errors: InputError naming file, column or option.

#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// One column and how its values become SI.
struct MotionColumn {
  LogQuantity what;
  NamedColumn from;
  io::Conversion conversion{};
  bool angle = false;   ///< the column turns
  double factor = 1.0;  ///< after the conversion: metres of one radian where --lead makes a length of it
};

struct MotionColumns {
  std::vector<MotionColumn> columns;
  bool angle = false;       ///< the axis is one of angles
  double per_radian = 0.0;  ///< travel of one radian [m/rad]; 0: no --lead

  /// The position, else the velocity.
  [[nodiscard]] const MotionColumn& base() const;
  /// Whether any column turns.
  [[nodiscard]] bool turns() const;
};

/// Columns without a unit that are not needed are left out with a note.
MotionColumns find_motion(const AxisColumns& columns, const std::string& lead,
                          std::vector<std::string>& notes);

}  // namespace stribeck::workflow
