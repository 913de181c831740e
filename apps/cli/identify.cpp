#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/core/fields.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/report/shell_words.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/identify_text.hpp>
#include <stribeck/workflow/inspect.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/plan/excitation_plan.hpp>

namespace stribeck::cli {
namespace {

struct IdentifyCommand {
  Common common;
  std::vector<std::string> logs;
  LogArguments log;
  std::string model = "auto";
  std::string method = "auto";
  std::string solver = "derivatives";
  IdentifyOptions identify;
  std::string output;
  bool inspect = false;
};

IdentifyOptions identify_options(const IdentifyCommand& o) {
  IdentifyOptions options = o.identify;
  options.method = *enum_value<Method>(o.method);
  options.model = *enum_value<ModelChoice>(o.model);
  options.for_axis_file = !o.output.empty();
  if (o.solver == "simplex") options.solver = ident::methods::Solver::kSimplex;
  return options;
}

bool is_machine(const std::string& path) { return path.ends_with(".toml"); }

/// --inspect identifies nothing, so only options on reading the log are allowed.
void check_inspect(const IdentifyCommand& o) {
  const auto none = [](bool given, const char* option) {
    if (given) refuse_option(option, "--inspect does not take it: it identifies nothing");
  };
  none(o.model != "auto", "--model");
  none(o.method != "auto", "--method");
  none(o.identify.terms.has_value(), "--terms");
  none(!o.identify.mass.empty(), "--mass");
  none(!o.identify.cut_off.empty(), "--cut-off");
  none(!o.identify.force_shift.empty(), "--force-shift");
  none(!o.identify.turn.empty(), "--turn");
  none(o.solver != "derivatives", "--solver");
  none(!o.output.empty(), "--output");
  none(!o.common.report.empty(), "--report");
  none(!o.common.plots.empty(), "--plots");
}

/// Refuses a log that is given twice, also under two names.
void refuse_repeated(const std::vector<std::string>& logs) {
  std::vector<std::filesystem::path> seen;
  for (const std::string& log : logs) {
    std::error_code ignored;
    seen.push_back(std::filesystem::weakly_canonical(log, ignored));
    if (std::find(seen.begin(), seen.end() - 1, seen.back()) != seen.end() - 1)
      refuse_option("LOG", fmt::format("{} is given twice: it would count as two runs", log));
  }
}

/// Every log and how its columns are read: with a machine file once for each of its axes in the log.
std::vector<std::pair<std::string, LogOptions>> logs_to_inspect(const IdentifyCommand& o,
                                                                const LogOptions& log_options) {
  std::vector<std::pair<std::string, LogOptions>> out;
  if (!is_machine(o.logs.front())) {
    for (const std::string& path : o.logs) out.emplace_back(path, log_options);
    return out;
  }
  const std::vector<std::string> logs(o.logs.begin() + 1, o.logs.end());
  for (const LogsOfAxis& one : logs_by_axis(read_description(o.logs.front()), logs, log_options)) {
    for (const std::string& path : one.logs) out.emplace_back(path, one.options);
  }
  if (out.empty()) refuse_option("LOG", "missing, expected logs after the machine file");
  return out;
}

int inspect_logs(const IdentifyCommand& o, const LogOptions& log_options) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool usable = true;
  for (const auto& [path, options] : logs_to_inspect(o, log_options)) {
    const Inspection found = inspect(read_log(path, options), options);
    say(o.common, found.text);
    json.push_back(found.json);
    usable = usable && found.usable;
  }
  write_json(o.common.json, json.size() == 1 ? json.front() : json, made_from(o.logs));
  return usable ? 0 : 1;
}

void write_page(const report::PageFolders& folders, const Identification& found, const AxisRecords& axis,
                const report::Made& made) {
  if (!folders.any()) return;
  report::IdentifyReportInput page = page_of(found, axis);
  page.command = made.command;
  page.version = made.version;
  page.inputs = made.inputs;
  report::write_identify_report(folders, page);
}

void write_axis_file(const std::string& path, const Identification& found, const AxisRecords& axis,
                     const OfMachineFile& known = {}) {
  io::write_atomically(path, axis_file_text(found, axis, STRIBECK_VERSION, known));
}

/// Every axis of a machine from whatever logs there are of it.
int identify_machine(const IdentifyCommand& o, const IdentifyOptions& options,
                     const LogOptions& log_options) {
  const MachineDescription machine = read_description(o.logs.front());
  const std::vector<std::string> logs(o.logs.begin() + 1, o.logs.end());
  if (logs.empty()) refuse_option("LOG", "missing, expected logs after the machine file");
  const report::Made made = made_from(o.logs);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  const std::vector<LogsOfAxis> all = logs_by_axis(machine, logs, log_options);
  if (all.empty()) refuse_option("--axis", fmt::format("got {}, of which there is no log", log_options.axis));
  for (const LogsOfAxis& one : all) {
    auto [axis, found] = computing("axis " + one.axis, o.common,
                                   [&] { return identify_logs(one.logs, one.options, options); });
    const ident::Interval& mass = found.result.mass_interval;
    // Before all others: with a wrong scale the whole result is wrong.
    std::vector<std::string>& warnings = found.result.warnings;
    const std::string wrong = mass_contradiction(machine.axis(one.axis), mass.low, mass.high);
    if (!wrong.empty() && found.result.force_unit == "N") warnings.insert(warnings.begin(), wrong);
    const std::string weight = load_contradiction(machine.axis(one.axis), found.result.load);
    if (!weight.empty() && found.result.force_unit == "N") warnings.insert(warnings.begin(), weight);
    const std::string friction = friction_unlike_file(machine.axis(one.axis), found.result);
    if (!friction.empty()) warnings.push_back(friction);
    const std::string too_far = travel_contradiction(machine.axis(one.axis), axis.records);
    if (!too_far.empty()) warnings.insert(warnings.begin(), too_far);
    const std::string too_fast = speed_contradiction(machine.axis(one.axis), axis.records);
    if (!too_fast.empty()) warnings.insert(warnings.begin(), too_fast);
    const std::string too_strong = force_contradiction(machine.axis(one.axis), axis.records);
    if (!too_strong.empty()) warnings.insert(warnings.begin(), too_strong);
    if (!o.output.empty()) {
      io::make_directory(o.output);
      write_axis_file(o.output + "/" + one.axis + ".toml", found, axis, of_machine_file(machine, one.axis));
    }
    const std::vector<Wanted> open = not_yet(found, machine.axis(one.axis), machine.sample_time);
    json.push_back(to_json(found, axis.axis));
    json.back()["not_yet"] = nlohmann::ordered_json::array();
    for (const Wanted w : open) json.back()["not_yet"].push_back(enum_name(w));
    const auto below = [&](const std::string& folder) {
      return folder.empty() ? folder : folder + "/" + one.axis;
    };
    write_page({below(o.common.report), below(o.common.plots)}, found, axis, made);
    std::string written;
    if (!o.output.empty()) written += fmt::format("Axis file: {}/{}.toml\n", o.output, one.axis);
    if (!o.common.report.empty())
      written += fmt::format("Page: {}/{}/index.html\n", o.common.report, one.axis);
    if (!o.common.plots.empty()) written += fmt::format("Figures: {}/{}\n", o.common.plots, one.axis);
    say(o.common,
        fmt::format(
            "{}from {}\n{}{}{}", json.size() > 1 ? "\n" : "", axis.sources, text_of(found, axis.axis),
            written,
            next_log(open, found.result, report::shell_quoted(o.logs.front()), report::shell_quoted(one.axis),
                     o.output.empty() ? "" : report::shell_quoted(o.output + "/" + one.axis + ".toml"))));
  }
  write_json(o.common.json, json, made);
  return 0;
}

/// A machine file stands first, wherever it was given. The side file of a log is none.
void put_machine_first(std::vector<std::string>& files) {
  const auto machine = std::find_if(files.begin(), files.end(), [](const std::string& path) {
    return is_machine(path) && describes_machine(path);
  });
  if (machine != files.end()) std::rotate(files.begin(), machine, machine + 1);
}

int run_identify(IdentifyCommand o) {
  put_machine_first(o.logs);
  const IdentifyOptions options = identify_options(o);
  check_options(options);
  if (o.inspect) check_inspect(o);
  refuse_repeated(o.logs);
  check_distinct(o.logs, {o.output, page_of(o.common), o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  const LogOptions log_options = o.log.resolved();
  if (!o.inspect && is_machine(o.logs.front())) return identify_machine(o, options, log_options);
  io::check_writable(o.output);
  if (o.inspect) return inspect_logs(o, log_options);
  const auto [axis, found] =
      computing("identify", o.common, [&] { return identify_logs(o.logs, log_options, options); });
  if (!o.output.empty()) write_axis_file(o.output, found, axis);
  const report::Made made = made_from(o.logs);
  write_json(o.common.json, to_json(found, axis.axis), made);
  write_page(folders_of(o.common), found, axis, made);
  say(o.common, text_of(found, axis.axis));
  return 0;
}

}  // namespace

void add_identify(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "identify", "Identify mass and friction of an axis from its logs, with 95 % confidence intervals");
  auto o = std::make_shared<IdentifyCommand>();
  verb->add_option(
          "log", o->logs,
          "Logs of one axis; several are fitted together. With a machine file first: logs of any of its axes, each identified from its own")
      ->required()
      ->type_name("[MACHINE.toml] LOG");
  verb->add_flag("--inspect", o->inspect,
                 "Only print what the logs contain and what can be identified from them");
  verb->add_option(
          "--model", o->model,
          "Friction model: auto, conventional, gaussian, or asymmetric (idim-ls only: friction by direction)")
      ->check(one_of(words_of<ModelChoice>()))
      ->capture_default_str();
  verb->add_option(
          "--method", o->method,
          "Method: auto (any motion), or by name: velocity-map (Model C), position-map (Model D, or cogging at "
          "standstill), jog (Model B, constant speeds), least-squares (Model A, pulses, and jogs for the "
          "viscous correction), break-away (slow ramps), gravity (both directions at equal speed), "
          "constant-acceleration (mass), idim-ls (published protocol)")
      ->check(one_of(words_of<Method>()))
      ->capture_default_str();
  verb->add_option("--terms", o->identify.terms,
                   "Number of Gaussians in each direction; left out: chosen by the error on held-out motion")
      ->check(whole_from(0, 6));
  verb->add_option("--mass", o->identify.mass,
                   "Known equivalent mass, e.g. \"57.65 N s2/mm\"; left out: identified")
      ->type_name("MASS");
  verb->add_option(
          "--force-shift", o->identify.force_shift,
          "Known time by which the force is later in the log than its motion, e.g. \"-1.5 ms\"; a force that is commanded and held "
          "stands half a period early by itself, and a filter of the drive does not count; left out: identified")
      ->type_name("TIME");
  verb->add_option("--cut-off", o->identify.cut_off,
                   "Low-pass filter at this frequency; left out: chosen from the noise")
      ->type_name("HZ");
  verb->add_option(
          "--turn", o->identify.turn,
          "Known travel per turn of the screw: periodic terms are searched at this period and its integer fractions (position-map)")
      ->type_name("TURN");
  verb->add_option("--solver", o->solver, "derivatives, or simplex (Nelder-Mead, as in published methods)")
      ->check(one_of({"derivatives", "simplex"}))
      ->capture_default_str();
  add_log_options(*verb, o->log);
  verb->add_option("-o,--output", o->output,
                   "Axis file to write; with a machine file the folder for AXIS.toml of each axis")
      ->type_name("AXIS.toml");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck identify x-pulses-log.csv x-sine-log.csv --axis x -o x.toml --report report\n"
      "  stribeck identify machine.toml logs/*.csv -o axes");
  verb->callback([o, &action] { action = [o] { return run_identify(*o); }; });
}

}  // namespace stribeck::cli
