#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <variant>
#include <vector>

#include <stribeck/friction/axis_model.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/targets/linuxcnc/axis_lines.hpp>
#include <stribeck/targets/linuxcnc/hal_axis.hpp>
#include <stribeck/targets/linuxcnc/hal_lines.hpp>
#include <stribeck/targets/linuxcnc/lincurve.hpp>
#include <stribeck/targets/target.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets::linuxcnc {

using workflow::option_si;
using workflow::refuse_option;
using workflow::travel_si;

namespace {

/// HAL names have 47 characters; the longest parameter takes 40 and a dot.
constexpr std::size_t kLongestName = 6;

void check_name(const std::string& name) {
  constexpr std::string_view kPermitted = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-";
  if (name.empty() || name.size() > kLongestName || name.find_first_not_of(kPermitted) != std::string::npos) {
    refuse_option("--name", fmt::format("got {}, expected 1 to {} letters, digits, dots and hyphens",
                                        io::in_quotes(name), kLongestName));
  }
}

/// Names of the HAL instances: the given ones, or a prefix with x, y, z, …
std::vector<std::string> names_for(const ExportRequest& o, const std::string& prefix,
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

/// As the axis files say, small or capital; x, y, … where one does not say a letter of LinuxCNC, or two say the same.
std::vector<std::string> letters_for(const ExportRequest& o) {
  if (o.files.size() > kAxisLetters.size()) refuse_option("AXIS.toml", "got more than nine axes");
  std::vector<std::string> axes;
  for (const std::size_t number : axis_numbers(axes_in_files(o))) axes.emplace_back(1, kAxisLetters[number]);
  return axes;
}

/// Largest speed of the table [m/s].
double table_speed(const ExportRequest& o, const std::string& file, const sim::AxisFile& axis) {
  if (!o.speed.empty())
    return travel_si("--speed", o.speed, quantity("m/s", "mm/s").positive(), axis.rotary.value_or(false));
  const std::optional<double> identified = axis.identified_speed();
  if (!identified)
    refuse_option("--speed",
                  fmt::format("missing: {} does not say how fast the axis goes, e.g. \"100 mm/s\"", file));
  return *identified;
}

/// A line for an axis whose machine unit is not a millimetre; else nothing.
std::string unit_line(const std::string& name, std::string_view axis, bool rotary) {
  const double unit = unit_of(axis, rotary);
  if (rotary) return setp(name, "position-unit", unit, "a rotary axis: LinuxCNC counts in degrees");
  if (!counts_degrees(axis)) return {};
  return setp(
      name, "position-unit", unit,
      fmt::format(
          "LinuxCNC counts axis {} in degrees; a file without rotary = true has arcs at a radius of {:g} mm",
          axis, 1e3 * HalAxis{}.radius));
}

}  // namespace

double omega_of(const ExportRequest& o) {
  return option_si("--omega", o.omega.empty() ? kOmega : o.omega,
                   quantity("rad/s", "rad/s").positive().at_most(1e5));
}

std::string controllers(const ExportRequest& o) {
  const double omega = omega_of(o);
  const std::vector<std::string> names = names_for(o, "ax.", letters_for(o));
  std::string out =
      io::comment_lines("Written by: " + o.command) + "# SI units; angular frequencies in rad/s.\n";
  out += fmt::format("# loadrt stribeck_axis names={}\n", fmt::join(names, ","));
  for (std::size_t i = 0; i < o.files.size(); ++i) {
    const auto file = workflow::read_axis_file(o.files[i]);
    out += '\n' + io::comment_lines(fmt::format("{} from {}", names[i], o.files[i]));
    out += unit_line(names[i], file.axis.value_or(""), file.rotary.value_or(false));
    out += controller_lines(names[i], file.model, omega, o.feedforward);
  }
  return out;
}

std::string tables(const ExportRequest& o, nlohmann::ordered_json& json, std::string& words) {
  const std::vector<std::string> names = names_for(o, "ff.", letters_for(o));
  std::string out = io::comment_lines("Written by: " + o.command) +
                    "# Velocities in mm/s, forces in N: for net ff.x.in from joint.0.vel-cmd, and "
                    "ff.x.out added to the force.\n"
                    "# Viscous friction is in the table: FF1 of pid is 0. Load is not: pid.bias.\n";
  std::string points;
  std::string body;
  json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < o.files.size(); ++i) {
    const auto file = workflow::read_axis_file(o.files[i]);
    const friction::AxisModel& model = file.model;
    const bool rotary = file.rotary.value_or(false);
    const bool degrees = rotary || counts_degrees(file.axis.value_or(""));
    const double unit = unit_of(file.axis.value_or(""), rotary);
    const Lincurve table = best_lincurve(model, table_speed(o, o.files[i], file), unit);
    const std::string worth = lincurve_words(table, model, degrees ? "deg/s" : "mm/s");
    points += fmt::format("{}{}", points.empty() ? "" : ",", table.table.corners.size());
    body += '\n' + io::comment_lines(fmt::format("{} from {}: {}", names[i], o.files[i], worth));
    if (rotary) {
      body += "# A rotary axis: its velocities are in deg/s, N stands for N m.\n";
    } else if (degrees) {
      body += fmt::format(
          "# LinuxCNC counts axis {} in degrees: its velocities are in deg/s. A file without rotary = true has forces in N and arcs at a "
          "radius of {:g} mm.\n",
          *file.axis, 1e3 * HalAxis{}.radius);
    }
    if (model.load != 0.0)
      body += fmt::format("# pid.bias for the load: {} N\n", report::significant(model.load, 4));
    body += lincurve_lines(names[i], table);
    words += fmt::format("{}: {}.\n", names[i], worth);
    nlohmann::ordered_json point = nlohmann::ordered_json::array();
    for (const Corner& c : table.table.corners) point.push_back({c.x, c.y});
    json.push_back({{"name", names[i]},
                    {"file", o.files[i]},
                    {"max_error_N", table.max_error},
                    {"rms_error_N", table.rms_error},
                    {degrees ? "points_deg_per_s_N" : "points_mm_per_s_N", point}});
  }
  out += fmt::format("# loadrt lincurve names={} personality={}\n", fmt::join(names, ","), points);
  return out + body;
}

std::string plants(const ExportRequest& o, const sim::Machine& machine) {
  std::vector<std::string> axes;
  for (const auto& [axis, unused] : machine.axes) axes.push_back(axis);
  const std::vector<std::string> names = names_for(o, "pl.", axes);
  std::string out = io::comment_lines("Written by: " + o.command) +
                    io::comment_lines(fmt::format("{}: {}", machine.name, machine.origin));
  out += fmt::format("# loadrt stribeck_plant names={}, in a thread of {} ms\n", fmt::join(names, ","),
                     1e3 * machine.sample_time);
  for (std::size_t i = 0; i < names.size(); ++i) {
    out +=
        fmt::format("\n# axis {}, largest force {:.6g} N\n", axes[i], machine.axes[i].second.force_limit());
    out += unit_line(names[i], axes[i], machine.axes[i].second.rotary);
    out += plant_lines(names[i], machine.axes[i].second);
  }
  return out;
}

}  // namespace stribeck::targets::linuxcnc
