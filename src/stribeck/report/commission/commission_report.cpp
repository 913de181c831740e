#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/commission/commission_report.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;
using Axis = CommissionedAxisReport;
using Stage = CommissionStage;

constexpr std::array<std::string_view, 5> kStages{"no log", "not determined", "not verified", "refused",
                                                  "ready"};

std::string mass_of(const Axis& a) {
  if (!std::isfinite(a.mass)) return {};
  if (a.rotary)
    return fmt::format("  inertia {} kg m2 (95 %: {} to {}), load {} N m, friction from {} to {} deg/s\n",
                       significant(a.mass, 4), significant(a.mass_low, 4), significant(a.mass_high, 4),
                       significant(a.load, 3), significant(kDegrees * a.velocity_low, 3),
                       significant(kDegrees * a.velocity_high, 3));
  const bool kilograms = io::shown_unit(a.mass, quantity("kg", "N s2/mm")) == "kg";
  const double scale = kilograms ? 1.0 : 1e-3;
  return fmt::format("  mass {} {} (95 %: {} to {}), load {} N, friction from {} to {} mm/s\n",
                     significant(scale * a.mass, 4), kilograms ? "kg" : "N s²/mm",
                     significant(scale * a.mass_low, 4), significant(scale * a.mass_high, 4),
                     significant(a.load, 3), significant(1e3 * a.velocity_low, 3),
                     significant(1e3 * a.velocity_high, 3));
}

double number(const Json& json, const char* key) {
  const auto at = json.find(key);
  return at != json.end() && at->is_number() ? at->get<double>() : kNaN;
}

}  // namespace

std::string_view name_of(CommissionStage stage) noexcept { return kStages[static_cast<std::size_t>(stage)]; }

std::string text_table(const CommissionReportInput& input) {
  std::string out;
  // What is skipped may be the log that an axis lacks: it comes first.
  for (const std::string& line : input.skipped) out += "skipped: " + clean_text(line) + "\n";
  for (const Axis& a : input.axes) {
    out += fmt::format("{}Axis {}: {}{}\n", out.empty() ? "" : "\n", clean_text(a.axis), name_of(a.stage),
                       a.unchanged ? " (inputs unchanged, nothing was computed again)" : "");
    if (!a.logs.empty()) out += "  identified from " + clean_text(joined(a.logs, ", ")) + "\n";
    out += mass_of(a);
    if (!a.verdict.empty())
      out += fmt::format("  verified on {}: {}, force error {} %\n", clean_text(a.held_out), a.verdict,
                         decimals(a.force_error, 1));
    if (!a.axis_file.empty()) out += "  axis file " + clean_text(a.axis_file) + "\n";
    for (const std::string& line : a.read) out += "  read: " + clean_text(line) + "\n";
    for (const std::string& line : a.warnings) out += "  warning: " + clean_text(line) + "\n";
    for (const std::string& line : a.open) out += "  open: " + clean_text(line) + "\n";
    if (a.stage == Stage::kNoLog && !input.skipped.empty())
      out += "  first: mend what was skipped, above, if it is a log of this axis\n";
    for (const std::string& command : a.next) out += "  next: " + clean_text(command) + "\n";
  }
  return out;
}

Json to_json(const Axis& a) {
  Json out;
  out["axis"] = a.axis;
  out["stage"] = name_of(a.stage);
  out["rotary"] = a.rotary;
  out["logs"] = a.logs;
  out["held_out"] = a.held_out.empty() ? Json(nullptr) : Json(a.held_out);
  out["unchanged"] = a.unchanged;
  out["mass_kg"] = number_or_null(a.mass);
  out["mass_ci95_kg"] = {number_or_null(a.mass_low), number_or_null(a.mass_high)};
  out["load_N"] = number_or_null(a.load);
  out["velocity_range_mm_per_s"] = {number_or_null(1e3 * a.velocity_low),
                                    number_or_null(1e3 * a.velocity_high)};
  out["force_error_percent"] = number_or_null(a.force_error);
  out["verdict"] = a.verdict.empty() ? Json(nullptr) : Json(a.verdict);
  out["axis_file"] = a.axis_file.empty() ? Json(nullptr) : Json(a.axis_file);
  out["read"] = a.read;
  out["warnings"] = a.warnings;
  out["open"] = a.open;
  out["next"] = a.next;
  return out;
}

bool read_axis_state(const Json& json, Axis& out) {
  const auto text = [&](const char* key) {
    const auto at = json.find(key);
    return at != json.end() && at->is_string() ? at->get<std::string>() : std::string();
  };
  const auto texts = [&](const char* key) {
    std::vector<std::string> list;
    const auto at = json.find(key);
    if (at == json.end() || !at->is_array()) return list;
    for (const Json& one : *at) {
      if (one.is_string()) list.push_back(one.get<std::string>());
    }
    return list;
  };
  const auto pair = [&](const char* key, double scale, double& low, double& high) {
    const auto at = json.find(key);
    if (at == json.end() || !at->is_array() || at->size() != 2) return;
    if ((*at)[0].is_number()) low = scale * (*at)[0].get<double>();
    if ((*at)[1].is_number()) high = scale * (*at)[1].get<double>();
  };
  if (!json.is_object() || text("axis").empty()) return false;
  const std::string stage = text("stage");
  std::size_t k = 0;
  while (k < kStages.size() && kStages[k] != stage) ++k;
  if (k == kStages.size()) return false;
  out = {};
  out.axis = text("axis");
  out.stage = static_cast<Stage>(k);
  const auto turns = json.find("rotary");
  out.rotary = turns != json.end() && turns->is_boolean() && turns->get<bool>();
  out.logs = texts("logs");
  out.held_out = text("held_out");
  out.mass = number(json, "mass_kg");
  pair("mass_ci95_kg", 1.0, out.mass_low, out.mass_high);
  out.load = number(json, "load_N");
  pair("velocity_range_mm_per_s", 1e-3, out.velocity_low, out.velocity_high);
  out.force_error = number(json, "force_error_percent");
  out.verdict = text("verdict");
  out.axis_file = text("axis_file");
  out.read = texts("read");
  out.warnings = texts("warnings");
  out.open = texts("open");
  out.next = texts("next");
  return true;
}

nlohmann::ordered_json to_json(const CommissionReportInput& input) {
  Json out;
  out["schema"] = "stribeck.commission/1";
  out["machine"] = input.machine;
  out["ready"] = input.ready();
  out["axes"] = Json::array();
  for (const Axis& a : input.axes) out["axes"].push_back(to_json(a));
  out["skipped"] = input.skipped;
  return out;
}

}  // namespace stribeck::report
