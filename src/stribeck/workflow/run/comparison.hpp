#pragma once
/// Several controllers on one virtual machine: what `stribeck compare` shows, from the options of a user.
///
///   workflow::ComparisonOptions o;
///   o.machine = "machines/biaxial-table.toml";
///   const workflow::Comparison c = workflow::run_comparison(o);
///   c.result.rows
///
/// Real time: no.
/// Errors: InputError for files and options; sim::Refused where no controller can be simulated.

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Empty texts and lists: by the machine.
struct ComparisonOptions {
  std::string machine;  ///< file
  std::string experiment;
  std::string drive;  ///< loops that the drives close themselves, put on every axis
  ParameterOptions parameters;
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::vector<std::string> speeds;
  std::vector<std::string> controllers;  ///< names or files of further ones
  std::vector<std::string> only;         ///< ids of those that run
  bool tuned = false;                    ///< each at its best gains: run_tuned_comparison() of run/tuning.hpp
  PathOptions path;
};

/// Files that the options name, and other words among them.
std::vector<std::string> inputs_of(const ComparisonOptions& options);

struct Comparison {
  std::string experiment;
  sim::Machine machine;
  Parameters parameters;
  sim::CompareResult result;
  std::vector<std::string> warnings;  ///< harmful_speeds() and check_coverage() of the result
};

/// What runs, before anything is identified or simulated.
struct ComparisonPlan {
  std::string experiment;
  sim::Machine machine;
  sim::CompareSpec spec;
};
/// Experiment, path and controllers for a machine; options.machine only names it in messages.
ComparisonPlan plan_comparison(const ComparisonOptions& options, sim::Machine machine);

/// A sentence for each speed at which every compensation leaves a larger error than none, or which do: in a table of many rows it is
/// overlooked.
std::vector<std::string> harmful_speeds(const sim::CompareResult& result);

/// On a machine of one's own: (a) is a rule for recording, not the loop of the control. Empty elsewhere.
std::string whose_loop(const ComparisonPlan& plan, const ComparisonOptions& options);

/// Runs it with parameters that are known already.
Comparison run_plan(ComparisonPlan plan, Parameters parameters,
                    const std::function<void(std::size_t, std::size_t)>& progress = {});

/// progress(done, all) may be called from any thread, one call at a time.
Comparison run_comparison(const ComparisonOptions& options,
                          const std::function<void(std::size_t, std::size_t)>& progress = {});

/// The result (report/json.hpp) with all warnings.
nlohmann::ordered_json to_json(const Comparison& comparison);

}  // namespace stribeck::workflow
