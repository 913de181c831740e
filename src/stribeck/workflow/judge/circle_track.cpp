#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include <stribeck/ident/circle/laps.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/judge/ball_bar.hpp>
#include <stribeck/workflow/judge/circle_track.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/log/runs.hpp>
#include <stribeck/workflow/option.hpp>
#include <utility>

namespace stribeck::workflow {
namespace {

constexpr double kUsualRadius = 10e-3;

/// Words of --map for positions and commands, and those for a ball-bar.
const std::vector<std::string>& words_of_positions() {
  static const std::vector<std::string> words{"x", "y", "rx", "ry"};
  return words;
}
const std::vector<std::string>& words_of_ball_bar() {
  static const std::vector<std::string> words{"angle", "radius", "deviation", "direction"};
  return words;
}

bool is_one_of(const std::string& what, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), what) != words.end();
}

}  // namespace

void CircleTrack::append(const CircleTrack& from, std::size_t at) {
  const auto copy = [at](const auto& source, auto& to) {
    if (!source.empty()) to.push_back(source[at]);
  };
  copy(from.x, x);
  copy(from.y, y);
  copy(from.rx, rx);
  copy(from.ry, ry);
  copy(from.t, t);
  copy(from.row, row);
  copy(from.part, part);
}

CircleTrack CircleTrack::empty_copy() const {
  CircleTrack copy;
  copy.axes = axes;
  copy.scale = scale;
  copy.ball_bar = ball_bar;
  copy.turned = turned;
  copy.feed = feed;
  return copy;
}

bool is_word_of_circle(const std::string& word) {
  return is_one_of(word, words_of_positions()) || is_one_of(word, words_of_ball_bar());
}

CircleMap circle_map(const std::vector<std::string>& texts) {
  const std::vector<std::string>&positions = words_of_positions(), &of_ball_bar = words_of_ball_bar();
  CircleMap given;
  for (const std::string& text : texts) {
    const auto [what, column] = halves("--map", text, "QUANTITY=COLUMN, e.g. x=\"x-pos mm\"");
    if (!is_word_of_circle(what))
      refuse_option("--map",
                    fmt::format("got {}, expected x, y (positions), rx, ry (commands), angle, radius, "
                                "deviation or direction (ball-bar)",
                                io::in_quotes(what)));
    if (!given.emplace(what, column).second) refuse_option("--map", fmt::format("{} is given twice", what));
  }
  if (given.count("rx") != given.count("ry"))
    refuse_option("--map", "got one of rx and ry, expected both or none");
  const auto count = [&](const std::vector<std::string>& words) {
    std::size_t there = 0;
    for (const std::string& word : words) there += given.count(word);
    return there;
  };
  if (count(of_ball_bar) == 0) return given;
  if (given.count("angle") != given.count("radius") + given.count("deviation"))
    refuse_option(
        "--map",
        "got a part of a ball-bar's columns, expected both or none of angle and radius (or deviation)");
  if (given.count("angle") == 0)
    refuse_option("--map", "got direction alone, expected angle and radius (or deviation) beside it");
  if (count(positions) > 0)
    refuse_option("--map", "got columns of a ball-bar beside positions, expected one or the other");
  return given;
}

namespace {

/// Radius of the circle that a track goes round, from the box round it, or where there is none of the least-squares circle of all rows;
/// absent for a line.
std::optional<double> radius_of(const CircleTrack& t) {
  constexpr int kPasses = 3;
  const bool commanded = !t.rx.empty();
  const auto half = [](const std::vector<double>& v) {
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    return 0.5 * (*high - *low);
  };
  double radius = std::max(half(commanded ? t.rx : t.x), half(commanded ? t.ry : t.y));
  for (int pass = 0; pass < kPasses; ++pass) {
    if (!(radius > 0.0)) return std::nullopt;
    const ident::circle::CircleMotion motion = ident::circle::circle_motion(t.samples(), t.t, radius);
    if (motion.runs.empty()) {
      try {
        return ident::circle::least_squares_circle(commanded ? t.rx : t.x, commanded ? t.ry : t.y).radius;
      } catch (const std::invalid_argument&) {
        return std::nullopt;
      }
    }
    std::vector<double> x, y;
    for (const ident::circle::CircleRun& run : motion.runs) {
      for (std::size_t i = run.first; i < run.last; ++i) {
        x.push_back(commanded ? t.rx[i] : t.x[i]);
        y.push_back(commanded ? t.ry[i] : t.y[i]);
      }
    }
    radius = ident::circle::least_squares_circle(x, y).radius;
  }
  return radius;
}

/// A command has its own rounding alone; a measured radius is off by what the machine makes of it.
double rounded_radius(double radius, bool commanded) {
  const double share = commanded ? 1e-6 : 1e-3;
  for (double step = std::pow(10.0, std::floor(std::log10(radius))); step > 1e-6; step *= 0.1) {
    for (const double part : {1.0, 0.5}) {
      const double near = std::round(radius / (part * step)) * part * step;
      if (std::abs(near - radius) <= share * radius) return near;
    }
  }
  return radius;
}

/// What files state, where --size says another radius; empty: no file does.
std::string note_on_stated_radii(const std::vector<io::Log>& logs, const CircleMap& map, double given) {
  constexpr double kSame = 1e-6;  // of the radius
  for (const io::Log& log : logs) {
    if (!ball_bar_columns(log, map)) continue;
    std::optional<double> stated;
    try {
      stated = stated_radius(log);
    } catch (const io::InputError&) {
      continue;  // what the file states cannot be used, and --size replaces it
    }
    if (stated && std::abs(*stated - given) > kSame * given)
      return fmt::format(
          "{} states a radius of {} mm, --size says {} mm and counts: angles in um/m, pitches and feeds depend on it (leave --size out "
          "where the file is right)",
          log.source, report::short_number(*stated * 1e3), report::short_number(given * 1e3));
  }
  return {};
}

}  // namespace

CircleRadius circle_radius(const std::vector<io::Log>& logs, const CircleMap& map, const std::string& size) {
  if (!size.empty()) {
    const double given = option_si("--size", size, quantity("m", "mm").positive());
    return {given, note_on_stated_radii(logs, map, given)};
  }
  std::optional<double> stated;
  const io::Log* first = nullptr;
  for (const io::Log& log : logs) {
    const auto bar = ball_bar_columns(log, map);
    if (!bar) continue;
    const std::optional<double> radius = stated_radius(log);
    if (!radius) continue;
    if (stated && std::abs(*radius - *stated) > 1e-9)
      throw io::InputError({log.source, 0, "radius",
                            fmt::format("states {} mm, {} states {} mm: expected circles of one radius (give "
                                        "--size where it is the same)",
                                        report::short_number(*radius * 1e3), first->source,
                                        report::short_number(*stated * 1e3))});
    stated = radius;
    first = &log;
  }
  if (stated) return {*stated};
  for (const io::Log& log : logs) {
    const auto bar = ball_bar_columns(log, map);
    if (bar && bar->series.front().deviation)
      throw io::InputError({log.source, 0, header_of(*bar->series.front().radial.column),
                            "is a deviation from a radius that the file does not state (give it with --size "
                            "\"100 mm\", with your value)"});
  }
  if (logs.empty()) return {kUsualRadius};
  bool commanded = false;
  std::optional<double> found;
  if (const auto bar = ball_bar_columns(logs.front(), map)) {
    std::vector<double> radii = positions(logs.front(), bar->series.front().radial);
    if (!radii.empty()) found = ident::stats::median(std::move(radii));
  } else {
    const CircleTrack track = circle_track(logs.front(), map, kUsualRadius);
    commanded = !track.rx.empty();
    found = radius_of(track);
  }
  if (!found || !(*found > 0.0)) return {kUsualRadius};
  const double radius = rounded_radius(*found, commanded);
  if (commanded) return {radius};
  return {radius,
          fmt::format(
              "the radius was not given: {:.7g} mm, the measured {:.6g} mm rounded (--size gives another)",
              radius * 1e3, *found * 1e3)};
}

std::vector<double> circle_times(const io::Log& log, std::size_t rows) {
  const int at = io::time_column(log);
  if (at < 0) return {};
  const io::Column& column = log.columns[static_cast<std::size_t>(at)];
  if (column.values.size() != rows || column.unit_text.empty()) return {};
  return io::in_si(column, quantity("s", "s"));
}

namespace {

/// Leaves out rows whose time the next row repeats, and refuses times that go back again and again. A time that goes back a few
/// times belongs to logs that were put one behind the other.
CircleTrack in_order_of_time(const io::Log& log, CircleTrack t) {
  constexpr double kOften = 0.01;        // of the rows
  constexpr double kMostRepeated = 0.6;  // of the rows
  if (t.t.empty()) return t;
  std::size_t back = 0, first = 0, repeated = 0;
  for (std::size_t i = 1; i < t.t.size(); ++i) {
    if (t.t[i] == t.t[i - 1]) ++repeated;
    if (!(t.t[i] < t.t[i - 1])) continue;
    if (back++ == 0) first = i;
  }
  if (static_cast<double>(back) > kOften * static_cast<double>(t.t.size()))
    throw io::InputError(
        {log.source, 0, log.columns[static_cast<std::size_t>(io::time_column(log))].name,
         fmt::format(
             "goes back in {} of {} rows, first from {:.15g} to {:.15g} s in row {}: expected rows in order of time (sort them)",
             back, t.t.size(), t.t[first - 1], t.t[first], t.row[first] + 1)});
  if (repeated == 0) return t;
  if (static_cast<double>(repeated) > kMostRepeated * static_cast<double>(t.t.size())) {
    t.t.clear();
    t.notes.push_back(
        fmt::format("the times repeat in {} of {} rows and are not used: they are too coarse, or stand still",
                    repeated, t.x.size()));
    return t;
  }
  CircleTrack out = t.empty_copy();
  for (std::size_t i = 0; i < t.t.size(); ++i) {
    if (i + 1 == t.t.size() || t.t[i] != t.t[i + 1]) out.append(t, i);
  }
  out.notes = std::move(t.notes);
  out.notes.push_back(
      fmt::format("{} of {} rows have the same time as the next row and are left out", repeated, t.t.size()));
  return out;
}

using Positions = std::pair<std::vector<double>, std::vector<double>>;

/// Whether commanded positions belong to the measured ones: nowhere farther than a fifth of the travel.
bool belongs(const std::vector<double>& commanded, const std::vector<double>& measured) {
  constexpr double kNear = 0.2;
  if (commanded.size() != measured.size() || measured.empty()) return false;
  const auto [low, high] = std::minmax_element(measured.begin(), measured.end());
  const double most = kNear * (*high - *low);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!(std::abs(commanded[i] - measured[i]) <= most)) return false;
  }
  return true;
}

/// The commanded positions of both axes, found by their names; absent where one is missing or does not belong to the measured ones,
/// which is noted.
std::optional<Positions> commanded_circle(const io::Log& log, const CircleTrack& measured,
                                          std::vector<std::string>& notes) {
  const auto rx = commanded_column(log, measured.axes[0]), ry = commanded_column(log, measured.axes[1]);
  if (!rx || !ry) return {};
  Positions found{positions(log, *rx), positions(log, *ry)};
  if (belongs(found.first, measured.x) && belongs(found.second, measured.y)) return found;
  notes.push_back(fmt::format(
      "{} and {} are not the commanded positions of {} and {}: they differ by more than a fifth of the travel; the centre is that of "
      "the measured circle (where they are, give --map rx=\"{} mm\" --map ry=\"{} mm\", with your columns and units)",
      io::in_quotes(header_of(*rx->column)), io::in_quotes(header_of(*ry->column)), measured.axes[0],
      measured.axes[1], rx->column->name, ry->column->name));
  return {};
}

/// Travel of an axis in the rows that count, in all where none is marked; NaN: the log has no position of it.
double travel_of(const io::Log& log, const std::string& axis, const std::vector<std::uint8_t>& counts) {
  try {
    std::vector<double> all = positions(log, position_column(log, axis));
    if (counts.size() == all.size()) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (counts[k] != 0) all[kept++] = all[k];
      }
      all.resize(kept);
    }
    if (all.empty()) return std::nan("");
    const auto [low, high] = std::minmax_element(all.begin(), all.end());
    return *high - *low;
  } catch (const io::InputError&) {
    return std::nan("");
  }
}

/// The axis that --map names by its column; empty: it does not say.
std::string axis_in(const std::string& column) {
  std::string found;
  for (const std::string& word : words_of_name(column)) {
    if (word != "x" && word != "y" && word != "z") continue;
    if (!found.empty() && found != word) return {};
    found = word;
  }
  return found;
}

/// The axes of the circle: those that --map names, else the two of x, y and z that move.
ident::circle::AxisNames axes_of_circle(const io::Log& log, const CircleMap& map, const std::string& where) {
  constexpr double kStill = 0.01;  // of the travel of the others
  ident::circle::AxisNames axes{"x", "y"};
  bool named = false;
  for (std::string& axis : axes) {
    const auto given = map.find(axis);
    if (given == map.end()) continue;
    named = true;
    if (const std::string own = axis_in(given->second); !own.empty()) axis = own;
  }
  if (named) return axes[0] == axes[1] ? ident::circle::AxisNames{"x", "y"} : axes;
  const std::vector<std::uint8_t> counts =
      where.empty() ? std::vector<std::uint8_t>() : rows_with(log, where);
  const double x = travel_of(log, "x", counts), y = travel_of(log, "y", counts),
               z = travel_of(log, "z", counts);
  if (!std::isfinite(z)) return axes;
  if (std::isfinite(x) && !(y > kStill * std::min(x, z))) return {"x", "z"};
  if (std::isfinite(y) && !(x > kStill * std::min(y, z))) return {"y", "z"};
  return axes;
}

/// A third axis that travels as far as a circle does makes circles of its own.
void note_other_planes(const io::Log& log, const CircleMap& map, const std::string& where, double radius,
                       CircleTrack& t) {
  constexpr double kAsCircle = 1.9;  // radii
  if (!where.empty() || !map.empty() || t.axes != CircleTrack().axes) return;
  const double z = travel_of(log, "z", {});
  if (!(z > kAsCircle * radius)) return;
  t.notes.push_back(fmt::format(
      "z travels {:.4g} mm in this log: if there are circles with z, they are left out; judge each plane alone, --where COLUMN=VALUE or a file for "
      "each",
      1e3 * z));
}

/// Which way round is counter-clockwise in the plane of a G-code program.
std::string plane_words(const ident::circle::AxisNames& axes) {
  const std::string which = axes[0] + axes[1];
  return fmt::format("the circle is one of {0} and {1}: counter-clockwise goes from {0}+ to {1}+{2}", axes[0],
                     axes[1],
                     which == "xz"   ? ", which is G2 in the plane G18"
                     : which == "yz" ? ", which is G3 in the plane G19"
                                     : "");
}

}  // namespace

CircleTrack circle_track(const io::Log& log, const CircleMap& map, double radius, const std::string& where) {
  if (const auto bar = ball_bar_columns(log, map))
    return in_order_of_time(log, ball_bar_track(log, *bar, radius));
  const io::Column* first = nullptr;
  const auto values = [&](const NamedColumn& named) {
    std::vector<double> all = positions(log, named);
    if (first == nullptr) first = named.column;
    if (all.size() != first->values.size()) {
      throw io::InputError({log.source, 0, named.column->name,
                            fmt::format("has {} rows, {} has {}: expected columns of one rate", all.size(),
                                        first->name, first->values.size())});
    }
    return all;
  };
  CircleTrack t;
  t.axes = axes_of_circle(log, map, where);
  const auto on_scale = [&](std::size_t axis) { return scale_column(log, t.axes[axis]); };
  t.scale = map.count("x") + map.count("y") == 0 && on_scale(0) && on_scale(1);
  if (t.scale)
    t.notes.push_back(fmt::format(
        "positions are those of the scales, {} and {}; --map x=… --map y=… chooses those of the motors",
        io::in_quotes(header_of(*on_scale(0)->column)), io::in_quotes(header_of(*on_scale(1)->column))));
  const auto position = [&](const std::string& key, const std::string& axis) {
    if (t.scale) return values(*scale_column(log, axis));
    const auto given = map.find(key);
    return values(given == map.end() ? position_column(log, axis) : named_column(log, given->second));
  };
  t.x = position("x", t.axes[0]);
  t.y = position("y", t.axes[1]);
  if (t.axes != CircleTrack().axes) t.notes.push_back(plane_words(t.axes));
  note_other_planes(log, map, where, radius, t);
  if (map.count("rx") > 0) {
    t.rx = values(named_column(log, map.at("rx")));
    t.ry = values(named_column(log, map.at("ry")));
  } else if (auto found = commanded_circle(log, t, t.notes)) {
    t.rx = std::move(found->first);
    t.ry = std::move(found->second);
  }
  t.t = circle_times(log, t.x.size());
  for (std::size_t i = 0; i < t.x.size(); ++i) t.row.push_back(i);
  return in_order_of_time(log, std::move(t));
}

}  // namespace stribeck::workflow
