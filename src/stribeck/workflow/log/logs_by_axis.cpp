#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>

namespace stribeck::workflow {
namespace {

std::vector<std::string> axes_of(const sim::Machine& machine) {
  std::vector<std::string> names;
  for (const auto& [name, axis] : machine.axes) names.push_back(name);
  return names;
}

/// Words of letters and digits, lower case.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : io::lower_case(text)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

/// Axes that stand behind or before a quantity in the names of columns: x_y is the position of y.
std::vector<std::string> axes_in_columns(const io::Log& log, const std::vector<std::string>& axes) {
  std::vector<std::string> found;
  for (const std::string& axis : axes) {
    const bool there = std::any_of(log.columns.begin(), log.columns.end(), [&](const io::Column& c) {
      const std::vector<std::string> words = words_of(c.name);
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

/// Unit of the force of this axis; empty: the log has no such axis.
std::string unit_of(const io::Log& log, LogOptions options, const std::string& axis) {
  options.axis = axis;
  try {
    const LoggedAxis found = logged_axis(log, options);
    return found.runs.empty() ? std::string() : found.runs.front().force_unit;
  } catch (const io::InputError&) {
    return {};
  }
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
    if (!unit_of(log, options, axis).empty()) named.push_back(axis);
  }
  // Columns that an axis of any name could take carry none.
  const bool plain = !unit_of(log, options, "any other").empty();
  if (!named.empty() && !plain) return named;
  const std::vector<std::string> words = words_of(std::filesystem::path(path).stem().string());
  std::vector<std::string> by_name;
  for (const std::string& axis : axes) {
    if (std::find(words.begin(), words.end(), io::lower_case(axis)) != words.end()) by_name.push_back(axis);
  }
  return by_name.size() == 1 ? by_name : std::vector<std::string>();
}

}  // namespace

std::vector<LogsOfAxis> logs_by_axis(const sim::Machine& machine, const std::vector<std::string>& logs,
                                     const LogOptions& options) {
  const std::vector<std::string> axes = axes_of(machine);
  std::vector<LogsOfAxis> all;
  for (const std::string& axis : axes) {
    all.push_back({axis, options, {}});
    all.back().options.axis = axis;
  }
  for (const std::string& path : logs) {
    const io::Log log = read_log(path, options);
    const std::vector<std::string> found = axes_in(log, path, options, axes);
    if (found.empty()) {
      throw io::InputError(
          {path, 0, "",
           fmt::format(
               "it is not known to which axis of {} this log belongs (write \"# axis: {}\" as its first line, name it {}-….csv, or identify it alone with --axis)",
               machine.name, axes.front(), axes.front())});
    }
    for (LogsOfAxis& one : all) {
      if (std::find(found.begin(), found.end(), one.axis) == found.end()) continue;
      one.logs.push_back(path);
      const auto at = std::find(axes.begin(), axes.end(), one.axis) - axes.begin();
      if (one.options.gain.empty() && unit_of(log, options, one.axis) == "V")
        one.options.gain =
            fmt::format("{} N/V", machine.axes[static_cast<std::size_t>(at)].second.plant.force_gain());
    }
  }
  std::erase_if(all, [&](const LogsOfAxis& one) {
    return one.logs.empty() || (!options.axis.empty() && one.axis != options.axis);
  });
  return all;
}

}  // namespace stribeck::workflow
