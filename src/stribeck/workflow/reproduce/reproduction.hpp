#pragma once
/// Reproduces the thesis's tables and figures: identification, experiments and, if asked for, robustness.
/// Real time: no. Errors: InputError, ident::Refused, sim::Refused.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <stribeck/workflow/reproduce/robustness.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct ReproduceOptions {
  std::vector<std::string> ids{"all"};  ///< of reproducible_ids()
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  // of robustness
  std::uint32_t machines = kRobustMachines;
  std::string vary = "all";              ///< factor in which the machines differ
  std::vector<std::string> controllers;  ///< built in, or files; empty: those of the study
};

/// Values of ReproduceOptions::ids: "all", then every experiment.
std::vector<std::string> reproducible_ids();

/// The sections that will be made; everything is checked before anything is computed.
struct ReproductionPlan {
  ReproduceOptions options;
  std::vector<std::string> identification;  ///< ids
  std::vector<sim::Experiment> experiments;
  bool robust = false;
  sim::RobustnessSpec robustness;
};
ReproductionPlan plan_reproduction(const ReproduceOptions& options);

/// Receives progress: stage of the work, how much of it is done, and its total.
using StageProgress = std::function<void(const char* stage, std::size_t done, std::size_t all)>;

/// All sections; the caller adds command and version.
report::ReproductionInput reproduce(const ReproductionPlan& plan, const StageProgress& progress = {});

}  // namespace stribeck::workflow
