#pragma once
/// From the columns of a log to signals of one axis: which column is what, in which unit, and how torque,
/// current, voltage or percent become a force.
///
///   position   m, or rad where the log has angles and no --lead is given
///   force      N; torque with --lead; anything with --gain; without one the log's own unit ("A", "%", "V",
///              "N m"), and a note says so
///
/// A column is chosen by --map, else by its name in the notations of the controls that io::read_log knows,
/// with the axis in it (x_y, X1_ActualPosition, ENC_POS|2, s ist/Y, q1). Two columns that could both be it are
/// refused, so is a position without a unit. A force with a gain is looked for among the columns of the gain's unit.
/// Errors: InputError naming file, column or option.

#include <cstdint>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct LogOptions {
  std::string axis{};
  std::vector<std::string> maps{};   ///< quantity=column [unit]
  std::string gain{};                ///< force per volt, ampere, newton metre or percent; empty: none
  std::string lead{};                ///< travel per turn; empty: none
  std::vector<std::string> where{};  ///< COLUMN=VALUE, rows that count
  std::vector<std::string> runs{};   ///< columns whose change begins a new run
  std::string sample_time{};         ///< for logs without a time column
  std::vector<std::string> keep{};   ///< kinds of findings that are left alone
  std::string map_file{};            ///< TOML file with any of these
};

/// The options with those of the map file, which the command line overrides.
LogOptions with_map_file(const LogOptions& options);

/// Any log, as io::read_log; a given sample time stands for a missing time column.
io::Log read_log(const std::string& path, const LogOptions& options);

/// A column with the unit that it stands in; "" where nobody says one.
struct NamedColumn {
  const io::Column* column = nullptr;
  std::string unit;
};

/// The column that --map names: "COLUMN", or "COLUMN UNIT" with a unit of the same kind as that of the file, which it replaces.
NamedColumn named_column(const io::Log& log, const std::string& text);

/// The column of an axis's position by its name; refused where there is none, or more than one could be it.
NamedColumn position_column(const io::Log& log, const std::string& axis);

/// All values of a position [m]; refused where the column is none.
std::vector<double> positions(const io::Log& log, const NamedColumn& named);

/// Which rows have the value: COLUMN=VALUE of --where; refused where none has.
std::vector<std::uint8_t> rows_with(const io::Log& log, const std::string& where);

/// One axis of a log.
struct LoggedAxis {
  std::vector<ident::log::RawLog> runs;
  std::vector<std::string> notes;  ///< what was chosen where a choice had to be made
  std::vector<std::pair<std::string, std::string>> columns;  ///< quantity, header of its column and unit
};
LoggedAxis logged_axis(const io::Log& log, const LogOptions& options);

/// The same, cleaned. Findings of mixed runs are among the findings.
ident::log::Conditioned condition_log(const io::Log& log, const LogOptions& options,
                                      std::vector<std::string>* notes = nullptr);

/// One clean record with a force in newton; refuses everything else.
ident::log::Record make_record(const io::Log& log, const LogOptions& options);

}  // namespace stribeck::workflow
