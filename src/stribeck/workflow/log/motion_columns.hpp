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

/// One column and the conversion of its values to SI.
struct MotionColumn {
  LogQuantity what;
  NamedColumn from;
  io::Conversion conversion{};
  bool angle = false;   ///< the column is an angle
  double factor = 1.0;  ///< applied after the conversion: metres per radian where --lead converts an angle
};

struct MotionColumns {
  std::vector<MotionColumn> columns;
  bool angle = false;       ///< the axis is described by angles
  double per_radian = 0.0;  ///< travel of one radian [m/rad]; 0: no --lead
  bool rotary = false;      ///< the lead is an angle: travel is the arc at a radius of 1 m
  bool of_table = false;    ///< rotary: degrees and radians are those of the axis, turns those of its motor

  /// Travel of one radian of a column in this unit [m/rad]; 0: not known.
  [[nodiscard]] double per_radian_of(const std::string& unit) const;
  /// The position column, else the velocity column.
  [[nodiscard]] const MotionColumn& base() const;
  /// Whether any column is an angle.
  [[nodiscard]] bool turns() const;
};

/// Leaves out columns without a unit that are not needed, with a note. Angles become travel with --lead, or with the drive of the
/// machine file.
MotionColumns find_motion(const AxisColumns& columns, const LogOptions& options,
                          std::vector<std::string>& notes);

}  // namespace stribeck::workflow
