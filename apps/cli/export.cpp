#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/targets/linuxcnc/configuration.hpp>
#include <stribeck/targets/linuxcnc/hal_lines.hpp>
#include <stribeck/targets/linuxcnc/limits.hpp>
#include <stribeck/targets/linuxcnc/lincurve.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {

using namespace targets::linuxcnc;

namespace {

using Json = nlohmann::ordered_json;

struct Options {
  Common common;
  std::vector<std::string> files;
  std::string to;
  std::string output;
  std::vector<std::string> names;
  std::string omega;  ///< empty: 40 rad/s, or that of the machine file
  std::string feedforward;
  bool lincurve = false;
  std::string speed;                    ///< of the table; empty: the model's own range
  std::string parameters;               ///< empty: identified
  std::vector<std::string> axis_files;  ///< AXIS=FILE
};

constexpr const char* kOmega = "40 rad/s";

/// HAL names have 47 characters, of which the longest parameter takes 40 and a dot.
constexpr std::size_t kLongestName = 6;

void check_name(const std::string& name) {
  constexpr std::string_view kPermitted = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-";
  if (name.empty() || name.size() > kLongestName || name.find_first_not_of(kPermitted) != std::string::npos) {
    refuse_option("--name", fmt::format("got {}, expected 1 to {} letters, digits, dots and hyphens",
                                        io::in_quotes(name), kLongestName));
  }
}

/// Names of the HAL instances: those given, or a prefix with x, y, z, …
std::vector<std::string> names_for(const Options& o, const std::string& prefix,
                                   const std::vector<std::string>& axes) {
  std::vector<std::string> names = o.names;
  if (names.empty()) {
    for (const std::string& axis : axes) names.push_back(prefix + axis);
  } else if (names.size() != axes.size()) {
    refuse_option("--name", fmt::format("got {}, expected {}, one for each axis", names.size(), axes.size()));
  }
  for (const std::string& name : names) check_name(name);
  if (std::set(names.begin(), names.end()).size() != names.size())
    refuse_option("--name", "expected names that differ");
  return names;
}

double omega_of(const Options& o) {
  return option_si("--omega", o.omega.empty() ? kOmega : o.omega, quantity("rad/s", "rad/s").positive());
}

std::vector<std::string> letters_for(const Options& o) {
  constexpr const char* kAxes = "xyzabcuvw";
  if (o.files.size() > 9) refuse_option("AXIS.toml", "got more than nine axes");
  std::vector<std::string> axes;
  for (std::size_t i = 0; i < o.files.size(); ++i) axes.emplace_back(1, kAxes[i]);
  return axes;
}

std::string controllers(const Options& o) {
  const double omega = omega_of(o);
  const std::vector<std::string> names = names_for(o, "ax.", letters_for(o));
  std::string out =
      fmt::format("# Written by: {}\n# SI units; angular frequencies in rad/s.\n", typed_command());
  out += fmt::format("# loadrt stribeck_axis names={}\n", fmt::join(names, ","));
  for (std::size_t i = 0; i < o.files.size(); ++i) {
    const auto model = io::read_toml<friction::AxisModel>(o.files[i]);
    out += fmt::format("\n# {} from {}\n", names[i], o.files[i]);
    out += controller_lines(names[i], model, omega, o.feedforward);
  }
  return out;
}

/// Largest speed of the table [m/s].
double table_speed(const Options& o, const std::string& file, const friction::AxisModel& model) {
  if (!o.speed.empty()) return option_si("--speed", o.speed, quantity("m/s", "mm/s").positive());
  const auto range = model.friction.identified_range();
  if (!range)
    refuse_option("--speed",
                  fmt::format("missing: {} does not say how fast the axis goes, e.g. \"100 mm/s\"", file));
  return std::min(-(*range)[0], (*range)[1]);
}

std::string tables(const Options& o, Json& json, std::string& words) {
  const std::vector<std::string> names = names_for(o, "ff.", letters_for(o));
  std::string out = fmt::format(
      "# Written by: {}\n# Velocities in mm/s, forces in N: for net ff.x.in from joint.0.vel-cmd, and "
      "ff.x.out added to the force.\n"
      "# Viscous friction is in the table: FF1 of pid is 0. Load is not: pid.bias.\n",
      typed_command());
  std::string points;
  std::string body;
  json = Json::array();
  for (std::size_t i = 0; i < o.files.size(); ++i) {
    const auto model = io::read_toml<friction::AxisModel>(o.files[i]);
    const Lincurve table = best_lincurve(model, table_speed(o, o.files[i], model), 1e-3);
    const std::string worth = lincurve_words(table, model, "mm/s");
    points += fmt::format("{}{}", points.empty() ? "" : ",", table.table.corners.size());
    body += fmt::format("\n# {} from {}: {}\n", names[i], o.files[i], worth);
    if (model.load != 0.0)
      body += fmt::format("# pid.bias for the load: {} N\n", report::significant(model.load, 4));
    body += lincurve_lines(names[i], table);
    words += fmt::format("{}: {}.\n", names[i], worth);
    Json point = Json::array();
    for (const Corner& c : table.table.corners) point.push_back({c.x, c.y});
    json.push_back({{"name", names[i]},
                    {"file", o.files[i]},
                    {"max_error_N", table.max_error},
                    {"rms_error_N", table.rms_error},
                    {"points_mm_per_s_N", point}});
  }
  out += fmt::format("# loadrt lincurve names={} personality={}\n", fmt::join(names, ","), points);
  return out + body;
}

std::string plants(const Options& o, const sim::Machine& machine) {
  std::vector<std::string> axes;
  for (const auto& [axis, unused] : machine.axes) axes.push_back(axis);
  const std::vector<std::string> names = names_for(o, "pl.", axes);
  std::string out =
      fmt::format("# Written by: {}\n# {}: {}\n", typed_command(), machine.name, machine.origin);
  out += fmt::format("# loadrt stribeck_plant names={}, in a thread of {} ms\n", fmt::join(names, ","),
                     1e3 * machine.sample_time);
  for (std::size_t i = 0; i < names.size(); ++i) {
    out +=
        fmt::format("\n# axis {}, largest force {:.6g} N\n", axes[i], machine.axes[i].second.force_limit());
    out += plant_lines(names[i], machine.axes[i].second);
  }
  return out;
}

/// What the controllers of each axis know.
std::vector<friction::AxisModel> models_of(const Options& o, const sim::Machine& machine) {
  const std::string& file = o.files.front();
  std::map<std::size_t, friction::AxisModel> given;
  for (const std::string& text : o.axis_files) {
    const auto [axis, axis_file] = axis_and_file(text);
    const std::size_t i = axis_index(machine, file, axis);
    if (!given.emplace(i, io::read_toml<friction::AxisModel>(axis_file)).second)
      refuse_option("--axis-file", fmt::format("axis {} is given twice", machine.axes[i].first));
  }
  std::vector<friction::AxisModel> models(machine.axes.size());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const sim::Commissioning& known = machine.axes[i].second.commissioning;
    if (const auto found = given.find(i); found != given.end()) {
      models[i] = found->second;
    } else if (o.parameters == "commissioning") {
      models[i].mass = known.mass;
      models[i].friction.steady = friction::Conventional<double>{known.friction, 0.0, {}};
    } else {
      open.push_back(i);
    }
  }
  Needs needs;
  needs.whole = true;
  sim::parallel_for(
      open.size(), 0, [] { return 0; },
      [&](int&, std::size_t k) {
        models[open[k]] = commission_axis(machine, open[k], needs, 1).knowledge.whole.value();
      });
  return models;
}

std::string base_name(const std::string& file) { return std::filesystem::path(file).filename().string(); }

Configuration configuration(const Options& o, const sim::Machine& machine) {
  const std::vector<std::string> letters = linuxcnc_letters(machine, o.files.front());
  Configuration c;
  c.name = machine.name;
  c.sample_time = machine.sample_time;
  c.feedforward = o.feedforward;
  // One for all axes, so that no direction has other gains than another.
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
  c.comment = fmt::format("# Written by: {} -o FOLDER\n", command);
  std::vector<DrivableLimits> can;
  for (const auto& [axis, a] : machine.axes) {
    can.push_back(drivable_limits(a));
    if (can.back().limits.speed > 0.0) continue;
    throw io::InputError(
        {o.files.front(), 0, "axes." + axis,
         fmt::format("the drive's {:.6g} N are too few for friction and load of this axis at any speed, "
                     "with a fifth left to accelerate (raise plant.drive.gain or plant.converter.range)",
                     a.force_limit())});
  }
  const std::vector<friction::AxisModel> models = models_of(o, machine);
  for (std::size_t i = 0; i < letters.size(); ++i)
    c.axes.push_back({letters[i], &machine.axes[i].second, can[i], models[i]});
  return c;
}

/// All texts are there before the first is written.
int export_configuration(const Options& o, const sim::Machine& machine) {
  namespace fs = std::filesystem;
  if (!o.names.empty())
    refuse_option("--name",
                  "does not apply to a whole configuration, which has names of its own (or -o NAME.hal)");
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
  const OutputFolder folder(o.output);
  const WrittenFolder written = write_folder(o.output, c.comment, files);
  fs::permissions(fs::path(o.output) / "play.py",
                  fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                  fs::perm_options::add, ignored);
  write_json(o.common.json, {{"schema", "stribeck.export/1"},
                             {"to", o.to},
                             {"folder", o.output},
                             {"files", written.files},
                             {"kept", written.kept}});
  std::string words = fmt::format("{} files in {}.\n", written.files.size(), o.output);
  if (!written.kept.empty())
    words += fmt::format("Kept, because edited since the last export: {} (remove a file to write it anew).\n",
                         report::listed(written.kept));
  say(o.common, words + fmt::format("  linuxcnc {}       with the AXIS screen\n"
                                    "  linuxcnc -r {}   without a screen\n",
                                    (fs::path(o.output) / "machine.ini").string(),
                                    (fs::path(o.output) / "headless.ini").string()));
  return 0;
}

/// Refuses what would change nothing.
void check_options(const Options& o, bool machine, bool folder) {
  const auto refuse = [](const char* option, const char* why) {
    refuse_option(option, std::string("does not apply to ") + why);
  };
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

int export_to(const Options& o) {
  const bool machine = std::any_of(o.files.begin(), o.files.end(), [](const std::string& file) {
    return io::load_toml(file).find("axes") != nullptr;
  });
  const bool folder = machine && !o.output.ends_with(".hal");
  check_options(o, machine, folder);
  std::vector<std::string> inputs = o.files;
  for (const std::string& text : o.axis_files) inputs.push_back(axis_and_file(text).second);
  check_distinct(inputs, {o.output, o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  if (folder) return export_configuration(o, load_machine(o.files.front()));
  io::check_writable(o.output);
  Json json = {{"schema", "stribeck.export/1"}, {"to", o.to}, {"file", o.output}};
  std::string words;
  const std::string text = machine      ? plants(o, load_machine(o.files.front()))
                           : o.lincurve ? tables(o, json["lincurve"], words)
                                        : controllers(o);
  io::write_atomically(o.output, text);
  write_json(o.common.json, json);
  say(o.common,
      fmt::format("{}{} lines of HAL in {}.\n", words, std::count(text.begin(), text.end(), '\n'), o.output));
  return 0;
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("export", "Write identified parameters in the format of another program");
  auto o = std::make_shared<Options>();
  verb->add_option(
          "files", o->files,
          "Axis files written by identify, to export controllers; or one machine file, to export a whole configuration or its virtual drives")
      ->required()
      ->type_name("FILE.toml");
  verb->add_option("--to", o->to, "linuxcnc: INI and HAL")->required()->check(one_of({"linuxcnc"}));
  verb->add_option(
          "-o,--output", o->output,
          "File to write (NAME.hal); for a machine file also a folder, which becomes a whole configuration")
      ->required()
      ->type_name("NAME.hal|FOLDER");
  verb->add_option("--name", o->names,
                   "HAL name of each axis; left out: ax.x, ax.y, …, or pl.x, … of drives, ff.x, … of tables")
      ->type_name("NAME");
  verb->add_option("--omega", o->omega,
                   std::string("Double pole of the position loops; left out: ") + kOmega +
                       ", or what the machine file has for commissioning")
      ->type_name("FREQUENCY");
  verb->add_option(
          "--feedforward", o->feedforward,
          "none, steady, dynamic or reversal; left out: dynamic where the file has bristles, else reversal")
      ->check(one_of({"none", "steady", "dynamic", "reversal"}));
  verb->add_flag(
      "--lincurve", o->lincurve,
      "For axis files: write the steady friction as a table of 16 points for LinuxCNC's stock component lincurve, and print the error of that table");
  verb->add_option("--speed", o->speed,
                   "For --lincurve: largest speed of the table; left out: that of the identified range")
      ->type_name("SPEED");
  verb->add_option(
          "--parameters", o->parameters,
          "For a configuration, parameters of its controllers: identified (from simulated logs of this machine, the default) or commissioning (the rough values of the machine file)")
      ->check(one_of({"identified", "commissioning"}));
  verb->add_option(
          "--axis-file", o->axis_files,
          "For a configuration: axis file written by identify, to be used for this axis; repeat for more axes")
      ->type_name("AXIS=FILE");
  add_common(*verb, o->common, Page::kNone);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck export machines/triaxial-tool.toml --to linuxcnc -o triaxial\n"
      "  stribeck export x.toml y.toml --to linuxcnc --omega \"60 rad/s\" -o axes.hal\n"
      "  stribeck export x.toml --to linuxcnc --lincurve --speed \"100 mm/s\" -o lincurve.hal");
  verb->callback([o, &action] { action = [o] { return export_to(*o); }; });
}

}  // namespace stribeck::cli
