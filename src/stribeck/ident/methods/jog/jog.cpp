#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/methods/equal_speed.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <stribeck/ident/methods/jog/jog_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::methods {
namespace jog {
namespace {

constexpr std::size_t kFewestSpeeds = 3;  // fewest that any candidate needs
constexpr double kTooMuch = 0.3;  // ratio of half sum to half difference above which it must be a load
/// A term is seen by one speed only if the half width of the interval, relative to the force, is larger between two speeds by this
/// factor than in the median gap.
constexpr double kOpen = 0.02;
constexpr double kOpenBeside = 5.0;

void weigh(std::vector<Point>& points) {
  const double typical = typical_error(points);
  if (!(typical > 0.0)) return;
  // The curve has errors too: no mean counts more than twice a typical one.
  for (Point& p : points) p.weight = 2.0 * typical * typical / (p.error * p.error + typical * typical);
}

struct Group {
  Result result;
  double residual_rms = 0.0;
};

/// One group of speeds that is fitted.
struct Fitted {
  const Fit& fit;
  const Spread& spread;
  const LoadEstimate& load;
  double taken = 0.0;  ///< load subtracted before the fit [N]
  bool both = false;   ///< the group has both directions
  Shown shown = {};
};

/// The load that is subtracted before a fit by direction: only where it is the same at all speeds, or too large for
/// friction.
double load_taken(const LoadEstimate& load, bool both) {
  if (!both || load.pairs.empty()) return 0.0;
  double friction = 0.0;
  for (const SpeedPair& p : load.pairs) friction += p.friction / static_cast<double>(load.pairs.size());
  return load.constant || std::abs(load.value) > kTooMuch * std::abs(friction) ? load.value : 0.0;
}

void write_symmetric(const Fitted& d, Result& r) {
  const Fit& fit = d.fit;
  r.set_steady(SteadyModel::kConventional);
  friction::Conventional<double> map;
  map.alpha0 = fit.p[0];
  map.alpha2 = fit.p[1];
  if (fit.kind.family != Family::kLine) {
    map.stribeck = friction::Stribeck<double>{fit.p[0] + fit.p[3], fit.p[4],
                                              fit.kind.family == Family::kFreeStribeck ? fit.p[5] : 2.0};
  }
  if (map.alpha2 < 0.0) {
    r.warnings.push_back(
        "friction falls with the speed over the whole range; a conventional model has no such viscous "
        "coefficient, and an axis file will refuse it");
  }
  r.friction.steady = map;
  r.load = d.taken + fit.p[2];
  if (d.both) {
    VectorXd g = VectorXd::Zero(static_cast<Index>(fit.parameters()));
    g(2) = 1.0;
    const double half = d.spread.half_width(g);
    r.parameters.push_back({"load", r.load, "N", "N", r.load - half, r.load + half, half < std::abs(r.load)});
    r.cannot_tell.push_back(
        "load and a Coulomb friction that differs between the directions cannot be distinguished at "
        "constant speed");
  } else {
    r.cannot_tell.push_back("load, and friction of the other direction: only one direction was run");
    r.warnings.push_back("only one direction was run: the other is taken to be its mirror image");
  }
}

void write_by_direction(const Fitted& d, Result& r) {
  r.set_steady(SteadyModel::kGaussian);
  r.friction.steady = as_map(d.fit, r.velocity_range);
  r.load = d.taken;
  if (d.taken != 0.0) {
    r.parameters.push_back({"load", d.taken, "N", "N", d.load.interval.low, d.load.interval.high,
                            d.load.interval.low > 0.0 || d.load.interval.high < 0.0});
    r.cannot_tell.push_back(
        "load and a Coulomb friction that differs between the directions cannot be distinguished: half "
        "the sum of both was taken as the load");
  } else {
    r.cannot_tell.push_back(
        fmt::format("load: half the sum of both directions, {:.4g} on average, varies with the speed; it was "
                    "taken for friction of each direction",
                    d.load.value));
  }
}

/// Residual of the fit at each mean, and its root mean square.
double write_points(const Fitted& d, const std::vector<Point>& lifted,
                    const std::vector<map::SteadyRun>& runs, const std::vector<log::Record>& records,
                    Result& r) {
  double square = 0.0;
  for (const Point& p : lifted) {
    const map::SteadyRun& run = runs[p.run];
    const double e = p.f - d.fit(p.v);
    square += e * e;
    const log::Record& rec = records[run.record];
    const std::size_t middle = (run.first + run.last) / 2;
    r.residuals.push_back(
        {rec.t[middle], rec.x.empty() ? 0.0 : rec.x[middle], p.v, e, static_cast<int>(run.record)});
    r.map.push_back({p.v, p.f - (r.load - d.taken), p.v > 0.0 ? 1 : -1});
    r.rows += run.last - run.first + 1;
  }
  return std::sqrt(square / static_cast<double>(lifted.size()));
}

/// Half widths relative to the force without the load, because the load shifts the whole curve.
double half_width_at(const Fitted& d, double v) {
  VectorXd g = d.fit.gradient(v);
  if (d.fit.kind.symmetric()) g(2) = 0.0;
  return d.spread.half_width(g);
}

void write_curve(const Fitted& d, int side, double slow, double fast, int points, Result& r) {
  for (int i = 0; i < points; ++i) {
    const int k = side == 0 ? i : points - 1 - i;
    const double v = (side == 0 ? 1.0 : -1.0) * (slow + (fast - slow) * k / (points - 1));
    const double f = d.fit(v) - (r.load - d.taken);
    const double half = half_width_at(d, v);
    r.curve.push_back({v, f, f - half, f + half});
  }
}

/// A term narrower than the steps of speed can have any height between them.
void note_open_gap(const Fitted& d, int side, const std::vector<SpeedMean>& mean, Result& r) {
  std::vector<double> share;  // half width over force, halfway to the next speed
  for (std::size_t i = 0; i + 1 < mean.size(); ++i) {
    const double v = (side == 0 ? 0.5 : -0.5) * (mean[i].v + mean[i + 1].v);
    share.push_back(half_width_at(d, v) / std::max(std::abs(d.fit(v) - (r.load - d.taken)), 1e-300));
  }
  if (share.empty()) return;
  const auto widest = std::max_element(share.begin(), share.end());
  const auto at = static_cast<std::size_t>(widest - share.begin());
  const double most = *widest;
  if (most > std::max(kOpen, kOpenBeside * stats::median(share))) {
    r.cannot_tell.push_back(fmt::format(
        "friction between {} and {}{}: the curve may bend more than these speeds show; jog at {} as well",
        d.shown.speed(mean[at].v), d.shown.speed(mean[at + 1].v),
        side == 0 ? "" : " of the negative direction", d.shown.speed(0.5 * (mean[at].v + mean[at + 1].v))));
  }
}

/// Curve and gaps of both directions, each from its slowest to its fastest speed.
void write_curves(const Fitted& d, const std::vector<Point>& points, int curve_points, Result& r) {
  double slow[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double fast[2] = {0.0, 0.0};
  for (const Point& p : points) {
    const int side = p.v > 0.0 ? 0 : 1;
    slow[side] = std::min(slow[side], std::abs(p.v));
    fast[side] = std::max(fast[side], std::abs(p.v));
  }
  std::vector<Point> by_speed = points;
  std::stable_sort(by_speed.begin(), by_speed.end(),
                   [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
  for (const int side : {1, 0}) {
    if (!(fast[side] > 0.0)) continue;
    write_curve(d, side, slow[side], fast[side], curve_points, r);
    note_open_gap(d, side, means_of(by_speed, side), r);
  }
}

Group fit_group(std::vector<Point> points, const std::vector<map::SteadyRun>& runs,
                const std::vector<log::Record>& records, const JogOptions& options) {
  const std::size_t folds = number_folds(points);
  weigh(points);
  double low = 0.0, high = 0.0;
  std::vector<map::SteadyRun> own;
  for (const Point& p : points) {
    low = std::min(low, p.v);
    high = std::max(high, p.v);
    own.push_back(runs[p.run]);
  }
  const bool both = low < 0.0 && high > 0.0;
  if (folds < kFewestSpeeds) {
    throw Refused(
        fmt::format("jog: {} different constant speeds, expected at least {}; excite --method jog writes a "
                    "motion through many",
                    folds, kFewestSpeeds));
  }
  const LoadEstimate load = load_of(own);
  const double taken = load_taken(load, both);
  // The symmetric candidates have a load parameter, so the same load may be subtracted for all.
  std::vector<Point> lifted = points;
  for (Point& p : lifted) p.f -= taken;
  Chosen chosen = choose(lifted, folds, Fitter(options, both), options, both, low, high);
  const Spread spread(chosen.fit, lifted);
  const Fitted fitted{chosen.fit, spread, load, taken, both, Shown(records.front())};

  Group out;
  Result& r = out.result;
  r.method = Method::kJog;
  r.force_unit = records.front().force_unit;
  r.position_unit = records.front().position_unit;
  r.models = std::move(chosen.candidates);
  r.held_out_rms = chosen.held_out;
  r.mass = kNaN;
  if (!both) {
    low = -std::max(-low, high);
    high = -low;
  }
  r.velocity_range = {low, high};
  add_parameters(chosen.fit, spread, r);
  if (chosen.fit.kind.symmetric()) {
    write_symmetric(fitted, r);
  } else {
    write_by_direction(fitted, r);
  }
  if (!chosen.chosen_by_leaving_out && !options.terms) {
    r.warnings.push_back(fmt::format(
        "{} speeds are too few to choose a model by leaving one out; the simplest was taken", folds));
  }
  out.residual_rms = write_points(fitted, lifted, runs, records, r);
  write_curves(fitted, points, options.curve_points, r);
  return out;
}

/// Records that move without constant speed: they determine the mass.
std::vector<log::Record> moving_records(const std::vector<log::Record>& records,
                                        const map::SteadyRuns& found) {
  constexpr double kMostlySteady = 0.3;
  std::vector<log::Record> out;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].x.empty()) continue;
    double steady = 0.0;
    for (const map::SteadyRun& run : found.runs) {
      if (run.record == i) steady += static_cast<double>(run.last - run.first + 1);
    }
    const auto [low, high] = std::minmax_element(records[i].x.begin(), records[i].x.end());
    if (steady < kMostlySteady * static_cast<double>(records[i].t.size()) && *high > *low)
      out.push_back(records[i]);
  }
  return out;
}

/// One group, or two where the friction jumps between speeds (the larger one first), and the warning about it.
std::vector<std::vector<Point>> split_at_jump(const std::vector<Point>& points,
                                              const std::vector<map::SteadyRun>& runs,
                                              const std::vector<log::Record>& records, std::string& note) {
  std::vector<std::vector<Point>> groups{points};
  const std::vector<Point> whole = by_record(points, runs, records);
  if (const auto jump = find_jump(whole)) {
    const Shown shown(records.front());
    groups.assign(2, {});
    for (const Point& p : points) {
      const auto same =
          std::find_if(whole.begin(), whole.end(), [&](const Point& q) { return q.run == p.run; });
      const Point& judged = same != whole.end() ? *same : p;
      groups[std::abs(judged.v) > jump->below ? 0 : 1].push_back(p);
    }
    note = fmt::format(
        "friction jumps by {:+.0f} % in both directions between {} and {}, which no "
        "friction curve does: two measuring days or states of the machine; the {} runs below and the "
        "{} runs above are identified separately",
        100.0 * jump->share, shown.speed(jump->below), shown.speed(jump->above), groups[1].size(),
        groups[0].size());
    if (groups[1].size() > groups[0].size()) std::swap(groups[0], groups[1]);
  }
  return groups;
}

void add_periodic(const map::SteadyRuns& found, Result& r) {
  const auto& e = *found.periodic;
  const double half = 1.96 * found.periodic_error;
  r.friction.eccentric.push_back(e);
  r.parameters.push_back(
      {"eta2", e.amplitude, "N", "N", e.amplitude - half, e.amplitude + half, half < e.amplitude});
  r.parameters.push_back({"period", e.period, "m", "mm", kNaN, kNaN, true});
  r.parameters.push_back(
      {"eta3", e.phase, "rad", "rad", e.phase - half / e.amplitude, e.phase + half / e.amplitude, true});
  r.warnings.push_back("the phase of the periodic term belongs to this homing of the axis");
}

/// The mass, from the records without constant speed.
void add_mass(const std::vector<log::Record>& records, const map::SteadyRuns& found,
              const JogOptions& options, Result& r) {
  if (options.mass) {
    r.mass = *options.mass;
    r.mass_interval = {*options.mass, *options.mass};
    return;
  }
  EqualSpeedOptions equal;
  constexpr double kLeast = 20e-6;
  if (!records.front().turns() || found.exclude > kLeast) equal.exclude = std::max(found.exclude, kLeast);
  if (found.periodic) equal.periods = {found.periodic->period};
  const std::vector<log::Record> moving = moving_records(records, found);
  MassEstimate mass;
  if (!moving.empty()) mass = mass_at_equal_speed(moving, equal);
  if (std::isfinite(mass.value) && mass.interval.low > 0.0) {
    r.mass = mass.value;
    r.mass_interval = mass.interval;
    r.parameters.insert(r.parameters.begin(),
                        {"mass", mass.value, "kg", "N s2/mm", mass.interval.low, mass.interval.high, true});
  } else if (moving.empty()) {
    r.cannot_tell.push_back("mass: constant speeds do not determine it (add the log of a sine)");
  } else {
    r.cannot_tell.push_back(
        "mass: the records without constant speed accelerate too little, or their force does not follow "
        "the acceleration");
  }
}

}  // namespace
}  // namespace jog

Jog identify_jog(const std::vector<log::Record>& records, const JogOptions& options) {
  using namespace jog;
  if (records.empty()) throw Refused("jog: no record given");
  for (const log::Record& r : records) {
    if (r.force_unit != records.front().force_unit || r.position_unit != records.front().position_unit) {
      throw Refused(r.source + ": its units differ from those of " + records.front().source +
                    "; identify them apart");
    }
  }
  const map::SteadyRuns found = map::find_steady_runs(records, options.steady);
  Jog jog;
  jog.runs = found.runs;
  if (found.runs.empty()) {
    throw Refused("jog: no stretch of constant speed was found; excite --method jog writes such a motion" +
                  (found.notes.empty() ? std::string() : " (" + found.notes.front() + ")"));
  }
  std::vector<Point> points;
  for (std::size_t i = 0; i < found.runs.size(); ++i) {
    const map::SteadyRun& run = found.runs[i];
    points.push_back({run.speed, run.force, run.error, 1.0, 0, i});
  }
  number_folds(points);
  std::string note;
  const auto groups = split_at_jump(points, found.runs, records, note);
  std::vector<Group> fitted;
  for (const auto& g : groups) {
    try {
      fitted.push_back(fit_group(g, found.runs, records, options));
    } catch (const Refused& e) {
      if (fitted.empty()) throw;
      note += fmt::format("; the smaller group: {}", e.what());
    }
  }
  jog.result = fitted.front().result;
  jog.residual_rms = fitted.front().residual_rms;
  for (std::size_t i = 1; i < fitted.size(); ++i) jog.groups.push_back(fitted[i].result);

  Result& r = jog.result;
  if (!note.empty()) r.warnings.insert(r.warnings.begin(), note);
  r.warnings.insert(r.warnings.end(), found.notes.begin(), found.notes.end());
  if (found.periodic) add_periodic(found, r);
  if (std::isfinite(found.relaxation)) {
    r.break_away_distance = found.relaxation;
  } else {
    r.cannot_tell.push_back("pre-sliding: no reversal is resolved by the rows");
  }
  add_mass(records, found, options, r);
  return jog;
}

}  // namespace stribeck::ident::methods
