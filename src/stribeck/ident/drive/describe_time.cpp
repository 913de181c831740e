#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/ident/bristle/place_stiffness.hpp>
#include <stribeck/ident/drive/describe.hpp>
#include <stribeck/ident/drive/text.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr std::size_t kFewestForDrift = 500;      // rows
constexpr double kWorthSaying = 0.02;             // of the friction
constexpr double kExactShift = 0.02;              // [rows] half width that moves nothing
constexpr std::size_t kMostRowsForRise = 20'000;  // a longer fit takes minutes
/// Least half width of a stiffness: how a bristle bends differs from machine to machine, and the residuals hardly show it. On random
/// machines (docs/sweep.md) the intervals held the truth in 78 % of 261 sets without it.
constexpr double kOtherBristle = 0.015;
constexpr double kMostApart = 4.0;  // ratio of the ends of an interval that still tells something

/// Widens an interval to both sides by how far the value moves with the shift.
Interval widened(double value, Interval own, const std::vector<double>& moved) {
  double below = 0.0, above = 0.0;
  for (const double other : moved) {
    const double change = std::log(other / value);
    below = std::max(below, -change), above = std::max(above, change);
  }
  return {value * std::exp(-std::hypot(std::log(value / own.low), below)),
          value * std::exp(std::hypot(std::log(own.high / value), above))};
}

/// The same fits with the force earlier and later by the half width of the shift.
void widen(std::vector<Parameter>& parameters, const std::vector<const std::vector<Parameter>*>& moved) {
  for (Parameter& p : parameters) {
    std::vector<double> values;
    for (const auto* other : moved) {
      const auto same =
          std::find_if(other->begin(), other->end(), [&](const Parameter& m) { return m.name == p.name; });
      if (same != other->end() && same->value > 0.0) values.push_back(same->value);
    }
    if (values.size() < moved.size() || values.empty() || !(p.value > 0.0) || !(p.ci_low > 0.0)) {
      p.identifiable = false;
      continue;
    }
    const Interval wide = widened(p.value, {p.ci_low, p.ci_high}, values);
    p.ci_low = wide.low, p.ci_high = wide.high;
    p.identifiable = p.identifiable && wide.high < kMostApart * wide.low;
  }
}

/// The same parameter of another fit: the interval reaches to the ends of its interval too.
void reach(Interval& own, double value, const Interval& other) {
  if (!(other.low > 0.0) || !(other.high > other.low) || !(own.low > 0.0)) return;
  own.low = std::min({own.low, other.low, value});
  own.high = std::max({own.high, other.high, value});
}

/// Below the slowest rows the friction may rise, and the map does not know it. LuGre is fitted a second time with such a rise as a
/// nuisance parameter; where that describes the reversals better, its values are possible too.
void reach_beside_unseen_rise(bristle::BristleFit& fit, const std::vector<log::Record>& records,
                              const friction::AxisModel& known, bristle::BristleOptions options,
                              double slowest) {
  if (!std::holds_alternative<friction::LuGre<double>>(fit.best) || fit.rows > kMostRowsForRise) return;
  options.elements = 0;
  options.unseen_below = slowest;
  if (fit.break_away > 0.0) options.near = fit.break_away;
  bristle::BristleFit risen;
  try {
    risen = bristle::fit_bristle(records, known, options);
  } catch (const Refused&) {
    return;
  }
  if (risen.lugre_parameters.empty() || risen.models.size() < 2 || fit.models.size() < 2) return;
  if (!(risen.models[1].held_out_rms < fit.models[1].held_out_rms)) return;
  for (std::size_t i = 0; i < std::min(fit.lugre_parameters.size(), risen.lugre_parameters.size()); ++i) {
    Parameter& p = fit.lugre_parameters[i];
    Interval wide{p.ci_low, p.ci_high};
    reach(wide, risen.lugre_parameters[i].value,
          {risen.lugre_parameters[i].ci_low, risen.lugre_parameters[i].ci_high});
    p.ci_low = wide.low, p.ci_high = wide.high;
    p.identifiable = p.identifiable && (p.name != "sigma0" || wide.high < kMostApart * wide.low);
  }
  reach(fit.break_away_interval, risen.break_away, risen.break_away_interval);
}

/// Whether the break-away distance is still told; a note where it is not. The law stays in the model: it predicts the reversals of these
/// logs, and a step in its place would be worse.
bool told_beside_unseen_rise(const bristle::BristleFit& fit, const Shown& shown, Notes& notes) {
  if (!(fit.break_away_interval.high > kMostApart * fit.break_away_interval.low)) return true;
  notes.cannot_tell.push_back(text(
      "the stiffness of pre-sliding: friction may rise below the slowest rows, and the break-away distance may then be anything from "
      "%s to %s; the model keeps %s, with which it predicts the reversals of this log; add slow jogs",
      shown.length(fit.break_away_interval.low).c_str(), shown.length(fit.break_away_interval.high).c_str(),
      shown.length(fit.break_away).c_str()));
  return false;
}

constexpr double kWidestShare = 0.35;  ///< half width of the logarithm of a stiffness that is determined

void add_place_stiffness(Result& result, const std::vector<log::Record>& records, double shift) {
  const friction::AxisModel known{result.mass, result.load, result.friction};
  const bristle::PlaceStiffness found =
      bristle::fit_place_stiffness(records, known, result.break_away_distance, shift);
  for (std::size_t k = 0; k < found.share.size(); ++k) {
    const double share = found.share[k], half = found.half[k];
    result.friction.places[k].stiffness = share;
    result.parameters.push_back({"stiffness_at_place_" + std::to_string(k + 1), share, "1", "1",
                                 share * std::exp(-half), share * std::exp(half), half < kWidestShare});
  }
}

/// No half width of a stiffness below kOtherBristle.
void allow_other_bristles(bristle::BristleFit& fit) {
  const auto as_other_bristles = [](double value) {
    return std::vector<double>{value * std::exp(-kOtherBristle), value * std::exp(kOtherBristle)};
  };
  for (std::vector<Parameter>* law : {&fit.lugre_parameters, &fit.gms_parameters}) {
    for (Parameter& p : *law) {
      if ((p.name != "sigma0" && p.name != "stiffness") || !(p.value > 0.0) || !(p.ci_low > 0.0)) continue;
      const Interval wide = widened(p.value, {p.ci_low, p.ci_high}, as_other_bristles(p.value));
      p.ci_low = wide.low, p.ci_high = wide.high;
    }
  }
  if (fit.break_away_interval.low > 0.0)
    fit.break_away_interval =
        widened(fit.break_away, fit.break_away_interval, as_other_bristles(fit.break_away));
}

/// Widens the intervals by how far the values move with the force earlier and later by `half` rows, the half width of its shift.
void allow_shifts(bristle::BristleFit& fit, const std::vector<log::Record>& records,
                  const friction::AxisModel& known, bristle::BristleOptions options, double half) {
  // A law that was not chosen has no intervals to widen, and its fit is the longest of all.
  if (!std::holds_alternative<friction::Gms<double>>(fit.best)) options.elements = 0;
  if (fit.break_away > 0.0) options.near = fit.break_away;
  const double shift = options.shift;
  std::vector<bristle::BristleFit> moved;
  for (const double by : {-half, half}) {
    options.shift = shift + by;
    try {
      moved.push_back(bristle::fit_bristle(records, known, options));
    } catch (const Refused&) {
      // The motion is the same: what was refused now is no statement about the parameters.
    }
  }
  std::vector<const std::vector<Parameter>*> lugre, gms;
  std::vector<double> distances;
  for (const bristle::BristleFit& m : moved) {
    lugre.push_back(&m.lugre_parameters), gms.push_back(&m.gms_parameters);
    if (m.break_away > 0.0) distances.push_back(m.break_away);
  }
  widen(fit.lugre_parameters, lugre);
  widen(fit.gms_parameters, gms);
  if (fit.break_away_interval.low > 0.0)
    fit.break_away_interval = widened(fit.break_away, fit.break_away_interval, distances);
}

/// Of each record the number of its log: a log that was cut at gaps is several records, one after the other in time.
std::vector<std::size_t> logs_of(std::span<const log::Record> records) {
  std::vector<std::size_t> out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const bool goes_on =
        r > 0 && records[r].source == records[r - 1].source && records[r].t.front() > records[r - 1].t.back();
    out.push_back(r == 0 ? 0 : out.back() + (goes_on ? 0 : 1));
  }
  return out;
}

/// The larger one of the two directions.
double level_at_rest(const Result& result) {
  return std::max(result.friction.parts(0.0, 0.0).level, result.friction.parts(-1e-9, 0.0).level);
}

/// A fit that was refused has the reason and nothing else.
bristle::BristleFit fit_of(const std::vector<log::Record>& records, const friction::AxisModel& known,
                           const bristle::BristleOptions& options) {
  try {
    return bristle::fit_bristle(records, known, options);
  } catch (const Refused& why) {
    bristle::BristleFit fit;
    fit.reason = why.what();
    return fit;
  }
}

/// "pre-sliding is not determinable from this log: the encoder …" goes on a sentence without its beginning.
std::string without_beginning(const std::string& reason) {
  const std::string_view beginning = bristle::kNotDeterminable;
  return reason.starts_with(beginning) ? reason.substr(beginning.size()) : reason;
}

struct BristleOfLog {
  bristle::BristleFit fit;
  std::vector<log::Record> records;
};

/// Of several logs the one whose reversals tell pre-sliding best when it is fitted alone: fast reversals of the others, which pass the
/// break-away distance within a few rows, hide it. Absent where none does.
std::optional<BristleOfLog> best_log_alone(const std::vector<log::Record>& records,
                                           const friction::AxisModel& known,
                                           const bristle::BristleOptions& options) {
  constexpr std::size_t kMostLogs = 6;
  const std::vector<std::size_t> log = logs_of(records);
  const std::size_t logs = log.empty() ? 0 : log.back() + 1;
  if (logs < 2 || logs > kMostLogs) return {};
  std::optional<BristleOfLog> best;
  const auto width = [](const Interval& i) { return i.low > 0.0 ? i.high / i.low : kInfinity; };
  for (std::size_t n = 0; n < logs; ++n) {
    std::vector<log::Record> own;
    for (std::size_t r = 0; r < records.size(); ++r) {
      if (log[r] == n) own.push_back(records[r]);
    }
    bristle::BristleFit fit = fit_of(own, known, options);
    if (!fit.determinable) continue;
    if (!best || width(fit.break_away_interval) < width(best->fit.break_away_interval))
      best = BristleOfLog{std::move(fit), std::move(own)};
  }
  return best;
}

}  // namespace

bool below_the_noise(const Result& result) {
  constexpr double kVisible = 0.5;
  return level_at_rest(result) < kVisible * result.held_out_rms;
}

std::vector<log::Record> records_of_reversals(const AlignedLog& log) {
  std::vector<log::Record> closed;
  for (std::size_t r = 0; r < log.records.size(); ++r) {
    if (log.motions[r].loop == log::Loop::kClosed) closed.push_back(log.records[r]);
  }
  if (closed.empty()) closed.assign(log.records.begin(), log.records.end());
  return closed;
}

void add_bristle(Result& result, const Found& found, Notes& notes) {
  const AlignedLog& log = found.log;
  const Shown shown(log.records.front());
  if (!(result.mass > 0.0) || result.position_unit != "m") return;
  const friction::AxisModel known{result.mass, result.load, result.friction};
  if (below_the_noise(result)) {
    notes.cannot_tell.push_back(
        text("pre-sliding: friction at rest, %s, lies below what the model leaves of the force, %s RMS",
             shown.force(level_at_rest(result)).c_str(), shown.force(result.held_out_rms).c_str()));
    return;
  }
  std::vector<log::Record> closed = records_of_reversals(log);
  bristle::BristleOptions options;
  options.shift = log.shift;
  const bool open = std::none_of(log.motions.begin(), log.motions.end(),
                                 [](const log::Motion& m) { return m.loop == log::Loop::kClosed; });
  bristle::BristleFit fit = fit_of(closed, known, options);
  if (!fit.determinable) {
    std::optional<BristleOfLog> one = best_log_alone(closed, known, options);
    if (!one) {
      result.bristles_too_fine = fit.too_coarse;
      notes.cannot_tell.push_back(fit.reason);
      return;
    }
    notes.warn(text("pre-sliding is that of %s, fitted alone; all logs together did not tell it: %s",
                    one->records.front().source.c_str(), without_beginning(fit.reason).c_str()));
    fit = std::move(one->fit), closed = std::move(one->records);
  }
  const double half = found.intervals.factor * found.intervals.shift_error;
  if (half > kExactShift) {
    allow_shifts(fit, closed, known, options, half);
    if (fit.break_away_interval.high > kMostApart * fit.break_away_interval.low) {
      notes.cannot_tell.push_back(text(
          "pre-sliding is not determinable from this log: with the shift between force and motion unknown, "
          "its break-away distance may be anything from %s to %s; %s, or give --force-shift",
          shown.length(fit.break_away_interval.low).c_str(),
          shown.length(fit.break_away_interval.high).c_str(),
          log.records.front().r.empty() ? "record the commanded position too"
                                        : "a log of excite --method multisine tells the shift"));
      return;
    }
  }
  allow_other_bristles(fit);
  reach_beside_unseen_rise(fit, closed, known, options,
                           std::max(found.rows.grid[0].low, found.rows.grid[1].low));
  const bool told = told_beside_unseen_rise(fit, shown, notes);
  const bool gms = std::holds_alternative<friction::Gms<double>>(fit.best);
  result.friction.dynamics = fit.best;
  result.model += gms ? " + gms" : " + lugre";
  for (Parameter p : gms ? fit.gms_parameters : fit.lugre_parameters) {
    // The ringing after pulses determines the stiffness, but hardly the damping (bristle_fit.hpp).
    if (open && p.name != "sigma0" && p.name != "stiffness") p.identifiable = false;
    if (!told) p.identifiable = false;
    result.parameters.push_back(std::move(p));
  }
  result.break_away_distance = fit.break_away;
  result.parameters.push_back({"break_away_distance", fit.break_away, "m", "um", fit.break_away_interval.low,
                               fit.break_away_interval.high, told});
  for (Candidate c : fit.models) {
    c.name = "after reversals: " + c.name;
    result.models.push_back(std::move(c));
  }
  if (!result.friction.places.empty()) add_place_stiffness(result, closed, log.shift);
}

void add_places(Result& result, const PlaceShares& along, const Shown& shown, Notes& notes) {
  if (along.places.empty() || result.position_unit != "m") return;
  result.friction.places = along.places;
  result.model += " + places";
  std::size_t least = 0, most = 0;
  for (std::size_t k = 0; k < along.places.size(); ++k) {
    const double share = along.places[k].level;
    if (share < along.places[least].level) least = k;
    if (share > along.places[most].level) most = k;
    const double half = along.half[k];
    result.parameters.push_back({"level_at_place_" + std::to_string(k + 1), share, "1", "1", share - half,
                                 share + half, half < share});
  }
  const auto at = [&](std::size_t k) { return shown.length(along.places[k].position); };
  notes.warn(text(
      "friction differs along the travel, from %+.3g %% at %s to %+.3g %% at %s: the model holds it at %zu places from %s to %s, which belong "
      "to the homing position of this log; beyond them, the nearest place counts",
      100.0 * (along.places[least].level - 1.0), at(least).c_str(), 100.0 * (along.places[most].level - 1.0),
      at(most).c_str(), along.places.size(), at(0).c_str(), at(along.places.size() - 1).c_str()));
}

DriftWords words_of_drift(const Found& found, const LevelDrift& drift) {
  DriftWords out;
  const Rows& rows = found.rows;
  const auto records = found.log.records;
  const std::vector<std::size_t> log = logs_of(records);
  std::vector<std::size_t> length(log.size());
  for (const int r : rows.record) ++length[log[static_cast<std::size_t>(r)]];
  const auto longest =
      static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
  std::vector<std::size_t> used;
  for (const std::size_t i : sample(rows)) {
    if (log[static_cast<std::size_t>(rows.record[i])] == longest) used.push_back(i);
  }
  if (used.size() < kFewestForDrift) return out;
  const auto time = [&](std::size_t i) {
    return records[static_cast<std::size_t>(rows.record[i])].t[rows.at[i]];
  };
  const log::Record& rec = records[static_cast<std::size_t>(rows.record[used.front()])];
  const double from = time(used.front()), to = time(used.back());
  MatrixXd X(static_cast<Index>(used.size()), 2);
  VectorXd y(static_cast<Index>(used.size()));
  std::vector<int> record(used.size());
  std::vector<std::size_t> at(used.size());
  for (std::size_t j = 0; j < used.size(); ++j) {
    const auto k = static_cast<Index>(j);
    const double tau = (time(used[j]) - from) / (to - from) - 0.5;
    record[j] = rows.record[used[j]];
    X(k, 0) = tau;
    X(k, 1) = tau * map::kDirection[rows.side[used[j]]];
    y(k) = found.intervals.residual[used[j]];
    at[j] = rows.at[used[j]];
  }
  const MatrixXd normal = X.transpose() * X;
  // With almost only one direction, offset and friction cannot be distinguished.
  if (!(stats::determinant(normal) > 1e-3 * normal(0, 0) * normal(1, 1))) return out;
  const MatrixXd inverse = stats::inverse(normal);
  const VectorXd x = inverse * (X.transpose() * y);
  const stats::Uncertainty uncertainty(X, y - X * x, inverse, record, at);
  const map::StaticFit& map = found.choice.map.fit;
  const auto friction = [&](double speed) { return 0.5 * (map.force(0, speed) + map.force(1, speed)); };
  const double slow = 0.5 * (map.force(0, rows.grid[0].low) + map.force(1, rows.grid[1].low));
  // The drift is that of all rows: it is a share of the friction at their speeds, not of that near zero.
  double level = 0.0;
  for (const std::size_t i : used)
    level += friction(std::abs(velocity_of(found.log, rows, i))) / static_cast<double>(used.size());
  const auto words = [&](const char* what, double rise) {
    return text(
        "%s %s by %s (%.2g %% of the mean friction) from the beginning to the end of %s: warming up or running in; the result is the mean over the record",
        what, rise > 0 ? "rose" : "fell", Shown(rec).force(std::abs(rise)).c_str(),
        100.0 * std::abs(rise / level), rec.source.c_str());
  };
  // Slow noise sometimes looks like a drift: the limit is twice the interval.
  const auto seen = [&](Index j) {
    const double half = uncertainty.half_width(VectorXd::Unit(2, j));
    return std::abs(x(j)) >= 2.0 * half && std::abs(x(j)) >= kWorthSaying * std::abs(slow);
  };
  if (seen(0)) out.offset = words("the offset of the force", x(0));
  // Errors of the curve hide a drift here that shows at equal speeds.
  const double rise = level * drift.rise(static_cast<std::size_t>(rows.record[used.front()]));
  if (seen(1))
    out.friction = words("friction", x(1));
  else if (std::abs(rise) >= kWorthSaying * std::abs(slow))
    out.friction = words("friction", rise);
  return out;
}

void describe_filter(const log::Record& record, Result& result, Notes& notes) {
  result.filter = record.filter;
  if (!record.filter) return;
  const ForceFilter& filter = *record.filter;
  result.parameters.push_back({"force_filter", filter.time, "s", "ms", filter.time - filter.half_width,
                               filter.time + filter.half_width, true});
  notes.warn(text(
      "the drive smoothed the force before it was logged, by a filter of first order of %.3g ± %.2g ms or by a mean over about %.3g ms; the filter was taken off the force before the fit, and a shift that is printed is the one without it",
      1e3 * filter.time, 1e3 * filter.half_width, 1e3 * filter.time * std::sqrt(12.0)));
}

}  // namespace stribeck::ident::drive
