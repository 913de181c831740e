#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/tune_options.hpp>

namespace stribeck::workflow {

sim::TuneSpec tune_spec(const TuneOptions& o, const ParameterOptions& parameters, const sim::Machine& machine,
                        const std::string& machine_file) {
  const std::string experiment =
      o.experiment.empty() ? default_experiment(machine, o.path, o.speeds) : o.experiment;
  sim::TuneSpec s;
  s.compare = experiment_spec(experiment, o.path, o.speeds, machine, machine_file);
  s.reference = s.compare.controllers.back();  // the last of the thesis's own controllers
  add_beyond(s.compare.controllers, experiment, parameters);
  s.compare.trials = o.trials;
  s.compare.seed = o.seed;
  s.compare.threads = o.threads;
  if (!o.controllers.empty()) {
    const std::vector<sim::ControllerSpec> known = std::move(s.compare.controllers);
    s.compare.controllers.clear();
    for (const std::string& name : o.controllers)
      add_controller(s.compare.controllers, chosen_controller(known, name), name);
  }
  s.limits.phase_margin = o.phase_margin * kPi / 180.0;
  s.limits.gain_margin = std::pow(10.0, o.gain_margin / 20.0);
  s.limits.delay_margin = o.delay_margin;
  if (!o.input_variation.empty())
    s.limits.input_variation =
        option_si("--input-variation", o.input_variation, quantity("V", "V").positive());
  if (!o.axial_mode.empty()) {
    // Light damping, and a table with half the mass, where nothing was measured.
    const plant::AxialMode mode{
        option_si("--axial-mode", o.axial_mode, quantity("Hz", "Hz").positive().at_most(1e4)), 0.02, 0.5};
    s.limits.axial_mode.assign(control::kMostAxes, mode);
  }
  s.evaluations = o.evaluations;
  s.goal = *enum_value<sim::TuneGoal>(o.goal);
  s.nearby = o.machines == "nearby";
  if (o.machines.empty()) {
    // On the model itself feedback is worth nothing, and gains would be as low as they can be.
    const std::vector<std::size_t> axes = sim::chosen_axes(machine, s.compare);
    s.nearby = std::any_of(axes.begin(), axes.end(),
                           [&](std::size_t i) { return !machine.axes[i].second.truth_from.empty(); });
  }
  s.stick_slip = o.stick_slip;
  return s;
}

sim::ControllerSpec renamed(sim::ControllerSpec c) {
  constexpr std::string_view kId = "-tuned";
  constexpr std::string_view kLabel = ", tuned";
  if (!c.id.ends_with(kId)) c.id = c.id.substr(0, 16 - kId.size()).append(kId);
  // Poles that a label names are those of the gains before.
  if (const auto pole = c.label.find(" pole"); pole != std::string::npos) {
    const auto comma = c.label.rfind(',', pole);
    if (comma != std::string::npos && comma > 0) c.label.resize(comma);
  }
  if (!c.label.ends_with(kLabel) && c.label.size() + kLabel.size() <= 60) c.label += kLabel;
  return c;
}

namespace {

std::string option_that_loosens(sim::Limit limit) {
  switch (limit) {
    case sim::Limit::kPhaseMargin:
      return " (lower --phase-margin)";
    case sim::Limit::kGainMargin:
      return " (lower --gain-margin)";
    case sim::Limit::kDelayMargin:
      return " (lower --delay-margin)";
    case sim::Limit::kInputVariation:
      return " (raise --input-variation)";
    case sim::Limit::kStability:
    case sim::Limit::kPath:
      break;
  }
  return " (start from slower gains: a file for --controller)";
}

}  // namespace

std::string way_out(const sim::TunedController& c, int evaluations) {
  if (!c.miss) return {};
  std::string out = option_that_loosens(c.miss->limit);
  if (c.evaluations >= evaluations)
    out += fmt::format(
        "; the search stopped at its limit of {} evaluations: first try a larger --evaluations", evaluations);
  return out;
}

}  // namespace stribeck::workflow
