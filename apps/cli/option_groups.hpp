#pragma once
/// Options that several verbs have, declared once: for a log, a path, parameters.
/// Real time: no.

#include <stribeck/workflow/log/log_options.hpp>
#include <string>

namespace CLI {
class App;
}

namespace stribeck::workflow {
struct ParameterOptions;
struct PathOptions;
}  // namespace stribeck::workflow

namespace stribeck::cli {

/// Options on reading the columns of a log, as they were typed.
struct LogArguments {
  workflow::LogOptions options;
  std::string map_file;

  /// Merged with the map file. Call it once, before the first log is read.
  [[nodiscard]] workflow::LogOptions resolved() const { return with_map_file(options, map_file); }
};
void add_log_options(CLI::App& verb, LogArguments& arguments);

/// Options on the origin of the compensators' parameters.
void add_parameter_options(CLI::App& verb, workflow::ParameterOptions& options);

/// Options on a path, and on the gains of the controllers that run along it.
void add_path_options(CLI::App& verb, workflow::PathOptions& options);

}  // namespace stribeck::cli
