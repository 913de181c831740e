#pragma once
/// Options that several verbs have, declared once: of a log, of a path, of parameters.
/// Real time: no.

namespace CLI {
class App;
}

namespace stribeck::workflow {
struct LogOptions;
struct ParameterOptions;
struct PathOptions;
}  // namespace stribeck::workflow

namespace stribeck::cli {

/// How the columns of a log are to be read.
void add_log_options(CLI::App& verb, workflow::LogOptions& options);

/// Where the compensators' parameters come from.
void add_parameter_options(CLI::App& verb, workflow::ParameterOptions& options);

/// A path, and the gains of the controllers that are driven along it.
void add_path_options(CLI::App& verb, workflow::PathOptions& options);

}  // namespace stribeck::cli
