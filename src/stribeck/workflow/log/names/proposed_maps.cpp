#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <stribeck/workflow/log/effort.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/log/names/proposed_maps.hpp>

namespace stribeck::workflow {
namespace {

/// Quantities whose names are looked for.
constexpr std::array kMotions{LogQuantity::kPosition, LogQuantity::kReference, LogQuantity::kVelocity};

/// The unit in which a control period is between 10 us and 50 ms.
std::string unit_of_time(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < t.size() && k < 1000; ++k) steps.push_back(t[k] - t[k - 1]);
  if (steps.empty()) return "s";
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  const double step = steps[steps.size() / 2];
  constexpr double kLongest = 0.05;  // of a control period [s]
  if (step <= kLongest) return "s";
  return step <= 1e3 * kLongest ? "ms" : step <= 1e6 * kLongest ? "us" : "ns";
}

/// ROS counts in m, m/s and N.
bool of_ros(const io::Log& log) {
  return std::any_of(log.columns.begin(), log.columns.end(), [](const io::Column& c) {
    const std::string name = lower_case(c.name);
    return name.find("joint_state") != std::string::npos || name.find("effort") != std::string::npos;
  });
}

/// Torques of these names are in percent or per mille of the rated one.
std::string unit_of_torque(const io::Column& c) {
  constexpr std::array<std::string_view, 4> kPercent{"torquereference", "torquefeedback", "act.trq",
                                                     "cmd.trq"};
  constexpr std::array<std::string_view, 4> kPerMille{"torque actual value", "torque demand value",
                                                      "target torque", "6077"};
  const std::string name = lower_case(c.name);
  const auto in = [&](std::string_view word) { return name.find(word) != std::string::npos; };
  if (std::any_of(kPercent.begin(), kPercent.end(), in)) return "%";
  return std::any_of(kPerMille.begin(), kPerMille.end(), in) ? "\u2030" : "N m";
}

std::string usual_unit(LogQuantity what, const io::Column& c, bool ros) {
  if (what == LogQuantity::kTorque) return unit_of_torque(c);
  if (what == LogQuantity::kPercent) return "%";
  const Quantity& q = known_column(what).quantity;
  return std::string(ros ? q.unit : q.shown);
}

/// What a column is by its name alone; "Y act" is taken for a position where it has no unit.
std::optional<NameMeaning> guess(const io::Column& c) {
  const std::string name = lower_case(c.name);
  for (const std::span<const LogQuantity> list :
       {std::span<const LogQuantity>(kMotions), std::span<const LogQuantity>(kForces)}) {
    for (const LogQuantity what : list) {
      for (const NameFamily& family : known_column(what).families) {
        if (std::find(family.begin(), family.end(), name) != family.end()) return NameMeaning{what, 0, {}};
      }
    }
  }
  if (const auto found = meaning_of(c.name, c.unit_text)) return found;
  return c.unit_text.empty() ? meaning_of(c.name, "mm") : std::nullopt;
}

}  // namespace

std::string axis_in_name(const io::Column& column) {
  const auto found = guess(column);
  return found ? found->axis : "";
}

std::string map_option(std::string_view what, const std::string& column) {
  // A name with quotes goes into the other ones.
  const char quote = column.find('"') == std::string::npos ? '"' : '\'';
  return fmt::format("--map {}={}{}{}", what, quote, column, quote);
}

std::string proposed_maps(const io::Log& log, const std::string& axis) {
  const int time = io::time_column(log);
  if (time < 0) return "";
  const io::Column& t = log.columns[static_cast<std::size_t>(time)];
  struct Choice {
    const io::Column* column;
    NameMeaning meaning;
  };
  std::map<LogQuantity, Choice> best;
  std::string of = lower_case(axis);
  for (const io::Column& c : log.columns) {
    if (&c == &t || c.values.empty()) continue;
    const auto found = guess(c);
    if (!found) continue;
    if (of.empty()) of = found->axis;
    if (!found->axis.empty() && found->axis != of) continue;
    const auto [at, fresh] = best.try_emplace(found->what, Choice{&c, *found});
    if (!fresh && found->rank < at->second.meaning.rank) at->second = {&c, *found};
  }
  const auto effort =
      std::find_if(kForces.begin(), kForces.end(), [&](LogQuantity what) { return best.contains(what); });
  if (effort == kForces.end() ||
      (!best.contains(LogQuantity::kPosition) && !best.contains(LogQuantity::kVelocity)))
    return "";
  const auto option = [](std::string_view what, const io::Column& c, const std::string& usual) {
    return map_option(what, c.name + " " + (c.unit_text.empty() ? usual : c.unit_text));
  };
  // A time with a unit is found by itself; one that was made of two columns has no name in the file.
  const bool ros = of_ros(log);
  std::string all =
      t.unit_text.empty() || t.unit_assumed ? option("t", t, unit_of_time(t.values)) : std::string();
  for (const LogQuantity what :
       {LogQuantity::kPosition, LogQuantity::kReference, LogQuantity::kVelocity, *effort}) {
    if (what == LogQuantity::kVelocity && best.contains(LogQuantity::kPosition)) continue;
    const auto found = best.find(what);
    if (found == best.end()) continue;
    const io::Column& c = *found->second.column;
    const std::string usual = usual_unit(what, c, ros);
    const std::string& unit = c.unit_text.empty() ? usual : c.unit_text;
    const LogQuantity kind = what == *effort ? kind_by_unit(unit, what) : what;
    all += (all.empty() ? "" : " ") + option(enum_name(kind), c, usual);
  }
  return all;
}

}  // namespace stribeck::workflow
