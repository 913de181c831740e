// The steps from logged signals to records. Each step has its own file, see condition_parts.hpp.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log {

using namespace parts;

namespace {

/// Beyond this, squares and sums would overflow.
void refuse_absurd(const RawLog& log) {
  const auto look = [&](const std::vector<double>& y, const char* name) {
    for (std::size_t k = 0; k < y.size(); ++k) {
      if (!(std::abs(y[k]) >= kAbsurd)) continue;  // NaN is reported with its column
      throw Refused(
          log.source +
          fmt::format(": row {}: the {} is {:g}, which no machine logs; repair or cut the log, or check "
                      "the unit of the column",
                      k < log.row.size() ? log.row[k] : k + 1, name, y[k]));
    }
  };
  for (const auto& [signal, name] : {std::pair{&log.x, "position"},
                                     {&log.r, "reference"},
                                     {&log.v, "velocity"},
                                     {&log.v_ref, "reference of the velocity"},
                                     {&log.f, "force"}}) {
    look(signal->t, "time");
    look(signal->y, name);
  }
}

/// Limits for a column whose unit differs from its header: an error of some powers of ten stays within them.
void refuse_implausible(const std::vector<Table>& tables, const std::string& source, bool position,
                        const std::string& force_unit, const std::string& position_unit) {
  constexpr double kLeastStep = 1e-9, kMostStep = 1e5;       // [s]
  constexpr double kLeastTravel = 1e-12, kMostTravel = 1e7;  // [m] or [rad], of velocities per second
  constexpr double kLeastForce = 1e-12, kMostForce = 1e12;
  const auto range_of = [&](std::vector<double> Table::*column) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Table& m : tables) {
      const auto [a, b] = std::minmax_element((m.*column).begin(), (m.*column).end());
      if (a == (m.*column).end()) continue;
      low = std::min(low, *a), high = std::max(high, *b);
    }
    return high - low;
  };
  const auto check = [&](double value, double least, double most, const char* what, const std::string& unit) {
    if (value >= least && value <= most) return;
    throw Refused(
        source +
        fmt::format(
            ": {} {:.3g} {}, which no machine has (expected {:g} to {:g}); the unit of the column is wrong",
            what, value, unit, least, most));
  };
  for (const Table& m : tables) check(m.sample_time, kLeastStep, kMostStep, "the time between rows is", "s");
  check(range_of(position ? &Table::x : &Table::v), kLeastTravel, kMostTravel,
        position ? "the position ranges over" : "the velocity ranges over",
        position ? position_unit : position_unit + "/s");
  check(range_of(&Table::f), kLeastForce, kMostForce, "the force ranges over", force_unit);
}

/// Refuses logs of one axis whose quantities or units differ.
void refuse_differing_runs(const std::vector<RawLog>& runs) {
  const RawLog& first = runs.front();
  for (const RawLog& log : runs) {
    refuse_absurd(log);
    if (log.position_unit != first.position_unit || log.force_unit != first.force_unit ||
        log.x.empty() != first.x.empty()) {
      throw Refused(log.source + ": other quantities or units than " + first.source +
                    "; runs of one axis need the same");
    }
  }
}

std::vector<Table> tables_of(std::vector<RawLog>& runs, Sampling& sampling, Notes& notes) {
  std::vector<Table> tables;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::vector<Table> pieces = regular_pieces(one_table(runs[i], i, notes), sampling, notes);
    std::move(pieces.begin(), pieces.end(), std::back_inserter(tables));
  }
  return tables;
}

/// Leaves out columns that not every table has; a velocity stays where it replaces the position.
void drop_partial_columns(std::vector<Table>& tables, bool position) {
  for (const auto column : {&Table::r, &Table::v}) {
    const bool everywhere =
        std::all_of(tables.begin(), tables.end(), [&](const Table& m) { return !(m.*column).empty(); });
    if (!everywhere && (column != &Table::v || position)) {
      for (Table& m : tables) (m.*column).clear();
    }
  }
}

/// Leaves out a channel that never changes; refuses the log where the channel is needed.
void refuse_constant(const std::vector<Table>& tables, const std::string& source, bool position) {
  if (constant(tables, &Table::f))
    throw Refused(source +
                  fmt::format(": the force keeps the value {:.6g} in every row: the channel is stuck or not "
                              "recorded (choose another one with --map)",
                              tables.front().f.front()));
  if (constant(tables, position ? &Table::x : &Table::v))
    throw Refused(
        source +
        fmt::format(": the {} keeps the value {:.6g} in every row: the axis did not move or the channel "
                    "is stuck (choose another one with --map)",
                    position ? "position" : "velocity", tables.front().motion().front()));
}

/// Brings the tables to the grid of the slowest channel and cuts out the rows that a frozen logger wrote.
std::vector<Table> without_repeats(std::vector<Table> tables, const std::string& source, bool position,
                                   Sampling& s, Notes& notes) {
  s.x_hold = position ? hold_of(tables, &Table::x) : 1.0;
  s.v_hold = tables.front().v.empty() ? 1.0 : hold_of(tables, &Table::v);
  s.f_hold = hold_of(tables, &Table::f);
  tables = without_frozen(std::move(tables), std::max({s.x_hold, s.v_hold, s.f_hold}), notes);
  tables = on_slow_grid(std::move(tables), s, notes);
  if (position && s.v_hold > 1.5 * std::max(s.x_hold, s.f_hold)) {
    for (Table& m : tables) m.v.clear();
    notes.add_all(
        "held", source, true,
        fmt::format("the velocity is new only every {:.4g} rows, slower than the position; not used",
                    s.v_hold),
        {s.v_hold});
  }
  return tables;
}

/// Leaves out pieces that are too short. Only the first of them is noted; `noted` tells whether that has happened.
std::vector<Table> long_enough(std::vector<Table> tables, const std::string& source, bool& noted,
                               Notes& notes) {
  std::vector<Table> out;
  for (Table& m : tables) {
    if (m.rows() >= kFewestRows) {
      out.push_back(std::move(m));
      continue;
    }
    if (!noted && m.rows() > 0)
      notes.add_range("short", m, 0, m.rows() - 1, true,
                      fmt::format("a piece of {} rows, fewer than {}; left out", m.rows(), kFewestRows),
                      {static_cast<double>(m.rows())});
    noted = true;
  }
  if (out.empty()) {
    throw Refused(
        source +
        fmt::format(": no stretch of {} rows is left that can be used (see the findings of --inspect)",
                    kFewestRows));
  }
  return out;
}

/// Repairs single samples, then channels, because a spike looks like a jump, and a jump makes a velocity look
/// wrong.
std::vector<Table> without_faults(std::vector<Table> tables, bool position, const Sampling& s, Notes& notes) {
  mend_spikes(tables, std::max(s.x_quantum_large, 3.0 * s.x_noise), &Table::x, "position", notes);
  if (position) mend_spikes(tables, s.v_quantum, &Table::v, "velocity", notes);
  mend_spikes(tables, s.f_quantum, &Table::f, "force", notes);
  if (position) mend_force_spikes(tables, notes);
  if (position) {
    mend_lost_rows(tables, s, notes);
    tables = cut_at_jumps(std::move(tables), s, notes);
    check_velocity(tables, s, notes);
  }
  check_reference(tables, notes);
  tables = cut_stuck_force(std::move(tables), s.f_hold, notes);
  cut_drive_off(tables, notes);
  cut_moved_without_drive(tables, notes);
  return tables;
}

bool starts_with(const std::string& sentence, const char* word) { return sentence.rfind(word, 0) == 0; }

/// Removes statements that do not hold for a log without position or without regular time.
void restrict_verdict(Conditioned& out, bool position, bool irregular) {
  const auto of_position = [](const std::string& t) {
    return starts_with(t, "terms") || starts_with(t, "pre-sliding");
  };
  const auto not_periodic = [](const std::string& t) { return !starts_with(t, "terms"); };
  if (!position) {
    std::erase_if(out.determinable, of_position);
    std::erase_if(out.cannot_tell, of_position);
    out.cannot_tell.push_back("terms periodic in position, pre-sliding: there is no position in this log");
  }
  if (irregular) {
    std::erase_if(out.determinable, not_periodic);
    std::erase_if(out.cannot_tell, not_periodic);
    out.cannot_tell.push_back(
        "mass, friction over speed, pre-sliding, delay: the rows were taken at irregular times; only force over position remains");
  }
}

void hand_over(Table m, const RawLog& raw, bool position, Conditioned& out) {
  Record record;
  record.source = raw.source;
  record.sample_time = m.sample_time;
  record.t = std::move(m.t);
  record.x = std::move(m.x);
  record.r = std::move(m.r);
  record.v = std::move(m.v);
  record.f = std::move(m.f);
  record.loop = raw.loop;
  record.force_unit = raw.force_unit;
  record.measured = raw.measured;
  record.position_unit = raw.position_unit;
  record.rotary = raw.rotary;
  record.integrated = !position;
  constexpr unsigned kNotFitted = kSignUnsure | kAtLimit | kRepairedRow;
  if (std::any_of(m.mark.begin(), m.mark.end(), [](std::uint8_t k) { return (k & kNotFitted) != 0; })) {
    record.skip.resize(m.mark.size());
    for (std::size_t k = 0; k < m.mark.size(); ++k) record.skip[k] = (m.mark[k] & kNotFitted) != 0 ? 1 : 0;
  }
  out.records.push_back(std::move(record));
  out.marks.push_back(std::move(m.mark));
  out.rows.push_back(std::move(m.row));
  out.run.push_back(m.run);
}

}  // namespace

const std::vector<std::string>& finding_kinds() {
  static const std::vector<std::string> kinds{
      "double-time", "rounded-time", "time-back", "jitter",     "gap",       "time-bases",  "held",
      "frozen",      "stuck",        "velocity",  "spike",      "jump",      "reference",   "drive-off",
      "unsigned",    "inverted",     "saturated", "short",      "irregular", "no-position", "contradiction",
      "mixed-runs",  "lost",         "stale",     "repeated",   "wrapped",   "exchanged",   "smoothed",
      "line",        "scale",        "commanded", "too-smooth", "late"};
  return kinds;
}

Conditioned condition(RawLog log, const ConditionOptions& options) {
  std::vector<RawLog> runs;
  runs.push_back(std::move(log));
  return condition(std::move(runs), options);
}

Conditioned condition(std::vector<RawLog> runs, const ConditionOptions& options) {
  if (runs.empty()) throw Refused("no log was given");
  Conditioned out;
  Notes notes(options);
  Sampling& s = out.sampling;
  const std::string& unit = runs.front().position_unit;
  const std::string& source = runs.front().source;
  const bool position = !runs.front().x.empty();
  const bool integrate_reference = runs.front().r.empty() && !runs.front().v_ref.empty();
  refuse_differing_runs(runs);
  const bool rotary = runs.front().rotary;
  // A rotary axis is carried at a radius of 1 m: its metres are radians.
  const std::string kind = rotary ? "rad" : unit;
  notes.turns(turning(kind), rotary);

  unwrap_positions(runs, notes);
  std::vector<Table> tables = tables_of(runs, s, notes);
  drop_partial_columns(tables, position);
  refuse_constant(tables, source, position);
  refuse_implausible(tables, source, position, runs.front().force_unit, unit);
  tables = without_repeats(std::move(tables), source, position, s, notes);
  bool noted = false;
  tables = long_enough(std::move(tables), source, noted, notes);
  if (!position) {
    integrate_velocity(tables, false);
    notes.add_all(
        "no-position", source, true,
        "no position in this log; integrated from the velocity, starting at zero: terms periodic in "
        "position and pre-sliding are not determined");
  }
  if (integrate_reference && !tables.front().r.empty()) integrate_velocity(tables, true);
  align_late_force(tables, notes);
  measure(tables, s);
  tables = without_faults(std::move(tables), position, s, notes);
  if (position && !integrate_reference) mend_exchanged(tables, notes);
  tables = long_enough(std::move(tables), source, noted, notes);
  measure(tables, s);
  recover_signs(tables, notes);
  mend_sign(tables, notes);
  find_saturation(tables, notes);
  for (Table& m : tables) mark_rest(m, std::max(s.x_quantum, s.x_noise));
  out.rough = rough_fit(tables);
  std::vector<double> times;
  for (const Table& m : tables) times.push_back(m.sample_time);
  s.sample_time = stats::thinned_quantile(times, 0.5);
  out.coverage = cover(tables, s, kind);
  if (!notes.has("irregular")) {
    refuse_implausible_drive(out.coverage, out.rough, source, runs.front().force_unit, kind, notes);
    if (position) name_commanded_position(tables, out.rough, notes);
    if (position) name_smoothed_force(tables, notes);
  }
  judge(out, kind, rotary);
  restrict_verdict(out, position, notes.has("irregular"));
  for (Table& m : tables) {
    const RawLog& raw = runs[m.run];
    hand_over(std::move(m), raw, position, out);
  }
  out.findings = notes.take();
  return out;
}

}  // namespace stribeck::ident::log
