#pragma once
/// Turns the columns of a log into signals of one axis, and these into clean records.
///
///   columns.hpp          the column for each quantity
///   motion_columns.hpp   position and velocity, in metres or radians
///   effort.hpp           force, torque, current, voltage or percent → force
///   log_times.hpp        the time base of each column
///   runs.hpp             rows that count, and separate runs
///
///   position   m, or rad where the log has angles and no --lead is given
///   force      N; torque with --lead; anything with --gain; without one the log's own unit ("A", "%", "V",
///              "N m"), and a note says so
///
/// A value of a column becomes a value of a signal in one step (converted.hpp), and ident::log::condition makes
/// records of the signals.
///
/// Real time: no.
/// Errors: InputError naming file, column or option.

#include <stribeck/ident/log/condition.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// One axis of a log.
struct LoggedAxis {
  std::vector<ident::log::RawLog> runs;
  std::vector<std::string> notes;                            ///< choices that were made, one sentence each
  std::vector<std::pair<std::string, std::string>> columns;  ///< quantity, header of its column and unit
  bool rotary = false;                                       ///< travel is the arc at a radius of 1 m
};
LoggedAxis logged_axis(const io::Log& log, const LogOptions& options);

/// The same, cleaned. The findings include mixed runs.
ident::log::Conditioned condition_axis(LoggedAxis axis, const std::string& source, const LogOptions& options);

/// Both steps: records of one axis of a log. The notes of LoggedAxis are added to `notes`.
ident::log::Conditioned condition_log(const io::Log& log, const LogOptions& options,
                                      std::vector<std::string>* notes = nullptr);

}  // namespace stribeck::workflow
