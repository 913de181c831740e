#pragma once
/// Which column of a log is what: chosen by --map, else by its name in the notations of the controls that
/// io::read_log knows, with the axis in it (x_y, X1_ActualPosition, ENC_POS|2, s ist/Y, q1).
///
/// The names are in known_columns.cpp: a new notation is a line there. Two columns that could both be one
/// quantity are refused.
///
/// Real time: no.
/// Errors: InputError naming file, column or option.

#include <array>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// Quantities of a log's columns, by the words of --map.
enum class LogQuantity {
  kTime,
  kReference,
  kPosition,
  kVelocity,
  kReferenceVelocity,
  kAcceleration,
  kForce,
  kTorque,
  kCurrent,
  kVoltage,
  kPercent
};

/// Names of one signal, lower case. A family is one notation in order of preference; columns of two families
/// are two candidates.
using NameFamily = std::vector<std::string_view>;

struct KnownColumn {
  LogQuantity what;
  Quantity quantity;
  std::vector<NameFamily> families;
};
const KnownColumn& known_column(LogQuantity what);

/// A column with the unit that its values have; "" where nobody says one.
struct NamedColumn {
  const io::Column* column = nullptr;
  std::string unit;
};

/// As the file calls it.
const std::string& header_of(const io::Column& column);
/// The same with its unit.
std::string header_with_unit(const NamedColumn& named);
/// Those of a log, for messages.
std::string column_names(const io::Log& log);

/// The columns of one axis.
class AxisColumns {
 public:
  /// Reads all of --map.
  AxisColumns(const io::Log& log, const LogOptions& options);

  [[nodiscard]] const io::Log& log() const noexcept { return log_; }
  /// Chosen by --map.
  [[nodiscard]] std::optional<NamedColumn> mapped(LogQuantity what) const;
  /// The same, else by its name.
  [[nodiscard]] std::optional<NamedColumn> find(LogQuantity what) const;

 private:
  const io::Log& log_;
  std::string axis_;
  std::vector<std::pair<LogQuantity, NamedColumn>> maps_;
};

/// The column that --map names: "COLUMN", or "COLUMN UNIT" with a unit of the same kind as that of the file, which it replaces.
NamedColumn named_column(const io::Log& log, const std::string& text);

/// The column of an axis's position by its name; refused where there is none, or more than one could be it.
NamedColumn position_column(const io::Log& log, const std::string& axis);

/// All values of a position [m]; refused where the column is none.
std::vector<double> positions(const io::Log& log, const NamedColumn& named);

/// Refuses a column whose unit contradicts its quantity.
[[noreturn]] void refuse_column(const io::Log& log, const NamedColumn& named, const std::string& message);

/// Throws, naming the file, where the column in this unit is not the quantity.
void check_unit(const io::Log& log, const io::Column& column, const std::string& unit, const Quantity& q);

}  // namespace stribeck::workflow

template <>
struct stribeck::EnumNames<stribeck::workflow::LogQuantity> {
  using Q = stribeck::workflow::LogQuantity;
  static constexpr std::array<std::pair<Q, std::string_view>, 11> names{{{Q::kTime, "t"},
                                                                         {Q::kReference, "r"},
                                                                         {Q::kPosition, "x"},
                                                                         {Q::kVelocity, "v"},
                                                                         {Q::kReferenceVelocity, "v_ref"},
                                                                         {Q::kAcceleration, "a"},
                                                                         {Q::kForce, "force"},
                                                                         {Q::kTorque, "torque"},
                                                                         {Q::kCurrent, "current"},
                                                                         {Q::kVoltage, "voltage"},
                                                                         {Q::kPercent, "percent"}}};
};
