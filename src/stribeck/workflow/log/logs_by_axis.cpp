#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>

namespace stribeck::workflow {
namespace {

std::vector<std::string> axes_of(const MachineDescription& machine) {
  std::vector<std::string> names;
  for (const auto& [name, axis] : machine.axes) names.push_back(name);
  return names;
}

/// Axes that stand behind or before a quantity in the names of columns: x_y is the position of y.
std::vector<std::string> axes_in_columns(const io::Log& log, const std::vector<std::string>& axes) {
  std::vector<std::string> found;
  for (const std::string& axis : axes) {
    const bool there = std::any_of(log.columns.begin(), log.columns.end(), [&](const io::Column& c) {
      const std::vector<std::string> words = words_of_name(c.name);
      if (words.size() < 2) return false;
      const auto is_axis = [&](const std::string& word) {
        return std::any_of(axes.begin(), axes.end(),
                           [&](const std::string& a) { return io::lower_case(a) == word; });
      };
      return words.back() == io::lower_case(axis) ||
             (words.front() == io::lower_case(axis) && !is_axis(words.back()));
    });
    if (there) found.push_back(axis);
  }
  return found;
}

DriveScale scale_of(const AxisDescription& axis) {
  DriveScale scale;
  if (axis.drive) scale.motors = axis.drive->motors;
  const auto text = [](std::optional<double> value, const char* unit) {
    return value && *value > 0.0 ? fmt::format("{} {}", *value, unit) : std::string();
  };
  scale.per_volt = text(axis.force_per_volt(), "N/V");
  scale.rotary = axis.rotary;
  if (axis.rotary) scale.lead = "360 deg";
  if (!axis.drive) return scale;
  scale.at_100_percent = text(axis.drive->rated(), "N");
  scale.per_ampere = text(axis.drive->per_ampere(), "N/A");
  if (const auto r = axis.drive->radius()) {
    scale.lead = axis.rotary ? text(360.0 * *r, "deg") : text(2e3 * kPi * *r, "mm");
    scale.per_newton_metre = text(axis.drive->motors / *r, "1/m");
  }
  if (const auto step = axis.drive->resolution())
    scale.count = axis.rotary ? text(*step * 180.0 / kPi, "deg") : text(*step * 1e3, "mm");
  return scale;
}

/// Whether the log has an axis of this name.
bool has_axis(const io::Log& log, LogOptions options, const std::string& axis) {
  options.axis = axis;
  try {
    return !logged_axis(log, options).runs.empty();
  } catch (const io::InputError&) {
    return false;
  }
}

/// The axis that a log names in its head where the machine has none of this name; else empty.
std::string stranger_in(const io::Log& log, const std::vector<std::string>& axes) {
  for (const auto& [key, value] : log.metadata) {
    if (key != "axis") continue;
    const auto same = [&, name = io::lower_case(value)](const std::string& a) {
      return io::lower_case(a) == name;
    };
    if (std::none_of(axes.begin(), axes.end(), same)) return value;
  }
  return {};
}

std::vector<std::string> axes_in(const io::Log& log, const std::string& path, const LogOptions& options,
                                 const std::vector<std::string>& axes) {
  for (const auto& [key, value] : log.metadata) {
    for (const std::string& axis : axes) {
      if (key == "axis" && io::lower_case(value) == io::lower_case(axis)) return {axis};
    }
  }
  if (axes.size() == 1) return axes;
  if (const auto labelled = axes_in_columns(log, axes); !labelled.empty()) return labelled;
  std::vector<std::string> named;
  for (const std::string& axis : axes) {
    if (has_axis(log, options, axis)) named.push_back(axis);
  }
  // Where an invented axis name finds columns too, the columns carry no name of an axis.
  const bool plain = has_axis(log, options, "any other");
  if (!named.empty() && !plain) return named;
  const std::vector<std::string> words = words_of_name(std::filesystem::path(path).stem().string());
  std::vector<std::string> by_name;
  for (const std::string& axis : axes) {
    if (std::find(words.begin(), words.end(), io::lower_case(axis)) != words.end()) by_name.push_back(axis);
  }
  return by_name.size() == 1 ? by_name : std::vector<std::string>();
}

/// Whether the axis keeps one position in all rows of this log.
bool rests(const io::Log& log, LogOptions options, const std::string& axis) {
  options.axis = axis;
  try {
    const LoggedAxis logged = logged_axis(log, options);
    const double first = logged.runs.empty() || logged.runs.front().x.y.empty()
                             ? std::numeric_limits<double>::quiet_NaN()
                             : logged.runs.front().x.y.front();
    return std::isfinite(first) &&
           std::all_of(logged.runs.begin(), logged.runs.end(), [&](const ident::log::RawLog& run) {
             return std::all_of(run.x.y.begin(), run.x.y.end(), [&](double x) { return x == first; });
           });
  } catch (const io::InputError&) {
    return false;  // what is wrong is said where the log is read
  }
}

/// A control records all its axes while one of them moves: those that rest say nothing.
void leave_out_resting(std::vector<std::string>& found, const io::Log& log, const LogOptions& options) {
  if (found.size() < 2 || !options.axis.empty()) return;
  std::vector<std::string> moving;
  for (const std::string& axis : found) {
    if (!rests(log, options, axis)) moving.push_back(axis);
  }
  if (!moving.empty()) found = std::move(moving);
}

}  // namespace

std::vector<LogsOfAxis> logs_by_axis(const MachineDescription& machine, const std::vector<std::string>& logs,
                                     const LogOptions& given) {
  LogOptions options = given;
  if (machine.sample_time > 0.0) options.drive.sample_time = fmt::format("{} s", machine.sample_time);
  const std::vector<std::string> axes = axes_of(machine);
  std::vector<LogsOfAxis> all;
  for (const auto& [name, axis] : machine.axes) {
    all.push_back({name, options, {}, {}});
    all.back().options.axis = name;
    all.back().options.drive = scale_of(axis);
    all.back().options.drive.sample_time = options.drive.sample_time;
  }
  for (const std::string& path : logs) {
    const io::Log log = read_log(path, options);
    const std::string other = stranger_in(log, axes);
    if (!other.empty() && options.axis.empty()) {
      throw io::InputError(
          {path, 0, "axis",
           fmt::format(
               "the log says that it is of axis {}; {} has {} (give the machine of this log, or take it "
               "for one of them with --axis {})",
               other, machine.name, fmt::join(axes, ", "), axes.front())});
    }
    std::vector<std::string> found = axes_in(log, path, options, axes);
    if (found.empty() && std::find(axes.begin(), axes.end(), options.axis) != axes.end())
      found = {options.axis};
    if (found.empty()) {
      throw io::InputError(
          {path, 0, "",
           fmt::format(
               "it is not known to which axis of {} this log belongs (write \"# axis: {}\" as its first line, name it {}-….csv, or identify it alone with --axis)",
               machine.name, axes.front(), axes.front())});
    }
    leave_out_resting(found, log, options);
    for (LogsOfAxis& one : all) {
      if (std::find(found.begin(), found.end(), one.axis) == found.end()) continue;
      one.logs.push_back(path);
      if (!other.empty()) {
        one.notes.push_back(fmt::format(
            "{} is a log of axis {}, as its head says; {} has no such axis, and it is taken for axis {}",
            path, other, machine.name, one.axis));
      }
    }
  }
  std::erase_if(all, [&](const LogsOfAxis& one) {
    return one.logs.empty() || (!options.axis.empty() && one.axis != options.axis);
  });
  return all;
}

}  // namespace stribeck::workflow
