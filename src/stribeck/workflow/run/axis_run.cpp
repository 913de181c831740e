#include <nlohmann/json.hpp>

#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/run/axis_run.hpp>

namespace stribeck::workflow {

AxisRun run_axis(const sim::Machine& machine, const std::string& file, const std::string& axis,
                 const io::Log& reference, std::uint64_t seed) {
  const std::size_t index = axis_index(machine, file, axis);
  const ReferenceFile given = reference_of(reference, machine, index);
  AxisRun run{machine.name, axis, seed, play(machine, index, given.r, given.force, seed), {}, {}};
  run.end_stop = cut_at_end_stop(run.recording, machine.axes[index].second.limits);
  run.log = as_log(run.recording);
  run.log.metadata.insert(run.log.metadata.begin(),
                          {{"machine", machine.name}, {"axis", axis}, {"seed", std::to_string(seed)}});
  return run;
}

nlohmann::ordered_json to_json(const AxisRun& run) {
  nlohmann::ordered_json json{{"schema", "stribeck.simulate/1"},
                              {"machine", run.machine},
                              {"axis", run.axis},
                              {"seed", run.seed},
                              {"rows", run.log.rows},
                              {"duration_s", run.recording.t.back()},
                              {"end_stop", nullptr}};
  if (const auto& stop = run.end_stop) {
    json["end_stop"] = {
        {"time_s", stop->time}, {"position_mm", stop->position * 1e3}, {"speed_mm_per_s", stop->speed * 1e3}};
  }
  return json;
}

}  // namespace stribeck::workflow
