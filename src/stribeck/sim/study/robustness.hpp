#pragma once
/// Runs controllers on machines that differ from the identified one, and collects their errors.
///
/// Machine i of a seed (variation.hpp) runs every controller on every travel. Controllers are built once, from the nominal
/// machine and its identification; only the machines differ. Each machine has its own noise, the same for all controllers.
/// When a run is lost: machine_runs.hpp.
///
/// Quantiles interpolate between order statistics, Q(p) = x_k + (h − k)(x_{k+1} − x_k) with h = p(n − 1); a lost run counts as
/// infinite.
///
/// Real time: no. Errors: Refused for a specification that means nothing.

#include <functional>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/study/machine_runs.hpp>
#include <stribeck/sim/study/variation.hpp>

namespace stribeck::sim {

struct RobustnessSpec {
  std::vector<Travel> travels;
  std::vector<std::size_t> axes;  ///< of the machine, in the order of the path's axes; empty: the first ones
  std::vector<ControllerSpec> controllers;
  Variation variation;
  std::uint32_t machines = 100;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: as many as the computer has
};

/// One controller on one travel.
struct RobustRow {
  ControllerSpec controller;
  std::size_t travel = 0;  ///< index into the spec's travels
  RobustRun nominal;       ///< on the identified machine
  std::vector<RobustRun> runs;
};

struct RobustnessResult {
  std::string machine;
  RobustnessSpec spec;
  std::vector<std::string> axes;
  std::vector<std::vector<Deviation>> deviations;  ///< by machine, then by axis
  std::vector<RobustRow> rows;                     ///< travel by travel, controller by controller
};

/// knowledge is that of the nominal machine, for its axes. progress(done, all) may be called from any thread, one call at a time.
RobustnessResult robustness(const Machine& nominal, const std::vector<AxisKnowledge>& knowledge,
                            const RobustnessSpec& spec,
                            const std::function<void(std::size_t, std::size_t)>& progress = {});

struct Quantiles {
  double median = 0.0;
  double p90 = 0.0;
  double p99 = 0.0;
  double worst = 0.0;
};

/// The value below which a share p (0 … 1) of the values lies, linear between two values; NaN for no values.
double interpolated_quantile(std::vector<double> values, double p);
Quantiles quantiles(std::vector<double> values);

/// A figure of every machine, infinite where the loop was lost.
std::vector<double> figures(const RobustRow& row, double Metrics::*figure);
/// The same divided by that of another controller on the same machine; 0 where only the other was lost.
std::vector<double> ratios(const RobustRow& row, const RobustRow& reference, double Metrics::*figure);
std::size_t lost(const RobustRow& row);

/// V2 on a circle of 10 mm at 3 and 9.5 mm/s, scored on the third revolution.
RobustnessSpec robust_biaxial();

/// Controllers of the robustness experiment; the others are compared with the first one.
std::vector<ControllerSpec> robust_controllers();

}  // namespace stribeck::sim
