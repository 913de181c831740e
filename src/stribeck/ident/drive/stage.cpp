#include <algorithm>
#include <cmath>
#include <optional>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/stage.hpp>
#include <utility>

namespace stribeck::ident::drive {
namespace {

/// exp(−6) = 0.25 % of the swing at a reversal is left beyond six relaxation lengths.
constexpr double kRelaxations = 6.0;
constexpr double kSmallSpeed =
    0.04;  // share of the largest speed; below it only the lag and the bristle show

}  // namespace

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

void note_weak_instrument(const LinearFit& before, const LinearFit& now, Notes& notes) {
  if (now.mass_by_acceleration && !before.mass_by_acceleration)
    notes.warn(
        "the acceleration that the reference or a calmer motion predicts hardly agrees with the measured one; the mass is found from the measured acceleration");
}

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
  LinearFit fit = stage.fit;
  if (shift) {
    stage.terms.shift = true;
    align(stage.log, *shift, stage.rows);
    fit = solve(stage.log, stage.rows, stage.terms, &stage.fit);
    fit = refine_shift(stage.log, stage.rows, stage.terms, std::move(fit));
    note_weak_instrument(stage.fit, fit, notes);
  }
  const Told told = ask_reversals(stage.log, stage.rows, stage.terms, stage.fit, stage.log.shift);
  if (shift && !told.refutes_found()) {
    stage.fit = std::move(fit);
    stage.first_shift = stage.log.shift;
    return;
  }
  if (told.refutes_held()) stage.log.held = stage.first_shift = told.simple.shift;
  if (!shift && stage.log.held == kHeldForce) return;
  stage.terms.shift = false;
  align(stage.log, stage.log.held, stage.rows);
  stage.fit = solve(stage.log, stage.rows, stage.terms, &stage.fit);
}

void settle(Stage& stage, const DriveFitOptions& options, Notes& notes) {
  AlignedLog& log = stage.log;
  const LinearFit before = stage.fit;
  if (stage.rows.sampled) align_all(log, log.shift);
  stage.relaxation =
      find_relaxation(log.motions, level_of(before), before.mass, before.load, stage.extent.near);
  const double length = stage.relaxation.length;
  Window window{stage.extent.near, kSmallSpeed, 0.0};
  if (length > 0.0) {
    window = {kRelaxations * length, 0.5 * kSmallSpeed, length};
  } else {
    notes.warn(
        "no reversal of motion in the log: the break-away distance is not known, so no rows are left out for it");
  }
  Rows all = gather(log, stage.extent, window, options.bins);
  stage.rows = sampled(all);
  const auto find_lags = [&] {
    if (length > 0.0) find_lag(log.motions, level_of(stage.fit), stage.relaxation, stage.rows);
  };
  const auto solve_again = [&] { stage.fit = solve(log, stage.rows, stage.terms, &stage.fit); };
  if (stage.terms.shift) ask_reference(log, stage.rows, stage.terms, stage.fit);
  if (length > 0.0) {
    find_lags();
    solve_again();
    find_lags();
  }
  solve_again();
  if (!options.shift) stage.fit = judge_shift(log, stage.rows, stage.terms, std::move(stage.fit));
  if (stage.rows.sampled) {
    stage.rows = std::move(all);
    align_all(log, log.shift);
    find_lags();
    if (stage.terms.shift) ask_reference(log, stage.rows, stage.terms, stage.fit);
    solve_again();
  }
  note_weak_instrument(before, stage.fit, notes);
}

void renew_lag(Stage& stage, const map::StaticFit& chosen) {
  if (!(stage.relaxation.length > 0.0)) return;
  Level level = level_of(stage.fit);
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const bool by_direction = chosen.family == map::StaticFit::Family::kByDirection;
    level.viscous[s] = std::max(0.0, by_direction ? chosen.branch[s].eta1 / chosen.top[s] : chosen.viscous);
  }
  find_lag(stage.log.motions, level, stage.relaxation, stage.rows);
  stage.fit = solve(stage.log, stage.rows, stage.terms, &stage.fit);
}

}  // namespace stribeck::ident::drive
