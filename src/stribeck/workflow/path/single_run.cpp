#include <fmt/format.h>
#include <vector>

#include <stribeck/io/error.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/single_run.hpp>

namespace stribeck::workflow {

sim::CompareSpec single_run(const SingleRunOptions& o, const ParameterOptions& parameters,
                            const sim::Machine& machine, const std::string& machine_file) {
  sim::CompareSpec spec;
  std::vector<std::string> speeds;
  if (!o.speed.empty()) speeds.push_back(o.speed);
  const bool own = o.experiment.empty() && default_experiment(machine, o.path, speeds) == kOwn;
  if (own || (o.experiment.empty() && machine.axes.size() == 1 && !is_file(o.path))) {
    // The motion of compare: the circle of the options needs two axes, and the gains of the biaxial table.
    const std::string experiment = default_experiment(machine, o.path, speeds);
    if (experiment != kOwn && (!speeds.empty() || !(o.path == PathOptions{})))
      refuse_option(
          "--speed and options of a path",
          fmt::format(
              "{} is the motion of this machine, and has its own path, speed and gains (leave them out)",
              experiment));
    spec = experiment_spec(experiment, o.path, speeds, machine, machine_file);
    spec.travels.resize(1);
  } else if (o.experiment.empty()) {
    if (source_of(o.path) == PathSource::kProgram && !o.speed.empty())
      refuse_option("--speed", "a part program has its own feed (leave it out)");
    use_path(
        spec, o.path,
        {option_si("--speed", o.speed.empty() ? "9.5 mm/s" : o.speed, quantity("m/s", "mm/s").positive())},
        machine, machine_file);
    spec.controllers = make_controllers(o.path);
    spec.accuracy = make_accuracy(o.path);
  } else {
    if (!(o.path == PathOptions{}) || !o.speed.empty()) {
      refuse_option("--experiment",
                    o.experiment + " has its own path, speed and gains: leave out the options of a path");
    }
    spec = printed_spec(o.experiment, machine, machine_file);
    spec.travels.resize(1);
  }
  const std::size_t printed = spec.controllers.size();
  add_beyond(spec.controllers, o.experiment, parameters);
  // The default, or the last of the thesis's controllers, which has the largest model.
  spec.controllers = {o.controller.empty() ? default_controller(spec.controllers, printed)
                                           : chosen_controller(spec.controllers, o.controller)};
  return spec;
}

}  // namespace stribeck::workflow
