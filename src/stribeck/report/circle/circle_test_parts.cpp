#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/circle/circle_parts.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using ident::circle::CircularTest;
using ident::circle::DirectionTest;

/// One figure of the test: head, direction or "both", value.
struct TestFigure {
  std::string head;
  std::string group;
  double value;  ///< [m]
};

const DirectionTest* direction_of(const CircularTest& t, bool counter_clockwise) {
  for (const DirectionTest& d : t.directions) {
    if (d.counter_clockwise == counter_clockwise) return &d;
  }
  return nullptr;
}

/// The figures of one log; NaN where a direction is missing.
std::vector<TestFigure> figures_of(const std::optional<CircularTest>& t) {
  const double none = std::nan("");
  std::vector<TestFigure> out;
  for (const bool counter_clockwise : {true, false}) {
    const DirectionTest* d = t ? direction_of(*t, counter_clockwise) : nullptr;
    const std::string group = counter_clockwise ? "ccw" : "cw";
    out.push_back({"G", group, d != nullptr ? d->circular_deviation : none});
    out.push_back({"F max", group, d != nullptr ? d->radial_max : none});
    out.push_back({"F min", group, d != nullptr ? d->radial_min : none});
  }
  out.push_back({"G(b)", "both", t ? t->bidirectional.value_or(none) : none});
  out.push_back({"H", "both", t ? t->hysteresis.value_or(none) : none});
  out.push_back({"D", "both", t ? t->mean_radial_deviation : none});
  return out;
}

bool any_test(const CircleReportInput& input) {
  for (const CircleLog& log : input.logs) {
    if (log.test) return true;
  }
  return false;
}

}  // namespace

std::string circular_test_text(const CircleReportInput& input) {
  if (!any_test(input)) return {};
  std::vector<TextColumn> columns{{"control", "", {}, false}};
  for (const TestFigure& f : figures_of(std::nullopt))
    columns.push_back({f.head, "µm", {}, true, f.head == "G" || f.head == "G(b)" ? f.group : ""});
  for (const CircleLog& log : input.logs) {
    columns[0].entries.push_back(clean_text(log.label));
    std::size_t k = 1;
    for (const TestFigure& f : figures_of(log.test)) columns[k++].entries.push_back(micrometres(f.value));
  }
  return "Circular test after ISO 230-4: G circular deviation, F radial deviation, H hysteresis, D mean radial deviation\n" +
         lay_out(columns);
}

void add_circular_test(Page& page, const CircleReportInput& input) {
  if (!any_test(input)) return;
  page.section("Circular test after ISO 230-4");
  Table table;
  table.columns = {{"control", "", false}};
  for (const TestFigure& f : figures_of(std::nullopt))
    table.columns.push_back({f.head, "µm, " + f.group, true});
  for (const CircleLog& log : input.logs) {
    std::vector<Cell> row{Cell{.text = log.label}};
    for (const TestFigure& f : figures_of(log.test)) row.push_back(Cell{.text = micrometres(f.value)});
    table.rows.push_back(std::move(row));
  }
  page.table(table);
  page.remark(
      "G: width of the narrowest ring that holds the path. G(b): the same for both directions together. F: largest "
      "and smallest distance from the centre less the nominal radius. H: largest distance between the "
      "directions at one angle. D: mean radius of both less the nominal radius. Run-in and run-out are "
      "left out. –: not measured.");
}

nlohmann::ordered_json circular_test_json(const CircularTest& t) {
  const auto um = [](double metres) { return io::number_or_null(metres * kMicro); };
  const auto optional_um = [&](const std::optional<double>& metres) {
    return metres ? um(*metres) : io::Json(nullptr);
  };
  io::Json out;
  out["directions"] = io::Json::array();
  for (const DirectionTest& d : t.directions) {
    io::Json one{{"direction", d.counter_clockwise ? "counter-clockwise" : "clockwise"},
                 {"circular_deviation_um", um(d.circular_deviation)},
                 {"radial_deviation_max_um", um(d.radial_max)},
                 {"radial_deviation_min_um", um(d.radial_min)},
                 {"laps", io::Json::array()}};
    for (const ident::circle::LapTest& lap : d.laps)
      one["laps"].push_back({{"max_contour_error_um", um(lap.max_error)},
                             {"rms_um", um(lap.rms)},
                             {"circular_deviation_um", um(lap.circular_deviation)}});
    out["directions"].push_back(std::move(one));
  }
  out["mean_radial_deviation_um"] = um(t.mean_radial_deviation);
  out["bidirectional_circular_deviation_um"] = optional_um(t.bidirectional);
  out["hysteresis_um"] = optional_um(t.hysteresis);
  out["hysteresis_angle_deg"] =
      t.hysteresis ? io::number_or_null(t.hysteresis_angle * 180.0 / kPi) : io::Json(nullptr);
  return out;
}

}  // namespace stribeck::report
