#include <fmt/core.h>

#include <cmath>
#include <stribeck/ident/bristle/bristle_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::bristle {
namespace {

/// Velocity that only gives a direction [m/s]: the steady map at rest is its limit from either side.
constexpr double kAtRest = 1e-9;
/// Clocks of one control that are read with jitter differ by less.
constexpr double kSameTime = 1e-3;
constexpr double kRootTwelve = 3.4641016151377544;

void check(const std::vector<log::Record>& records, const BristleOptions& options) {
  if (records.empty()) throw Refused("dynamic friction: no record was given; at least one is needed");
  for (const log::Record& record : records) {
    const auto bad = log::problems(record);
    if (!bad.empty()) throw Refused(bad.front());
    const double T = records.front().sample_time;
    if (std::abs(record.sample_time - T) > kSameTime * T)
      throw Refused(
          record.source +
          fmt::format(": sampled every {:g} s, the first record every {:g} s; records of one fit need one "
                      "sampling time",
                      record.sample_time, T));
  }
  if (options.elements != 0 && (options.elements < 2 || options.elements > kMostElements))
    throw Refused(
        fmt::format("dynamic friction: {} GMS elements; expected 2 to 6, or 0 for none", options.elements));
  for (const double sd : {options.mass_tolerance.value_or(1.0), options.level_tolerance,
                          options.load_tolerance, options.viscous_tolerance}) {
    if (!(sd > 0.0) || !std::isfinite(sd))
      throw Refused(fmt::format("dynamic friction: a tolerance of {:g}; expected a number above zero", sd));
  }
}

Given prepare(const std::vector<log::Record>& records, const friction::AxisModel& known,
              const BristleOptions& options) {
  Given g;
  g.records = &records;
  g.known = &known;
  g.options = options;
  g.data.level = {known.friction.parts(kAtRest, 0.0).level, known.friction.parts(-kAtRest, 0.0).level};
  if (!(known.mass > 0.0) || !(g.data.level[0] > 0.0) || !(g.data.level[1] > 0.0))
    throw Refused(fmt::format(
        "dynamic friction: the axis model has mass {:g} and friction levels {:g} and {:g} at rest; all "
        "must be positive, so identify the steady map first",
        known.mass, g.data.level[0], g.data.level[1]));
  for (const log::Record& record : records) {
    log::MotionOptions as_logged;
    as_logged.shift = options.shift;
    g.data.motion.push_back(log::reconstruct(record, as_logged));
    const log::Motion& m = g.data.motion.back();
    g.data.noise = std::max(g.data.noise, m.position_noise);
    g.data.reversals += m.reversals.empty() ? 0 : m.reversals.size() - 1;
    g.open = g.open && m.loop == log::Loop::kOpen;
    g.stroke = std::max(g.stroke, m.stroke);
  }
  g.quantum = kRootTwelve * g.data.noise;
  g.level = 0.5 * (g.data.level[0] + g.data.level[1]);
  g.units = {records.front().position_unit, records.front().force_unit};
  g.shown = Shown(records.front());
  return g;
}

/// Median number of rows within three break-away distances after a reversal.
double rows_per_reversal(const BristleData& data, double break_away) {
  std::vector<double> per_turn;
  for (const log::Motion& m : data.motion) {
    for (std::size_t i = 1; i < m.reversals.size(); ++i) {
      const std::size_t turn = m.reversals[i];
      double count = 0.0;
      for (std::size_t k = turn;
           k < m.rows() && m.stretch[k] == m.stretch[turn] && m.distance[k] < 3.0 * break_away; ++k)
        count += 1.0;
      per_turn.push_back(count);
    }
  }
  return stats::median(std::move(per_turn));
}

/// Predicts stretches that were left out, and adds the law to the candidates.
void score(const std::string& name, const Model& model, const Fitted& f, const Rows& rows,
           std::vector<HeldOut>& scores, BristleFit& out) {
  scores.push_back(hold_out(model, f.solution.p, f.free, f.prior, rows.noise, rows.path));
  out.models.push_back(
      {name, 0, static_cast<int>(f.free.size()) - rows.path.starts, scores.back().rms(), 0.0, false});
}

struct Choice {
  std::size_t best = 0;
  std::size_t chosen = 0;
};

/// The simplest within one standard error of the best.
Choice choose(const std::vector<HeldOut>& scores, std::vector<Candidate>& models) {
  Choice c;
  for (std::size_t i = 1; i < models.size(); ++i) {
    if (models[i].held_out_rms < models[c.best].held_out_rms) c.best = i;
  }
  c.chosen = c.best;
  for (std::size_t i = 0; i < models.size(); ++i)
    models[i].standard_error = i == c.best ? 0.0 : error_of_difference(scores[i], scores[c.best]);
  for (std::size_t i = c.best; i-- > 0;) {
    if (models[i].held_out_rms <= models[c.best].held_out_rms + models[i].standard_error) c.chosen = i;
  }
  models[c.chosen].chosen = true;
  return c;
}

}  // namespace

BristleFit fit_bristle(const std::vector<log::Record>& records, const friction::AxisModel& known,
                       const BristleOptions& options) {
  check(records, options);
  const Given given = prepare(records, known, options);
  BristleFit out;
  out.mass = known.mass;
  out.load = known.load;
  out.reversals = given.data.reversals;
  const auto give_up = [&](const std::string& why) {
    out.reason = kNotDeterminable + why;
    return out;
  };
  if (std::any_of(records.begin(), records.end(), [](const log::Record& r) { return r.integrated; }))
    return give_up("it has no position, and an integrated velocity does not show so small distances");
  if (given.data.reversals == 0) return give_up("the motion has no reversal; record one with reversals");
  const double guess = options.near ? *options.near : guess_break_away(records, given.data, known);
  if (!(guess > 0.0) || !std::isfinite(guess)) return give_up("the axis does not move");

  Rows rows;
  rows.setting.mass = known.mass;
  rows.setting.load = known.load;
  rows.setting.scales.level = given.level;
  Fitted lugre;
  const std::string why = fit_lugre(given, guess, rows, lugre);
  if (!why.empty()) return give_up(why);
  out.rows = rows.path.rows.size();
  report_lugre(given, rows, lugre, out);
  out.rows_per_reversal = rows_per_reversal(given.data, lugre.break_away);

  std::vector<HeldOut> scores;
  score("static", *static_model(rows.setting), fit_static(given, rows), rows, scores, out);
  score("LuGre", *lugre_model(rows.setting), lugre, rows, scores, out);
  std::optional<Fitted> gms;
  std::optional<Candidate> refused;
  // GMS takes longer than everything else.
  const bool richer = options.elements > 0 && !beyond_any_law(given, lugre, out);
  if (richer) refused = gms_refused(given, rows, lugre);
  if (richer && !refused) gms = fit_gms(given, rows, lugre);
  if (gms) {
    report_gms(given, rows, *gms, out);
    score("GMS, " + std::to_string(options.elements) + " elements", *gms_model(rows.setting, gms->own), *gms,
          rows, scores, out);
  }
  const Choice c = choose(scores, out.models);
  answer(given, rows, c.chosen == 2 ? *gms : lugre, c.best, c.chosen, out);
  if (refused) {
    const double beside = out.models[1].held_out_rms;
    refused->held_out_rms *= beside;
    refused->standard_error *= beside;
    out.models.push_back(*refused);
  }
  return out;
}

}  // namespace stribeck::ident::bristle
