#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include <stribeck/core/scalar.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/judge/ball_bar.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::array<std::string_view, 7> kAngleWords{"angle", "angular", "winkel", "theta", "phi", "θ", "φ"};
constexpr std::array<std::string_view, 5> kRadiusWords{"radius", "r", "distance", "abstand", "istradius"};
constexpr std::array<std::string_view, 8> kDeviationWords{
    "deviation", "dev", "abweichung", "error", "fehler", "radiusabweichung", "radialabweichung", "dr"};
constexpr std::array<std::string_view, 7> kNominalWords{"nominal", "soll",       "sollradius", "nennradius",
                                                        "target",  "programmed", "commanded"};
constexpr std::array<std::string_view, 4> kDirectionWords{"direction", "dir", "richtung", "drehrichtung"};
constexpr std::array<std::string_view, 4> kFeedWords{"feed", "feedrate", "vorschub", "bahnvorschub"};

constexpr std::array<std::string_view, 11> kBesideWords{"nominal",   "circle",     "test", "ballbar",
                                                        "ball",      "bar",        "soll", "kreis",
                                                        "commanded", "programmed", "rate"};

/// Counter-clockwise, clockwise, or neither.
std::optional<bool> told_direction(const std::vector<std::string>& words) {
  constexpr std::array<std::string_view, 9> kCounter{
      "ccw", "acw", "counterclockwise", "anticlockwise", "counter", "anti", "gegen", "gegenuhrzeigersinn",
      "g3"};
  constexpr std::array<std::string_view, 4> kClock{"cw", "clockwise", "uhrzeigersinn", "g2"};
  if (any_word(words, kCounter)) return true;
  if (any_word(words, kClock)) return false;
  return std::nullopt;
}

enum class Role { kNone, kAngle, kRadius, kDeviation, kNominal, kDirection };

bool is_length(const std::string& unit) {
  if (unit.empty()) return false;
  try {
    static_cast<void>(io::conversion(unit, "m"));
    return true;
  } catch (const io::InputError&) {
    return false;
  }
}

Role role_of(const io::Column& column) {
  const std::vector<std::string> words = words_of_name(column.name);
  if (any_word(words, kDirectionWords)) return Role::kDirection;
  if (any_word(words, kNominalWords)) return any_word(words, kAngleWords) ? Role::kNone : Role::kNominal;
  const bool angle = any_word(words, kAngleWords);
  if (any_word(words, kDeviationWords)) return angle ? Role::kNone : Role::kDeviation;
  if (angle) return Role::kAngle;
  // "ccw [um]" beside an angle.
  const bool bare = std::all_of(words.begin(), words.end(),
                                [](const std::string& word) { return told_direction({word}).has_value(); });
  if (bare && !words.empty() && is_length(column.unit_text)) return Role::kDeviation;
  return any_word(words, kRadiusWords) ? Role::kRadius : Role::kNone;
}

[[noreturn]] void refuse_two(const io::Log& log, const io::Column& one, const io::Column& other,
                             std::string_view what) {
  throw io::InputError(
      {log.source, 0, header_of(other),
       fmt::format(
           "and {} could both be the {} of a ball-bar (choose with --map angle=… and --map radius=… or "
           "--map deviation=…{})",
           io::in_quotes(header_of(one)), what, what == "direction" ? ", and --map direction=…" : "")});
}

std::optional<bool> direction_of(const io::Column& column) {
  return told_direction(words_of_name(column.name));
}

/// Columns of numbers of one role and direction; a column without a direction serves both.
const io::Column* column_for(const io::Log& log, Role role, std::optional<bool> counter_clockwise) {
  const io::Column* found = nullptr;
  for (const io::Column& c : log.columns) {
    if (c.values.empty()) continue;
    if (role_of(c) != role || direction_of(c) != counter_clockwise) continue;
    if (found != nullptr) refuse_two(log, *found, c, role == Role::kAngle ? "angle" : "radius");
    found = &c;
  }
  return found;
}

std::optional<BallBarColumns::Series> series_of(const io::Log& log, std::optional<bool> counter_clockwise) {
  const io::Column* radial = column_for(log, Role::kRadius, counter_clockwise);
  const bool deviation = radial == nullptr;
  if (deviation) radial = column_for(log, Role::kDeviation, counter_clockwise);
  if (radial == nullptr) return std::nullopt;
  const io::Column* angle = column_for(log, Role::kAngle, counter_clockwise);
  if (angle == nullptr) angle = column_for(log, Role::kAngle, std::nullopt);
  if (angle == nullptr) return std::nullopt;
  return BallBarColumns::Series{
      counter_clockwise, {angle, angle->unit_text}, {radial, radial->unit_text}, deviation};
}

/// Columns that tell a direction go before those that do not: a mean of both directions says less.
void add_told_series(const io::Log& log, BallBarColumns& columns) {
  for (const bool counter_clockwise : {true, false}) {
    if (auto one = series_of(log, counter_clockwise)) columns.series.push_back(*one);
  }
  if (columns.series.empty()) {
    if (auto both = series_of(log, std::nullopt)) columns.series.push_back(*both);
    return;
  }
  for (const io::Column& c : log.columns) {
    const Role role = role_of(c);
    if (c.values.empty() || direction_of(c) || (role != Role::kRadius && role != Role::kDeviation)) continue;
    columns.notes.push_back(fmt::format("column {} is left out: other columns tell their direction",
                                        io::in_quotes(header_of(c))));
  }
}

const io::Column* direction_column(const io::Log& log) {
  const io::Column* found = nullptr;
  for (const io::Column& c : log.columns) {
    if (role_of(c) != Role::kDirection) continue;
    if (found != nullptr) refuse_two(log, *found, c, "direction");
    found = &c;
  }
  return found;
}

/// The unit that --map gives goes before that of the file.
void note_new_unit(const NamedColumn& named, std::vector<std::string>& notes) {
  const std::string& own = named.column->unit_text;
  if (own.empty() || named.column->unit_assumed || named.unit == own) return;
  const double times = io::conversion(named.unit, own).factor;
  if (times == 1.0) return;
  notes.push_back(
      fmt::format("column {} has the unit {} in the file; --map gives {} instead, {:.6g} times as much",
                  io::in_quotes(header_of(*named.column)), own, named.unit, times));
}

bool has_position(const io::Log& log, const std::string& axis) {
  try {
    static_cast<void>(position_column(log, axis));
    return true;
  } catch (const io::InputError&) {
    return false;
  }
}

/// A value of the lines above the names; its unit may stand in the key. `option` gives the same and goes before it.
struct Stated {
  std::array<std::string_view, 4> names;
  Quantity quantity;
  std::string_view option;
};

/// Where the number at the beginning of a text ends.
std::size_t end_of_number(const std::string& text) {
  return std::min(text.find_first_not_of("+-.,0123456789eE "), text.size());
}

/// "100,5 mm" above a table of decimal commas. A point there may stand between thousands.
std::string with_decimal_point(const io::Log& log, const std::string& key, std::string text) {
  if (log.decimal_sign != ',') return text;
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(end_of_number(text));
  if (std::find(text.begin(), end, '.') != end)
    throw io::InputError(
        {log.source, 0, key,
         fmt::format("got {}, expected a number without a point: the table has decimal commas, "
                     "and a point may stand between thousands (write 1000 or 1,0)",
                     io::in_quotes(text))});
  std::replace(text.begin(), end, ',', '.');
  return text;
}

std::optional<double> stated_value(const io::Log& log, const Stated& stated) {
  for (const auto& [key, value] : log.metadata) {
    const auto open = key.find_first_of("[(");
    const std::vector<std::string> words = words_of_name(key.substr(0, open));
    // "tool radius" and "feed override" are something else.
    const bool plain = std::all_of(words.begin(), words.end(), [&](const std::string& word) {
      return any_word({word}, stated.names) || any_word({word}, kBesideWords);
    });
    if (!any_word(words, stated.names) || !plain) continue;
    std::string text = value;
    if (open != std::string::npos) {
      const auto close = key.find_first_of("])", open);
      if (close != std::string::npos && end_of_number(text) == text.size())
        text += " " + key.substr(open + 1, close - open - 1);
    }
    // "size: 1441" counts the rows.
    if (std::find(words.begin(), words.end(), "size") != words.end() &&
        !is_length(text.substr(end_of_number(text))))
      continue;
    try {
      return io::to_si(with_decimal_point(log, key, text), stated.quantity);
    } catch (const io::InputError& e) {
      throw io::InputError({log.source, 0, key,
                            fmt::format("{}; {} replaces it", e.problems().front().message, stated.option)});
    }
  }
  return std::nullopt;
}

std::vector<double> angles_of(const io::Log& log, const NamedColumn& angle) {
  io::Column turned = *angle.column;
  turned.unit_text = angle.unit;
  if (turned.unit_text.empty())
    throw io::InputError(
        {log.source, 0, turned.name,
         "has no unit, expected one of an angle (name the column \"angle [deg]\", or give --map "
         "angle=\"angle deg\" --map radius=\"radius mm\")"});
  try {
    return io::in_si(turned, quantity("rad", "deg"));
  } catch (const io::InputError& e) {
    io::Problem p = e.problems().front();
    p.file = log.source;
    throw io::InputError(p);
  }
}

/// A deviation of this share of the radius is no error of a machine, as in ident/circle.
constexpr double kFarthest = 0.2;

/// The distances from the centre [m].
std::vector<double> radii_of(const io::Log& log, const BallBarColumns::Series& s, double radius) {
  std::vector<double> radii = positions(log, s.radial);
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (s.deviation) radii[i] += radius;
    if (std::abs(radii[i] - radius) < kFarthest * radius) continue;
    throw io::InputError(
        {log.source, 0, header_of(*s.radial.column),
         fmt::format("row {}: a radius of {} mm, expected about {} mm{}", i + 1,
                     report::short_number(radii[i] * 1e3), report::short_number(radius * 1e3),
                     s.deviation ? " (--size is the nominal radius)"
                                 : " (--size is the nominal radius; a column of deviations from it is named "
                                   "\"deviation [um]\" or given with --map deviation=…)")});
  }
  return radii;
}

/// Rows of one direction.
struct Piece {
  std::size_t first;
  std::size_t last;
  std::optional<bool> counter_clockwise;

  [[nodiscard]] std::string text() const {
    return fmt::format("rows {} to {} are {}", first + 1, last,
                       *counter_clockwise ? "counter-clockwise" : "clockwise");
  }
};

/// Fewer rows say nothing about the way that an angle turns.
constexpr std::size_t kFewRows = 3;

std::optional<bool> direction_at(const io::Log& log, const io::Column& column, std::size_t row) {
  std::string text;
  if (column.texts.empty()) {
    const double value = column.values[row];
    if (value == 1.0 || value == -1.0) return value > 0.0;
    text = io::number_text(value);
  } else {
    text = column.texts[row];
    if (text == "+" || text == "-") return text == "+";
    if (const auto told = told_direction(words_of_name(text))) return told;
  }
  throw io::InputError(
      {log.source, 0, header_of(column),
       fmt::format("row {}: got {}, expected ccw or cw (or + or -, 1 or -1)", row + 1, io::in_quotes(text))});
}

std::vector<Piece> pieces_of(const io::Log& log, const BallBarColumns& c, const BallBarColumns::Series& s,
                             std::size_t rows) {
  if (c.direction == nullptr) return {{0, rows, s.counter_clockwise}};
  if (std::max(c.direction->values.size(), c.direction->texts.size()) != rows)
    throw io::InputError({log.source, 0, header_of(*c.direction),
                          fmt::format("has another number of rows than {}", header_of(*s.angle.column))});
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < rows; ++i) {
    const auto told = direction_at(log, *c.direction, i);
    if (pieces.empty() || pieces.back().counter_clockwise != told) pieces.push_back({i, i, told});
    pieces.back().last = i + 1;
  }
  if (pieces.size() > 2 && pieces.size() * kFewRows > rows)
    throw io::InputError(
        {log.source, 0, header_of(*c.direction),
         fmt::format("changes {} times in {} rows, expected the rows of one direction behind "
                     "each other (sort the table by direction, then in order of the motion)",
                     pieces.size() - 1, rows)});
  return pieces;
}

/// How far the angle turns over the rows of a piece: its sum with sign, and all ways forth and back [rad].
struct Turn {
  double sum = 0.0;
  double ways = 0.0;
};

constexpr double kOneSense = 0.5;  ///< of all ways: the angle goes one way

Turn turn_of(const Piece& piece, const std::vector<double>& angles) {
  constexpr double kLeastWay = kPi / 180.0;  // below it is the noise of an angle
  Turn turn;
  double from = 0.0;
  for (std::size_t i = piece.first + 1; i < piece.last; ++i) {
    turn.sum += std::remainder(angles[i] - angles[i - 1], 2.0 * kPi);
    const double way = std::abs(turn.sum - from);
    if (way < kLeastWay) continue;
    turn.ways += way;
    from = turn.sum;
  }
  return turn;
}

/// Whether the rows of a piece stand against the direction that is told.
bool is_reversed(const io::Log& log, const BallBarColumns::Series& s, const Piece& piece,
                 const std::vector<double>& angles) {
  if (!piece.counter_clockwise || piece.last - piece.first < kFewRows) return false;
  const Turn turn = turn_of(piece, angles);
  if (turn.ways == 0.0) return false;
  if (std::abs(turn.sum) < kOneSense * turn.ways)
    throw io::InputError(
        {log.source, 0, header_of(*s.angle.column),
         fmt::format("{}, but their angle goes forth and back, {} deg in all and {} deg from the "
                     "first row to the last: expected one way (keep the rows of one way, or leave "
                     "out the direction where the order of the angles tells it)",
                     piece.text(), report::short_number(turn.ways * 180.0 / kPi),
                     report::short_number(std::abs(turn.sum) * 180.0 / kPi))});
  return *piece.counter_clockwise != (turn.sum > 0.0);
}

/// Adds the rows of a piece in the order of the motion.
void add_piece(CircleTrack& t, const Piece& piece, bool reversed, const std::vector<double>& angles,
               const std::vector<double>& radii, double radius) {
  const int part = t.part.empty() ? 0 : t.part.back() + 1;
  for (std::size_t k = piece.first; k < piece.last; ++k) {
    const std::size_t i = reversed ? piece.last - 1 - (k - piece.first) : k;
    t.x.push_back(radii[i] * std::cos(angles[i]));
    t.y.push_back(radii[i] * std::sin(angles[i]));
    t.rx.push_back(radius * std::cos(angles[i]));
    t.ry.push_back(radius * std::sin(angles[i]));
    t.row.push_back(i);
    if (piece.counter_clockwise) t.part.push_back(part);
  }
}

/// The rows of a clockwise test may have been sorted by their angle: a backlash then has the other sign.
void note_untold(bool counter_clockwise, std::vector<std::string>& notes) {
  notes.push_back(fmt::format(
      "the table names no direction, and its angles only increase: taken as measured in that order, {} (if the rows were "
      "sorted by angle, add a column direction with ccw or cw)",
      counter_clockwise ? "counter-clockwise" : "clockwise"));
}

/// One note for all pieces that were reversed.
void note_reversed(const std::vector<Piece>& reversed, std::vector<std::string>& notes) {
  constexpr std::size_t kMostNamed = 3;
  if (reversed.empty()) return;
  std::string text;
  for (std::size_t i = 0; i < std::min(reversed.size(), kMostNamed); ++i)
    text += fmt::format("{}{}, but their angle {}", i == 0 ? "" : "; ", reversed[i].text(),
                        *reversed[i].counter_clockwise ? "falls" : "increases");
  if (reversed.size() > kMostNamed)
    text += fmt::format("; and {} more such parts", reversed.size() - kMostNamed);
  notes.push_back(text + ": taken as the angle from +x towards +y, in reversed order of the rows");
}

}  // namespace

std::optional<BallBarColumns> ball_bar_columns(const io::Log& log, const CircleMap& map) {
  BallBarColumns columns;
  if (const auto angle = map.find("angle"); angle != map.end()) {
    const bool deviation = map.count("deviation") != 0;
    columns.series.push_back({std::nullopt, named_column(log, angle->second),
                              named_column(log, map.at(deviation ? "deviation" : "radius")), deviation});
    note_new_unit(columns.series.back().angle, columns.notes);
    note_new_unit(columns.series.back().radial, columns.notes);
    if (const auto told = map.find("direction"); told != map.end()) columns.direction = &log.at(told->second);
    return columns;
  }
  if (!map.empty()) return std::nullopt;
  const auto is_angle = [](const io::Column& c) { return role_of(c) == Role::kAngle; };
  if (std::none_of(log.columns.begin(), log.columns.end(), is_angle) || has_position(log, "x"))
    return std::nullopt;
  add_told_series(log, columns);
  if (columns.series.empty())
    throw io::InputError(
        {log.source, 0, "columns",
         fmt::format(
             "an angle but no radius: expected \"radius [mm]\" or \"deviation [um]\" of a ball-bar, got {} "
             "(name it with --map angle=… --map radius=…)",
             column_names(log))});
  if (columns.series.size() == 1) columns.direction = direction_column(log);
  return columns;
}

std::optional<double> stated_radius(const io::Log& log) {
  const Stated radius{
      {"radius", "sollradius", "nennradius", "size"}, quantity("m", "mm").positive(), "--size"};
  if (const auto told = stated_value(log, radius)) return told;
  for (const io::Column& c : log.columns) {
    if (c.values.empty() || role_of(c) != Role::kNominal) continue;
    const std::vector<double> all = positions(log, {&c, c.unit_text});
    const auto [least, most] = std::minmax_element(all.begin(), all.end());
    if (*most - *least > 1e-9 || !(*least > 0.0))
      throw io::InputError(
          {log.source, 0, header_of(c),
           fmt::format(
               "is from {} mm to {} mm, expected one radius above 0 for all rows (--size replaces it)",
               report::short_number(*least * 1e3), report::short_number(*most * 1e3))});
    return *least;
  }
  return std::nullopt;
}

std::optional<double> stated_feed(const io::Log& log) {
  return stated_value(log, {kFeedWords, quantity("m/s", "mm/min").positive(), "--feed"});
}

CircleTrack ball_bar_track(const io::Log& log, const BallBarColumns& columns, double radius, bool mirrored) {
  CircleTrack t;
  t.ball_bar = true;
  t.notes = columns.notes;
  std::vector<Piece> reversed;
  for (const BallBarColumns::Series& s : columns.series) {
    std::vector<double> angles = angles_of(log, s.angle);
    if (mirrored) std::transform(angles.begin(), angles.end(), angles.begin(), std::negate<>());
    const std::vector<double> radii = radii_of(log, s, radius);
    if (columns.direction == nullptr && !s.counter_clockwise) {
      const Turn turn = turn_of({0, angles.size(), std::nullopt}, angles);
      const double increase = mirrored ? -turn.sum : turn.sum;
      if (increase > kOneSense * turn.ways) note_untold(!mirrored, t.notes);
    }
    if (angles.size() != radii.size())
      throw io::InputError({log.source, 0, s.angle.column->name,
                            fmt::format("has {} rows, {} has {}: expected columns of one rate", angles.size(),
                                        s.radial.column->name, radii.size())});
    for (const Piece& piece : pieces_of(log, columns, s, angles.size())) {
      const bool turned = is_reversed(log, s, piece, angles);
      if (turned) reversed.push_back(piece);
      add_piece(t, piece, turned, angles, radii, radius);
    }
  }
  note_reversed(reversed, t.notes);
  t.turned = !reversed.empty();
  // Times of rows that stand in another order would be no times of the motion.
  const bool in_order = columns.series.size() == 1 && std::is_sorted(t.row.begin(), t.row.end());
  if (in_order) t.t = circle_times(log, t.x.size());
  return t;
}

}  // namespace stribeck::workflow
