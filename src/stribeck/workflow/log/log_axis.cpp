#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include <stribeck/ident/log/mixed_runs.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/effort.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/log/log_times.hpp>
#include <stribeck/workflow/log/motion_columns.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/log/runs.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

/// Index of the times of position or velocity, which are the times of the axis; −1: rows with a given sample time.
int base_time_of(const AxisColumns& columns, const NamedColumn& base, const LogTimes& times,
                 double sample_time) {
  const io::Log& log = columns.log();
  const int index = times.index_of(*base.column);
  if (index < 0 && sample_time == 0.0) {
    throw io::InputError(
        {log.source, 0, "t",
         fmt::format("no column for the time; the log has {} (name it with --map t=\"COLUMN UNIT\", or "
                     "give the time between rows with --sample-time \"1 ms\")",
                     column_names(log))});
  }
  if (index >= 0 && &log.columns[static_cast<std::size_t>(index)] == base.column)
    refuse_column(log, base, "is the time itself, expected a position");
  return index;
}

/// Converts columns to signals, run by run.
struct Signals {
  const io::Log& log;
  const Selection& selection;
  LogTimes& times;
  const NamedColumn& base;
  int base_time;

  ident::log::Signal of(const io::Column& column, const io::Conversion& conversion, double factor,
                        std::size_t run) const {
    ident::log::Signal s;
    const int index = times.index_of(column);
    // Columns that share the times of the position need no times of their own.
    const bool own = index >= 0 && (&column == base.column || index != base_time);
    if (selection.all) {
      s.y = converted(column, conversion, factor);
      if (own) s.t = times.seconds(index);
      return s;
    }
    if (column.values.size() != log.rows)
      refuse_option("--where",
                    fmt::format("column {} has rows of its own", io::in_quotes(header_of(column))));
    const std::vector<std::size_t>& rows = selection.runs[run];
    s.y = converted(column, conversion, factor, rows);
    if (own) {
      const std::vector<double>& t = times.seconds(index);
      s.t.reserve(rows.size());
      for (const std::size_t row : rows) s.t.push_back(t[row]);
    }
    return s;
  }
};

/// Whether a force, torque or current is named the actual one, which the drive makes, and not its command.
bool is_actual(const io::Column& column) {
  const auto meaning = meaning_of(column.name, column.unit_text);
  return meaning && meaning->rank == 0;
}

ident::log::Signal& signal_for(ident::log::RawLog& raw, LogQuantity what) {
  switch (what) {
    case LogQuantity::kPosition:
      return raw.x;
    case LogQuantity::kReference:
      return raw.r;
    case LogQuantity::kVelocity:
      return raw.v;
    default:
      return raw.v_ref;
  }
}

/// Message for a column that seems to contain two runs that were not declared.
void note_unmarked_runs(const io::Log& log, int base_time, std::vector<std::string>& notes) {
  const std::string marks = marks_of_runs(log, log.columns[static_cast<std::size_t>(base_time)].values);
  if (marks.empty()) return;
  notes.push_back(fmt::format(
      "several runs in one file, distinguished by {}: choose those that belong together with --where COLUMN=VALUE, and separate them with --runs COLUMN",
      marks));
}

/// The voltage of a motor makes no force in proportion: what its turning induces counts against it.
void note_motor_voltage(const Effort& e, std::vector<std::string>& notes) {
  constexpr std::array<std::string_view, 3> kDuty{"pwm", "duty", "tastgrad"};
  constexpr std::array<std::string_view, 4> kOfMotor{"motor", "mot", "armature", "anker"};
  constexpr std::array<std::string_view, 3> kVoltage{"voltage", "spannung",
                                                     "volt"};  // "motor current monitor [V]" is none
  const std::vector<std::string> words = words_of_name(e.from.column->name);
  const bool of_motor =
      e.what == LogQuantity::kVoltage && any_word(words, kOfMotor) && any_word(words, kVoltage);
  if (!any_word(words, kDuty) && !of_motor) return;
  notes.push_back(fmt::format(
      "column {} is the voltage of the motor: the voltage that its turning induces is part of the viscous friction, and a shift of the force "
      "moves that part too, so that the mass may be wrong by several percent: log the current of the motor",
      io::in_quotes(e.from.column->name)));
}

}  // namespace

LoggedAxis logged_axis(const io::Log& log, const LogOptions& options) {
  LoggedAxis out;
  const AxisColumns columns(log, options);
  out.notes = columns.rescaled();
  const MotionColumns motion = find_motion(columns, options, out.notes);
  const Effort effort = find_effort(columns, motion, options, out.notes);
  note_motor_voltage(effort, out.notes);
  const bool lead_used = motion.turns() || effort.by_lead;
  const bool turns_of_motor =
      std::any_of(motion.columns.begin(), motion.columns.end(), [&](const MotionColumn& m) {
        return m.angle && (!motion.of_table || motion.per_radian_of(m.from.unit) != 1.0);
      });
  if (options.lead.empty() && motion.per_radian != 0.0 &&
      (turns_of_motor || (effort.by_lead && !motion.of_table)))
    out.notes.push_back(
        fmt::format("one turn of the motor is {} of travel, from the drive of the machine file",
                    six_digits(options.drive.lead)));
  if (!options.lead.empty() && !options.drive.lead.empty() && options.gain.empty() && !effort.by_lead &&
      effort.unit == "N" && effort.what != LogQuantity::kForce)
    out.notes.push_back(fmt::format(
        "--lead converts the positions; the force keeps the drive of the machine file, whose turn is {} of travel",
        six_digits(options.drive.lead)));
  const bool told = std::any_of(log.metadata.begin(), log.metadata.end(),
                                [](const auto& entry) { return entry.first == kRotaryKey; });
  out.rotary = options.drive.rotary || (told && !motion.angle) || (motion.rotary && lead_used);
  if (out.rotary) out.notes.emplace_back(kRotaryNote);
  if (!options.lead.empty() && !lead_used)
    refuse_option(
        "--lead",
        "no column of this log is an angle and the force is not a torque: the option has no effect, leave it out");

  LogTimes times(columns);
  const double sample_time = options.sample_time.empty() ? 0.0
                                                         : option_si("--sample-time", options.sample_time,
                                                                     quantity("s", "ms").positive());
  const NamedColumn& base = motion.base().from;
  const int base_time = base_time_of(columns, base, times, sample_time);
  const Selection selection = select_rows(log, options);
  if (selection.all && base_time >= 0) note_unmarked_runs(log, base_time, out.notes);

  for (const MotionColumn& m : motion.columns)
    out.columns.emplace_back(enum_name(m.what), header_with_unit(m.from));
  out.columns.emplace_back(enum_name(effort.what), header_with_unit(effort.from));
  const Signals signals{log, selection, times, base, base_time};
  const std::size_t runs = selection.all ? 1 : selection.runs.size();
  for (std::size_t i = 0; i < runs; ++i) {
    ident::log::RawLog raw;
    raw.source = selection.all ? log.source : run_name(log, options, selection.runs[i].front());
    raw.force_unit = effort.unit;
    raw.measured = is_actual(*effort.from.column);
    raw.position_unit = motion.angle ? "rad" : "m";
    raw.rotary = out.rotary;
    raw.sample_time = sample_time;
    for (const MotionColumn& m : motion.columns)
      signal_for(raw, m.what) = signals.of(*m.from.column, m.conversion, m.factor, i);
    raw.f = signals.of(*effort.from.column, effort.conversion, effort.factor, i);
    const auto add = [&](const io::Column* other, double sign) {
      const ident::log::Signal more = signals.of(*other, effort.conversion, sign * effort.factor, i);
      std::transform(raw.f.y.begin(), raw.f.y.end(), more.y.begin(), raw.f.y.begin(), std::plus<>());
    };
    for (const io::Column* other : effort.from.beside) add(other, 1.0);
    for (const io::Column* other : effort.from.against) add(other, -1.0);
    if (!selection.all) {
      raw.row = selection.runs[i];
      for (std::size_t& k : raw.row) ++k;  // counted from 1
    }
    out.runs.push_back(std::move(raw));
  }
  return out;
}

ident::log::Conditioned condition_axis(LoggedAxis axis, const std::string& source,
                                       const LogOptions& options) {
  ident::log::Conditioned clean;
  try {
    clean = ident::log::condition(std::move(axis.runs), ident::log::ConditionOptions{options.keep});
  } catch (const ident::Refused& why) {
    // The log itself is wrong, not the options.
    throw io::InputError(io::Problem{"", 0, "", why.what()});
  }
  if (std::find(options.keep.begin(), options.keep.end(), "mixed-runs") != options.keep.end()) return clean;
  for (ident::log::Finding& f : ident::log::warn_of_mixed_runs(clean.records)) {
    f.text = source + ": " + f.text;
    clean.findings.push_back(std::move(f));
  }
  return clean;
}

ident::log::Conditioned condition_log(const io::Log& log, const LogOptions& options,
                                      std::vector<std::string>* notes) {
  LoggedAxis axis = logged_axis(log, options);
  if (notes != nullptr) notes->insert(notes->end(), axis.notes.begin(), axis.notes.end());
  return condition_axis(std::move(axis), log.source, options);
}

}  // namespace stribeck::workflow
