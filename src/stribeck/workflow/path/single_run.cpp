#include <fmt/format.h>
#include <filesystem>
#include <system_error>
#include <vector>

#include <stribeck/io/error.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/single_run.hpp>

namespace stribeck::workflow {

namespace {

/// The requested one of the controllers.
sim::ControllerSpec chosen_controller(const std::vector<sim::ControllerSpec>& controllers,
                                      std::size_t printed, const std::string& wanted) {
  // The default, or the last of the thesis's controllers, which has the largest model.
  if (wanted.empty()) return default_controller(controllers, printed);
  std::vector<std::string> ids;
  for (const sim::ControllerSpec& c : controllers) {
    if (c.id == wanted) return c;
    ids.push_back(c.id);
  }
  std::error_code ignored;
  if (std::filesystem::exists(wanted, ignored)) return read_controller(wanted);
  refuse_option("--controller", fmt::format("got {}, expected a file or one of {}", io::in_quotes(wanted),
                                            report::listed(ids)));
}

}  // namespace

sim::CompareSpec single_run(const SingleRunOptions& o, const ParameterOptions& parameters,
                            const sim::Machine& machine, const std::string& machine_file) {
  sim::CompareSpec spec;
  if (o.experiment.empty()) {
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
    const auto all = sim::experiments();
    spec = sim::find_experiment(all, o.experiment)->settings.front().spec;
    spec.travels.resize(1);
  }
  const std::size_t printed = spec.controllers.size();
  add_beyond(spec.controllers, o.experiment, parameters);
  spec.controllers = {chosen_controller(spec.controllers, printed, o.controller)};
  return spec;
}

}  // namespace stribeck::workflow
