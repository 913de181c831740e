#pragma once
/// One run along a path under one controller: the path of an experiment or of the user.
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>

namespace stribeck::workflow {

struct SingleRunOptions {
  std::string
      experiment;  ///< its path, gains and controllers; empty: those of `path`, of one axis those of compare
  PathOptions path;
  std::string speed;       ///< empty: 9.5 mm/s
  std::string controller;  ///< id of one of them, or a file; empty: the default
};

/// Travel and controller of the run; the caller adds seed and trials.
sim::CompareSpec single_run(const SingleRunOptions& options, const ParameterOptions& parameters,
                            const sim::Machine& machine, const std::string& machine_file);

}  // namespace stribeck::workflow
