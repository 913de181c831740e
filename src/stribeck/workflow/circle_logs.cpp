#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes.hpp>
#include <stribeck/ident/circle/circularity.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/metrics.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/judge/ball_bar.hpp>
#include <stribeck/workflow/judge/circle_track.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/runs.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

namespace circle = ident::circle;

namespace {

using Track = CircleTrack;

/// The rows that --where names; all without it.
Track chosen_rows(const io::Log& log, const Track& track, const std::string& where) {
  if (where.empty()) return track;
  const std::vector<std::uint8_t> counts = rows_with(log, where);
  const auto last = std::max_element(track.row.begin(), track.row.end());
  if (last != track.row.end() && *last + 1 != counts.size())
    throw io::InputError(
        {log.source, 0, where, "has another sampling rate than the positions (leave it out)"});
  Track some = track.empty_copy();
  for (std::size_t i = 0; i < track.row.size(); ++i) {
    if (counts[track.row[i]] != 0) some.append(track, i);
  }
  return some;
}

/// A mean radius that is off by more than a thousandth means that the given nominal radius is wrong.
void note_other_length(const Track& t, double radius, std::vector<std::string>& notes) {
  constexpr double kMost = 1e-3;
  double sum = 0.0;
  for (std::size_t i = 0; i < t.x.size(); ++i) sum += std::hypot(t.x[i], t.y[i]);
  const double mean = sum / static_cast<double>(std::max<std::size_t>(1, t.x.size()));
  if (!(std::abs(mean - radius) > kMost * radius)) return;
  notes.push_back(fmt::format(
      "the mean radius of the rows is {:.6g} mm, {:.6g} mm is the nominal one: the radius that is found holds the difference, and "
      "small causes hide behind it (give --size where another radius was meant)",
      1e3 * mean, 1e3 * radius));
}

/// Runs of rows without times have the feed that was stated.
circle::CircleMotion motion_of(const Track& t, double radius) {
  circle::CircleMotion motion = circle::circle_motion(t.samples(), t.t, radius);
  motion.axes = t.axes;
  motion.scale = t.scale;
  motion.ball_bar = t.ball_bar;
  if (t.ball_bar) note_other_length(t, radius, motion.notes);
  for (circle::CircleRun& run : motion.runs) {
    if (run.time.empty()) run.feed = t.feed;
  }
  return motion;
}

circle::CircleTest tested(const io::Log& log, const Track& t, const std::string& where, double radius) {
  try {
    return circle::circle_test(t.samples(), radius, sim::kGlitchTravel);
  } catch (const std::invalid_argument& e) {
    throw io::InputError(
        {log.source, 0, where,
         fmt::format("{}; got {} rows (--where COLUMN=VALUE chooses rows, --size is the nominal radius)",
                     e.what(), t.x.size())});
  }
}

/// A part program may go round without being a circle: its corners would be judged as errors of the machine.
void refuse_other_paths(const io::Log& log, const Track& t, const circle::CircleMotion& motion,
                        const std::string& where) {
  constexpr double kMostCommanded = 0.02;  // of the radius: a command has no error but its rounding
  constexpr double kMostMeasured = 0.1;
  constexpr double kMostRows = 0.1;
  const bool commanded = !t.rx.empty();
  const std::vector<double>&x = commanded ? t.rx : t.x, &y = commanded ? t.ry : t.y;
  // Each run about its own middle: two circles may stand at different places.
  std::size_t rows = 0, off = 0;
  double low = HUGE_VAL, high = 0.0;
  for (const circle::CircleRun& run : motion.runs) {
    const auto first = static_cast<std::ptrdiff_t>(run.first), last = static_cast<std::ptrdiff_t>(run.last);
    const std::vector<double> own_x(x.begin() + first, x.begin() + last);
    const std::vector<double> own_y(y.begin() + first, y.begin() + last);
    const circle::LeastSquaresCircle own = circle::least_squares_circle(own_x, own_y);
    const double most = (commanded ? kMostCommanded : kMostMeasured) * own.radius;
    for (std::size_t i = 0; i < own_x.size(); ++i) {
      const double radius = std::hypot(own_x[i] - own.x, own_y[i] - own.y);
      low = std::min(low, radius), high = std::max(high, radius);
      if (std::abs(radius - own.radius) > most) ++off;
    }
    rows += own_x.size();
  }
  if (static_cast<double>(off) <= kMostRows * static_cast<double>(rows)) return;
  throw io::InputError(
      {log.source, 0, where,
       fmt::format(
           "the {} positions go round, but are no circle: {:.4g} to {:.4g} mm from their middle; expected a circle (--where "
           "COLUMN=VALUE chooses the rows of one)",
           commanded ? "commanded" : "measured", 1e3 * low, 1e3 * high)});
}

/// What --map must say of the columns where the axis `wide` counts diameters.
std::string diameter_map(const io::Log& log, const Track& t, const CircleMap& map, std::size_t wide) {
  std::vector<std::string> options;
  for (std::size_t a = 0; a < 2; ++a) {
    for (const bool commanded : {false, true}) {
      if (commanded && t.rx.empty()) continue;
      const std::string key = std::string(commanded ? "r" : "") + (a == 0 ? "x" : "y");
      const auto column = commanded     ? commanded_column(log, t.axes[a])
                          : t.scale     ? scale_column(log, t.axes[a])
                          : map.empty() ? std::optional(position_column(log, t.axes[a]))
                                        : std::nullopt;
      const std::string unit = column && !column->unit.empty() ? column->unit : "mm";
      options.push_back(fmt::format("--map {}=\"{} {}{}\"", key, column ? column->column->name : "COLUMN",
                                    a == wide ? "0.5 " : "", unit));
    }
  }
  return report::joined(options, " ");
}

/// A lathe may count X in diameter: an ellipse twice as wide as high, which is a circle with half of that axis.
void refuse_diameter(const io::Log& log, const Track& t, const CircleMap& map, const std::string& where) {
  constexpr double kSame = 0.03;      // of the spans
  constexpr double kOnCircle = 0.05;  // of the radius
  constexpr double kMostRows = 0.7;   // the others lead in and out
  if (t.ball_bar || t.x.empty()) return;
  const std::array<const std::vector<double>*, 2> at = {t.rx.empty() ? &t.x : &t.rx,
                                                        t.rx.empty() ? &t.y : &t.ry};
  std::array<double, 2> middle{}, span{};
  for (std::size_t a = 0; a < 2; ++a) {
    const auto [low, high] = std::minmax_element(at[a]->begin(), at[a]->end());
    middle[a] = 0.5 * (*low + *high), span[a] = *high - *low;
  }
  const std::size_t wide = span[0] > span[1] ? 0 : 1, other = 1 - wide;
  if (!(std::abs(span[wide] - 2.0 * span[other]) <= kSame * span[wide])) return;
  const double radius = 0.5 * span[other];
  std::size_t on = 0;
  for (std::size_t i = 0; i < t.x.size(); ++i) {
    const double here = std::hypot(0.5 * ((*at[wide])[i] - middle[wide]), (*at[other])[i] - middle[other]);
    if (std::abs(here - radius) <= kOnCircle * radius) ++on;
  }
  if (static_cast<double>(on) < kMostRows * static_cast<double>(t.x.size())) return;
  throw io::InputError(
      {log.source, 0, where,
       fmt::format(
           "{0} covers twice as much as {1}, and with half of {0} the rows are a circle with a radius of {2:.4g} mm: {0} is in diameter, as a "
           "lathe may count it (give half a millimetre for each of {0}, {3})",
           t.axes[wide], t.axes[other], 1e3 * radius, diameter_map(log, t, map, wide))});
}

/// One circle for each direction of travel, without run-in and run-out.
void add_circles(report::CircleLog& one, const io::Log& log, const CircleMap& map, const Track& t,
                 const std::string& where, double radius, std::vector<std::string>& rows) {
  refuse_diameter(log, t, map, where);
  const circle::CircleMotion motion = motion_of(t, radius);
  // Where no circle is found, the test says what is missing.
  if (motion.runs.empty()) {
    if (motion.longest_arc > 0.0)
      throw io::InputError(
          {log.source, 0, where,
           fmt::format(
               "the longest arc in one direction is one of {:.0f} deg, expected at least {:.0f} deg, better a revolution; got {} rows "
               "(--where COLUMN=VALUE chooses rows, --size is the nominal radius)",
               motion.longest_arc * 180.0 / kPi, circle::kLeastArc * 180.0 / kPi, t.x.size())});
    one.circles.push_back(tested(log, t, where, radius));
    rows.push_back(where);
    return;
  }
  refuse_other_paths(log, t, motion, where);
  for (const bool counter_clockwise :
       {motion.runs.front().counter_clockwise, !motion.runs.front().counter_clockwise}) {
    Track own = t.empty_copy();
    double revolutions = 0.0;
    std::vector<int> part;
    for (std::size_t r = 0; r < motion.runs.size(); ++r) {
      const circle::CircleRun& run = motion.runs[r];
      if (run.counter_clockwise != counter_clockwise) continue;
      for (std::size_t i = run.first; i < run.last; ++i) own.append(t, i);
      part.resize(own.x.size(), static_cast<int>(r));
      revolutions += run.revolutions;
    }
    own.part = std::move(part);  // between two runs nothing is travelled
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
  circle::CircleMotion motion = motion_of(all, radius);
  one.notes.insert(one.notes.end(), motion.notes.begin(), motion.notes.end());
  if (motion.runs.empty()) return;
  one.test = circle::circular_test(all.samples(), motion);
  double feeds = 0.0;
  for (const circle::CircleRun& run : motion.runs) feeds += run.feed;
  one.feed = feeds / static_cast<double>(motion.runs.size());
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

/// A log, its circles, and its chosen rows.
struct Judged {
  report::CircleLog one;
  Track all;
  std::vector<std::string> rows;
};

/// Rows of a ball-bar against their told direction have two readings: the rows stand in reversed order, which is taken, or the angle is
/// counted the other way. A machine with causes that differ by direction shows which one it is.
void note_other_reading(Judged& j, const io::Log& log, const CircleMap& map, double radius) {
  constexpr double kSeveralTimes = 3.0;
  if (!j.all.ball_bar || !j.all.turned) return;
  const auto bar = ball_bar_columns(log, map);
  if (!bar) return;
  Track other = ball_bar_track(log, *bar, radius, true);
  if (other.turned) return;
  other.feed = j.all.feed;
  const auto own = circle::diagnose({motion_of(j.all, radius)});
  const auto mirrored = circle::diagnose({motion_of(other, radius)});
  if (!own || !mirrored || !(own->rest_rms > kSeveralTimes * mirrored->rest_rms)) return;
  j.one.notes.push_back(fmt::format(
      "read with the angle from +x towards -y, and the rows in their order, the causes leave {:.2g} um in place of {:.2g} um RMS: most likely the "
      "angle is counted that way, and the causes above are wrong (give the angles the other sign in the file)",
      1e6 * mirrored->rest_rms, 1e6 * own->rest_rms));
}

/// The feed that a ball-bar's file states; one that cannot be read is refused only where it is needed.
void take_stated_feed(Track& t, const io::Log& log, bool needed) {
  try {
    if (const auto stated = stated_feed(log)) t.feed = *stated;
  } catch (const io::InputError& e) {
    if (needed) throw;
    const io::Problem& p = e.problems().front();
    t.notes.push_back(fmt::format("the stated {} is not used: {}", io::in_quotes(p.key), p.message));
  }
}

/// The feed of a log without times: of --feed, else as the file states it.
void give_feed(Track& t, const CircleOptions& o, const io::Log& log, std::size_t at) {
  if (t.ball_bar) take_stated_feed(t, log, o.feeds.empty() && t.t.empty());
  if (o.feeds.empty()) return;
  const double feed =
      option_si("--feed", o.feeds[o.feeds.size() == 1 ? 0 : at], quantity("m/s", "mm/min").positive());
  if (!t.t.empty()) {
    t.notes.emplace_back("the feed follows from the times; --feed is not used");
    return;
  }
  if (std::isfinite(t.feed) && std::abs(t.feed - feed) > 1e-6 * feed)
    t.notes.push_back(fmt::format("states a feed of {} mm/min; --feed gives {} mm/min",
                                  report::short_number(t.feed * 6e4), report::short_number(feed * 6e4)));
  t.feed = feed;
}

Judged judged(const CircleOptions& o, const io::Log& log, const CircleMap& map, double radius,
              std::size_t at) {
  const std::vector<std::string> wheres = o.where.empty() ? std::vector<std::string>{""} : o.where;
  Track track = circle_track(log, map, radius, wheres.front());
  give_feed(track, o, log, at);
  Judged j;
  j.one.file = o.logs[at];
  j.one.label = o.labels.empty() ? std::filesystem::path(o.logs[at]).stem().string() : o.labels[at];
  j.one.axes = track.axes;
  j.one.notes = track.notes;
  j.all = track.empty_copy();
  for (const std::string& where : wheres) {
    if (where != wheres.front() && circle_track(log, map, radius, where).axes != track.axes)
      throw io::InputError(
          {log.source, 0, where,
           fmt::format("is a circle in another plane than {} (judge each plane alone)", wheres.front())});
    const Track chosen = chosen_rows(log, track, where);
    add_circles(j.one, log, map, chosen, where, radius, j.rows);
    for (std::size_t i = 0; i < chosen.row.size(); ++i) j.all.append(chosen, i);
  }
  if (o.where.empty()) note_other_reading(j, log, map, radius);
  return j;
}

/// Logs of the two directions, one behind the other, are one measurement of a machine.
void join_directions(std::vector<Judged>& all) {
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    Judged& a = all[i];
    Judged& b = all[i + 1];
    const bool fits = a.one.circles.size() == 1 && b.one.circles.size() == 1 &&
                      a.one.circles[0].counter_clockwise != b.one.circles[0].counter_clockwise &&
                      a.one.axes == b.one.axes && a.all.scale == b.all.scale &&
                      a.all.t.empty() == b.all.t.empty() && a.all.rx.empty() == b.all.rx.empty() &&
                      a.all.ball_bar == b.all.ball_bar && same(a.all.feed, b.all.feed);
    if (!fits) continue;
    a.one.label += " + " + b.one.label;
    a.one.file += " + " + b.one.file;
    a.one.circles.push_back(b.one.circles[0]);
    a.one.notes.insert(a.one.notes.end(), b.one.notes.begin(), b.one.notes.end());
    for (std::size_t k = 0; k < a.one.beside.size(); ++k) {
      if (a.one.beside[k] != b.one.beside[k]) a.one.beside[k] += " + " + b.one.beside[k];
    }
    a.rows.push_back(b.rows[0]);
    // Two files are two motions.
    a.all.part.resize(a.all.row.size(), 0);
    b.all.part.resize(b.all.row.size(), 0);
    const int next = 1 + *std::max_element(a.all.part.begin(), a.all.part.end());
    for (int& part : b.all.part) part += next;
    for (std::size_t k = 0; k < b.all.row.size(); ++k) a.all.append(b.all, k);
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
}

/// All logs are compared with the first.
void check_as_first(const report::CircleLog& one, const report::CircleLog& first) {
  if (one.circles.size() != first.circles.size())
    throw io::InputError({one.file,
                          0,
                          {},
                          fmt::format("has {} circles, one for each direction; {} has {}", one.circles.size(),
                                      first.file, first.circles.size())});
  if (one.axes != first.axes)
    throw io::InputError({one.file,
                          0,
                          {},
                          fmt::format("is a circle of {} and {}; {} is one of {} and {} (judge them apart)",
                                      one.axes[0], one.axes[1], first.file, first.axes[0], first.axes[1])});
  for (std::size_t c = 0; c < one.circles.size(); ++c) {
    if (one.circles[c].counter_clockwise != first.circles[c].counter_clockwise)
      throw io::InputError(
          {one.file,
           0,
           {},
           "turns the other way than " + first.file +
               " (give --together where both are of one machine, first the one, then the other)"});
  }
}

void check_counts(const CircleOptions& o) {
  if (!o.labels.empty() && o.labels.size() != o.logs.size())
    refuse_option("--label",
                  fmt::format("got {}, expected {}, one for each log", o.labels.size(), o.logs.size()));
  if (o.feeds.size() > 1 && o.feeds.size() != o.logs.size())
    refuse_option("--feed", fmt::format("got {}, expected one, or {}, one for each log", o.feeds.size(),
                                        o.logs.size()));
}

constexpr const char* kNoCauses =
    "the causes are not told: that takes a row every 2.5 degrees, and an arc on which they differ";

}  // namespace

io::Log read_circle_log(const std::string& path) {
  io::ReadOptions options;
  options.times_needed = false;
  return io::read_log(path, options);
}

report::CircleReportInput judge_circles(const CircleOptions& o, const std::vector<io::Log>& read) {
  check_counts(o);
  const CircleMap map = circle_map(o.maps);
  report::CircleReportInput input;
  input.limits = limits_of(o.limits);
  const auto beside = beside_columns(o, input);
  std::vector<io::Log> own;
  for (std::size_t i = 0; read.empty() && i < o.logs.size(); ++i) own.push_back(read_circle_log(o.logs[i]));
  const std::vector<io::Log>& logs = read.empty() ? own : read;
  const CircleRadius radius = circle_radius(logs, map, o.size);
  input.radius = radius.value;
  if (!radius.note.empty()) input.warnings.push_back(radius.note);
  input.title = fmt::format("Circle of {} mm", report::short_number(input.radius * 1e3));
  std::vector<Judged> all;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    all.push_back(judged(o, logs[i], map, input.radius, i));
    for (const auto& words : beside) all.back().one.beside.push_back(words[i]);
    // Names from a side file are known to the program and need no note; a gap between two circles is a pause, and one in a circle
    // ends its run, which is noted.
    for (const io::Note& note : logs[i].notes) {
      if (note.about != io::Note::About::kGivenNames && note.about != io::Note::About::kGaps)
        input.warnings.push_back(all.back().one.label + ": " + note.text);
    }
  }
  if (o.together) join_directions(all);
  std::vector<circle::CircleMotion> motions;
  for (Judged& j : all) {
    if (!input.logs.empty()) check_as_first(j.one, input.logs.front());
    std::vector<circle::CircleMotion> own_motions;
    add_test(j.one, j.all, input.radius, own_motions);
    if (!o.together && !own_motions.empty()) {
      j.one.diagnosis = circle::diagnose(own_motions);
      if (!j.one.diagnosis) j.one.notes.emplace_back(kNoCauses);
    }
    motions.insert(motions.end(), std::make_move_iterator(own_motions.begin()),
                   std::make_move_iterator(own_motions.end()));
    for (const std::string& note : j.one.notes) input.warnings.push_back(j.one.label + ": " + note);
    if (input.logs.empty()) input.rows = j.rows;
    input.logs.push_back(std::move(j.one));
  }
  if (o.together && !motions.empty()) {
    input.together = circle::diagnose(motions);
    if (!input.together) input.warnings.emplace_back(kNoCauses);
  }
  return input;
}

}  // namespace stribeck::workflow
