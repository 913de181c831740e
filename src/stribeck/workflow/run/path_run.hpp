#pragma once
/// One run of a virtual machine along a path under one controller: `stribeck simulate`.
/// Real time: no.
/// Errors: InputError naming the option or the file; sim::Refused where the run would mean nothing.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/single_run.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct PathRunOptions {
  SingleRunOptions run;
  ParameterOptions parameters;
  std::uint32_t trial = 0;  ///< with the seed it determines the noise
  std::uint64_t seed = 1;
};

struct PathRun {
  std::string experiment;
  sim::CompareSpec spec;
  sim::CompareResult result;          ///< one row
  io::Log log;                        ///< its trace
  std::vector<std::string> warnings;  ///< check_coverage() of the result
};

/// `file`: where the machine comes from, for messages.
PathRun run_path(const PathRunOptions& options, const sim::Machine& machine, const std::string& file);

nlohmann::ordered_json to_json(const PathRun& run);

}  // namespace stribeck::workflow
