#include <nlohmann/json.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/pages/reproduction.hpp>
#include <utility>

namespace stribeck::report {

nlohmann::ordered_json reproduction_json(const ReproductionInput& input) {
  using io::Json;
  using io::number_or_null;
  Json out;
  out["schema"] = "stribeck.reproduce/1";
  out["seed"] = input.seed;
  out["trials"] = input.trials;
  Json sections = Json::array();
  for (const ReproducedSection& s : input.sections) {
    Json one;
    one["id"] = s.id;
    one["title"] = s.title;
    one["source"] = s.source;
    one["setting"] = s.setting;
    one["machine"] = s.machine;
    one["parameters"] = s.parameters;
    Json figures = Json::array();
    for (const ReproducedFigure& f : s.figures) {
      figures.push_back({{"what", f.what},
                         {"of", f.of},
                         {"against", f.against.empty() ? Json(nullptr) : Json(f.against)},
                         {"unit", f.unit},
                         {"printed", number_or_null(f.printed)},
                         {"ours", number_or_null(f.ours)},
                         {"spread", Json::array({number_or_null(f.low), number_or_null(f.high)})},
                         {"ratio", number_or_null(f.ratio())},
                         {"source", f.source}});
    }
    one["figures"] = std::move(figures);
    Json columns = Json::array();
    for (const Column& c : s.table.columns)
      columns.push_back(c.unit.empty() ? c.head : c.head + " [" + c.unit + "]");
    Json rows = Json::array();
    for (const auto& row : s.table.rows) {
      Json cells = Json::array();
      for (const Cell& c : row) cells.push_back(c.text);
      rows.push_back(std::move(cells));
    }
    one["table"] = {{"columns", std::move(columns)}, {"rows", std::move(rows)}};
    one["remarks"] = s.remarks;
    sections.push_back(std::move(one));
  }
  out["sections"] = std::move(sections);
  return out;
}

}  // namespace stribeck::report
