#pragma once
/// How to read the columns of a log: texts with units, as a user gives them, checked when the log is read. Options of the
/// command and of a map file are merged here once, before a log is read.
///
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <stribeck/io/keys.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// What the machine file says of the drive of an axis: taken for a log whose unit needs it where --gain or --lead is not given. Empty:
/// not known.
struct DriveScale {
  std::string per_volt{};
  std::string at_100_percent{};
  std::string per_ampere{};
  std::string ampere_doubt{};      ///< why per_ampere may be wrong
  std::string per_newton_metre{};  ///< of one motor's torque
  std::string lead{};              ///< travel per turn of the motor
  std::string count{};             ///< travel per count of the motor's encoder
  std::string sample_time{};       ///< time between rows, for a log that tells none
  int motors = 1;                  ///< that drive the axis together: the scales are those of all
  bool rotary = false;             ///< the axis turns: degrees are its own, turns those of the motor
  bool balanced = false;           ///< the file says that nothing pulls the axis: a load of 0
  bool weighted = false;           ///< the file says that a load pulls the axis
};

/// A number with its unit, in six digits, for notes.
std::string six_digits(const std::string& quantity);

struct LogOptions {
  std::string axis{};                ///< name of the axis in the log; empty: the log has one axis
  std::vector<std::string> maps{};   ///< quantity=column [unit], none=column
  std::string gain{};                ///< force per volt, ampere, newton metre or percent; empty: none
  std::string lead{};                ///< travel per turn, of a rotary axis an angle; empty: none
  std::vector<std::string> where{};  ///< COLUMN=VALUE selects the rows that count
  std::vector<std::string> runs{};   ///< columns in which a change begins a new run
  std::string sample_time{};         ///< for logs without a time column
  std::vector<std::string> keep{};   ///< kinds of findings that are left alone
  DriveScale drive{};                ///< no option of the command
};

/// The options merged with those of a map file (TOML with any of these keys), which they override; empty: no file.
LogOptions with_map_file(LogOptions options, const std::string& map_file);
/// Keys of a map file, for the reference page.
std::vector<io::KeyInfo> map_file_keys();

/// Period of the control as the machine file has it [s]; 0: not known.
double control_period(const LogOptions& options);

/// Begins a map of a column that counts for nothing, as if the log did not have it: none=COLUMN.
inline constexpr std::string_view kNotUsed = "none=";

/// Any log, as io::read_log; a given sample time replaces a missing time column, and columns that a map leaves out are not in it.
io::Log read_log(const std::string& path, const LogOptions& options);

}  // namespace stribeck::workflow
