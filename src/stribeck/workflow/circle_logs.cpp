#include <fmt/format.h>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <stribeck/ident/circle/causes.hpp>
#include <stribeck/ident/circle/circularity.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/metrics.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/runs.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

namespace circle = ident::circle;

namespace {

/// The texts of --map: quantity, column.
std::map<std::string, std::string> mapped(const CircleOptions& o) {
  std::map<std::string, std::string> given;
  for (const std::string& text : o.maps) {
    const auto [what, column] = halves("--map", text, "QUANTITY=COLUMN, e.g. x=\"x-pos mm\"");
    if (what != "x" && what != "y" && what != "rx" && what != "ry" && what != "angle" && what != "radius")
      refuse_option("--map",
                    fmt::format("got {}, expected x, y (positions), rx, ry (commands), angle or radius "
                                "(ball-bar)",
                                io::in_quotes(what)));
    if (!given.emplace(what, column).second) refuse_option("--map", fmt::format("{} is given twice", what));
  }
  if (given.count("rx") != given.count("ry"))
    refuse_option("--map", "got one of rx and ry, expected both or none");
  if (given.count("angle") != given.count("radius"))
    refuse_option("--map", "got one of angle and radius, expected both or none");
  if (given.count("angle") != 0 && given.size() > 2)
    refuse_option("--map", "got angle and radius beside positions, expected one or the other");
  return given;
}

/// The columns of a log that are used.
struct Track {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> rx;  ///< empty: no command
  std::vector<double> ry;
  std::vector<double> t;  ///< empty: no times

  [[nodiscard]] circle::CircleSamples samples() const { return {x, y, rx, ry}; }

  /// Its rows from `first` to before `last`, behind those of `to`.
  void append_to(Track& to, std::size_t first, std::size_t last) const {
    const auto copy = [&](const std::vector<double>& from, std::vector<double>& all) {
      if (!from.empty()) all.insert(all.end(), from.begin() + first, from.begin() + last);
    };
    copy(x, to.x);
    copy(y, to.y);
    copy(rx, to.rx);
    copy(ry, to.ry);
    copy(t, to.t);
  }
};

/// Times of the rows [s]; empty where the log has none of one unit for all.
std::vector<double> times_of(const io::Log& log, std::size_t rows) {
  const int at = io::time_column(log);
  if (at < 0) return {};
  const io::Column& column = log.columns[static_cast<std::size_t>(at)];
  if (column.values.size() != rows || column.unit_text.empty()) return {};
  return io::in_si(column, quantity("s", "s"));
}

/// The columns angle and radius of a ball-bar, mapped or named so; absent where the log has positions.
std::optional<std::pair<NamedColumn, NamedColumn>> ball_bar_columns(
    const io::Log& log, const std::map<std::string, std::string>& map) {
  if (const auto angle = map.find("angle"); angle != map.end())
    return std::pair{named_column(log, angle->second), named_column(log, map.at("radius"))};
  if (!map.empty() || log.find("x") != nullptr) return std::nullopt;
  const io::Column* angle = log.find("angle");
  const io::Column* radius = log.find("radius");
  if (angle == nullptr || radius == nullptr || angle->values.empty() || radius->values.empty())
    return std::nullopt;
  return std::pair{NamedColumn{angle, angle->unit_text}, NamedColumn{radius, radius->unit_text}};
}

/// A ball-bar measures the distance from its own centre: that is the centre of the command.
Track ball_bar_track(const io::Log& log, const NamedColumn& angle, const NamedColumn& radius, double size) {
  io::Column turned = *angle.column;
  turned.unit_text = angle.unit;
  if (turned.unit_text.empty())
    throw io::InputError(
        {log.source, 0, turned.name,
         "has no unit, expected one of an angle (name the column \"angle [deg]\", or give --map "
         "angle=\"angle deg\" --map radius=\"radius mm\")"});
  const std::vector<double> angles = io::in_si(turned, quantity("rad", "deg"));
  const std::vector<double> radii = positions(log, radius);
  if (angles.size() != radii.size())
    throw io::InputError({log.source, 0, turned.name,
                          fmt::format("has {} rows, {} has {}: expected columns of one rate", angles.size(),
                                      radius.column->name, radii.size())});
  Track t;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    t.x.push_back(radii[i] * std::cos(angles[i]));
    t.y.push_back(radii[i] * std::sin(angles[i]));
    t.rx.push_back(size * std::cos(angles[i]));
    t.ry.push_back(size * std::sin(angles[i]));
  }
  t.t = times_of(log, t.x.size());
  return t;
}

Track track_of(const io::Log& log, const std::map<std::string, std::string>& map, double size) {
  if (const auto bar = ball_bar_columns(log, map)) return ball_bar_track(log, bar->first, bar->second, size);
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
  t.t = times_of(log, t.x.size());
  return t;
}

/// The rows that --where names; all without it.
Track chosen_rows(const io::Log& log, const Track& track, const std::string& where) {
  if (where.empty()) return track;
  const std::vector<std::uint8_t> counts = rows_with(log, where);
  if (counts.size() != track.x.size())
    throw io::InputError(
        {log.source, 0, where, "has another sampling rate than the positions (leave it out)"});
  Track some;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] != 0) track.append_to(some, i, i + 1);
  }
  return some;
}

circle::CircleTest tested(const io::Log& log, const Track& t, const std::string& where, double radius) {
  try {
    return circle::circle_test(t.samples(), radius, sim::kGlitchTravel);
  } catch (const std::invalid_argument& e) {
    throw io::InputError(
        {log.source, 0, where,
         fmt::format(
             "{}; got {} rows (--where COLUMN=VALUE chooses rows, --size is the radius that was meant)",
             e.what(), t.x.size())});
  }
}

/// One circle for each direction of travel, without run-in and run-out.
void add_circles(report::CircleLog& one, const io::Log& log, const Track& t, const std::string& where,
                 double radius, std::vector<std::string>& rows) {
  const circle::CircleMotion motion = circle::circle_motion(t.samples(), t.t, radius);
  // Where no circle is found, the test says what is missing.
  if (motion.runs.empty()) {
    one.circles.push_back(tested(log, t, where, radius));
    rows.push_back(where);
    return;
  }
  for (const bool counter_clockwise :
       {motion.runs.front().counter_clockwise, !motion.runs.front().counter_clockwise}) {
    Track own;
    double revolutions = 0.0;
    for (const circle::CircleRun& run : motion.runs) {
      if (run.counter_clockwise != counter_clockwise) continue;
      t.append_to(own, run.first, run.last);
      revolutions += run.revolutions;
    }
    if (own.x.empty()) continue;
    one.circles.push_back(tested(log, own, where, radius));
    one.circles.back().revolutions = revolutions;
    rows.push_back(where);
  }
}

/// The circular test of all chosen rows of a log together; absent where they are circles at different places.
/// Its motion is added to `motions`.
void add_test(report::CircleLog& one, const Track& all, double radius,
              std::vector<circle::CircleMotion>& motions) {
  constexpr double kOnePlace = 0.01;  // of the radius
  const circle::CircleTest& first = one.circles.front();
  for (const circle::CircleTest& c : one.circles) {
    if (std::hypot(c.centre_x - first.centre_x, c.centre_y - first.centre_y) > kOnePlace * radius) {
      one.notes.push_back("the circles are at different places: no figures of both directions together");
      return;
    }
  }
  circle::CircleMotion motion = circle::circle_motion(all.samples(), all.t, radius);
  one.notes.insert(one.notes.end(), motion.notes.begin(), motion.notes.end());
  if (motion.runs.empty()) return;
  one.test = circle::circular_test(all.samples(), motion);
  motions.push_back(std::move(motion));
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

std::vector<report::CircleLimit> limits_of(const std::vector<std::string>& texts) {
  std::vector<report::CircleLimit> limits;
  for (const std::string& text : texts) {
    const auto [figure, length] = halves("--limit", text, "FIGURE=LENGTH, e.g. G=5um");
    const auto& known = report::limited_figures();
    if (std::find(known.begin(), known.end(), figure) == known.end()) {
      refuse_option("--limit",
                    fmt::format("got {}, expected one of {}", io::in_quotes(figure), report::listed(known)));
    }
    limits.push_back({figure, option_si("--limit", length, quantity("m", "um").positive())});
  }
  return limits;
}

}  // namespace

io::Log read_circle_log(const std::string& path) {
  io::ReadOptions options;
  options.times_needed = false;
  return io::read_log(path, options);
}

report::CircleReportInput judge_circles(const CircleOptions& o, const std::vector<io::Log>& read) {
  const double radius = option_si("--size", o.size, quantity("m", "mm").positive());
  if (!o.labels.empty() && o.labels.size() != o.logs.size())
    refuse_option("--label",
                  fmt::format("got {}, expected {}, one for each log", o.labels.size(), o.logs.size()));
  report::CircleReportInput input;
  input.title = fmt::format("Circle of {} mm", report::short_number(radius * 1e3));
  input.radius = radius;
  input.limits = limits_of(o.limits);
  const auto beside = beside_columns(o, input);
  const auto map = mapped(o);
  std::vector<circle::CircleMotion> motions;
  for (std::size_t i = 0; i < o.logs.size(); ++i) {
    const io::Log log = read.empty() ? read_circle_log(o.logs[i]) : read[i];
    const Track track = track_of(log, map, radius);
    report::CircleLog one;
    one.file = o.logs[i];
    one.label = o.labels.empty() ? std::filesystem::path(o.logs[i]).stem().string() : o.labels[i];
    Track all;
    std::vector<std::string> rows;
    for (const std::string& where : o.where.empty() ? std::vector<std::string>{""} : o.where) {
      const Track chosen = chosen_rows(log, track, where);
      add_circles(one, log, chosen, where, radius, rows);
      chosen.append_to(all, 0, chosen.x.size());
    }
    std::vector<circle::CircleMotion> own;
    add_test(one, all, radius, own);
    if (!o.together && !own.empty()) one.diagnosis = circle::diagnose(own);
    motions.insert(motions.end(), std::make_move_iterator(own.begin()), std::make_move_iterator(own.end()));
    for (const std::string& note : one.notes) input.warnings.push_back(one.label + ": " + note);
    if (i == 0) input.rows = rows;
    for (const auto& words : beside) one.beside.push_back(words[i]);
    if (i > 0) {
      if (one.circles.size() != input.logs.front().circles.size())
        throw io::InputError(
            {log.source,
             0,
             {},
             fmt::format("has {} circles, one for each direction; {} has {}", one.circles.size(),
                         input.logs.front().file, input.logs.front().circles.size())});
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
  if (o.together && !motions.empty()) input.together = circle::diagnose(motions);
  return input;
}

}  // namespace stribeck::workflow
