#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stribeck/ident/drive/describe.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/relaxation.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/text.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {
namespace {

/// exp(−6) = 0.25 % of the swing at a reversal is left beyond six relaxation lengths.
constexpr double kRelaxations = 6.0;
constexpr double kSmallSpeed =
    0.04;  // share of the largest speed; below it only the lag and the bristle show
/// Ratio of held-out errors below which another explanation is accepted.
constexpr double kBetter = 0.9;

Level level_of(const LinearFit& fit) {
  Level level;
  level.curve = fit.curve;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    for (double& f : level.curve[s].force) f -= map::kDirection[s] * fit.load;
    level.viscous[s] = std::max(0.0, level.curve[s].line().slope);
  }
  return level;
}

bool one_sample_time(std::span<const log::Record> records) {
  const double T = records.front().sample_time;
  for (const log::Record& r : records) {
    if (std::abs(r.sample_time - T) > 0.01 * T) return false;
  }
  return true;
}

/// The values that each step hands to the next; the steps are functions of them.
struct Stage {
  AlignedLog log;
  Extent extent;
  Rows rows;
  Terms terms;
  LinearFit fit;
  double break_away = std::numeric_limits<double>::quiet_NaN();  ///< distance in which friction settles [m]
};

/// Warns once that the instrument could not be used.
void note_weak_instrument(const LinearFit& before, const LinearFit& now, Notes& notes) {
  if (now.mass_by_acceleration && !before.mass_by_acceleration)
    notes.warn("the reference hardly moves with the measured acceleration; the mass rests on the latter");
}

/// Friction near reversals is not known yet, so a generous distance is left out.
void fit_first(Stage& stage, const DriveFitOptions& options, Notes& notes) {
  stage.rows = sampled(gather(stage.log, stage.extent, {stage.extent.near, kSmallSpeed, 0.0}, options.bins));
  const LinearFit first = solve(stage.log, stage.rows, stage.terms);
  stage.fit = solve(stage.log, stage.rows, stage.terms, &first);
  note_weak_instrument(first, stage.fit, notes);
}

void take_out_shift(Stage& stage, Notes& notes) {
  if (!one_sample_time(stage.log.records)) {
    notes.warn("records of different sample times: the shift of the force is not estimated");
    return;
  }
  const std::optional<double> shift = find_shift(stage.log, stage.rows, stage.terms.known_mass);
  if (!shift) return;
  stage.terms.shift = true;
  align(stage.log, *shift, stage.rows);
  LinearFit fit = solve(stage.log, stage.rows, stage.terms, &stage.fit);
  fit = refine_shift(stage.log, stage.rows, stage.terms, std::move(fit));
  note_weak_instrument(stage.fit, fit, notes);
  stage.fit = std::move(fit);
}

/// Selects rows in which friction has settled, subtracts the remaining lag and judges the shift.
void settle(Stage& stage, const DriveFitOptions& options, Notes& notes) {
  AlignedLog& log = stage.log;
  const LinearFit before = stage.fit;
  if (stage.rows.sampled) align_all(log, log.shift);
  const Relaxation relaxation =
      find_relaxation(log.motions, level_of(before), before.mass, before.load, stage.extent.near);
  const double length = relaxation.length;
  Window window{stage.extent.near, kSmallSpeed, 0.0};
  if (length > 0.0) {
    stage.break_away = length;
    window = {kRelaxations * length, 0.5 * kSmallSpeed, length};
  } else {
    notes.warn(
        "no reversal of motion in the log: the distance to break away is not known and nothing is left out "
        "for it");
  }
  Rows all = gather(log, stage.extent, window, options.bins);
  stage.rows = sampled(all);
  const auto find_lags = [&] {
    if (length > 0.0) find_lag(log.motions, level_of(stage.fit), relaxation, stage.rows);
  };
  const auto solve_again = [&] { stage.fit = solve(log, stage.rows, stage.terms, &stage.fit); };
  if (stage.terms.shift) ask_reference(log, stage.rows, stage.fit);
  if (length > 0.0) {
    find_lags();
    solve_again();
    find_lags();
  }
  solve_again();
  if (!options.shift) stage.fit = judge_shift(log, stage.rows, stage.terms, std::move(stage.fit), notes);
  if (stage.rows.sampled) {
    stage.rows = std::move(all);
    align_all(log, log.shift);
    find_lags();
    if (stage.terms.shift) ask_reference(log, stage.rows, stage.fit);
    solve_again();
  }
  note_weak_instrument(before, stage.fit, notes);
}

/// A result, and the shift that was removed [s]; 0: none.
struct Fitted {
  Result result;
  double shift = 0.0;
};

Fitted fit_drive(std::span<const log::Record> records, const DriveFitOptions& options) {
  Notes notes;
  Stage stage;
  stage.log = reconstruct_all(records, options.cut_off, options.shift, notes);
  stage.extent = extent_of(stage.log);
  stage.terms.known_mass = options.mass;
  fit_first(stage, options, notes);
  if (!options.shift) take_out_shift(stage, notes);
  settle(stage, options, notes);
  MapChoice choice = choose_map(stage.log, stage.rows, stage.terms, stage.fit, options);
  std::vector<SpectrumLine> spectrum;
  if (options.periodic) {
    PeriodicChoice periodic =
        choose_periodic(stage.log, stage.rows, stage.terms, stage.fit, std::move(choice), options, notes);
    note_weak_instrument(stage.fit, periodic.fit, notes);
    choice = std::move(periodic.map);
    stage.terms = std::move(periodic.terms);
    stage.fit = std::move(periodic.fit);
    spectrum = std::move(periodic.spectrum);
  }
  const LinearFit fit = with_terms_of(choice, stage.terms, std::move(stage.fit));
  const Intervals found_intervals = intervals(stage.log, stage.rows, stage.terms, fit, choice);
  const Found found{stage.log, stage.rows, stage.terms, fit, choice, found_intervals};
  Fitted out{describe(found, options, notes),
             stage.terms.shift ? stage.log.shift * records.front().sample_time : 0.0};
  Result& result = out.result;
  result.spectrum = std::move(spectrum);
  result.break_away_distance = stage.break_away;
  if (options.dynamics) add_bristle(result, stage.log, notes);
  warn_of_drift(found, result.force_unit, notes);
  result.warnings = std::move(notes.warnings);
  result.cannot_tell = std::move(notes.cannot_tell);
  return out;
}

}  // namespace

Result identify_drive(const std::vector<log::Record>& records, const DriveFitOptions& options) {
  Fitted found = fit_drive(records, options);
  Result& result = found.result;
  if (found.shift == 0.0 || !result.friction.eccentric.empty() || !options.periodic) return std::move(result);
  // A loop that works against a force periodic in position looks like a shift, and a wrong shift hides the periodic term.
  DriveFitOptions without = options;
  without.shift = kHeldForce;
  Result other = fit_drive(records, without).result;
  if (other.friction.eccentric.empty() || !(other.held_out_rms < kBetter * result.held_out_rms))
    return std::move(result);
  other.warnings.push_back(text(
      "the force seemed to be %.3g ms %s than its motion; with periodic terms instead, the residual is %.3g in place of %.3g %s, so no shift is removed",
      1e3 * std::abs(found.shift), found.shift > 0.0 ? "later" : "earlier", other.held_out_rms,
      result.held_out_rms, other.force_unit.c_str()));
  return other;
}

}  // namespace stribeck::ident::drive
