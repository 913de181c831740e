#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include <stribeck/report/lost_motion/lost_motion_report.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using ident::lost_motion::Estimate;
using ident::lost_motion::LostMotion;

/// A quantity as it is shown; key: its name in JSON.
struct Shown {
  const char* name;
  const char* key;
  const char* unit;
  double scale;
  std::optional<Estimate> LostMotion::*member;
};

constexpr std::array kShown{
    Shown{"lost motion", "lost_motion_um", "um", 1e6, &LostMotion::total},
    Shown{"backlash", "backlash_um", "um", 1e6, &LostMotion::backlash},
    Shown{"change of the backlash", "backlash_slope_um_per_m", "um/m", 1e6, &LostMotion::backlash_slope},
    Shown{"wind-up", "stiffness_N_per_um", "N/um", 1e-6, &LostMotion::stiffness}};

}  // namespace

Table lost_motion_table(const LostMotion& found) {
  Table t{"", {{"lost motion", "", false}, {"value", ""}, {"95 % interval", ""}, {"unit", "", false}}, {}};
  for (const Shown& s : kShown) {
    const std::optional<Estimate>& e = found.*s.member;
    if (!e) continue;
    const double low = s.scale * e->low();
    const double high = s.scale * e->high();
    t.rows.push_back({{s.name},
                      {shown_number(s.scale * e->value, low, high)},
                      {shown_number(low, low, high) + " … " + shown_number(high, low, high)},
                      {printed_unit(s.unit)}});
  }
  return t;
}

std::string lost_motion_text(const LostMotion& found) {
  std::string out = "\n";
  if (std::any_of(kShown.begin(), kShown.end(),
                  [&](const Shown& s) { return (found.*s.member).has_value(); }))
    out += fmt::format("{:<26}{:>10}{:>11}{:>9}  unit\n", "lost motion", "value", "95 % from", "to");
  for (const Shown& s : kShown) {
    const std::optional<Estimate>& e = found.*s.member;
    if (!e) continue;
    const double low = s.scale * e->low();
    const double high = s.scale * e->high();
    out += fmt::format("{:<26}{:>10}{:>11}{:>9}  {}\n", s.name, shown_number(s.scale * e->value, low, high),
                       shown_number(low, low, high), shown_number(high, low, high), s.unit);
  }
  for (const std::string& words : found.words) out += "Lost motion: " + words + ".\n";
  return out;
}

nlohmann::ordered_json lost_motion_json(const LostMotion& found) {
  nlohmann::ordered_json json;
  for (const Shown& s : kShown) {
    const std::optional<Estimate>& e = found.*s.member;
    json[s.key] = nullptr;
    if (e)
      json[s.key] = {
          {"value", s.scale * e->value}, {"low", s.scale * e->low()}, {"high", s.scale * e->high()}};
  }
  json["table_friction_N"] = nullptr;
  if (found.stiffness) json["table_friction_N"] = found.table_friction;
  json["scale_error_um_per_m"] = 1e6 * found.scale_error;
  json["reversals"] = found.reversals;
  json["none"] = found.none;
  json["words"] = found.words;
  return json;
}

}  // namespace stribeck::report
