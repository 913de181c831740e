#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/pages/tune_report.hpp>
#include <stribeck/report/run/tune_choice.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <vector>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;

std::string error_text(double error) {
  return std::isnan(error) ? "not simulated" : std::isinf(error) ? "path lost" : micrometres(error);
}

/// Controllers of which the machines were scored.
std::vector<const sim::TunedController*> scored(const sim::TuneResult& result) {
  std::vector<const sim::TunedController*> all;
  for (const sim::TunedController& c : result.controllers) {
    if (!c.machines.empty()) all.push_back(&c);
  }
  return all;
}

/// A figure of a controller, mean over the travels; NaN: none.
double mean_of(const sim::TunedController& c, sim::Figure::OfRun which) {
  if (!c.found() || c.after.empty()) return std::nan("");
  double sum = 0.0;
  for (const sim::TravelScore& s : c.after) sum += s.mean.*which;
  return sum / static_cast<double>(c.after.size());
}

}  // namespace

std::string nearby_text(const sim::TuneResult& result) {
  const auto all = scored(result);
  if (all.empty()) return {};
  TextColumn machine{"machine", "", {}, false};
  for (const sim::MachineScore& m : all.front()->machines) machine.entries.push_back(m.machine);
  std::vector<TextColumn> columns{machine};
  for (const sim::TunedController* c : all) {
    TextColumn& column = columns.emplace_back(TextColumn{"(" + clean_text(c->start.id) + ")", "µm", {}});
    for (const sim::MachineScore& m : c->machines)
      column.entries.push_back(error_text(m.before) + " → " + error_text(m.after));
  }
  return "\nLargest error on each machine for which the gains were chosen, mean over the speeds, own gains → tuned\n" +
         lay_out(columns);
}

nlohmann::ordered_json nearby_json(const sim::TunedController& controller) {
  Json all = Json::array();
  for (const sim::MachineScore& m : controller.machines)
    all.push_back({{"machine", m.machine},
                   {"start_max_contour_error_um", number_or_null(1e6 * m.before)},
                   {"tuned_max_contour_error_um", number_or_null(1e6 * m.after)}});
  return all;
}

void add_nearby(Page& page, const sim::TuneResult& result) {
  const auto all = scored(result);
  if (all.empty()) return;
  page.section("Machines for which the gains were chosen");
  Table table;
  table.columns = {{"machine", "", false}};
  for (const sim::TunedController* c : all)
    table.columns.push_back({"(" + c->start.id + ")", "µm, own → tuned", true});
  for (std::size_t m = 0; m < all.front()->machines.size(); ++m) {
    table.rows.push_back({{all.front()->machines[m].machine}});
    for (const sim::TunedController* c : all)
      table.rows.back().push_back(
          {error_text(c->machines[m].before) + " → " + error_text(c->machines[m].after)});
  }
  page.table(table);
  page.remark(
      "Largest error, mean over the speeds. Each machine differs from the model in this way on every axis, and the compensators do not know it.");
}

std::string trade_off_text(const sim::TradeOff& all, const sim::TuneSpec& spec) {
  if (all.results.empty()) return {};
  TextColumn id{"", "", {}, false};
  id.least = kLongestId;
  std::vector<TextColumn> columns{id};
  for (const sim::TunedController& c : all.results.front().controllers)
    columns.front().entries.push_back(clean_text(c.start.id));
  for (std::size_t i = 0; i < all.shares.size(); ++i) {
    TextColumn& column =
        columns.emplace_back(TextColumn{fmt::format("{:.0f} %", 100.0 * all.shares[i]), "µm", {}});
    for (const sim::TunedController& c : all.results[i].controllers) {
      const double error = mean_of(c, &sim::Metrics::max_contour_error);
      column.entries.push_back(std::isnan(error) ? "–" : micrometres(error));
    }
  }
  return fmt::format(
             "\nLargest error, mean over the speed{}, tuned under shares of the limit of mean |Δu| (–: no gains keep the limits)\n",
             spec.compare.travels.size() == 1 ? "" : "s") +
         lay_out(columns);
}

nlohmann::ordered_json trade_off_json(const sim::TradeOff& all, const sim::TuneSpec& spec) {
  Json out = Json::array();
  for (std::size_t i = 0; i < all.shares.size(); ++i) {
    Json one{{"share", all.shares[i]},
             {"input_variation_V", io::numbers(all.results[i].variation_limit)},
             {"controllers", Json::array()}};
    for (const sim::TunedController& c : all.results[i].controllers) {
      Json row{{"controller", c.start.id}, {"missed", c.found() ? Json(nullptr) : Json(why_none(c, spec))}};
      Json errors(nullptr), variation(nullptr);
      for (const sim::TravelScore& s : c.after) {
        errors.push_back(number_or_null(1e6 * s.mean.max_contour_error));
        variation.push_back(number_or_null(s.mean.input_variation));
      }
      row["max_contour_error_um"] = std::move(errors);
      row["input_variation_V"] = std::move(variation);
      one["controllers"].push_back(std::move(row));
    }
    out.push_back(std::move(one));
  }
  return out;
}

void add_trade_off(Page& page, const sim::TradeOff& all) {
  if (all.results.empty()) return;
  page.section("Error against input variation");
  Plot plot{.title = "What a rougher input buys",
            .x_label = "mean |Δu|, mean over the speeds [mV]",
            .y_label = "largest error, mean over the speeds [µm]",
            .width = 720,
            .height = 380};
  for (std::size_t k = 0; k < all.results.front().controllers.size(); ++k) {
    Series s;
    for (const sim::TuneResult& r : all.results) {
      const double x = mean_of(r.controllers[k], &sim::Metrics::input_variation);
      const double y = mean_of(r.controllers[k], &sim::Metrics::max_contour_error);
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      s.x.push_back(1e3 * x);
      s.y.push_back(1e6 * y);
    }
    const std::string& id = all.results.front().controllers[k].start.id;
    s.label = "(" + id + ")";
    s.color = controller_color(id, k);
    if (!s.x.empty()) plot.series.push_back(std::move(s));
  }
  page.figures(
      {plot}, 1,
      fmt::format(
          "Each controller at its best gains under {} shares of the limit of input variation, from {:.0f} to {:.0f} %. Where a curve "
          "is flat, more input buys no accuracy: take its left end.",
          all.shares.size(), 100.0 * all.shares.front(), 100.0 * all.shares.back()));
}

}  // namespace stribeck::report
