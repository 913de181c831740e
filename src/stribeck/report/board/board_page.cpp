#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/report/board/board_parts.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

std::string color_of(const BoardEntrant& e, std::size_t position) { return controller_color(e.id, position); }

Cell name_cell(const BoardEntrant& e, std::size_t position) {
  return {fmt::format("{}. {}", position + 1, clean_text(e.id)) + (e.outside ? " *" : ""), "",
          clean_text(e.label) + (e.source.empty() ? "" : " — " + clean_text(e.source)), false,
          color_of(e, position)};
}

Cell figure_cell(const sim::Confident& c, bool best = false, std::string_view infinite = "failed") {
  return {board_number(c.value, infinite), "", board_interval(c, infinite), best};
}

/// Medians as points with whiskers, one place for each entry; what failed is left out.
template <class Row, class Get>
Plot medians(const std::vector<Row>& rows, Get&& get, const std::string& title, const std::string& y_label) {
  Plot p;
  p.title = title;
  p.description = "median over the machines with its 95 % confidence, " + title;
  p.x_label = "place in the table";
  p.y_label = y_label;
  p.log_y = true;
  p.legend = Legend::kNone;
  p.height = 360;
  std::size_t place = 0;
  for (const Row& row : rows) {
    const sim::Confident& c = get(row);
    ++place;
    if (!std::isfinite(c.value) || !(c.value > 0.0)) continue;
    const auto x = static_cast<double>(place);
    const std::string color = color_of(row.entrant, place - 1);
    Series whisker;
    whisker.x = {x, x};
    whisker.y = {std::isfinite(c.low) && c.low > 0.0 ? c.low : c.value,
                 std::isfinite(c.high) ? c.high : c.value};
    whisker.color = color;
    whisker.width = 2.0;
    p.series.push_back(std::move(whisker));
    Series point;
    point.x = {x};
    point.y = {c.value};
    point.style = Style::kPoints;
    point.color = color;
    point.width = 5.0;
    p.series.push_back(std::move(point));
    p.x_tics.push_back({x, std::to_string(place)});
  }
  p.x_range = Range{0.4, static_cast<double>(place) + 0.6};
  return p;
}

std::vector<ControlRow> rows_at(const BoardResult& r, const std::string& motion) {
  std::vector<ControlRow> rows;
  std::copy_if(r.control.begin(), r.control.end(), std::back_inserter(rows),
               [&](const ControlRow& row) { return row.motion == motion; });
  return rows;
}

void add_identification(Page& page, const BoardResult& r) {
  if (r.identification.empty()) return;
  page.section("Identification");
  page.paragraph(
      "Every entry gets the same logs: pulses of force and a sine. Curve: error of the steady force at nine speeds in both "
      "directions. Unseen: error of the force on a motion that was not in the logs. Covered: share of the true values within "
      "the stated intervals of 95 %; none are stated by an axis file alone.");
  const auto curve = [](const IdentificationRow& row) -> const sim::Confident& {
    return row.curve_error.median;
  };
  const Plot plot = medians(r.identification, curve, "error of the friction curve", "error [%]");
  if (!plot.series.empty())
    page.figure(plot, "Median over the axes; lines: 95 % confidence by bootstrap over the machines.");
  Table t;
  t.columns = {{"entry", "", false},  {"curve", "%"},    {"99 %", "%"},    {"mass", "%"},
               {"99 %", "%"},         {"unseen", "%"},   {"covered", "%"}, {"half width", "%"},
               {"mass covered", "%"}, {"failed", "axes"}};
  for (std::size_t i = 0; i < r.identification.size(); ++i) {
    const IdentificationRow& row = r.identification[i];
    t.rows.push_back({name_cell(row.entrant, i),
                      figure_cell(row.curve_error.median, i == 0),
                      figure_cell(row.curve_error.p99),
                      figure_cell(row.mass_error.median),
                      figure_cell(row.mass_error.p99),
                      figure_cell(row.held_out_error.median),
                      {covered_in_words(row), "", board_interval(row.covered)},
                      {board_number(row.half_width)},
                      {board_number(row.covered_mass)},
                      {std::to_string(row.failed())}});
  }
  page.table(t);
}

void add_control(Page& page, const BoardResult& r) {
  if (r.control.empty()) return;
  page.section("Control");
  page.paragraph(
      "Every controller knows the same identified model of each axis. Contour error of the third lap, in µm; |Δu|: mean change "
      "of the input from one period to the next.");
  for (const std::string& motion : board_motions(r)) {
    page.subsection(motion);
    const std::vector<ControlRow> rows = rows_at(r, motion);
    const auto largest = [](const ControlRow& row) -> const sim::Confident& { return row.max_error.median; };
    const Plot plot = medians(rows, largest, "largest contour error, " + motion, "largest error [µm]");
    if (!plot.series.empty())
      page.figure(plot, "Median over the machines; lines: 95 % confidence by bootstrap over the machines.");
    Table t;
    t.columns = {{"entry", "", false}, {"max", "µm"},  {"99 %", "µm"},       {"RMS", "µm"},
                 {"99 %", "µm"},       {"|Δu|", "mV"}, {"lost", "machines"}, {"failed", "machines"}};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const ControlRow& row = rows[i];
      t.rows.push_back({name_cell(row.entrant, i),
                        figure_cell(row.max_error.median, i == 0, "lost"),
                        figure_cell(row.max_error.p99, false, "lost"),
                        figure_cell(row.rms.median, false, "lost"),
                        figure_cell(row.rms.p99, false, "lost"),
                        figure_cell(row.input_variation.median, false, "lost"),
                        {std::to_string(row.lost)},
                        {std::to_string(row.failed())}});
    }
    page.table(t);
  }
}

/// "auto has the smallest, 2.1 % (1.9–2.4); next of 5: jog with 2.3 %", and whether these machines tell the two apart. The best row is
/// the first; empty where it has no value.
template <class Row, class Get>
std::string first_in_words(const std::vector<Row>& rows, Get&& get, std::string_view unit,
                           std::string_view infinite) {
  if (rows.empty() || !std::isfinite(get(rows[0]).value)) return {};
  const sim::Confident& best = get(rows[0]);
  const std::string interval = board_interval(best, infinite);
  std::string words =
      fmt::format("{} has {}{} {}{}", clean_text(rows[0].entrant.id), rows.size() > 1 ? "the smallest, " : "",
                  board_number(best.value), unit, interval.empty() ? "" : " (" + interval + ")");
  if (rows.size() < 2) return words;
  const sim::Confident& second = get(rows[1]);
  const std::string id = clean_text(rows[1].entrant.id);
  if (!std::isfinite(second.value))
    return words +
           fmt::format("; next of {}: {}, {} in half of the cases or more", rows.size(), id, infinite);
  words += fmt::format("; next of {}: {} with {} {}", rows.size(), id, board_number(second.value), unit);
  if (second.low <= best.high) words += ", which these machines do not tell apart from it";
  return words;
}

/// Who is first, and by how much.
std::vector<std::string> answers(const BoardResult& r) {
  std::vector<std::string> all;
  const auto add = [&](std::string_view of, std::string words) {
    if (!words.empty()) all.push_back(fmt::format("{}: {}.", of, words));
  };
  add("Median error of the friction curve",
      first_in_words(
          r.identification,
          [](const IdentificationRow& row) -> const sim::Confident& { return row.curve_error.median; }, "%",
          "failed"));
  for (const std::string& motion : board_motions(r)) {
    const std::vector<ControlRow> rows = rows_at(r, motion);
    add("Median of the largest contour error, " + motion,
        first_in_words(
            rows, [](const ControlRow& row) -> const sim::Confident& { return row.max_error.median; }, "µm",
            "lost"));
  }
  return all;
}

Page board_page(const BoardReportInput& input) {
  const BoardResult& r = input.result;
  Page page("Board", "stribeck " + input.version);
  for (const std::string& words : answers(r)) page.lead(words);
  page.paragraph(board_in_words(r) + ".");
  page.paragraph(
      "In small type below a number: its interval of 95 % confidence. A question mark: the 99th percentile has no upper end "
      "below 368 machines. Entries with * were given by the user.");
  page.warnings(r.warnings);
  add_identification(page, r);
  add_control(page, r);
  if (!r.costs.empty()) {
    page.section("Time of a step");
    Table t;
    t.columns = {{"entry", "", false}, {"time of a step of two axes"}};
    for (const BoardCost& c : r.costs) t.rows.push_back({{clean_text(c.id)}, {cost_in_words(c)}});
    page.table(t);
    page.remark("Measured on this computer; it differs from run to run.");
  }
  page.list("What failed or lost the path", failures_in_words(r));
  page.section("Machines");
  page.paragraph(joined(r.machines, ", ") + ".");
  page.made({input.command, input.version, {}});
  return page;
}

}  // namespace

std::string board_report(const BoardReportInput& input) { return board_page(input).html(); }

void write_board_report(const PageFolders& folders, const BoardReportInput& input) {
  write_page(board_page(input), folders);
}

}  // namespace stribeck::report
