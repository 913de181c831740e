#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <stribeck/io/json.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/run/smooth_speeds.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

/// A slowest smooth speed [mm/s] before and after. "–": no loop there that is stable.
std::string smooth_speed(const sim::TunedController& c, std::size_t axis,
                         std::optional<double> sim::SmoothSpeed::*which) {
  const auto one = [&](const std::vector<sim::SmoothSpeed>& speeds) -> std::string {
    if (axis >= speeds.size()) return "–";
    const std::optional<double>& v = speeds[axis].*which;
    if (!v) return "none";
    if (*v < 1.01 * sim::kSlowestLooked) return "below " + short_number(sim::kSlowestLooked * 1e3);
    return significant(*v * 1e3, 2);
  };
  return one(c.start_smooth) + " → " + one(c.tuned_smooth);
}

/// Controller and axis, for every row of the table of smooth speeds.
std::vector<std::pair<const sim::TunedController*, std::size_t>> smooth_rows(const sim::TuneResult& r) {
  std::vector<std::pair<const sim::TunedController*, std::size_t>> rows;
  for (const sim::TunedController& c : r.controllers) {
    if (c.start_smooth.empty() && c.tuned_smooth.empty()) continue;
    for (std::size_t i = 0; i < r.axes.size(); ++i) rows.emplace_back(&c, i);
  }
  return rows;
}

}  // namespace

std::string smooth_speed_text(const sim::TuneResult& result) {
  const auto rows = smooth_rows(result);
  if (rows.empty()) return {};
  TextColumn id{"", "", {}, false};
  id.least = kLongestId;
  TextColumn axis{"axis", "", {}, false};
  TextColumn predicted{"describing function", "mm/s", {}};
  TextColumn simulated{"simulation", "mm/s", {}};
  for (const auto& [c, i] : rows) {
    id.entries.push_back(clean_text(c->start.id));
    axis.entries.push_back(clean_text(result.axes[i]));
    predicted.entries.push_back(smooth_speed(*c, i, &sim::SmoothSpeed::predicted));
    simulated.entries.push_back(smooth_speed(*c, i, &sim::SmoothSpeed::simulated));
  }
  return "\nSlowest speed without stick-slip, at its own gains → tuned\n" +
         lay_out({id, axis, predicted, simulated});
}

void add_smooth_speeds(Page& page, const sim::TuneResult& r) {
  const auto rows = smooth_rows(r);
  if (rows.empty()) return;
  page.section("Slowest speed without stick-slip");
  Table smooth;
  smooth.columns = {{"", "", false},
                    {"axis", "", false},
                    {"describing function", "mm/s, own → tuned", true},
                    {"simulation", "mm/s, own → tuned", true}};
  for (const auto& [c, i] : rows) {
    smooth.rows.push_back({{c->start.id},
                           {r.axes[i]},
                           {smooth_speed(*c, i, &sim::SmoothSpeed::predicted)},
                           {smooth_speed(*c, i, &sim::SmoothSpeed::simulated)}});
  }
  page.table(smooth);
  page.remark(
      "Each axis alone on a straight line. Below this speed it sticks and slips: move faster, or take a stiffer loop. The describing "
      "function takes the identified friction, the simulation that of the machine.");
}

nlohmann::ordered_json smooth_speed_json(const std::vector<sim::SmoothSpeed>& speeds,
                                         const std::vector<std::string>& axes) {
  using Json = nlohmann::ordered_json;
  const auto shown = [](const std::optional<double>& v) {
    return v ? io::number_or_null(*v * 1e3) : nlohmann::ordered_json(nullptr);
  };
  Json list = Json::array();
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    list.push_back({{"axis", axes[i]},
                    {"predicted_mm_per_s", shown(speeds[i].predicted)},
                    {"simulated_mm_per_s", shown(speeds[i].simulated)}});
  }
  return list;
}

}  // namespace stribeck::report
