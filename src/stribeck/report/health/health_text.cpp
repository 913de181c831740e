#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/health/date.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/health/health_parts.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

namespace health = ident::health;
using health::Change;
using health::Channel;
using health::date_of;
using health::Number;
using io::Json;
using io::number_or_null;

std::string shown(const Channel& c, double si) { return significant(si * unit_of(c).per_si, 4); }

Json place_of(const Channel& c, std::size_t end) {
  if (c.number == Number::kPlace || (c.number == Number::kPeriodic && end == 0))
    return number_or_null(1e3 * c.at[end]);
  return nullptr;
}

Json to_json(const Channel& c) {
  const HealthUnit unit = unit_of(c);
  const auto share = [&](double value) { return number_or_null(100.0 * c.share(value)); };
  Json out;
  out["number"] = enum_name(c.number);
  out["from_mm"] = place_of(c, 0);
  out["to_mm"] = place_of(c, 1);
  out["unit"] = unit.name;
  out["reference"] = number_or_null(c.trend.reference * unit.per_si);
  out["now"] = number_or_null(c.trend.now * unit.per_si);
  out["change_percent"] = share(c.trend.now - c.trend.reference);
  out["change_half_width_percent"] = share(c.trend.drift_half_width);
  out["scatter_percent"] = share(c.trend.scatter);
  out["per_degree_percent"] = share(c.trend.per_degree);
  out["status"] = status_of(c);
  return out;
}

Json to_json(const Change& change, const std::vector<Channel>& channels) {
  Json out;
  out["kind"] = change.slow ? "drift" : "step";
  out["date"] = date_of(change.day);
  out["earliest"] = date_of(change.earliest);
  out["latest"] = date_of(change.latest);
  out["probability"] = change.slow ? Json(nullptr) : number_or_null(change.probability);
  out["beyond_limit"] = change.beyond_limit;
  out["undone"] = change.undone;
  out["restores"] = change.restores;
  out["restores_part"] = change.restores_part;
  out["effects"] = Json::array();
  for (const health::Shift& s : change.shifts) {
    const Channel& c = channels[s.channel];
    out["effects"].push_back({{"number", enum_name(c.number)},
                              {"from_mm", place_of(c, 0)},
                              {"to_mm", place_of(c, 1)},
                              {"percent", number_or_null(100.0 * s.share)},
                              {"half_width_percent", number_or_null(196.0 * s.deviation)},
                              {"counts", s.counts}});
  }
  out["causes"] = Json::array();
  for (const health::Cause& cause : change.causes)
    out["causes"].push_back({{"what", cause.what}, {"why", cause.why}, {"next", cause.next}});
  return out;
}

std::string numbers_table(const HealthAxis& axis) {
  std::vector<TextColumn> columns{{"number", "", {}, false}, {"unit", "", {}, false}, {"first", "", {}},
                                  {"now", "", {}},           {"change", "%", {}},     {"±", "%", {}},
                                  {"scatter", "%", {}},      {"", "", {}, false}};
  for (const Channel& c : axis.health.channels) {
    columns[0].entries.push_back(name_of(c));
    columns[1].entries.push_back(printed_unit(unit_of(c).name));
    columns[2].entries.push_back(shown(c, c.trend.known() ? c.trend.reference : c.readings.front().value));
    columns[3].entries.push_back(shown(c, c.trend.known() ? c.trend.now : c.readings.back().value));
    columns[4].entries.push_back(with_sign(100.0 * c.share(c.trend.now - c.trend.reference), 1));
    columns[5].entries.push_back(decimals(100.0 * c.share(c.trend.drift_half_width), 1));
    columns[6].entries.push_back(decimals(100.0 * c.share(c.trend.scatter), 1));
    columns[7].entries.push_back(status_of(c));
  }
  return lay_out(columns);
}

}  // namespace

std::string name_of(const Channel& c) {
  const HealthUnit travel = c.rotary ? HealthUnit{"deg", 180.0 / kPi} : HealthUnit{"mm", 1e3};
  switch (c.number) {
    case Number::kForward:
      return "friction towards +";
    case Number::kBackward:
      return "friction towards -";
    case Number::kCoulomb:
      return "Coulomb friction";
    case Number::kViscous:
      return "viscous, at top speed";
    case Number::kOffset:
      return "offset (load)";
    case Number::kMass:
      return "mass";
    case Number::kSpring:
      return "spring, at the end of the travel";
    case Number::kUnbalance:
      return "unbalance";
    case Number::kPlace:
      return fmt::format("above the mean, {} to {} {}", decimals(travel.per_si * c.at[0], 1),
                         decimals(travel.per_si * c.at[1], 1), travel.name);
    case Number::kPeriodic:
      return fmt::format("periodic, {:.4g} {}", travel.per_si * c.at[0], travel.name);
    case Number::kCircularDeviation:
      return "circular deviation";
    case Number::kHysteresis:
      return "circular hysteresis";
  }
  return {};
}

HealthUnit unit_of(const Channel& c) {
  switch (c.number) {
    case Number::kMass: {
      if (c.rotary) return {"kg m2", 1.0};
      const bool kilograms = io::shown_unit(c.scale, quantity("kg", "N s2/mm")) == "kg";
      return kilograms ? HealthUnit{"kg", 1.0} : HealthUnit{"N s2/mm", 1e-3};
    }
    case Number::kCircularDeviation:
    case Number::kHysteresis:
      return {"um", 1e6};
    default:
      return {c.rotary ? "N m" : "N", 1.0};
  }
}

std::string status_of(const Channel& c) {
  if (!c.trend.known()) return "too few tests";
  if (c.trend.stepped) return "changed";
  if (c.trend.drifted) return "drifted";
  return c.trend.pending ? "test again" : "ok";
}

std::string percent(double share, int digits) { return with_sign(100.0 * share, digits) + " %"; }

std::string when(const Change& change) {
  if (change.slow) return "until " + date_of(change.day);
  const std::string day = date_of(change.day);
  const std::string from = date_of(change.earliest), to = date_of(change.latest);
  return from == to ? day : fmt::format("{} ({} to {})", day, from, to);
}

std::string kind_of(const Change& change) {
  if (change.slow) return "slow change beyond its limit";
  const std::string sure =
      change.probability > 0.999 ? "above 99.9" : decimals(100.0 * change.probability, 1);
  return fmt::format("step, {} % sure, {}", sure,
                     change.undone          ? "taken back since"
                     : change.restores      ? "takes an earlier step back"
                     : change.restores_part ? "takes an earlier step back in part"
                     : change.beyond_limit  ? "beyond its limit"
                                            : "within the limits");
}

std::string effects_of(const Change& change, const std::vector<Channel>& channels) {
  std::vector<health::Shift> shifts = change.shifts;
  std::erase_if(shifts, [](const health::Shift& s) { return !s.counts; });
  std::stable_sort(shifts.begin(), shifts.end(), [](const health::Shift& a, const health::Shift& b) {
    return std::abs(a.share) > std::abs(b.share);
  });
  std::vector<std::string> words;
  for (const health::Shift& s : shifts)
    words.push_back(name_of(channels[s.channel]) + " " + percent(s.share, 0));
  return joined(words, "; ");
}

std::string tests_of(const HealthAxis& axis) {
  const std::size_t n = axis.tests.size();
  const std::string first = date_of(axis.tests.front().day), last = date_of(axis.tests.back().day);
  return n == 1 ? "1 test, " + first : fmt::format("{} tests from {} to {}", n, first, last);
}

std::string pending_of(const HealthAxis& axis) {
  std::vector<std::string> words;
  std::size_t tests = 0;
  for (const Channel& c : axis.health.channels) {
    if (!c.trend.pending || c.trend.changed()) continue;
    words.push_back(name_of(c) + " " + percent(c.share(c.trend.pending->change), 0));
    tests = std::max(tests, c.trend.pending->tests);
  }
  if (words.empty()) return {};
  return fmt::format(
      "The newest {}: {}. {} no change yet, it may be an outlier: repeat the test, a change needs three",
      tests == 1 ? "test differs from those before" : "two tests differ from those before",
      joined(words, "; "), tests == 1 ? "One test is" : "Two tests are");
}

std::string further_limits(const HealthReportInput& input) {
  for (const HealthAxis& axis : input.axes) {
    for (const Channel& c : axis.health.channels) {
      if (c.number == Number::kViscous && c.trend.known() && c.trend.drift_limit != input.limits.drift)
        return fmt::format(" (of viscous friction without temperatures {} %)",
                           short_number(100.0 * c.trend.drift_limit));
    }
  }
  return {};
}

std::string shares_of(const HealthReportInput& input) {
  bool forces = false, circles = false;
  for (const HealthAxis& axis : input.axes) {
    for (const Channel& c : axis.health.channels) {
      const bool circle = c.number == Number::kCircularDeviation || c.number == Number::kHysteresis;
      (circle ? circles : forces) = true;
    }
  }
  std::vector<std::string> words;
  if (forces)
    words.emplace_back(
        "Changes of forces are shares of the friction level of the first test; of Coulomb friction of itself, at least of 30 % of that level; of viscous friction of itself where it is larger than the level.");
  if (circles)
    words.emplace_back(
        "Changes of a circle are shares of twice the value of the first test, at least of 2 um.");
  return joined(words, " ");
}

std::string verdict_of(const HealthAxis& axis) {
  if (axis.health.changed()) return "changed beyond its limits";
  const bool known = std::any_of(axis.health.channels.begin(), axis.health.channels.end(),
                                 [](const Channel& c) { return c.trend.known(); });
  if (known && !pending_of(axis).empty()) return "the newest test differs";
  return known ? "no change beyond the limits" : "too few tests for a trend (three are needed)";
}

std::string text_table(const HealthReportInput& input) {
  std::string out;
  for (const std::string& file : input.added) out += "Added " + clean_text(file) + ".\n";
  for (const HealthAxis& axis : input.axes) {
    const std::string name = axis.motion.empty() ? "Circle" : "Axis " + clean_text(axis.name);
    out += fmt::format("{}{}: {}, {}.\n", out.empty() ? "" : "\n", name, tests_of(axis), verdict_of(axis));
    out += numbers_table(axis);
    if (const std::string pending = pending_of(axis); !pending.empty()) out += pending + ".\n";
    for (const Change& change : axis.health.changes) {
      out += fmt::format("{}: {}\n  {}\n", when(change), kind_of(change),
                         effects_of(change, axis.health.channels));
      for (const health::Cause& cause : change.causes)
        out += fmt::format("  likely: {} ({})\n  next: {}\n", cause.what, cause.why, cause.next);
    }
    if (axis.tests.size() < 3 && !axis.motion.empty()) {
      out += "Motion to repeat:\n";
      for (const std::string& command : axis.motion) out += "  " + command + "\n";
    }
  }
  out += fmt::format("\n{} Limits: a step of {} %, a slow change of {} %{}.\n", shares_of(input),
                     short_number(100.0 * input.limits.step), short_number(100.0 * input.limits.drift),
                     further_limits(input));
  for (const std::string& remark : input.remarks) out += "remark: " + clean_text(remark) + "\n";
  return out;
}

nlohmann::ordered_json to_json(const HealthReportInput& input) {
  Json out;
  out["schema"] = "stribeck.health/1";
  out["machine"] = input.machine;
  out["archive"] = input.archive;
  out["changed"] = input.changed();
  out["added"] = input.added;
  out["limits"] = {{"step_percent", number_or_null(100.0 * input.limits.step)},
                   {"drift_percent", number_or_null(100.0 * input.limits.drift)}};
  out["axes"] = Json::array();
  for (const HealthAxis& axis : input.axes) {
    Json one;
    one["axis"] = axis.name;
    one["tests"] = axis.tests.size();
    one["first"] = date_of(axis.tests.front().day);
    one["last"] = date_of(axis.tests.back().day);
    one["changed"] = axis.health.changed();
    one["numbers"] = Json::array();
    for (const Channel& c : axis.health.channels) one["numbers"].push_back(to_json(c));
    one["changes"] = Json::array();
    for (const Change& c : axis.health.changes) one["changes"].push_back(to_json(c, axis.health.channels));
    one["motion"] = axis.motion;
    out["axes"].push_back(std::move(one));
  }
  out["remarks"] = input.remarks;
  return out;
}

}  // namespace stribeck::report
