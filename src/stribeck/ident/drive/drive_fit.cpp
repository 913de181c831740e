#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stribeck/ident/drive/describe.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/intervals/open_model.hpp>
#include <stribeck/ident/drive/load/load_of_reversals.hpp>
#include <stribeck/ident/drive/places/places.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/smoothing/before_filter.hpp>
#include <stribeck/ident/drive/smoothing/filter_search.hpp>
#include <stribeck/ident/drive/smoothing/hidden_ripple.hpp>
#include <stribeck/ident/drive/stage.hpp>
#include <stribeck/ident/drive/text.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {
namespace {

/// Ratio of held-out errors below which another explanation is accepted.
constexpr double kBetter = 0.9;
constexpr double kMovedShift = 0.05;    ///< [rows] beside the periodic terms: everything is fitted again
constexpr double kRefinedShift = 1e-3;  ///< [rows]
constexpr double kTwinsMayGain = 1.02;  ///< of the held-out error
constexpr int kMostPlacePasses = 3;
constexpr double kWellTold = 0.1;  ///< [rows] half width of a shift that nothing else explains

/// Map and periodic terms.
struct Steady {
  MapChoice map;
  std::vector<SpectrumLine> spectrum;
};

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
  align(log, kHeldForce, stage.rows);
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

/// A map, the linear terms that belong to it, and their intervals.
struct Judged {
  MapChoice map;
  LinearFit fit;
  Intervals found;
};

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

/// Everything that is chosen beside places.
struct Placed {
  Stage stage;
  std::vector<double> lag;  ///< of the rows, without places
  PlaceShares along;
  std::optional<Judged> judged;
  Steady steady;
  Notes notes;
};

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

/// All steps from the rows to what is judged.
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

/// A fit without what the reversals tell of pre-sliding, which costs more than all of it.
struct Fitted {
  Placed placed;
  MapChoice map;
  std::optional<ToldLoad> load;
  const LevelDrift* taken_out = nullptr;  ///< the drift that the records had
  Result result;
  LevelDrift drift;                 ///< of friction over the time of the logs
  std::vector<log::Record> steady;  ///< the records without that drift; empty where there is none

  [[nodiscard]] Found found() const {
    const Judged& judged = *placed.judged;
    return {placed.stage.log, placed.stage.rows, placed.stage.terms, judged.fit, map, judged.found, load,
            taken_out};
  }
  /// The shift that was removed [s]; 0: none.
  [[nodiscard]] double shift() const {
    const AlignedLog& log = placed.stage.log;
    return placed.stage.terms.shift ? log.shift * log.records.front().sample_time : 0.0;
  }
  /// Half width of the interval of the shift [rows].
  [[nodiscard]] double shift_half() const {
    return placed.judged->found.factor * placed.judged->found.shift_error;
  }
};

Fitted fit_drive(std::span<const log::Record> records, const DriveFitOptions& options,
                 const LevelDrift* taken_out) {
  Placed placed = choose_all(records, options);
  MapChoice map = placed.judged->map;
  Fitted out{std::move(placed), std::move(map), {}, taken_out, {}, {}, {}};
  const Notes unsaid = out.placed.notes;
  const auto describe_now = [&] {
    out.placed.notes = unsaid;
    out.result = describe(out.found(), options, out.placed.notes);
  };
  describe_now();
  if (options.dynamics) out.load = load_of_reversals(out.result, out.found());
  if (out.load) {
    out.map = with_load(std::move(out.map), out.load->value);
    describe_now();
  }
  out.drift = LevelDrift(out.placed.stage.log, out.placed.stage.rows, out.map.map.fit,
                         out.placed.judged->found.residual);
  if (out.drift.found() && taken_out == nullptr)
    out.steady = at_mean_level(out.placed.stage.log, out.drift, out.result.mass, out.result.load);
  return out;
}

/// With a shift and without, where periodic terms may be the reason for one.
Fitted fit_both(std::span<const log::Record> records, const DriveFitOptions& options,
                const LevelDrift* taken_out) {
  Fitted found = fit_drive(records, options, taken_out);
  const Result& result = found.result;
  const bool well_told = found.shift_half() < kWellTold && !result.friction.eccentric.empty();
  if (found.shift() == 0.0 || well_told || options.shift || !options.periodic) return found;
  // A loop that works against a force periodic in position looks like a shift, and a wrong shift hides the term.
  DriveFitOptions without = options;
  without.search_shift = false;
  Fitted second = fit_drive(records, without, taken_out);
  const Result& other = second.result;
  if (other.friction.eccentric.empty() || !(other.held_out_rms < kBetter * result.held_out_rms)) return found;
  second.placed.stage.first_shift = found.placed.stage.first_shift;
  second.placed.notes.warn(text(
      "the force seemed to be %.3g ms %s than its motion; periodic terms explain the force better (residual %.3g instead of %s), and the shift removed is %.3g ms",
      1e3 * std::abs(found.shift()), found.shift() > 0.0 ? "later" : "earlier", other.held_out_rms,
      Shown(records.front()).force(result.held_out_rms).c_str(),
      1e3 * (second.shift() == 0.0 ? 0.0 : std::abs(second.shift()))));
  return second;
}

/// A fit on the force before the filter of the drive, and that force.
struct BeforeFilter {
  std::vector<log::Record> records;
  Fitted fitted;
};

/// Where a filter was found beside a free shift, but the shift that was given leaves no room for it.
void note_given_shift(const ForceFilter& filter, double given, Notes& notes) {
  notes.warn(text(
      "the log shows a filter of the drive of %.3g ms, which the given shift of %.3g ms does not allow: a given shift is that of the force before the filter, as it is printed without --force-shift; the filter was left on the force",
      1e3 * filter.time, 1e3 * given));
}

/// Absent where no filter shows, or one was taken off already. Rows and the lag at reversals were found with the filter; so it is searched
/// once more beside those without.
std::optional<BeforeFilter> before_filter_of(Fitted& logged, const DriveFitOptions& options) {
  constexpr double kSame = 0.02;  // of the time
  constexpr int kMostPasses = 3;
  const auto records = logged.placed.stage.log.records;
  if (!options.filter || records.front().filter || !one_sample_time(records)) return {};
  const double T = records.front().sample_time;
  const AlignedLog& log = logged.placed.stage.log;
  const auto search = [&](const Stage& by, double shift) -> std::optional<ForceFilter> {
    const std::optional<ForceFilter> found = find_filter(log, by.rows, by.terms, by.fit, shift);
    if (!found || !options.shift) return found;
    // A given shift that is wrong looks like a filter too.
    const auto given =
        find_filter(log, by.rows, by.terms, by.fit, *options.shift + found->time / T, options.shift);
    if (given && std::abs(given->time - found->time) < given->half_width + found->half_width) return given;
    note_given_shift(*found, *options.shift * T, logged.placed.notes);
    return {};
  };
  const auto take = [&](const ForceFilter& filter) {
    std::vector<log::Record> before(records.begin(), records.end());
    for (log::Record& r : before) take_off(filter, r);
    Fitted fitted = fit_both(before, options, nullptr);
    return BeforeFilter{std::move(before), std::move(fitted)};
  };
  const Stage& found = logged.placed.stage;
  const double first = found.terms.shift ? found.log.shift : found.first_shift;
  auto filter =
      search(found, options.shift ? find_shift(log, found.rows, options.mass).value_or(first) : first);
  if (!filter) return {};
  try {
    BeforeFilter out = take(*filter);
    for (int pass = 1; pass < kMostPasses; ++pass) {
      const Stage& stage = out.fitted.placed.stage;
      const auto next = search(stage, stage.log.shift + filter->time / T);
      if (!next || std::abs(next->time - filter->time) < kSame * filter->time) break;
      filter = next;
      out = take(*filter);
    }
    return out;
  } catch (const Refused&) {
    return {};  // too few rows are left
  }
}

/// A fit behind a low-pass that shows what the window of the motion hides.
struct Finer {
  DriveFitOptions options;
  Fitted fitted;
  std::string words;
};

/// Absent where no ripple is hidden, or the finer fit does not find it.
std::optional<Finer> with_hidden_ripple(const Fitted& found, std::span<const log::Record> records,
                                        const DriveFitOptions& options) {
  constexpr double kWorth =
      0.005;  // of the friction: a part of what the loop answers, which the window takes off
  constexpr double kNear = 0.03;  // of the period
  if (options.cut_off > 0.0 || !options.periodic || !one_sample_time(records)) return {};
  const AlignedLog& log = found.placed.stage.log;
  double level = 0.0;
  for (const CurvePoint& p : found.result.curve) level = std::max(level, std::abs(p.friction));
  const auto ripple = find_hidden_ripple(log, kWorth * level);
  const auto has = [&](const Fitted& fit) {
    const auto& terms = fit.result.friction.eccentric;
    return std::any_of(terms.begin(), terms.end(), [&](const auto& term) {
      return std::abs(term.period - ripple->period) < kNear * ripple->period;
    });
  };
  if (!ripple || has(found)) return {};
  DriveFitOptions finer = options;
  finer.cut_off = ripple->cut_off;
  try {
    Fitted out = fit_both(records, finer, nullptr);
    if (!has(out)) return {};
    const Shown shown(records.front());
    return Finer{
        finer, std::move(out),
        text("the low-pass for the noise of the encoder hides a force that repeats every %s: everything was "
             "identified behind one of %.3g Hz, which shows it",
             shown.length(ripple->period).c_str(), finer.cut_off)};
  } catch (const Refused&) {
    // The low-pass leaves too few rows.
  }
  return {};
}

/// Adds pre-sliding and the warnings.
Result finished(Fitted fitted, const DriveFitOptions& options, const DriftWords& drift) {
  Result result = std::move(fitted.result);
  Notes& notes = fitted.placed.notes;
  result.spectrum = std::move(fitted.placed.steady.spectrum);
  const double settles = fitted.placed.stage.relaxation.length;
  result.break_away_distance = settles > 0.0 ? settles : std::numeric_limits<double>::quiet_NaN();
  add_places(result, fitted.placed.along, Shown(fitted.placed.stage.log.records.front()), notes);
  if (options.dynamics) add_bristle(result, fitted.found(), notes);
  result.open = open_model(fitted.found(), result);
  result.level_drifts = !drift.friction.empty();
  result.cut_off = options.cut_off;
  for (const std::string& words : {drift.offset, drift.friction}) {
    if (!words.empty()) notes.warn(words);
  }
  result.warnings = std::move(notes.warnings);
  result.cannot_tell = std::move(notes.cannot_tell);
  return result;
}

}  // namespace

Result identify_drive(const std::vector<log::Record>& records, const DriveFitOptions& options) {
  Fitted found = fit_both(records, options, nullptr);
  std::vector<log::Record> before_filter;
  if (auto before = before_filter_of(found, options)) {
    before_filter = std::move(before->records);  // the fit goes on pointing to them
    found = std::move(before->fitted);
  }
  DriveFitOptions used = options;
  std::string hidden;
  if (auto finer = with_hidden_ripple(found, found.placed.stage.log.records, options)) {
    used = finer->options;
    hidden = std::move(finer->words);
    found = std::move(finer->fitted);
  }
  DriftWords drift = words_of_drift(found.found(), found.drift);
  const auto done = [&](Fitted fitted) {
    Result result = finished(std::move(fitted), used, drift);
    if (!hidden.empty()) result.warnings.push_back(std::move(hidden));
    return result;
  };
  if (found.steady.empty()) return done(std::move(found));
  // Cold rows are of some speeds and warm ones of others: the map of the mean level needs all of them at that level.
  Fitted level = fit_both(found.steady, used, &found.drift);
  if (!(level.result.held_out_rms < found.result.held_out_rms)) return done(std::move(found));
  // The drift of friction that was taken out is still said.
  drift.offset = words_of_drift(level.found(), level.drift).offset;
  return done(std::move(level));
}

}  // namespace stribeck::ident::drive
