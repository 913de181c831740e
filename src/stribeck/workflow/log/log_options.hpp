#pragma once
/// How the columns of a log are to be read, as a user says it: texts with units, which are checked where the
/// log is known. Options of the command and of a map file come together here, once, before a log is read.
///
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <stribeck/io/keys.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct LogOptions {
  std::string axis{};                ///< name of the axis in the log; empty: the log has one axis
  std::vector<std::string> maps{};   ///< quantity=column [unit]
  std::string gain{};                ///< force per volt, ampere, newton metre or percent; empty: none
  std::string lead{};                ///< travel per turn; empty: none
  std::vector<std::string> where{};  ///< COLUMN=VALUE, rows that count
  std::vector<std::string> runs{};   ///< columns whose change begins a new run
  std::string sample_time{};         ///< for logs without a time column
  std::vector<std::string> keep{};   ///< kinds of findings that are left alone
};

/// The options with those of a map file (TOML with any of these keys), which they override; empty: no file.
LogOptions with_map_file(LogOptions options, const std::string& map_file);
/// What a map file may hold, for the reference page.
std::vector<io::KeyInfo> map_file_keys();

/// Any log, as io::read_log; a given sample time stands for a missing time column.
io::Log read_log(const std::string& path, const LogOptions& options);

}  // namespace stribeck::workflow
