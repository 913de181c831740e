#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stribeck/ident/drive/choice/choose_all.hpp>
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
constexpr double kWellTold = 0.1;  ///< [rows] half width of a shift that nothing else explains

/// A fit without what the reversals tell of pre-sliding, which costs more than all of it.
struct Fitted {
  Placed placed;
  MapChoice map;
  std::optional<ToldLoad> load;
  const LevelDrift* taken_out = nullptr;  ///< the drift that the records had
  Result result;
  LevelDrift drift;                 ///< of friction over the time of the logs
  std::vector<log::Record> steady;  ///< the records without that drift; empty where there is none
  Notes unsaid;                     ///< the notes before the result was described
  bool may_drift = true;

  [[nodiscard]] Found found() const {
    const Judged& judged = *placed.judged;
    return {placed.stage.log, placed.stage.rows, placed.stage.terms, judged.fit, map, judged.found, load,
            taken_out,        may_drift};
  }
  void describe_now(const DriveFitOptions& options) {
    placed.notes = unsaid;
    result = describe(found(), options, placed.notes);
  }
  /// The shift that was removed [s]; 0: none.
  [[nodiscard]] double shift() const {
    const AlignedLog& log = placed.stage.log;
    const bool removed = placed.stage.terms.shift || log.shift != kHeldForce;
    return removed ? log.shift * log.records.front().sample_time : 0.0;
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
  Fitted out{std::move(placed), std::move(map), {}, taken_out, {}, {}, {}, {}};
  out.unsaid = out.placed.notes;
  out.describe_now(options);
  if (options.dynamics && !options.balanced) out.load = load_of_reversals(out.result, out.found());
  if (out.load) {
    out.map = with_load(std::move(out.map), out.load->value);
    out.describe_now(options);
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

/// Largest rise or fall of friction within a log, as a share.
double largest_rise(const Fitted& fitted) {
  double most = 0.0;
  for (std::size_t r = 0; r < fitted.placed.stage.log.records.size(); ++r)
    most = std::max(most, std::abs(fitted.drift.rise(r)));
  return most;
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
  // Where each speed has its own time, an error of the curve looks like a drift, and a large one. A true one leaves less once it is taken out.
  constexpr double kLarge = 0.05, kVeryLarge = 0.3, kClearly = 0.8;
  const double rise = largest_rise(found), needed = rise > kVeryLarge ? kClearly
                                                    : rise > kLarge   ? kBetter
                                                                      : 1.0;
  if (!(level.result.held_out_rms < needed * found.result.held_out_rms)) {
    if (rise > kLarge) {
      found.may_drift = false;
      found.describe_now(used);
      drift = words_of_drift(found.found(), LevelDrift());
    }
    return done(std::move(found));
  }
  // The drift of friction that was taken out is still said.
  drift.offset = words_of_drift(level.found(), level.drift).offset;
  return done(std::move(level));
}

}  // namespace stribeck::ident::drive
