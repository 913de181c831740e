#pragma once
/// Judges circles that were travelled, from the logs of any control.
/// Real time: no.
/// Errors: InputError naming the log or the option.

#include <stribeck/io/log/log.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct CircleOptions {
  std::vector<std::string> logs;
  std::string size;  ///< nominal radius; empty: see circle_radius()
  std::vector<std::string>
      feeds;                      ///< of logs without times: one for all, or one for each; empty: of the file
  std::vector<std::string> maps;  ///< QUANTITY=COLUMN [UNIT]
  std::vector<std::string> where;   ///< COLUMN=VALUE, one circle each; empty: one circle of all rows
  std::vector<std::string> labels;  ///< one for each log; empty: the files' names
  std::vector<std::string> beside;  ///< HEAD=VALUE,VALUE,…: a further column of the table
  std::vector<std::string> limits;  ///< FIGURE=LENGTH: largest allowed value
  bool together = false;            ///< the logs are of one machine: one diagnosis over all
};

/// The input of the page; the caller adds command and version. `read`: the logs, where they are read already; options.logs has their
/// names.
report::CircleReportInput judge_circles(const CircleOptions& options, const std::vector<io::Log>& read = {});

/// A log of a circle: it needs no times, because the order of its rows is enough.
io::Log read_circle_log(const std::string& path);

}  // namespace stribeck::workflow
