#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include <apps/cli/commands.hpp>
#include <apps/cli/shared.hpp>
#include <capi/parameters.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::vector<std::string> files;
  std::string to;
  std::string output;
  std::vector<std::string> names;
  std::string omega = "40 rad/s";
  std::string feedforward;
};

/// HAL's spelling of a parameter's name.
std::string hal_name(std::string_view name) {
  std::string out(name);
  std::replace(out.begin(), out.end(), '_', '-');
  return out;
}

std::string setp(const std::string& component, std::string_view parameter, double value,
                 std::string_view word = {}) {
  std::string line = fmt::format("setp {}.{} {}", component, hal_name(parameter), value);
  if (!word.empty()) line += fmt::format("  # {}", word);
  return line + '\n';
}

/// Every parameter that a struct holds.
template <class T>
std::string setp_all(const std::string& component, const T& value) {
  std::string out;
  capi::Name name;
  capi::values_of(name, value, "",
                  [&](std::string_view key, double x, std::string_view, std::string_view word) {
                    out += setp(component, key, x, word);
                  });
  return out;
}

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

std::string controllers(const Options& o) {
  const double omega = option_si("--omega", o.omega, quantity("rad/s", "rad/s").positive());
  constexpr const char* kAxes = "xyzabcuvw";
  if (o.files.size() > 9) refuse_option("AXIS.toml", "got more than nine axes");
  std::vector<std::string> axes;
  for (std::size_t i = 0; i < o.files.size(); ++i) axes.emplace_back(1, kAxes[i]);
  const std::vector<std::string> names = names_for(o, "ax.", axes);
  std::string out =
      fmt::format("# Written by: {}\n# SI units; angular frequencies in rad/s.\n", typed_command());
  out += fmt::format("# loadrt stribeck_axis names={}\n", fmt::join(names, ","));
  for (std::size_t i = 0; i < o.files.size(); ++i) {
    const auto model = io::read_toml<friction::AxisModel>(o.files[i]);
    const bool bristles = !std::holds_alternative<friction::Static>(model.friction.dynamics);
    const std::string feedforward = !o.feedforward.empty() ? o.feedforward
                                    : bristles             ? "dynamic"
                                                           : "reversal";
    out += fmt::format("\n# {} from {}\n", names[i], o.files[i]);
    out += setp(names[i], "omega", omega);
    constexpr std::array<std::string_view, 4> kWords{"none", "steady", "dynamic", "reversal"};
    const auto which = std::find(kWords.begin(), kWords.end(), feedforward) - kWords.begin();
    out += setp(names[i], "feedforward", static_cast<double>(which), feedforward);
    out += setp(names[i], "guarded", 1.0);
    out += setp_all(names[i], model);
  }
  return out;
}

std::string plants(const Options& o) {
  const sim::Machine machine = load_machine(o.files.front());
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
    out += setp_all(names[i], machine.axes[i].second.plant);
  }
  return out;
}

int export_to(const Options& o) {
  if (!o.common.report.empty()) refuse_option("--report", "export writes no page");
  check_distinct(o.files, {o.output, o.common.json});
  check_outputs(o.common);
  check_writable(o.output);
  const bool machine = io::load_toml(o.files.front()).find("axes") != nullptr;
  if (machine && o.files.size() > 1)
    refuse_option("MACHINE.toml", "expected one machine file, or axis files alone");
  if (machine && !o.feedforward.empty())
    refuse_option("--feedforward", "does not apply to a machine file, only to axis files");
  const std::string text = machine ? plants(o) : controllers(o);
  io::write_atomically(o.output, text);
  write_json(o.common.json, {{"schema", "stribeck.export/1"}, {"to", o.to}, {"file", o.output}});
  say(o.common,
      fmt::format("{} lines of HAL in {}.\n", std::count(text.begin(), text.end(), '\n'), o.output));
  return 0;
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("export", "Parameters as another program takes them");
  auto o = std::make_shared<Options>();
  verb->add_option("files", o->files,
                   "Axis files that identify wrote: the controllers; or one machine file: its virtual drives")
      ->required()
      ->type_name("FILE.toml");
  verb->add_option("--to", o->to, "linuxcnc: setp lines of stribeck_axis, or stribeck_plant, for a HAL file")
      ->required()
      ->check(CLI::IsMember({"linuxcnc"}));
  verb->add_option("-o,--output", o->output, "File to write")->required()->type_name("AXIS.hal");
  verb->add_option("--name", o->names, "HAL name of each axis; left out: ax.x, ax.y, …, or pl.x, pl.y, …")
      ->type_name("NAME");
  verb->add_option("--omega", o->omega, "Double pole of the position loops")
      ->type_name("FREQUENCY")
      ->capture_default_str();
  verb->add_option(
          "--feedforward", o->feedforward,
          "none, steady, dynamic or reversal; left out: dynamic where the file has bristles, else reversal")
      ->check(CLI::IsMember({"none", "steady", "dynamic", "reversal"}));
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer("Example:\n  stribeck export x.toml y.toml --to linuxcnc --omega \"60 rad/s\" -o axes.hal");
  verb->callback([o, &action] { action = [o] { return export_to(*o); }; });
}

}  // namespace stribeck::cli
