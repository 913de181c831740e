#pragma once
/// Finds the column of a log for each quantity: by --map, else by its name in the notations of the controls that
/// io::read_log knows, with the axis in the name (x_y, X1_ActualPosition, ENC_POS|2, s ist/Y, q1).
///
/// The names are in known_columns.cpp, one line for each notation. Two columns that could both be the same quantity are
/// refused.
///
/// Real time: no.
/// Errors: InputError naming file, column or option.

#include <array>
#include <memory>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// Quantities of columns, named as in --map.
enum class LogQuantity {
  kTime,
  kReference,
  kPosition,
  kMotor,  ///< position of the motor, beside that of the table
  kScale,  ///< position of the table, beside that of the motor
  kVelocity,
  kReferenceVelocity,
  kAcceleration,
  kForce,
  kTorque,
  kCurrent,
  kVoltage,
  kPercent,
  kPressure  ///< difference of the pressures at a piston; never found by its name, for it may be any pressure
};

/// Those that give the force, in the order in which they are preferred.
inline constexpr std::array kForces{LogQuantity::kForce,   LogQuantity::kCurrent, LogQuantity::kTorque,
                                    LogQuantity::kPercent, LogQuantity::kVoltage, LogQuantity::kPressure};

/// Names of one signal in lower case. A family is one notation, in order of preference; columns of two families
/// are two candidates.
using NameFamily = std::vector<std::string_view>;

struct KnownColumn {
  LogQuantity what;
  Quantity quantity;
  std::vector<NameFamily> families;
};
const KnownColumn& known_column(LogQuantity what);

/// A column with the unit of its values; "" where no unit is known.
struct NamedColumn {
  const io::Column* column = nullptr;
  std::string unit;
  std::vector<const io::Column*> beside{};  ///< of the same unit, to be added to it: forces of several motors
  std::shared_ptr<const io::Column>
      made{};  ///< the column itself where it is no column of the log, but a sum of two
  std::vector<const io::Column*>
      against{};  ///< the same, to be subtracted: of motors that turn the other way round
};

/// Its name in the file.
const std::string& header_of(const io::Column& column);
/// The same with its unit.
std::string header_with_unit(const NamedColumn& named);
/// Names of all columns of a log, for messages.
std::string column_names(const io::Log& log);

/// The columns of one axis.
class AxisColumns {
 public:
  /// Reads all texts of --map.
  AxisColumns(const io::Log& log, const LogOptions& options);

  [[nodiscard]] const io::Log& log() const noexcept { return log_; }
  /// As --axis says; "" where it was not given.
  [[nodiscard]] const std::string& axis() const noexcept { return axis_; }
  /// The column chosen by --map.
  [[nodiscard]] std::optional<NamedColumn> mapped(LogQuantity what) const;
  /// The same, else found by its name.
  [[nodiscard]] std::optional<NamedColumn> find(LogQuantity what) const;
  /// The columns that are this quantity of axes with other names, as a sentence; empty: there is none.
  [[nodiscard]] std::string of_other_axes(LogQuantity what) const;
  /// Columns that --map does not name and whose unit is one of these; `doubtful`: also where it stands in the name alone and may be the
  /// letter of an axis ("out_V").
  [[nodiscard]] std::vector<NamedColumn> with_unit_of(const std::vector<std::string_view>& units,
                                                      bool doubtful = false) const;
  /// Columns whose unit --map replaces by one of another scale, one sentence each.
  [[nodiscard]] std::vector<std::string> rescaled() const;

 private:
  const io::Log& log_;
  std::string axis_;
  std::vector<std::pair<LogQuantity, NamedColumn>> maps_;
};

/// The longest name of a column that a text begins with, and the unit behind it; null: there is none.
NamedColumn column_called(const io::Log& log, const std::string& text);
/// The column that --map names: "COLUMN", or "COLUMN UNIT" with a unit of the same kind, which replaces that of the file.
NamedColumn named_column(const io::Log& log, const std::string& text);

/// The position column of an axis, found by its name; refused where there is none, or more than one candidate.
NamedColumn position_column(const io::Log& log, const std::string& axis);

/// The commanded position of an axis: the column `r` and the axis ("rx"), or one found by its name ("x_ref", "Sollposition X");
/// absent where there is none.
std::optional<NamedColumn> commanded_column(const io::Log& log, const std::string& axis);

/// The position of an axis on a scale at the table, beside that of the motor; absent where there is none.
std::optional<NamedColumn> scale_column(const io::Log& log, const std::string& axis);

/// All values of a position [m]; refused where the column is no position.
std::vector<double> positions(const io::Log& log, const NamedColumn& named);

/// Increments of an encoder, whose size the log does not say.
bool is_count(const std::string& unit);
/// "1/min", "min-1": controls write so for turns per minute.
bool is_per_minute(const std::string& unit);
inline constexpr std::string_view kTurnsPerMinute = "rpm";

/// Refuses a column whose unit contradicts its quantity.
[[noreturn]] void refuse_column(const io::Log& log, const NamedColumn& named, const std::string& message);

/// Throws, naming the file, where a column with this unit cannot be the quantity, whose own one is `q`.
void check_unit(const io::Log& log, const io::Column& column, const std::string& unit, LogQuantity what,
                const Quantity& q);

}  // namespace stribeck::workflow

template <>
struct stribeck::EnumNames<stribeck::workflow::LogQuantity> {
  using Q = stribeck::workflow::LogQuantity;
  static constexpr std::array<std::pair<Q, std::string_view>, 14> names{{{Q::kTime, "t"},
                                                                         {Q::kReference, "r"},
                                                                         {Q::kPosition, "x"},
                                                                         {Q::kMotor, "motor"},
                                                                         {Q::kScale, "scale"},
                                                                         {Q::kVelocity, "v"},
                                                                         {Q::kReferenceVelocity, "v_ref"},
                                                                         {Q::kAcceleration, "a"},
                                                                         {Q::kForce, "force"},
                                                                         {Q::kTorque, "torque"},
                                                                         {Q::kCurrent, "current"},
                                                                         {Q::kVoltage, "voltage"},
                                                                         {Q::kPercent, "percent"},
                                                                         {Q::kPressure, "pressure"}}};
};
