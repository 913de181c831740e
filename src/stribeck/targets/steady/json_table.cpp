// --to json: the steady friction as lookup tables with their units, for programs that have no target of their own.
#include <fmt/format.h>
#include <stribeck/stribeck.h>
#include <algorithm>
#include <cmath>

#include <stribeck/io/json.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/targets/steady/approximation.hpp>

namespace stribeck::targets {

namespace {

/// Points of each direction.
constexpr std::size_t kRowsOfADirection = 50;
constexpr int kDigits = 9;

/// Both directions in ascending velocity, with the digits that the file has: velocity [mm/s], friction [N].
std::vector<Corner> json_rows(const Axis& axis) {
  std::vector<Corner> rows;
  for (const Corner& c : nearest_points(axis, kRowsOfADirection, -1.0))
    rows.push_back({with_digits(-1e3 * c.x, kDigits), with_digits(-c.y, kDigits)});
  std::reverse(rows.begin(), rows.end());
  for (const Corner& c : nearest_points(axis, kRowsOfADirection, 1.0))
    rows.push_back({with_digits(1e3 * c.x, kDigits), with_digits(c.y, kDigits)});
  return rows;
}

Form json_form(const Axis& axis) {
  Form form;
  form.periodic = form.mass = form.load = true;
  const std::vector<Corner> rows = json_rows(axis);
  form.held = [rows](double v) { return interpolated(rows, 1e3 * v); };
  form.to_do =
      "Any program reads the table: interpolate linearly over the velocity of the command, and keep the end values beyond it. Between "
      "the two rows around zero the friction is a ramp. Check first that at a constant positive velocity it pushes in the positive "
      "direction.";
  return form;
}

nlohmann::ordered_json periodic_terms(const Axis& axis) {
  nlohmann::ordered_json terms = nlohmann::ordered_json::array();
  for (const auto& t : axis.model.friction.eccentric) {
    terms.push_back({{"amplitude_N", t.amplitude},
                     {"period_mm", 1e3 * t.period},
                     {"phase_rad", t.phase},
                     {"form", enum_name(t.form)}});
  }
  return terms;
}

Packed json_file(const std::vector<Axis>& axes, const SteadyText& known, const std::string& command) {
  report::Made made{command, stribeck_version(), {}};
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Axis& axis = axes[i];
    made.inputs.push_back({axis.file, io::sha256_of_file(axis.file)});
    nlohmann::ordered_json velocity = nlohmann::ordered_json::array();
    nlohmann::ordered_json friction = nlohmann::ordered_json::array();
    for (const Corner& row : json_rows(axis)) {
      velocity.push_back(row.x);
      friction.push_back(row.y);
    }
    nlohmann::ordered_json one{{"name", axis.name},
                               {"file", axis.file},
                               {"rotary", axis.rotary},
                               {"mass_kg", axis.model.mass},
                               {"load_N", axis.model.load},
                               {"slowest_mm_per_s", 1e3 * axis.slowest},
                               {"fastest_mm_per_s", 1e3 * axis.fastest},
                               {"velocity_mm_per_s", velocity},
                               {"friction_N", friction},
                               {"periodic", periodic_terms(axis)}};
    if (const auto& spring = axis.model.friction.spring) {
      one["spring"] = {{"stiffness_N_per_mm", 1e-3 * spring->stiffness},
                       {"zero_at_mm", 1e3 * spring->zero_at}};
      if (spring->from) one["spring"]["from_mm"] = 1e3 * *spring->from;
      if (spring->to) one["spring"]["to_mm"] = 1e3 * *spring->to;
    }
    for (const char* key : {"max_error_N", "rms_error_N", "rms_friction_N", "left_out"})
      one[key] = known.json[i][key];
    list.push_back(one);
  }
  return {
      io::dump({{"schema", "stribeck.friction-table/1"}, {"made", report::to_json(made)}, {"axes", list}}),
      {}};
}

}  // namespace

extern const SteadyTarget kJson;
const SteadyTarget kJson{.name = "json",
                         .what = "friction over velocity as a lookup table in JSON, with units and error",
                         .write = json_form,
                         .extension = ".json",
                         .pack = json_file};

}  // namespace stribeck::targets
