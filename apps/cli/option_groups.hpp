#pragma once
/// Options that several verbs have, declared once: of a log, of a path, of parameters.
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

/// How the columns of a log are to be read, as it was typed.
struct LogArguments {
  workflow::LogOptions options;
  std::string map_file;

  /// With what the map file adds. Called once, before the first log is read.
  [[nodiscard]] workflow::LogOptions resolved() const { return with_map_file(options, map_file); }
};
void add_log_options(CLI::App& verb, LogArguments& arguments);

/// Where the compensators' parameters come from.
void add_parameter_options(CLI::App& verb, workflow::ParameterOptions& options);

/// A path, and the gains of the controllers that are driven along it.
void add_path_options(CLI::App& verb, workflow::PathOptions& options);

}  // namespace stribeck::cli
