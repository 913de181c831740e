#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>
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

/// Whether the last word of a name is the symbol of a unit and no axis: "current_a" in amperes, "Temperature C".
bool ends_with_unit(const std::vector<std::string>& words) {
  struct Symbol {
    std::string_view unit;
    std::vector<std::string_view> parts;  ///< of words for what it measures
  };
  static const std::vector<Symbol> kSymbols{{"a", {"curr", "strom", "amp", "cour", "corr"}},
                                            {"c", {"temp", "celsius"}},
                                            {"v", {"volt", "spannung", "tension", "monitor"}},
                                            {"w", {"power", "leistung", "puiss", "poten"}}};
  return std::any_of(kSymbols.begin(), kSymbols.end(), [&](const Symbol& s) {
    return words.back() == s.unit && std::any_of(words.begin(), words.end() - 1, [&](const std::string& w) {
             return std::any_of(s.parts.begin(), s.parts.end(),
                                [&](std::string_view part) { return w.find(part) != std::string::npos; });
           });
  });
}

/// Axes that stand behind or before a quantity in the names of columns: x_y is the position of y. "current_a" tells of an axis a only
/// where another column does.
std::vector<std::string> axes_in_columns(const io::Log& log, const std::vector<std::string>& axes) {
  std::vector<std::string> found;
  for (const std::string& axis : axes) {
    const bool there = std::any_of(log.columns.begin(), log.columns.end(), [&](const io::Column& c) {
      const std::vector<std::string> words = words_of_name(c.name);
      if (words.size() < 2) return false;
      const bool unit = ends_with_unit(words);
      const auto is_axis = [&](const std::string& word) {
        return std::any_of(axes.begin(), axes.end(),
                           [&](const std::string& a) { return io::lower_case(a) == word; });
      };
      return (words.back() == io::lower_case(axis) && !unit) ||
             (words.front() == io::lower_case(axis) && (unit || !is_axis(words.back())));
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
  const RoughAxis& rough = axis.commissioning;
  const bool is_told = !rough.load.empty() && !rough.unbalance;
  scale.balanced = is_told && rough.load.low() == 0.0 && rough.load.high() == 0.0;
  scale.weighted = is_told && !scale.balanced;
  if (axis.rotary) scale.lead = "360 deg";
  if (!axis.drive) return scale;
  scale.at_100_percent = text(axis.drive->rated(), "N");
  scale.per_ampere = text(axis.drive->per_ampere(), "N/A");
  scale.ampere_doubt = axis.drive->constant_doubt();
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
    const bool unit = std::any_of(log.columns.begin(), log.columns.end(), [&](const io::Column& c) {
      const std::vector<std::string> words = words_of_name(c.name);
      return words.size() > 1 && words.back() == io::lower_case(axis) && ends_with_unit(words);
    });
    if (!unit && has_axis(log, options, axis)) named.push_back(axis);
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

/// How far an axis goes in a log, and by how much its position changes at least from row to row.
struct Motion {
  double span = std::numeric_limits<double>::infinity();  ///< infinite: not known
  double step = 0.0;                                      ///< 0: it does not change
};

Motion motion_in(const io::Log& log, LogOptions options, const std::string& axis) {
  options.axis = axis;
  try {
    double low = std::numeric_limits<double>::infinity(), high = -low, step = low;
    for (const ident::log::RawLog& run : logged_axis(log, options).runs) {
      const std::vector<double>& x = run.x.y;
      for (std::size_t k = 0; k < x.size(); ++k) {
        if (!std::isfinite(x[k])) continue;
        low = std::min(low, x[k]);
        high = std::max(high, x[k]);
        const double change = k > 0 ? std::abs(x[k] - x[k - 1]) : 0.0;
        if (change > 0.0) step = std::min(step, change);
      }
    }
    if (low > high) return {};
    return {high - low, std::isfinite(step) ? step : 0.0};
  } catch (const io::InputError&) {
    return {};  // what is wrong is said where the log is read
  }
}

/// A control records all its axes while one of them moves: those that rest say nothing. The encoder of an axis that rests may go to and
/// fro by a step or two.
void leave_out_resting(std::vector<std::string>& found, const io::Log& log, const LogOptions& options) {
  constexpr double kSteps = 3.5;     // of its encoder
  constexpr double kFarLess = 1e-3;  // of the axis that moves farthest
  if (found.size() < 2 || !options.axis.empty()) return;
  std::vector<Motion> motions;
  double farthest = 0.0;
  for (const std::string& axis : found) {
    motions.push_back(motion_in(log, options, axis));
    if (std::isfinite(motions.back().span)) farthest = std::max(farthest, motions.back().span);
  }
  std::vector<std::string> moving;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Motion& m = motions[i];
    const bool rests = m.span == 0.0 || (m.span <= kSteps * m.step && m.span < kFarLess * farthest);
    if (!rests) moving.push_back(found[i]);
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
