#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/output_folder.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/targets/linuxcnc/axis_lines.hpp>
#include <stribeck/targets/linuxcnc/configuration.hpp>
#include <stribeck/targets/linuxcnc/loop_warnings.hpp>
#include <stribeck/targets/pulse/options.hpp>
#include <stribeck/targets/target.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

extern const Target kLinuxCnc;

namespace linuxcnc {
namespace {

using workflow::axis_and_file;
using workflow::axis_index;
using workflow::refuse_option;

/// The model of an axis file, which must be of this axis of the machine.
friction::AxisModel model_for(const sim::Machine& machine, std::size_t i, const std::string& machine_file,
                              const std::string& file) {
  const auto& [name, axis] = machine.axes[i];
  const sim::AxisFile given = workflow::read_axis_file(file);
  const std::string said = given.axis.value_or("");
  if (!said.empty() && io::lower_case(said) != io::lower_case(name))
    throw io::InputError(
        {file, 0, "axis",
         fmt::format("the file is of axis {}, expected one of axis {} of {} (give the file of that axis)",
                     io::in_quotes(said), name, machine_file)});
  if (given.rotary.value_or(false) != axis.rotary)
    throw io::InputError(
        {file, 0, "rotary",
         fmt::format("the file is of a {} axis, but axis {} of {} is {} (give the file of that axis)",
                     axis.rotary ? "linear" : "rotary", name, machine_file,
                     axis.rotary ? "rotary" : "linear")});
  return given.model;
}

/// What the machine file knows of an axis before anything is identified.
friction::AxisModel rough_model(const workflow::MachineDescription& description, const std::string& axis,
                                const sim::Commissioning& known) {
  friction::AxisModel model;
  model.mass = known.mass;
  model.friction.steady = friction::Conventional<double>{known.friction, 0.0, {}};
  for (const auto& [name, a] : description.axes)
    if (name == axis) model.load = a.commissioning.load_force();
  return model;
}

/// Parameters of the controllers of each axis.
std::vector<friction::AxisModel> models_of(const ExportRequest& o, const sim::Machine& machine,
                                           const workflow::MachineDescription& description) {
  const std::string& file = o.files.front();
  std::map<std::size_t, friction::AxisModel> given;
  for (const std::string& text : o.axis_files) {
    const auto [axis, axis_file] = axis_and_file(text);
    const std::size_t i = axis_index(machine, file, axis);
    if (!given.emplace(i, model_for(machine, i, file, axis_file)).second)
      refuse_option("--axis-file", fmt::format("axis {} is given twice", machine.axes[i].first));
  }
  std::vector<friction::AxisModel> models(machine.axes.size());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (const auto found = given.find(i); found != given.end()) {
      models[i] = found->second;
    } else if (o.parameters == "commissioning") {
      models[i] = rough_model(description, machine.axes[i].first, machine.axes[i].second.commissioning);
    } else {
      open.push_back(i);
    }
  }
  workflow::Needs needs;
  needs.whole = true;
  sim::parallel_for(
      open.size(), 0, [] { return 0; },
      [&](int&, std::size_t k) {
        models[open[k]] = workflow::commission_axis(machine, open[k], needs, 1).knowledge.whole.value();
      });
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!models[i].drive_loop) models[i].drive_loop = machine.axes[i].second.known_loop();
  }
  return models;
}

std::string base_name(const std::string& file) { return std::filesystem::path(file).filename().string(); }

Configuration configuration(const ExportRequest& o, const sim::Machine& machine) {
  const std::vector<std::string> letters = linuxcnc_letters(machine, o.files.front());
  Configuration c;
  c.name = io::one_line(machine.name);
  c.sample_time = machine.sample_time;
  c.feedforward = o.feedforward;
  // The same for all axes, so that every direction has equal gains.
  c.omega = machine.axes.front().second.commissioning.omega;
  for (const auto& [axis, a] : machine.axes) c.omega = std::min(c.omega, a.commissioning.omega);
  if (!o.omega.empty()) c.omega = omega_of(o);
  if (!control::sampled_loop_stable(c.omega * c.omega, 2.0 * c.omega, 0.0, c.sample_time)) {
    refuse_option(
        "--omega",
        fmt::format("{:.6g} rad/s makes a loop that is unstable at a period of {:.6g} ms (lower it)", c.omega,
                    1e3 * c.sample_time));
  }
  std::string command = fmt::format("stribeck export {} --to linuxcnc", base_name(o.files.front()));
  if (!o.omega.empty()) command += fmt::format(" --omega \"{}\"", o.omega);
  if (!o.feedforward.empty()) command += " --feedforward " + o.feedforward;
  if (!o.parameters.empty()) command += " --parameters " + o.parameters;
  for (const std::string& text : o.axis_files) {
    const auto [axis, file] = axis_and_file(text);
    command += fmt::format(" --axis-file {}={}", axis, base_name(file));
  }
  c.made = io::printable(fmt::format("Written by: {} -o FOLDER", command));
  c.comment = io::comment_lines(c.made);
  std::vector<DrivableLimits> can;
  for (const auto& [axis, a] : machine.axes) {
    can.push_back(drivable_limits(a));
    if (can.back().limits.speed > 0.0) continue;
    throw io::InputError(
        {o.files.front(), 0, "axes." + axis,
         fmt::format(
             "the drive's {:.6g} N are too little for friction and load of this axis at any speed with a fifth left for acceleration (raise plant.drive.gain or plant.converter.range)",
             a.force_limit())});
  }
  const workflow::MachineDescription description = workflow::read_description(o.files.front());
  const std::vector<friction::AxisModel> models = models_of(o, machine, description);
  for (std::size_t i = 0; i < letters.size(); ++i) {
    c.axes.push_back({letters[i], &machine.axes[i].second, can[i], models[i]});
    if (!description.axes[i].second.rotary) continue;
    if (!angular(c.axes.back()))
      throw io::InputError(
          {o.files.front(), 0, "axes." + description.axes[i].first,
           "is rotary, expected one of LinuxCNC's letters for it: a, b or c (rename the axis)"});
    c.axes.back().radius = 1.0;
  }
  return c;
}

/// All texts are made before the first one is written.
Exported export_configuration(const ExportRequest& o, const sim::Machine& machine) {
  namespace fs = std::filesystem;
  if (!o.names.empty())
    refuse_option("--name",
                  "does not apply to a whole configuration, which has its own names (or -o NAME.hal)");
  std::error_code ignored;
  if (fs::exists(o.output, ignored) && !fs::is_directory(o.output, ignored)) {
    throw io::InputError(
        {o.output,
         0,
         {},
         "is a file, expected a folder for the configuration (or -o NAME.hal for the drives alone)"});
  }
  const Configuration c = configuration(o, machine);
  const NamedTexts files = configuration_files(c);
  const io::OutputFolder folder(o.output);
  const WrittenFolder written = write_folder(o.output, c.comment, files);
  Exported out;
  out.json = {{"schema", "stribeck.export/1"}, {"to", kLinuxCnc.name}, {"folder", o.output},
              {"files", written.files},        {"kept", written.kept}, {"warnings", loop_warnings(c)}};
  out.text = fmt::format("{} files in {}.\n", written.files.size(), o.output);
  for (const std::string& w : loop_warnings(c)) out.text += fmt::format("warning: {}\n", w);
  if (!written.kept.empty())
    out.text +=
        fmt::format("Kept, because edited since the last export: {} (remove a file to write it anew).\n",
                    report::listed(written.kept));
  out.text += fmt::format(
      "  linuxcnc {}       with the AXIS screen\n"
      "  linuxcnc -r {}   without a screen\n",
      (fs::path(o.output) / "machine.ini").string(), (fs::path(o.output) / "headless.ini").string());
  return out;
}

/// Refuses options that would have no effect.
void check_options(const ExportRequest& o, bool machine, bool folder) {
  refuse_pulse_options(o);
  const auto refuse = [](const char* option, const char* why) {
    refuse_option(option, std::string("does not apply to ") + why);
  };
  if (!o.gain.empty()) refuse("--gain", "--to linuxcnc, whose forces are in newtons (--to pid takes it)");
  if (!o.lead.empty()) refuse("--lead", "--to linuxcnc, which moves the axis, not the motor");
  if (!o.resolution.empty()) refuse("--resolution", "--to linuxcnc, only to pid and all");
  if (!o.zero.empty()) refuse("--zero", "--to linuxcnc, only to moteus and all");
  if (machine && o.files.size() > 1)
    refuse_option("MACHINE.toml", "expected one machine file, or axis files alone");
  if (!folder) {
    const char* why = machine ? "the drives alone, only to a whole configuration (-o FOLDER)"
                              : "axis files, only to a machine file";
    if (!o.parameters.empty()) refuse("--parameters", why);
    if (!o.axis_files.empty()) refuse("--axis-file", why);
  }
  if (machine && o.lincurve)
    refuse(
        "--lincurve",
        "a machine file, only to axis files; a whole configuration has its tables in control-lincurve.hal");
  if (machine && !folder) {
    constexpr const char* kWhy = "the drives alone, only to controllers: axis files, or -o FOLDER";
    if (!o.feedforward.empty()) refuse("--feedforward", kWhy);
    if (!o.omega.empty()) refuse("--omega", kWhy);
  }
  if (o.lincurve && !o.omega.empty())
    refuse("--omega", "a table, only to controllers (leave out --lincurve)");
  if (o.lincurve && !o.feedforward.empty())
    refuse("--feedforward", "a table, only to controllers (leave out --lincurve)");
  if (!o.lincurve && !o.speed.empty()) refuse("--speed", "anything but --lincurve");
}

/// For a machine: INI and HAL, or its drives alone; for axis files: controllers or tables.
Exported write(const ExportRequest& o) {
  const bool machine = std::any_of(o.files.begin(), o.files.end(), workflow::describes_machine);
  const bool folder = machine && !o.output.ends_with(".hal");
  check_options(o, machine, folder);
  const auto read_machine = [&] { return workflow::read_virtual_machine(o.files.front(), o.axis_files); };
  if (folder) return export_configuration(o, read_machine());
  io::check_writable(o.output);
  Exported out;
  out.json = {{"schema", "stribeck.export/1"}, {"to", kLinuxCnc.name}, {"file", o.output}};
  const std::string text = machine      ? plants(o, read_machine())
                           : o.lincurve ? tables(o, out.json["lincurve"], out.text)
                                        : controllers(o);
  io::write_atomically(o.output, text);
  out.text += fmt::format("{} lines of HAL in {}.\n", std::count(text.begin(), text.end(), '\n'), o.output);
  return out;
}

}  // namespace
}  // namespace linuxcnc

const Target kLinuxCnc{
    "linuxcnc", "axis files of identify, or one machine file",
    "NAME.hal, or of a machine a folder: INI and HAL",
    "none for controllers and drives; a table of lincurve has 16 points: its largest and RMS error stand in the file, "
    "on the screen and in the JSON",
    &linuxcnc::write};

}  // namespace stribeck::targets
