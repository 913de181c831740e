#include <nlohmann/json.hpp>

#include <stribeck/report/json.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/run/path_run.hpp>
#include <stribeck/workflow/traces.hpp>

namespace stribeck::workflow {

PathRun run_path(const PathRunOptions& o, const sim::Machine& machine, const std::string& file) {
  PathRun out{o.run.experiment, single_run(o.run, o.parameters, machine, file), {}, {}, {}};
  out.spec.trials = o.trial + 1;
  out.spec.seed = o.seed;
  check_travel(machine, file, out.spec);
  const Parameters parameters = get_parameters(machine, file, o.parameters, out.spec);
  out.result = sim::run_once(machine, parameters.knowledge, out.spec, o.trial);
  out.warnings = check_coverage(out.result, sim::chosen_axes(machine, out.spec), parameters);
  out.log = as_log(out.result.axes, out.result.rows.front().trace);
  const sim::ControllerSpec& controller = out.spec.controllers.front();
  const sim::Travel& travel = out.spec.travels.front();
  out.log.metadata = {{"machine", machine.name},
                      {"controller", controller.id + ", " + controller.label},
                      {"path", travel.name + ", " + travel.pace_in_words()},
                      {"seed", std::to_string(o.seed)}};
  return out;
}

nlohmann::ordered_json to_json(const PathRun& run) {
  nlohmann::ordered_json json = report::to_json(run.result, run.experiment);
  json["schema"] = "stribeck.simulate/1";
  for (const std::string& warning : run.warnings) json["warnings"].push_back(warning);
  return json;
}

}  // namespace stribeck::workflow
