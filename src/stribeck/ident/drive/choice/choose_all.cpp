#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stribeck/ident/drive/choice/choose_all.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {
namespace {

constexpr double kMovedShift = 0.05;    ///< [rows] beside the periodic terms: everything is fitted again
constexpr double kRefinedShift = 1e-3;  ///< [rows]
constexpr double kTwinsMayGain = 1.02;  ///< of the held-out error
constexpr int kMostPlacePasses = 3;

Steady choose_steady(Stage& stage, const DriveFitOptions& options, Notes& notes) {
  Steady out{choose_map(stage.log, stage.rows, stage.terms, stage.fit, options), {}};
  if (!options.periodic) return out;
  PeriodicChoice periodic =
      choose_periodic(stage.log, stage.rows, stage.terms, stage.fit, std::move(out.map), options, notes);
  note_weak_instrument(stage.fit, periodic.fit, notes);
  stage.terms = std::move(periodic.terms);
  stage.fit = std::move(periodic.fit);
  return {std::move(periodic.map), std::move(periodic.spectrum)};
}

/// Everything that was fitted with one shift.
struct Attempt {
  Terms terms;
  LinearFit fit;
  double shift = kHeldForce;
  Steady steady;
  Notes notes;
};

void take(Stage& stage, const Attempt& attempt) {
  stage.terms = attempt.terms;
  stage.fit = attempt.fit;
  align(stage.log, attempt.shift, stage.rows);
  if (stage.terms.shift) ask_reference(stage.log, stage.rows, stage.terms, stage.fit);
}

constexpr double kSamePeriod = 0.02;

/// A term that reverses and one that does not, of one period: together they look like a shift.
bool twins(const PeriodicColumns& a, const PeriodicColumns& b) {
  return a.form != b.form && std::abs(a.period / b.period - 1.0) < kSamePeriod;
}

/// The larger one of twins stays.
std::vector<PeriodicColumns> without_twins(const std::vector<PeriodicColumns>& terms) {
  std::vector<PeriodicColumns> kept;
  for (const PeriodicColumns& term : terms) {
    if (std::none_of(kept.begin(), kept.end(), [&](const auto& other) { return twins(term, other); }))
      kept.push_back(term);
  }
  return kept;
}

bool has_twins(const std::vector<PeriodicColumns>& terms) {
  return without_twins(terms).size() < terms.size();
}

/// Judges the shift again beside the periodic terms, from the commanded force on; true when it is another one.
bool shift_moves(Stage& stage) {
  AlignedLog& log = stage.log;
  const double before = log.shift;
  stage.terms.periodic = without_twins(stage.terms.periodic);
  stage.terms.shift = true;
  align(log, log.held, stage.rows);
  stage.fit = solve(log, stage.rows, stage.terms, nullptr);
  ask_reference(log, stage.rows, stage.terms, stage.fit);
  stage.fit = solve(log, stage.rows, stage.terms, &stage.fit);
  stage.fit = judge_shift(log, stage.rows, stage.terms, std::move(stage.fit));
  return std::abs(log.shift - before) > kMovedShift;
}

/// Map and periodic terms, with the shift as it was found and, where that moves beside the terms, with the other one:
/// the same terms, and terms that are searched anew. What predicts held-out motion best is taken.
Attempt choose_attempt(Stage& stage, const DriveFitOptions& options, bool shift_known, const Notes& notes) {
  Notes own = notes;
  Steady steady = choose_steady(stage, options, own);
  Attempt best{stage.terms, stage.fit, stage.log.shift, std::move(steady), std::move(own)};
  if (shift_known || stage.terms.periodic.empty()) return best;
  if (shift_moves(stage)) {
    const auto enter = [&](Steady other, Notes words) {
      // A shift is one number with a known cause; the second of twins is two numbers with none.
      const bool explained = has_twins(best.terms.periodic) && !has_twins(stage.terms.periodic);
      const double limit = (explained ? kTwinsMayGain : 1.0) * best.steady.map.map.held_out_rms;
      if (!(other.map.map.held_out_rms < limit)) return;
      best = {stage.terms, stage.fit, stage.log.shift, std::move(other), std::move(words)};
    };
    enter({with_joint_fits(choose_map(stage.log, stage.rows, stage.terms, stage.fit, options), stage.fit),
           best.steady.spectrum},
          best.notes);
    stage.terms.periodic.clear();
    stage.fit = solve(stage.log, stage.rows, stage.terms, &stage.fit);
    own = notes;
    Steady anew = choose_steady(stage, options, own);
    enter(std::move(anew), std::move(own));
  }
  take(stage, best);
  return best;
}

/// The map beside the terms that the stage has.
void choose_map_again(const Stage& stage, Steady& steady, const DriveFitOptions& options) {
  steady.map = choose_map(stage.log, stage.rows, stage.terms, stage.fit, options);
  if (!stage.terms.periodic.empty()) steady.map = with_joint_fits(std::move(steady.map), stage.fit);
}

/// The lag of friction beside the viscous part of the map, where held-out motion is predicted clearly better with it.
void take_better_lag(Stage& stage, Steady& steady, const DriveFitOptions& options) {
  if (!(stage.relaxation.length > 0.0)) return;
  const std::vector<double> lag = stage.rows.lag;
  const LinearFit fit = stage.fit;
  MapChoice before = steady.map;
  renew_lag(stage, before.map.fit);
  choose_map_again(stage, steady, options);
  constexpr double kWorthwhile = 0.99;  // of the held-out error
  if (steady.map.map.held_out_rms < kWorthwhile * before.map.held_out_rms) return;
  stage.rows.lag = lag;
  stage.fit = fit;
  steady.map = std::move(before);
}

/// The shift was found before the periodic terms. Beside them it is refined to the end, because what is left of it in its
/// column has an interval of the column only.
void finish_shift(Stage& stage, Steady& steady, const DriveFitOptions& options) {
  if (!stage.terms.shift) return;
  const LinearFit fit = with_terms_of(steady.map, stage.terms, stage.fit);
  if (std::abs(fit.value(fit.value.size() - 1)) < kRefinedShift) return;
  stage.fit = refine_shift(stage.log, stage.rows, stage.terms, std::move(stage.fit));
  choose_map_again(stage, steady, options);
}

Judged judge(const Stage& stage, MapChoice map, bool shift_known) {
  LinearFit fit = with_terms_of(map, stage.terms, stage.fit);
  Intervals found = intervals(stage.log, stage.rows, stage.terms, fit, map, shift_known);
  return {std::move(map), std::move(fit), std::move(found)};
}

/// The periodic terms whose amplitude the data tell from nothing.
std::vector<PeriodicColumns> certain_terms(const Terms& terms, const Judged& judged) {
  std::vector<PeriodicColumns> kept;
  for (std::size_t n = 0; n < terms.periodic.size(); ++n) {
    const auto at = static_cast<Index>(terms.first_periodic() + 2 * n);
    const double amplitude = judged.fit.value.segment<2>(at).norm();
    VectorXd along = judged.found.zero();
    along.segment<2>(at) = judged.fit.value.segment<2>(at) / std::max(amplitude, 1e-300);
    if (amplitude > judged.found.factor * judged.found.error_of(along)) kept.push_back(terms.periodic[n]);
  }
  return kept;
}

/// Terms that the data do not tell from nothing go, unless a map of few parameters tells them and predicts held-out motion better
/// than the map without them.
Judged without_uncertain_terms(Stage& stage, Judged judged, const DriveFitOptions& options,
                               bool shift_known) {
  std::vector<PeriodicColumns> kept = certain_terms(stage.terms, judged);
  const std::size_t all = stage.terms.periodic.size();
  if (kept.size() == all) return judged;
  std::optional<Judged> together;
  if (!judged.map.joint) {
    std::optional<MapChoice> map = only_joint_fits(judged.map, stage.fit);
    if (map) together = judge(stage, std::move(*map), shift_known);
    if (together && certain_terms(stage.terms, *together).size() < all) together.reset();
  }
  const Terms terms = stage.terms;
  const LinearFit fit = stage.fit;
  stage.terms.periodic = std::move(kept);
  stage.fit = solve(stage.log, stage.rows, stage.terms, &stage.fit);
  MapChoice map =
      with_joint_fits(choose_map(stage.log, stage.rows, stage.terms, stage.fit, options), stage.fit);
  if (together && together->map.map.held_out_rms < map.map.held_out_rms) {
    stage.terms = terms;
    stage.fit = fit;
    return std::move(*together);
  }
  return judge(stage, std::move(map), shift_known);
}

/// Takes `next` out in place of the present places; map and terms are then chosen anew.
void lay_and_judge(Placed& p, const PlaceShares& next, const DriveFitOptions& options, bool shift_known,
                   const Notes& before) {
  Stage& stage = p.stage;
  const Level level = level_of(stage.fit);
  stage.rows.lag = p.lag;
  lay_places(stage.log, stage.rows, level, next.places);
  p.along = next;
  stage.terms.periodic.clear();
  stage.fit = solve(stage.log, stage.rows, stage.terms, &stage.fit);
  p.notes = before;
  p.steady = choose_steady(stage, options, p.notes);
  p.judged = without_uncertain_terms(stage, judge(stage, p.steady.map, shift_known), options, shift_known);
  stage.fit = p.judged->fit;
}

/// Friction along the travel, until the rows show no more.
void take_out_places(Placed& p, const DriveFitOptions& options, bool shift_known, const Notes& before) {
  for (int pass = 0; pass < kMostPlacePasses; ++pass) {
    const Level level = level_of(p.stage.fit);
    PlaceShares found = find_places({p.stage.log, p.stage.rows, level, p.judged->found.residual});
    if (found.places.empty()) return;
    found.places = together(p.along.places, found.places);
    lay_and_judge(p, found, options, shift_known, before);
  }
}

}  // namespace

Placed choose_all(std::span<const log::Record> records, const DriveFitOptions& options) {
  Notes notes;
  Stage stage;
  stage.log = reconstruct_all(records, options.cut_off, options.shift, notes, options.mass.has_value());
  stage.extent = extent_of(stage.log);
  stage.terms.known_mass = options.mass;
  const bool shift_known = options.shift || !one_sample_time(records);
  fit_first(stage, options, notes);
  if (!options.shift && options.search_shift) take_out_shift(stage, notes);
  settle(stage, options, notes);
  const Notes before = notes;
  Attempt attempt = choose_attempt(stage, options, shift_known, notes);
  Steady steady = std::move(attempt.steady);
  take_better_lag(stage, steady, options);
  if (!shift_known) finish_shift(stage, steady, options);
  Judged first = without_uncertain_terms(stage, judge(stage, steady.map, shift_known), options, shift_known);
  stage.fit = first.fit;
  std::vector<double> lag = stage.rows.lag;
  Placed placed{std::move(stage), std::move(lag),    {},
                std::move(first), std::move(steady), std::move(attempt.notes)};
  if (options.places && records.front().position_unit == "m")
    take_out_places(placed, options, shift_known, before);
  return placed;
}

}  // namespace stribeck::ident::drive
