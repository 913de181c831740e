#pragma once
/// The rows of a log that count (--where), and the runs that they are split into (--runs).
///
/// Real time: no.
/// Errors: InputError naming the option.

#include <cstddef>
#include <cstdint>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Marks the rows with the value COLUMN=VALUE of --where; refused where no row has it.
std::vector<std::uint8_t> rows_with(const io::Log& log, const std::string& where);

/// Rows of the runs, from 0.
struct Selection {
  bool all = true;                             ///< one run of all rows, whatever the length of the columns
  std::vector<std::vector<std::size_t>> runs;  ///< otherwise
};
Selection select_rows(const io::Log& log, const LogOptions& options);

/// The log's name with the values that distinguish the run of this row from others.
std::string run_name(const io::Log& log, const LogOptions& options, std::size_t row);

/// Names of the columns that change where the time `t` restarts, and only there: they distinguish runs. "" where none does.
std::string marks_of_runs(const io::Log& log, const std::vector<double>& t);

}  // namespace stribeck::workflow
