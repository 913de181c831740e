#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/effort.hpp>
#include <stribeck/workflow/log/motors.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

/// Units of a share of the rated torque; CiA 402 has per mille.
constexpr std::array<std::string_view, 7> kShares{"%",        "pct",       "percent", "\u2030",
                                                  "permille", "per mille", "promille"};

/// Without the factor of "0.1 %".
std::string_view without_factor(std::string_view unit) {
  const auto word = unit.find_first_not_of("0123456789.+- ");
  return unit.substr(word == std::string_view::npos ? 0 : word);
}

bool is_share(const std::string& unit) {
  return std::find(kShares.begin(), kShares.end(), without_factor(unit)) != kShares.end();
}

}  // namespace

LogQuantity kind_by_unit(const std::string& unit, LogQuantity by_name) {
  for (const LogQuantity what : kForces) {
    const bool fits = what == LogQuantity::kPercent
                          ? is_share(unit)
                          : conversion_between(unit, known_column(what).quantity.unit).has_value();
    if (fits) return what;
  }
  return by_name;
}

namespace {

/// Values with a unit of a force that are none: an override, the load of the motor over minutes, the supply of the drive.
bool is_of_supply(const std::string& name) {
  constexpr std::array<std::string_view, 11> kWords{
      "override", "utilization", "utilisation", "auslastung",    "i2t",   "i\u00B2t",
      "bus",      "temperature", "temperatur",  "zwischenkreis", "supply"};
  constexpr std::array<std::string_view, 1> kDirect{"dc"}, kLink{"link"};
  const std::vector<std::string> words = words_of_name(name);
  return any_word(words, kWords) || (any_word(words, kDirect) && any_word(words, kLink));
}

/// How to name the force: where several columns have one unit for it, with their names, added or one of them.
std::string how_to_name(const std::vector<NamedColumn>& some) {
  const auto alike = [&](const NamedColumn& n) { return n.unit == some.front().unit; };
  if (some.size() < 2 || !std::all_of(some.begin(), some.end(), alike))
    return "name it with --map force=\"COLUMN UNIT\", or torque, current, voltage, percent, pressure";
  const std::string_view what = enum_name(kind_by_unit(some.front().unit, LogQuantity::kForce));
  std::string sum;
  for (const NamedColumn& n : some) sum += (sum.empty() ? "" : " + ") + header_of(*n.column);
  return fmt::format(
      "{} columns have the unit {}: name that of this axis, --map {}=\"{} {}\", or of motors that drive it together "
      "--map {}=\"{} {}\"",
      some.size(), some.front().unit, what, header_of(*some.front().column), some.front().unit, what, sum,
      some.front().unit);
}

/// All columns that could be the force, and messages on columns that could not be distinguished.
struct Candidates {
  std::vector<Effort> efforts;
  std::optional<io::InputError> ambiguous;
};

/// The first column of kForces, with what stands before it without a unit; all of them where a gain, a lead or a drive decides.
Candidates find_candidates(const AxisColumns& columns, bool with_gain, bool all,
                           std::vector<std::string>& notes) {
  Candidates found;
  for (const bool by_map : {true, false}) {
    for (const LogQuantity what : kForces) {
      std::optional<NamedColumn> named = columns.mapped(what);
      if (by_map != named.has_value()) continue;
      try {
        if (!by_map) named = columns.find(what);
      } catch (const io::InputError& e) {
        // Another quantity may be the force: with a gain any, without one what was found before.
        if (!with_gain && found.efforts.empty()) throw;
        if (!found.ambiguous) found.ambiguous = e;
      }
      if (!named) continue;
      if (const std::string defined = unit_of_object(header_of(*named->column));
          named->unit.empty() && !defined.empty()) {
        named->unit = defined;
        notes.push_back(fmt::format(
            "column {} has no unit; taken as per mille of the rated value, which CiA 402 defines for this object",
            io::in_quotes(header_of(*named->column))));
      }
      Effort e;
      e.what = by_map || named->unit.empty() ? what : kind_by_unit(named->unit, what);
      // --map torque="ActTorque ‰": per mille of the rated torque.
      if (by_map && what == LogQuantity::kTorque && is_share(named->unit)) e.what = LogQuantity::kPercent;
      e.from = std::move(*named);
      found.efforts.push_back(std::move(e));
      if (!all && (by_map || !found.efforts.back().from.unit.empty())) break;
    }
    if (!found.efforts.empty()) break;
  }
  if (!found.efforts.empty()) return found;
  if (found.ambiguous) throw *found.ambiguous;
  std::vector<NamedColumn> some;
  for (const bool doubtful : {false, true}) {
    if (some.empty()) some = columns.with_unit_of({"N", "N m", "A", "V", "%"}, doubtful);
    std::erase_if(some, [&](const NamedColumn& n) {
      constexpr std::array<std::string_view, 6> kOther{"temp", "state", "status", "flag", "mode", "phase"};
      return is_of_supply(header_of(*n.column)) ||
             (doubtful && any_word(words_of_name(n.column->name), kOther));
    });
  }
  if (some.size() == 1) {
    Effort e;
    e.from = some.front();
    e.what = kind_by_unit(e.from.unit, LogQuantity::kForce);
    notes.push_back(fmt::format(
        "column {} is taken as the force: no other has a unit of force, torque, current, voltage or "
        "a share of them",
        io::in_quotes(header_of(*e.from.column))));
    found.efforts.push_back(std::move(e));
    return found;
  }
  throw io::InputError(
      {columns.log().source, 0, "force",
       fmt::format(
           "no column for the force, nor for torque, current, voltage or percent; the log has {} ({})",
           column_names(columns.log()), how_to_name(some))});
}

/// A force, or a torque that the lead converts to a force.
void scale(Effort& e, double factor, bool is_torque, double per_radian) {
  e.factor = factor;
  e.unit = "N";
  if (!is_torque) return;
  if (per_radian != 0.0) {
    e.factor /= per_radian;
    e.by_lead = true;
  } else {
    e.unit = "N m";
  }
}

/// Whether the gain belongs to this effort; it is then applied.
bool apply_gain(Effort& e, const std::string& gain, const MotionColumns& motion) {
  const std::string per =
      e.what == LogQuantity::kPercent ? "" : "/(" + std::string(known_column(e.what).quantity.unit) + ")";
  struct Target {
    std::string unit;
    bool torque;
  };
  for (const Target& t :
       {Target{e.what == LogQuantity::kTorque ? "1/m" : "N" + per, false}, Target{"N m" + per, true}}) {
    double factor = 0.0;
    try {
      factor = io::to_si(gain, Quantity{t.unit, t.unit});
    } catch (const io::InputError&) {
      continue;
    }
    if (factor == 0.0) refuse_option("--gain", "got 0, expected the force per unit of the column");
    scale(e, factor, t.torque, motion.per_radian);
    if (e.unit != "N" && !motion.angle)
      refuse_option("--gain", fmt::format("got {}, a torque; give the travel per turn too (--lead \"5 mm\")",
                                          io::in_quotes(gain)));
    return true;
  }
  return false;
}

[[noreturn]] void refuse_gain(const Candidates& found, const std::string& gain) {
  if (found.ambiguous) throw *found.ambiguous;
  const Effort& first = found.efforts.front();
  const bool pressure = conversion_between(first.from.unit, "Pa").has_value();
  if (found.efforts.size() == 1 && first.what == LogQuantity::kForce && pressure) {
    refuse_option("--gain",
                  fmt::format("got {}, but column {} is a pressure and no force (--map pressure=\"{} {}\")",
                              io::in_quotes(gain), io::in_quotes(header_of(*first.from.column)),
                              first.from.column->name, first.from.unit));
  }
  if (found.efforts.size() == 1 && first.what == LogQuantity::kForce) {
    refuse_option(
        "--gain",
        fmt::format(
            "got {}, but the force of this log, column {}, has a scale already: leave the gain out, or map the column that it belongs to (--map voltage=\"COLUMN V\")",
            io::in_quotes(gain), io::in_quotes(header_of(*first.from.column))));
  }
  std::string kinds;
  for (const Effort& e : found.efforts) kinds += (kinds.empty() ? "" : ", ") + std::string(enum_name(e.what));
  const auto unit_like = [](LogQuantity what) {
    switch (what) {
      case LogQuantity::kVoltage:
        return "N/V";
      case LogQuantity::kCurrent:
        return "N/A";
      case LogQuantity::kPercent:
        return "N or N m (at 100 %), N/%";
      case LogQuantity::kTorque:
        return "1/mm, or N m/(N m) where the position is an angle,";
      case LogQuantity::kPressure:
        return "N/bar";
      default:
        return "N/V, N/A";
    }
  };
  refuse_option(
      "--gain",
      fmt::format("got {}, expected a number{} with a unit like {} for the {} of this log",
                  io::in_quotes(gain), gain.find(',') == std::string::npos ? "" : " with a decimal point",
                  unit_like(first.what), kinds));
}

Effort with_gain(Candidates found, const std::string& gain, const MotionColumns& motion) {
  for (Effort& e : found.efforts) {
    if (e.what == LogQuantity::kForce) continue;  // its scale is known
    if (apply_gain(e, gain, motion)) return e;
  }
  refuse_gain(found, gain);
}

/// Whether all values are whole numbers, and more than a few.
bool are_whole(const io::Column& column) {
  constexpr double kFew = 20.0;
  double most = 0.0;
  for (const double value : column.values) {
    if (std::isfinite(value) && value != std::round(value)) return false;
    if (std::isfinite(value)) most = std::max(most, std::abs(value));
  }
  return most > kFew;
}

/// Notes the unit of an effort whose scale is not known.
void keep_own_unit(Effort& e, std::vector<std::string>& notes) {
  const std::string& unit = e.from.unit;
  const auto known = [&](const char* si) { return unit.empty() ? std::string("units") : std::string(si); };
  const char* gain_unit = "1/mm";
  switch (e.what) {
    case LogQuantity::kCurrent:
      e.unit = known("A");
      gain_unit = "N/A";
      break;
    case LogQuantity::kVoltage:
      e.unit = known("V");
      gain_unit = "N/V";
      break;
    case LogQuantity::kPercent:
      e.unit = "%";
      gain_unit = "N";
      break;
    case LogQuantity::kPressure:
      e.unit = known("Pa");
      gain_unit = "N/bar";
      break;
    default:
      e.unit = known("N m");
  }
  if (unit.empty() && e.what != LogQuantity::kPercent) {
    notes.push_back(fmt::format(
        "the scale of the force is not known: {0} has no unit and is identified as it is (say what it is, with "
        "--map torque=\"{1} N m\", current=\"{1} A\", percent=\"{1} %\" or percent=\"{1} ‰\"{2}, and give --gain, or a machine file "
        "with the drive)",
        io::in_quotes(header_of(*e.from.column)), e.from.column->name,
        are_whole(*e.from.column) ? " (whole numbers, as here, are mostly per mille of the rated torque)"
                                  : ""));
    return;
  }
  notes.push_back(
      fmt::format("the scale of the force is not known: {} is identified in its own unit, {} (with "
                  "--gain \"1048 {}\" it becomes newton)",
                  io::in_quotes(header_of(*e.from.column)), e.unit, gain_unit));
}

/// The force per unit of this column that the machine file says; empty: it does not. For a torque, --lead overrides the lead of the drive.
std::string gain_of(const LogOptions& options, const Effort& e) {
  const DriveScale& drive = options.drive;
  if (e.from.unit.empty()) return {};
  switch (e.what) {
    case LogQuantity::kTorque:
      return options.lead.empty() ? drive.per_newton_metre : std::string();
    case LogQuantity::kVoltage:
      return drive.per_volt;
    case LogQuantity::kPercent:
      return drive.at_100_percent;
    case LogQuantity::kCurrent:
      return drive.per_ampere;
    default:
      return {};
  }
}

/// Whether the drive of the machine file gives the scale; it is then applied.
bool apply_drive(Effort& e, const AxisColumns& columns, const LogOptions& options,
                 const MotionColumns& motion, std::vector<std::string>& notes) {
  const std::string gain = gain_of(options, e);
  if (gain.empty() || !apply_gain(e, gain, motion)) return false;
  if (e.what != LogQuantity::kVoltage) take_all_motors(e, columns, options.drive.motors, notes);
  if (e.what != LogQuantity::kVoltage) {
    // Of an axis that turns, the torque of the motor times a pure number.
    std::string scale = six_digits(gain);
    const bool ratio = e.what == LogQuantity::kTorque && options.drive.rotary;
    if (ratio) scale = "a ratio of " + scale.substr(0, scale.find(' '));
    // "8 N", "8 N/A" of an axis that is carried at a radius of 1 m.
    if (const auto newton = scale.find(" N"); options.drive.rotary && newton != std::string::npos)
      scale.insert(newton + 2, " m");
    // The scale is that of all motors together.
    const bool several = !e.from.beside.empty() || !e.from.against.empty();
    const char* of_several = options.drive.motors > 1 ? "the mean of columns " : "the sum of columns ";
    std::string from = (several ? of_several : "column ") + io::in_quotes(header_of(*e.from.column));
    for (const io::Column* other : e.from.beside) from += ", " + io::in_quotes(header_of(*other));
    for (const io::Column* other : e.from.against) from += ", less " + io::in_quotes(header_of(*other));
    notes.push_back(fmt::format("the {} is that of {} with {}{}, from the drive of the machine file",
                                options.drive.rotary ? "torque" : "force", from, scale,
                                e.what == LogQuantity::kPercent ? " at 100 %" : ""));
    if (e.what == LogQuantity::kCurrent && !options.drive.ampere_doubt.empty())
      notes.push_back("the scale of the current is doubtful: " + options.drive.ampere_doubt);
  }
  return true;
}

/// Without a gain: the first column whose scale is known, else the first one that has a unit, else the first one.
Effort first_scaled(const Candidates& found, const LogOptions& options, const MotionColumns& motion) {
  const auto scaled = [&](const Effort& e) {
    if (e.what == LogQuantity::kForce) return true;
    const bool by_lead = e.what == LogQuantity::kTorque && !e.from.unit.empty() && motion.per_radian != 0.0;
    return by_lead || !gain_of(options, e).empty();
  };
  auto at = std::find_if(found.efforts.begin(), found.efforts.end(), scaled);
  if (at == found.efforts.end())
    at = std::find_if(found.efforts.begin(), found.efforts.end(),
                      [](const Effort& e) { return !e.from.unit.empty(); });
  return at == found.efforts.end() ? found.efforts.front() : *at;
}

/// Whether the machine file says anything of the drive.
bool knows_drive(const DriveScale& drive) {
  return !drive.per_volt.empty() || !drive.at_100_percent.empty() || !drive.per_ampere.empty() ||
         !drive.lead.empty();
}

void set_conversion(Effort& e, const io::Log& log) {
  const Quantity q = known_column(e.what).quantity;
  const std::string& unit = e.from.unit;
  if (is_count(unit)) {
    const std::string& name = e.from.column->name;
    refuse_column(
        log, e.from,
        fmt::format("is in counts; say what they are, with the size of one, e.g. --map percent=\"{0} 0.1 %\" "
                    "or --map force=\"{0} 0.25 N\"",
                    name));
  }
  if (e.unit == "units" || (e.unit == "%" && unit.empty())) return;
  if (const auto c = conversion_between(unit, q.unit)) {
    e.conversion = *c;
    if (e.unit == "%") e.factor = 100.0;
  } else {
    check_unit(log, *e.from.column, unit, e.what, q);
  }
}

}  // namespace

Effort find_effort(const AxisColumns& columns, const MotionColumns& motion, const LogOptions& options,
                   std::vector<std::string>& notes) {
  const std::string& gain = options.gain;
  const bool decides = !gain.empty() || motion.per_radian != 0.0 || knows_drive(options.drive);
  Candidates found = find_candidates(columns, !gain.empty(), decides, notes);
  Effort effort =
      gain.empty() ? first_scaled(found, options, motion) : with_gain(std::move(found), gain, motion);
  const bool by_drive = gain.empty() && effort.what != LogQuantity::kForce && !is_count(effort.from.unit) &&
                        apply_drive(effort, columns, options, motion, notes);
  if (by_drive) {
    set_conversion(effort, columns.log());
    return effort;
  }
  note_second_motor(effort, columns, options.drive.motors, notes);
  if (gain.empty() && effort.what == LogQuantity::kTorque && !effort.from.unit.empty()) {
    scale(effort, 1.0, true, motion.per_radian);
    if (effort.unit != "N") {
      notes.emplace_back(
          motion.angle
              ? "the force is a torque in N m about an angle in rad"
              : "the force is given as a torque and is identified in N m; with --lead \"5 mm\" it becomes N");
    }
  } else if (gain.empty() && effort.what != LogQuantity::kForce) {
    keep_own_unit(effort, notes);
  }
  set_conversion(effort, columns.log());
  return effort;
}

}  // namespace stribeck::workflow
