#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/motion_columns.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/log/names/proposed_maps.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

bool is_velocity(LogQuantity what) {
  return what == LogQuantity::kVelocity || what == LogQuantity::kReferenceVelocity;
}

/// What a table turns in one turn of its motor [rad]; absent: the lead is no angle.
std::optional<double> angle_of(const std::string& lead) {
  // An angle is a pure number to the library of units, and so is "5 %".
  constexpr std::array<std::string_view, 6> kAngles{"deg", "rad", "rev", "turn", "gon", "\u00b0"};
  const bool named = std::any_of(kAngles.begin(), kAngles.end(),
                                 [&](std::string_view a) { return lead.find(a) != std::string::npos; });
  if (!named) return std::nullopt;
  try {
    return io::to_si(lead, quantity("rad", "deg"));
  } catch (const io::InputError&) {
    return std::nullopt;
  }
}

/// Whether a unit of angle or rotation is a turn, or turns per second or minute.
bool counts_turns(const std::string& unit) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  auto conversion = conversion_between(unit, "rad");
  if (!conversion) conversion = conversion_between(unit, "rad/s");
  if (!conversion) return false;
  const double turns = conversion->factor / kTurn;
  return std::abs(turns - 1.0) < 1e-9 || std::abs(60.0 * turns - 1.0) < 1e-9;
}

void take_lead(const std::string& given, MotionColumns& motion) {
  if (given.empty()) return;
  const std::string lead = of_one_turn(given);
  const std::optional<double> angle = angle_of(lead);
  motion.rotary = angle.has_value();
  const double travel = angle ? *angle : option_si("--lead", lead, quantity("m", "mm").at_most(100.0));
  if (travel == 0.0) refuse_option("--lead", "got 0, expected the travel per turn");
  motion.per_radian = travel / (2.0 * std::numbers::pi);
}

/// `--map x="CMD mm - ERROR mm"` where a log has the commanded position and the following error in place of the measured one.
std::string with_following_error(const AxisColumns& columns) {
  constexpr std::array<std::string_view, 10> kWords{
      "error",          "following", "lag",       "schleppfehler", "schleppabstand",
      "lageabweichung", "ferr",      "deviation", "poserror",      "ferror"};
  const std::optional<NamedColumn> command = columns.find(LogQuantity::kReference);
  if (!command) return {};
  constexpr std::array<std::string_view, 5> kOfThePath{"contour", "kontur", "radial", "path", "bahn"};
  const std::string wanted = axis_in_name(*command->column);
  std::vector<const io::Column*> errors;
  for (const io::Column& c : columns.log().columns) {
    const std::vector<std::string> words = words_of_name(c.name);
    if (c.values.empty() || !conversion_between(c.unit_text, "m") || !any_word(words, kWords) ||
        any_word(words, kOfThePath))
      continue;
    const bool other = std::any_of(words.begin(), words.end(), [&](const std::string& w) {
      return w.size() == 1 && w != wanted &&
             std::string_view("xyzabcuvw").find(w[0]) != std::string_view::npos;
    });
    if (!other) errors.push_back(&c);
  }
  if (errors.size() != 1) return {};
  return fmt::format("--map x=\"{} {} - {} {}\", or with + where the error is measured less commanded",
                     command->column->name, command->unit, errors.front()->name, errors.front()->unit_text);
}

/// Whether a position that --map names is a commanded one by its name.
void doubt_command(const AxisColumns& columns, const NamedColumn& x, std::vector<std::string>& notes) {
  const auto meaning = meaning_of(x.column->name, x.unit);
  if (x.made || !columns.mapped(LogQuantity::kPosition) || !meaning ||
      meaning->what != LogQuantity::kReference)
    return;
  notes.push_back(fmt::format(
      "column {} is a commanded position by its name: the axis follows it late and with errors, so that mass and friction come out wrong "
      "(map the measured position, or --map x=\"COMMAND UNIT - FOLLOWING ERROR UNIT\")",
      io::in_quotes(header_of(*x.column))));
}

/// Whether a name, in small letters, has the letter of an axis as a word that is not the one wanted: "y table".
bool is_of_another_axis(const std::string& name, const std::string& axis) {
  const std::vector<std::string> words = words_of_name(name);
  return !axis.empty() && std::any_of(words.begin(), words.end(), [&](const std::string& w) {
    return w.size() == 1 && std::string_view("xyzabcuvw").find(w[0]) != std::string_view::npos &&
           w != lower_case(axis);
  });
}

/// The only column with a unit of length, or else of angle, that is neither commanded nor an error by its name; absent: there is none, or
/// more than one.
std::optional<NamedColumn> only_place(const AxisColumns& columns) {
  // Parts of names, also of "FollowingError".
  constexpr std::array<std::string_view, 21> kNoPlace{
      "err",  "diff", "dev",    "abweich", "fehler", "follow", "lag",  "schlepp", "limit", "temp", "spind",
      "traj", "want", "profil", "phase",   "radi",   "window", "diam", "thick",   "offs",  "toler"};
  constexpr std::array<std::string_view, 5> kPerhapsCommanded{"cpos", "posc", "npos", "spos", "tpos"};
  for (const std::string_view unit : {"m", "rad"}) {
    std::vector<NamedColumn> some = columns.with_unit_of({unit});
    std::erase_if(some, [&](const NamedColumn& n) {
      const auto meaning = meaning_of(n.column->name, n.unit);
      const std::string name = lower_case(n.column->name);
      const bool other = std::any_of(kNoPlace.begin(), kNoPlace.end(), [&](std::string_view part) {
        return name.find(part) != std::string::npos;
      });
      return other || any_word(words_of_name(name), kPerhapsCommanded) ||
             is_of_another_axis(name, columns.axis()) ||
             (meaning && meaning->what == LogQuantity::kReference);
    });
    if (some.size() == 1) return some.front();
    if (!some.empty()) return std::nullopt;
  }
  return std::nullopt;
}

/// The columns that exist, in the order in which they are shown.
std::vector<MotionColumn> motion_of(const AxisColumns& columns, std::vector<std::string>& notes) {
  std::optional<NamedColumn> x = columns.find(LogQuantity::kPosition);
  const std::optional<NamedColumn> v = columns.find(LogQuantity::kVelocity);
  // Of two encoders the one on the motor, where the force acts.
  for (const LogQuantity encoder : {LogQuantity::kMotor, LogQuantity::kScale}) {
    if (x || v) break;
    x = columns.find(encoder);
    if (x)
      notes.push_back(fmt::format("the position is that of column {}", io::in_quotes(header_of(*x->column))));
  }
  if (!x && !v) {
    if (const std::string others = columns.of_other_axes(LogQuantity::kPosition); !others.empty()) {
      throw io::InputError(
          {columns.log().source, 0, "x",
           fmt::format("no column for the position of this axis by its name; {} (say which one "
                       "it is with --map x=\"COLUMN UNIT\")",
                       others)});
    }
    x = only_place(columns);
    if (x)
      notes.push_back(fmt::format(
          "column {} is taken as the position: no other has a unit of length or angle (another: --map x=\"COLUMN UNIT\")",
          io::in_quotes(header_of(*x->column))));
  }
  if (!x && !v) {
    std::string all = with_following_error(columns);
    if (all.empty()) all = proposed_maps(columns.log(), columns.axis());
    throw io::InputError({columns.log().source, 0, "x",
                          fmt::format("no column for the position, nor for the velocity; the log has {} ({})",
                                      column_names(columns.log()),
                                      all.empty() ? "name it with --map x=\"COLUMN UNIT\""
                                                  : "perhaps, with your units: " + all)});
  }
  if (x) doubt_command(columns, *x, notes);
  const std::optional<NamedColumn> r = columns.find(LogQuantity::kReference);
  std::vector<MotionColumn> all;
  if (x) all.push_back({LogQuantity::kPosition, *x});
  if (r) all.push_back({LogQuantity::kReference, *r});
  if (v) all.push_back({LogQuantity::kVelocity, *v});
  if (r) return all;
  if (const auto v_ref = columns.find(LogQuantity::kReferenceVelocity))
    all.push_back({LogQuantity::kReferenceVelocity, *v_ref});
  return all;
}

/// Units that say too little, with the way out.
void refuse_vague_unit(const io::Log& log, const MotionColumn& m, bool velocity) {
  const std::string& unit = m.from.unit;
  const std::string name(enum_name(m.what));
  const std::string& column = m.from.column->name;
  if (is_count(unit))
    refuse_column(log, m.from,
                  velocity
                      ? fmt::format("is in counts; say what they are, with the size of one, e.g. --map "
                                    "{}=\"{} 0.001 mm/s\"",
                                    name, column)
                      : fmt::format("is in increments; say how long one is: --map {}=\"{} 0.001 mm\", where "
                                    "0.001 mm is one count",
                                    name, column));
  if (velocity && conversion_between(unit, "Hz"))
    refuse_column(
        log, m.from,
        fmt::format("has the unit {}, which may be turns or radians; say which: --map {}=\"{} rpm\", "
                    "\"{} rev/s\" or \"{} rad/s\"",
                    unit, name, column, column, column));
}

/// Sets conversion and angle by the unit.
void convert(const io::Log& log, MotionColumn& m) {
  const bool velocity = is_velocity(m.what);
  if (velocity && is_per_minute(m.from.unit)) m.from.unit = kTurnsPerMinute;
  refuse_vague_unit(log, m, velocity);
  const std::string& unit = m.from.unit;
  const auto linear = conversion_between(unit, velocity ? "m/s" : "m");
  const auto turning = conversion_between(unit, velocity ? "rad/s" : "rad");
  if (!linear && !turning) {
    check_unit(log, *m.from.column, unit, m.what, velocity ? quantity("m/s", "mm/s") : quantity("m", "mm"));
    refuse_column(
        log, m.from,
        fmt::format("{} is not a unit of a {}", io::in_quotes(unit), velocity ? "velocity" : "position"));
  }
  m.angle = !linear;
  m.conversion = linear ? *linear : *turning;
}

/// Refuses a length as the position of an axis that turns, but for a log that says itself that its lengths are arcs.
void refuse_length_of_table(const io::Log& log, const MotionColumn& m, const LogOptions& options) {
  const bool told = std::any_of(log.metadata.begin(), log.metadata.end(),
                                [](const auto& entry) { return entry.first == kRotaryKey; });
  if (!options.drive.rotary || m.angle || told) return;
  refuse_column(
      log, m.from,
      fmt::format(
          "is a length ({}), and {} turns: expected an angle (give the log of this axis, or say of which axis this log "
          "is with --axis; lengths that are arcs at a radius of 1 m need the line \"# {}: arcs\" at the head of the log)",
          m.from.unit, options.axis.empty() ? "this axis" : "axis " + options.axis, kRotaryKey));
}

/// Refuses columns that disagree on whether the axis is an angle.
void check_agreement(const io::Log& log, const MotionColumn& m, const MotionColumns& motion) {
  if (m.angle && motion.per_radian == 0.0 && !motion.angle) {
    refuse_column(log, m.from,
                  fmt::format("turns ({}), the position does not; give the travel per turn (--lead \"5 mm\")",
                              m.from.unit));
  }
  if (!m.angle && motion.angle) {
    refuse_column(
        log, m.from,
        fmt::format("is a length ({}), the position is an angle; give the travel per turn (--lead \"5 mm\")",
                    m.from.unit));
  }
}

bool is_base(const MotionColumn& m, const std::vector<MotionColumn>& all) {
  if (m.what == LogQuantity::kPosition) return true;
  return m.what == LogQuantity::kVelocity &&
         std::none_of(all.begin(), all.end(),
                      [](const MotionColumn& other) { return other.what == LogQuantity::kPosition; });
}

}  // namespace

double MotionColumns::per_radian_of(const std::string& unit) const {
  return of_table && !counts_turns(unit) ? 1.0 : per_radian;
}

const MotionColumn& MotionColumns::base() const {
  return *std::find_if(columns.begin(), columns.end(),
                       [&](const MotionColumn& m) { return is_base(m, columns); });
}

bool MotionColumns::turns() const {
  return std::any_of(columns.begin(), columns.end(), [](const MotionColumn& m) { return m.angle; });
}

MotionColumns find_motion(const AxisColumns& columns, const LogOptions& options,
                          std::vector<std::string>& notes) {
  const io::Log& log = columns.log();
  MotionColumns motion;
  take_lead(options.lead.empty() ? options.drive.lead : options.lead, motion);
  motion.of_table = options.drive.rotary;
  const std::vector<MotionColumn> all = motion_of(columns, notes);
  for (MotionColumn m : all) {
    const bool base = is_base(m, all);
    if (is_count(m.from.unit) && !is_velocity(m.what) && !options.drive.count.empty()) {
      if (base)
        notes.push_back(fmt::format(
            "a count of column {} is {}, as encoder_counts and the transmission of the machine file say (another length: --map {}=\"{} "
            "0.001 mm\", with yours)",
            io::in_quotes(header_of(*m.from.column)), six_digits(options.drive.count), enum_name(m.what),
            m.from.column->name));
      m.from.unit = options.drive.count;
    }
    const bool counts = is_count(m.from.unit);
    const bool share = m.from.unit == "%";
    if ((m.from.unit.empty() || counts || share) && !base && !columns.mapped(m.what)) {
      notes.push_back(fmt::format("column {} {} (give it with --map {}=\"COLUMN UNIT\")",
                                  io::in_quotes(header_of(*m.from.column)),
                                  counts  ? "is in counts and is not used"
                                  : share ? "is a share of a rated value and is not used"
                                          : "has no unit and is not used",
                                  enum_name(m.what)));
      continue;
    }
    convert(log, m);
    if (base) refuse_length_of_table(log, m, options);
    if (base) motion.angle = m.angle && motion.per_radian == 0.0;
    check_agreement(log, m, motion);
    if (m.angle && !motion.angle) m.factor = motion.per_radian_of(m.from.unit);
    motion.columns.push_back(m);
  }
  return motion;
}

}  // namespace stribeck::workflow
