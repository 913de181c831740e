#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/log.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/circle_report.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::vector<std::string> logs;
  std::string path = "circle";
  std::string size = "10 mm";
  std::vector<std::string> maps;    ///< QUANTITY=COLUMN [UNIT]
  std::vector<std::string> where;   ///< COLUMN=VALUE, a circle each
  std::vector<std::string> labels;  ///< one for each log
  std::vector<std::string> beside;  ///< HEAD=VALUE,VALUE,…
};

/// A column by name, or by name and unit.
std::vector<double> positions(const io::Log& log, const std::string& text) {
  const io::Column* found = log.find(text);
  const auto blank = text.rfind(' ');
  if (found != nullptr || blank == std::string::npos)
    return io::in_si(found != nullptr ? *found : log.at(text), quantity("m", "mm"));
  io::Column column = log.at(text.substr(0, blank));
  const std::string unit = text.substr(blank + 1);
  if (column.unit_text.empty()) column.unit_text = unit;
  if (column.unit_text != unit) {
    throw io::InputError({log.source, 0, column.name,
                          fmt::format("--map gives {}, the log has {}", io::in_quotes(unit),
                                      io::in_quotes(column.unit_text))});
  }
  return io::in_si(column, quantity("m", "mm"));
}

std::map<std::string, std::string> mapped(const Options& o) {
  std::map<std::string, std::string> map{{"x", "x"}, {"y", "y"}};
  std::map<std::string, std::string> given;
  for (const std::string& text : o.maps) {
    const auto [what, column] = halves("--map", text, "QUANTITY=COLUMN, e.g. x=\"x-pos mm\"");
    if (what != "x" && what != "y" && what != "rx" && what != "ry")
      refuse_option("--map", fmt::format("got {}, expected x, y (positions), rx or ry (commands)",
                                         io::in_quotes(what)));
    if (!given.emplace(what, column).second) refuse_option("--map", fmt::format("{} is given twice", what));
    map[what] = column;
  }
  if (map.count("rx") != map.count("ry"))
    refuse_option("--map", "got one of rx and ry, expected both or none");
  return map;
}

/// Rows at which a column has a value; all where `where` is empty.
std::vector<std::size_t> rows_of(const io::Log& log, const std::string& where) {
  std::vector<std::size_t> rows;
  if (where.empty()) {
    for (std::size_t i = 0; i < log.rows; ++i) rows.push_back(i);
    return rows;
  }
  const auto [name, text] = halves("--where", where, "COLUMN=VALUE, e.g. line=7");
  const io::Column& column = log.at(name);
  double value = 0.0;
  try {
    std::size_t used = 0;
    value = std::stod(text, &used);
    if (used != text.size() || !std::isfinite(value)) throw std::invalid_argument("");
  } catch (const std::exception&) {
    refuse_option("--where", fmt::format("got {}, expected a number after {}=", io::in_quotes(text), name));
  }
  for (std::size_t i = 0; i < column.values.size(); ++i) {
    if (column.values[i] == value) rows.push_back(i);
  }
  if (rows.empty()) throw io::InputError({log.source, 0, name, fmt::format("no row has {}", where)});
  return rows;
}

sim::CircleTest judge(const Options& o, const io::Log& log, const std::string& where, double radius) {
  const std::vector<std::size_t> rows = rows_of(log, where);
  std::map<std::string, std::vector<double>> chosen;
  for (const auto& [what, text] : mapped(o)) {
    const std::vector<double> all = positions(log, text);
    for (const std::size_t i : rows) {
      if (i < all.size()) chosen[what].push_back(all[i]);
    }
  }
  try {
    return sim::circle_test({chosen["x"], chosen["y"], chosen["rx"], chosen["ry"]}, radius);
  } catch (const std::invalid_argument& e) {
    throw io::InputError(
        {log.source, 0, where,
         fmt::format("{} in {} rows, expected one revolution or more (--where COLUMN=VALUE chooses rows)",
                     e.what(), rows.size())});
  }
}

int evaluate(const Options& o) {
  check_distinct(o.logs, {o.common.json});
  const double radius = option_si("--size", o.size, quantity("m", "mm").positive());
  if (!o.labels.empty() && o.labels.size() != o.logs.size())
    refuse_option("--label",
                  fmt::format("got {}, expected {}, one for each log", o.labels.size(), o.logs.size()));
  report::CircleReportInput input;
  input.title = fmt::format("Circle of {} mm", report::short_number(radius * 1e3));
  input.radius = radius;
  input.rows = o.where;
  input.command = typed_command();
  input.version = STRIBECK_VERSION;
  std::vector<std::vector<std::string>> beside;
  for (const std::string& text : o.beside) {
    const auto [head, values] = halves("--beside", text, "HEAD=VALUE,VALUE,…, one for each log");
    input.beside.push_back(head);
    std::vector<std::string> words{""};
    for (const char c : values) {
      if (c == ',') {
        words.emplace_back();
      } else {
        words.back() += c;
      }
    }
    if (words.size() != o.logs.size())
      refuse_option("--beside", fmt::format("{}: got {} values, expected {}, one for each log", head,
                                            words.size(), o.logs.size()));
    beside.push_back(words);
  }
  for (std::size_t i = 0; i < o.logs.size(); ++i) {
    const io::Log log = io::read_log(o.logs[i]);
    report::CircleLog one;
    one.file = o.logs[i];
    one.label = o.labels.empty() ? std::filesystem::path(o.logs[i]).stem().string() : o.labels[i];
    if (o.where.empty()) one.circles.push_back(judge(o, log, "", radius));
    for (const std::string& where : o.where) one.circles.push_back(judge(o, log, where, radius));
    for (const auto& words : beside) one.beside.push_back(words[i]);
    if (i > 0) {
      for (std::size_t c = 0; c < one.circles.size(); ++c) {
        if (one.circles[c].counter_clockwise != input.logs.front().circles[c].counter_clockwise)
          throw io::InputError({log.source, 0, {}, "turns the other way than " + input.logs.front().file});
      }
    }
    // What the program itself set up (names from a side file) need not be told.
    for (const std::string& note : log.notes) {
      if (note.find("names and units are those given") == std::string::npos)
        input.warnings.push_back(one.label + ": " + note);
    }
    input.logs.push_back(std::move(one));
  }
  const OutputFolder page_folder = check_outputs(o.common);
  write_json(o.common.json, report::to_json(input));
  if (!o.common.report.empty()) report::write_circle_report(o.common.report, input);
  say(o.common, report::text_table(input));
  return 0;
}

}  // namespace

void add_evaluate(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("evaluate", "Contour error of circles that were travelled, from any log");
  auto o = std::make_shared<Options>();
  verb->add_option("logs", o->logs, "Logs of the same program under one control each")
      ->required()
      ->type_name("LOG...");
  verb->add_option("--path", o->path, "What was travelled")->check(one_of({"circle"}))->capture_default_str();
  verb->add_option("--size", o->size, "Radius that was meant")->type_name("LENGTH")->capture_default_str();
  verb->add_option("--map", o->maps,
                   "Which column is what: x, y (positions), rx, ry (commands, whose centre is the circle's; "
                   "without them the "
                   "least-squares centre is taken)")
      ->type_name("QUANTITY=COLUMN");
  verb->add_option("--where", o->where,
                   "Rows of one circle, e.g. line=7; repeat for more circles; left out: all rows")
      ->type_name("COLUMN=VALUE");
  verb->add_option("--label", o->labels, "Name of each log's control; left out: the file's")
      ->type_name("NAME");
  verb->add_option("--beside", o->beside, "A further column of the table, with one value for each log")
      ->type_name("HEAD=VALUE,VALUE");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck evaluate pid.log axis.log --map x=\"x-pos mm\" --map y=\"y-pos mm\" --where "
      "line=7 --report page");
  verb->callback([o, &action] { action = [o] { return evaluate(*o); }; });
}

}  // namespace stribeck::cli
