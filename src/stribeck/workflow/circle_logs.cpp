#include <fmt/format.h>
#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/runs.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

namespace {

/// The texts of --map: quantity, column.
std::map<std::string, std::string> mapped(const CircleOptions& o) {
  std::map<std::string, std::string> given;
  for (const std::string& text : o.maps) {
    const auto [what, column] = halves("--map", text, "QUANTITY=COLUMN, e.g. x=\"x-pos mm\"");
    if (what != "x" && what != "y" && what != "rx" && what != "ry")
      refuse_option("--map", fmt::format("got {}, expected x, y (positions), rx or ry (commands)",
                                         io::in_quotes(what)));
    if (!given.emplace(what, column).second) refuse_option("--map", fmt::format("{} is given twice", what));
  }
  if (given.count("rx") != given.count("ry"))
    refuse_option("--map", "got one of rx and ry, expected both or none");
  return given;
}

/// The columns of a log that are used, all rows.
struct Track {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> rx;  ///< empty: no command
  std::vector<double> ry;
};

Track track_of(const io::Log& log, const std::map<std::string, std::string>& map) {
  const io::Column* first = nullptr;
  const auto values = [&](const std::string& what) -> std::vector<double> {
    const auto given = map.find(what);
    if (given == map.end() && what.size() > 1) return {};
    const NamedColumn named =
        given == map.end() ? position_column(log, what) : named_column(log, given->second);
    std::vector<double> all = positions(log, named);
    if (first == nullptr) first = named.column;
    if (all.size() != first->values.size()) {
      throw io::InputError({log.source, 0, named.column->name,
                            fmt::format("has {} rows, {} has {}: expected columns of one rate", all.size(),
                                        first->name, first->values.size())});
    }
    return all;
  };
  Track t;
  t.x = values("x");
  t.y = values("y");
  t.rx = values("rx");
  t.ry = values("ry");
  return t;
}

sim::CircleTest judge(const io::Log& log, const Track& track, const std::string& where, double radius) {
  std::vector<std::uint8_t> counts;
  if (!where.empty()) counts = rows_with(log, where);
  if (!where.empty() && counts.size() != track.x.size())
    throw io::InputError(
        {log.source, 0, where, "has another sampling rate than the positions (leave it out)"});
  const auto chosen = [&](const std::vector<double>& all) {
    if (where.empty()) return all;
    std::vector<double> some;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (counts[i] != 0) some.push_back(all[i]);
    }
    return some;
  };
  const Track t{chosen(track.x), chosen(track.y), chosen(track.rx), chosen(track.ry)};
  try {
    return sim::circle_test({t.x, t.y, t.rx, t.ry}, radius);
  } catch (const std::invalid_argument& e) {
    throw io::InputError(
        {log.source, 0, where,
         fmt::format(
             "{}; got {} rows (--where COLUMN=VALUE chooses rows, --size is the radius that was meant)",
             e.what(), t.x.size())});
  }
}

/// Adds the heads of the further columns to the page; returns the entries for each log.
std::vector<std::vector<std::string>> beside_columns(const CircleOptions& o,
                                                     report::CircleReportInput& input) {
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
  return beside;
}

}  // namespace

report::CircleReportInput judge_circles(const CircleOptions& o) {
  const double radius = option_si("--size", o.size, quantity("m", "mm").positive());
  if (!o.labels.empty() && o.labels.size() != o.logs.size())
    refuse_option("--label",
                  fmt::format("got {}, expected {}, one for each log", o.labels.size(), o.logs.size()));
  report::CircleReportInput input;
  input.title = fmt::format("Circle of {} mm", report::short_number(radius * 1e3));
  input.radius = radius;
  input.rows = o.where;
  const auto beside = beside_columns(o, input);
  const auto map = mapped(o);
  for (std::size_t i = 0; i < o.logs.size(); ++i) {
    io::ReadOptions read;
    read.times_needed = false;  // no times needed: the order of the rows is enough
    const io::Log log = io::read_log(o.logs[i], read);
    const Track track = track_of(log, map);
    report::CircleLog one;
    one.file = o.logs[i];
    one.label = o.labels.empty() ? std::filesystem::path(o.logs[i]).stem().string() : o.labels[i];
    if (o.where.empty()) one.circles.push_back(judge(log, track, "", radius));
    for (const std::string& where : o.where) one.circles.push_back(judge(log, track, where, radius));
    for (const auto& words : beside) one.beside.push_back(words[i]);
    if (i > 0) {
      for (std::size_t c = 0; c < one.circles.size(); ++c) {
        if (one.circles[c].counter_clockwise != input.logs.front().circles[c].counter_clockwise)
          throw io::InputError({log.source, 0, {}, "turns the other way than " + input.logs.front().file});
      }
    }
    // Names from a side file are known to the program and need no note.
    for (const io::Note& note : log.notes) {
      if (note.about != io::Note::About::kGivenNames) input.warnings.push_back(one.label + ": " + note.text);
    }
    input.logs.push_back(std::move(one));
  }
  return input;
}

}  // namespace stribeck::workflow
