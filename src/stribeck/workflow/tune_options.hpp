#pragma once
/// Options of a search for gains, as a user gives them.
/// Real time: no.
/// Errors: InputError naming the option.

#include <cstdint>
#include <stribeck/sim/study/tuning.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct TuneOptions {
  std::string experiment;  ///< empty: the default one for the machine
  PathOptions path;
  std::vector<std::string> speeds;
  std::vector<std::string> controllers;  ///< ids, built in, or files; empty: all of the experiment
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  double phase_margin = 45.0;   ///< [deg]
  double gain_margin = 6.0;     ///< [dB]
  double delay_margin = 1.0;    ///< [control periods]
  std::string input_variation;  ///< largest mean |Δu|; empty: that of the thesis's last controller
  std::string axial_mode;       ///< frequency; empty: rigid
  int evaluations = 300;
  std::string goal = "accuracy";  ///< or surface, speed
  std::string
      machines;  ///< nominal or nearby; empty: nearby where an axis is simulated as its identified model
  bool trade_off = false;   ///< also look for what other limits of the variation give
  bool stick_slip = false;  ///< look for the slowest smooth speed of every axis
};

/// Controllers, travels and limits of the search.
sim::TuneSpec tune_spec(const TuneOptions& options, const ParameterOptions& parameters,
                        const sim::Machine& machine, const std::string& machine_file);

/// The tuned controller under its own name, so that it can be listed beside the original one.
sim::ControllerSpec renamed(sim::ControllerSpec controller);

/// The option that would let some gains meet the limits, and whether the search ended by the number of its evaluations; empty where some gains meet them.
std::string way_out(const sim::TunedController& controller, int evaluations);

}  // namespace stribeck::workflow
