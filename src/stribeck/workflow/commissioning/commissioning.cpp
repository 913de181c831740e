#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/io/write_at_once.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/commissioning/originals.hpp>
#include <stribeck/workflow/commissioning/parts.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::workflow::commissioning {
namespace {

struct Stage {
  const char* name;
  io::Json (*run)(Work&);
};
constexpr std::array<Stage, 7> kStages{{{"check", check},
                                        {"moves", moves},
                                        {"record", record},
                                        {"identify", identify_axes},
                                        {"before", circle_before},
                                        {"after", circle_after},
                                        {"write", write_configuration}}};

std::optional<double> largest(const StageFolder& folders, const char* stage) {
  const auto result = folders.result(stage);
  if (!result || !result->contains("max_um") || !result->at("max_um").is_number()) return std::nullopt;
  return 1e-6 * result->at("max_um").get<double>();
}

/// Everything on which the stages depend; the INI file does not count, as the last stage changes it.
std::string inputs_of_stages(const Options& o) {
  return fmt::format("{}\n{}\n{}\n{}\n{:g} {:g}\n", o.version, io::sha256_of_file(o.machine),
                     std::filesystem::absolute(o.ini).string(), o.axis, o.limits.good, o.limits.usable);
}

/// Models that a stage gave the controllers go out again where that stage was not finished, or an earlier one is repeated.
void take_models_out(RunningMachine& machine, const Options& options, const StageFolder& folders) {
  std::error_code ignored;
  if (!std::filesystem::exists(folders.path(kModelValues), ignored)) return;
  if (folders.done("after") && (options.stage.empty() || options.stage == "write")) return;
  machine.switch_off();
  ChangedValues(machine, folders.path(kModelValues)).give_back();
}

StageDone run_stage(const Stage& stage, Work work, StageFolder& folders) {
  work.folder = folders.begin(stage.name);
  work.dialogue.say(fmt::format("--- {}", stage.name));
  io::Json result = stage.run(work);
  result["stage"] = stage.name;
  result["says"] = work.says;
  folders.finish(stage.name, std::move(result));
  return {stage.name, false, work.says};
}

/// What a command that was killed had changed for a while is given back to a machine that is off.
void give_back(RunningMachine& machine, const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) machine.switch_off();
  ChangedValues(machine, file).give_back();
}

}  // namespace

const std::vector<std::string>& stage_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Stage& s : kStages) out.emplace_back(s.name);
    return out;
  }();
  return names;
}

Outcome run(RunningMachine& machine, const Options& options, const Dialogue& dialogue) {
  const io::WriteAtOnce at_once;
  const MachineDescription description = read_description(options.machine);
  io::make_directory(options.output);
  StageFolder folders(options.output, stage_names(), inputs_of_stages(options));
  give_back(machine, folders.path(kForAWhile));
  take_models_out(machine, options, folders);
  const RunningAxes axes = find_axes(machine, description, options.axis);
  static_cast<void>(machine.state());  // messages of the past
  Outcome out;
  try {
    for (const Stage& stage : kStages) {
      const bool wanted = options.stage == stage.name;
      if (!options.stage.empty() && !wanted) continue;
      if (wanted) {
        if (const std::string missing = folders.missing_before(stage.name); !missing.empty())
          throw Stopped(fmt::format("stage {} needs {} first (run --stage {} first, or leave out --stage)",
                                    stage.name, missing, missing));
      } else if (const auto known = folders.result(stage.name)) {
        out.stages.push_back({stage.name, true, known->value("says", std::vector<std::string>())});
        continue;
      }
      out.stages.push_back(
          run_stage(stage, {machine, options, dialogue, description, axes, folders, {}, {}}, folders));
    }
  } catch (...) {
    end_safely(machine, folders.path(kForAWhile));
    throw;
  }
  out.before = largest(folders, "before");
  out.after = largest(folders, "after");
  if (const std::string page = folders.path("after/page/index.html"); std::filesystem::exists(page))
    out.page = page;
  if (const auto written = folders.result("write"))
    out.files = written->value("files", std::vector<std::string>());
  return out;
}

std::vector<std::string> undo(RunningMachine* machine, const std::string& output) {
  const io::WriteAtOnce at_once;
  std::vector<std::string> done;
  for (const std::string& path : restore_files(output)) done.push_back("given back: " + path);
  for (const char* file : {kForAWhile, kModelValues}) {
    const std::string path = output + '/' + file;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    if (machine == nullptr) {
      // LinuxCNC begins with what its files say.
      std::filesystem::remove(path, ignored);
      continue;
    }
    machine->switch_off();
    ChangedValues(*machine, path).give_back();
    done.emplace_back("values of HAL given back; the machine is off");
  }
  // What follows from the files that are no longer there has to be done again.
  std::error_code ignored;
  for (const char* stage : {"write", "after"}) std::filesystem::remove_all(output + '/' + stage, ignored);
  return done;
}

}  // namespace stribeck::workflow::commissioning
