#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <stribeck/core/fields.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/methods/break_away.hpp>
#include <stribeck/ident/methods/equal_speed.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/report/said_once.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/judge/diagnosis.hpp>
#include <stribeck/workflow/log/encoders.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

using Records = std::vector<ident::log::Record>;

/// The options that a method takes, in addition to those of every method.
struct Takes {
  Method method;
  std::vector<ModelChoice> models;
  bool terms, mass, cut_off, turn, solver, force_shift;
};

const Takes& takes_of(Method method) {
  using enum ModelChoice;
  using M = Method;
  static const std::vector<Takes> all{
      {M::kAuto, {kAuto, kConventional, kGaussian}, true, true, true, false, false, true},
      {M::kVelocityMap, {kAuto, kGaussian}, true, true, false, false, false, false},
      {M::kPositionMap, {kAuto}, false, true, false, true, false, false},
      {M::kJog, {kAuto, kConventional, kGaussian}, true, true, false, false, true, false},
      {M::kLeastSquaresA, {kAuto, kConventional}, false, false, false, false, true, false},
      {M::kIdimLs, {kAuto, kConventional, kAsymmetric}, false, false, false, false, false, false},
      {M::kBreakAway, {kAuto}, false, true, false, false, false, false},
      {M::kGravity, {kAuto}, false, false, false, false, false, false},
      {M::kConstantAcceleration, {kAuto}, false, false, false, false, false, false}};
  return *std::find_if(all.begin(), all.end(), [&](const Takes& t) { return t.method == method; });
}

/// Refuses every option that the method would not use; `which` names the method.
void check_taken(const IdentifyOptions& o, Method method, const std::string& which) {
  const Takes& m = takes_of(method);
  const auto takes = [&](bool given, bool taken, const char* option) {
    if (given && !taken) refuse_option(option, which + " does not take it");
  };
  takes(o.terms.has_value(), m.terms, "--terms");
  takes(!o.mass.empty(), m.mass, "--mass");
  takes(!o.cut_off.empty(), m.cut_off, "--cut-off");
  takes(!o.force_shift.empty(), m.force_shift, "--force-shift");
  takes(!o.turn.empty(), m.turn, "--turn");
  takes(o.solver != ident::methods::Solver::kDerivatives, m.solver, "--solver");
  if (std::find(m.models.begin(), m.models.end(), o.model) == m.models.end()) {
    std::vector<std::string> models;
    for (const ModelChoice model : m.models) models.emplace_back(enum_name(model));
    refuse_option("--model", fmt::format("got {}, which {} cannot give (expected {})", enum_name(o.model),
                                         which, report::joined(models, ", ")));
  }
  if (o.terms.value_or(0) > 0 && o.model == ModelChoice::kConventional)
    refuse_option("--terms", fmt::format("got {}, but --model conventional has no Gaussians", *o.terms));
}

/// The method that auto stands for.
void check_auto(const IdentifyOptions& o, Method method, const char* why) {
  check_taken(o, method, fmt::format("the method for this log ({}, {})", enum_name(method), why));
}

std::optional<double> optional_si(const std::string& text, const Quantity& quantity, const char* option) {
  if (text.empty()) return std::nullopt;
  return option_si(option, text, quantity);
}

/// From a milligram, in any unit of force, to more than any machine table.
std::optional<double> given_mass(const IdentifyOptions& o) {
  return optional_si(o.mass, quantity("kg", "N s2/mm").at_least(1e-6).at_most(1e9), "--mass");
}

/// Between one period of the log and half the sampling frequency.
double given_cut_off(const IdentifyOptions& o, const Records& records) {
  const auto f = optional_si(o.cut_off, quantity("Hz", "Hz").positive(), "--cut-off");
  if (!f) return 0.0;
  double least = 0.0, most = std::numeric_limits<double>::infinity();
  for (const ident::log::Record& r : records) {
    least = std::max(least, 1.0 / (r.t.back() - r.t.front()));
    most = std::min(most, 0.5 / r.sample_time);
  }
  if (!(*f > least) || !(*f < most)) {
    refuse_option("--cut-off",
                  fmt::format("got {}, expected above {:.4g} Hz, one period of the log, and below {:.6g} "
                              "Hz, half of its sampling frequency",
                              io::in_quotes(o.cut_off), least, most));
  }
  return *f;
}

/// A known shift of the force [rows].
std::optional<double> given_shift(const IdentifyOptions& o, const Records& records) {
  const auto shift = optional_si(o.force_shift, quantity("s", "ms"), "--force-shift");
  if (!shift) return shift;
  const double T = records.front().sample_time;
  for (const ident::log::Record& r : records) {
    if (std::abs(r.sample_time - T) > 0.01 * T) {
      refuse_option(
          "--force-shift",
          fmt::format("got {}, but the logs have sample times of {:.4g} and {:.4g} ms: expected one, "
                      "so identify them separately",
                      io::in_quotes(o.force_shift), 1e3 * T, 1e3 * r.sample_time));
    }
  }
  constexpr double kMost = ident::replay::kMostGivenShift;
  if (!(std::abs(*shift) <= kMost * T)) {
    refuse_option("--force-shift",
                  fmt::format("got {}, expected at most {:.4g} ms, {:g} rows of this log, either way",
                              io::in_quotes(o.force_shift), 1e3 * kMost * T, kMost));
  }
  return *shift / T;
}

/// A known travel of one turn that this log can show.
std::optional<double> given_turn(const IdentifyOptions& o, const AxisRecords& axis) {
  if (o.turn.empty()) return std::nullopt;
  const Records& records = axis.records;
  const bool turns = records.front().position_unit == "rad";
  const double turn = travel_si(
      "--turn", o.turn, (turns ? quantity("rad", "rad") : quantity("m", "mm")).positive(), axis.rotary);
  // Fractions of a much longer turn lie too close together to be resolved; a shorter turn is not seen.
  constexpr double kLongest = 20.0, kShortest = 1.0 / 2000.0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ident::log::Record& r : records) {
    const auto [a, b] = std::minmax_element(r.x.begin(), r.x.end());
    low = std::min(low, *a), high = std::max(high, *b);
  }
  const double travel = high - low;
  if (!(turn <= kLongest * travel) || !(turn >= kShortest * travel)) {
    const double shown = turns ? 1.0 : axis.rotary ? 180.0 / kPi : 1e3;
    const char* unit = turns ? "rad" : axis.rotary ? "deg" : "mm";
    refuse_option(
        "--turn",
        fmt::format("got {}, expected between {:.4g} and {:.4g} {} for the travel of {:.4g} {} in this log",
                    io::in_quotes(o.turn), shown * kShortest * travel, shown * kLongest * travel, unit,
                    shown * travel, unit));
  }
  return turn;
}

/// Distance over which an axis moves to and fro.
double travelled(const ident::log::Record& r) {
  // Over 20 ms, so that noise is no motion.
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(0.02 / r.sample_time)));
  double sum = 0.0;
  for (std::size_t k = step; k < r.x.size(); k += step) sum += std::abs(r.x[k] - r.x[k - step]);
  return sum;
}

/// Runs of constant speed, each logged separately: the speeds of a jog as many controls export them. A part program also has stretches
/// of constant speed, of many speeds, and tells the mass between them.
bool steady_speeds(const Records& records, std::size_t runs) {
  constexpr std::size_t kFewestRuns = 4;
  constexpr double kSame = 1.15;       // ratio of two speeds of one file
  constexpr double kMostOfWay = 0.45;  // what is left out after ramps and reversals is up to a third and more
  if (runs < kFewestRuns) return false;
  struct OfDirection {
    double slowest = 0.0, fastest = 0.0, way = 0.0;
    [[nodiscard]] bool is_one_speed() const { return way == 0.0 || fastest < kSame * slowest; }
  };
  // A jog may come back faster than it went.
  std::vector<std::array<OfDirection, 2>> of(records.size());
  try {
    for (const ident::map::SteadyRun& run : ident::map::find_steady_runs(records).runs) {
      OfDirection& r = of[run.record][run.speed > 0.0 ? 0 : 1];
      const double speed = std::abs(run.speed);
      r.slowest = r.way == 0.0 ? speed : std::min(r.slowest, speed);
      r.fastest = std::max(r.fastest, speed);
      r.way += std::abs(run.way);
    }
  } catch (const ident::Refused&) {
    return false;
  }
  std::size_t steady = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    const double way = of[i][0].way + of[i][1].way;
    steady += way > 0.0 && of[i][0].is_one_speed() && of[i][1].is_one_speed() &&
                      way > kMostOfWay * travelled(records[i])
                  ? 1
                  : 0;
  }
  return 10 * steady >= 7 * records.size();
}

Identification by_jog(const IdentifyOptions& o, const Records& records) {
  ident::methods::JogOptions options;
  options.solver = o.solver;
  if (o.terms) options.terms = o.terms;
  options.gaussians = o.model != ModelChoice::kConventional;
  options.mass = given_mass(o);
  ident::methods::Jog jog = ident::methods::identify_jog(records, options);
  return {std::move(jog.result), false, std::move(jog.groups)};
}

Identification by_position(const IdentifyOptions& o, const AxisRecords& axis, bool holding) {
  ident::methods::PositionMapOptions options;
  options.mass = given_mass(o);
  options.turn = given_turn(o, axis);
  options.holding = holding;
  return {ident::methods::identify_position_map(axis.records, options), holding};
}

Identification by_least_squares(const IdentifyOptions& o, const Records& records) {
  // Pulses run in open loop, jogs follow a position. Where no record is open loop, all records count as pulses.
  Records pulses, jogs;
  for (const ident::log::Record& r : records) (r.r.empty() ? pulses : jogs).push_back(r);
  const bool closed_loop_only = pulses.empty();
  if (closed_loop_only) std::swap(pulses, jogs);
  ident::methods::LeastSquaresAOptions options;
  options.solver = o.solver;
  ident::methods::LeastSquaresA a = jogs.empty()
                                        ? ident::methods::identify_least_squares_a(pulses, options)
                                        : ident::methods::identify_least_squares_a(pulses, jogs, options);
  Identification found{a.result, false, {}, std::move(a)};
  if (closed_loop_only) {
    found.result.warnings.push_back(
        records.front().source +
        ": least squares is made for pulses in open loop; in a closed-loop log the force reacts to the "
        "noise, and mass and interval can be far off (use --method velocity-map)");
  }
  return found;
}

Identification by_idim_ls(const IdentifyOptions& o, const Records& records) {
  if (records.size() > 1) {
    refuse_option(
        "LOG",
        fmt::format("got {} records (several logs, or a gap in one), expected one for --method idim-ls",
                    records.size()));
  }
  ident::methods::IdimOptions options;
  options.by_direction = o.model == ModelChoice::kAsymmetric;
  ident::methods::IdimResult idim = ident::methods::identify_idim_ls(records.front(), options);
  return {std::move(idim.result), false, {}, {}, std::move(idim.published)};
}

Identification by_break_away(const IdentifyOptions& o, const Records& records) {
  ident::methods::BreakAwayOptions options;
  options.mass = given_mass(o);
  return {ident::methods::identify_break_away(records, options).result};
}

Identification by_velocity(const IdentifyOptions& o, const Records& records) {
  ident::methods::VelocityMapOptions options;
  if (o.terms) options.terms = o.terms;
  options.mass = given_mass(o);
  return {ident::methods::identify_velocity_map(records, options)};
}

/// Fits the whole drive at once, for any motion.
Identification by_drive_fit(const IdentifyOptions& o, const AxisRecords& axis, Depth depth) {
  const Records& records = axis.records;
  ident::drive::DriveFitOptions options;
  options.search_shift = !axis.as_commanded;
  options.control_period = axis.control_period;
  options.dynamics = depth == Depth::kWhole;
  if (o.terms) options.terms = o.terms;
  if (o.model == ModelChoice::kConventional) options.most_terms = 0;
  if (o.model == ModelChoice::kGaussian) options.symmetric = false;
  options.mass = given_mass(o);
  options.shift = given_shift(o, records);
  options.cut_off = given_cut_off(o, records);
  Records with_positions;
  for (const ident::log::Record& r : records) with_positions.push_back(ident::map::with_positions(r));
  options.balanced = axis.balanced;
  options.weighted = axis.weighted;
  ident::Result result = ident::drive::identify_drive(with_positions, options);
  if (!axis.balanced || o.model == ModelChoice::kConventional) return {std::move(result)};
  const ident::Parameter* load = result.find("load");
  if (load == nullptr || !(load->ci_low * load->ci_high > 0.0)) return {std::move(result)};
  options.symmetric = false;
  const ident::Shown people(result.position_unit, result.force_unit, axis.rotary);
  const std::string apart = people.force(std::abs(load->value));
  result = ident::drive::identify_drive(with_positions, options);
  if (result.find("load") == nullptr)
    result.warnings.push_back(fmt::format(
        "half of the difference between the directions is {}: as the machine file says a load of 0, it is taken as friction",
        apart));
  return {std::move(result)};
}

bool mass_is_determined(const ident::Result& result) {
  return result.mass > 0.0 && result.mass_interval.low > 0.0;
}

/// Runs of constant speed that do not determine the mass still determine the friction; absent where they are too few.
std::optional<Identification> friction_alone(const IdentifyOptions& o, const AxisRecords& axis) {
  constexpr double kLeastShare = 0.4;  // of the rows
  std::size_t rows = 0;
  for (const ident::log::Record& r : axis.records) rows += r.x.size();
  try {
    check_auto(o, Method::kJog, "too little acceleration for the mass");
    Identification found = by_jog(o, axis.records);
    if (static_cast<double>(found.result.rows) < kLeastShare * static_cast<double>(rows)) return std::nullopt;
    found.result.warnings.insert(
        found.result.warnings.begin(),
        axis.sources +
            ": too little acceleration for the mass; friction is that of the constant speeds (method jog)");
    return found;
  } catch (const ident::Refused&) {
    return std::nullopt;
  } catch (const io::InputError&) {
    return std::nullopt;
  }
}

/// The method that suits the motion.
Identification by_motion(const IdentifyOptions& o, const AxisRecords& axis, Depth depth) {
  if (ident::methods::held_at_standstill(axis.records)) {
    check_auto(o, Method::kPositionMap, "the axis is held at standstill");
    return by_position(o, axis, true);
  }
  if (steady_speeds(axis.records, axis.runs)) {
    check_auto(o, Method::kJog, "runs of constant speed");
    return by_jog(o, axis.records);
  }
  if (axis.one_direction) {
    check_auto(o, Method::kPositionMap, "the axis moves in one direction only");
    Identification found = by_position(o, axis, false);
    found.result.warnings.insert(
        found.result.warnings.begin(),
        "one direction only: mass, and friction of that direction including any load; add the motion back for the rest");
    return found;
  }
  Identification found = by_drive_fit(o, axis, depth);
  if (mass_is_determined(found.result)) return found;
  std::optional<Identification> friction = friction_alone(o, axis);
  return friction ? std::move(*friction) : std::move(found);
}

Identification by_method(const IdentifyOptions& o, const AxisRecords& axis, Depth depth) {
  const Records& records = axis.records;
  switch (o.method) {
    case Method::kVelocityMap:
      return by_velocity(o, records);
    case Method::kPositionMap:
      return by_position(o, axis, ident::methods::held_at_standstill(records));
    case Method::kJog:
      return by_jog(o, records);
    case Method::kLeastSquaresA:
      return by_least_squares(o, records);
    case Method::kIdimLs:
      return by_idim_ls(o, records);
    case Method::kBreakAway:
      return by_break_away(o, records);
    case Method::kGravity:
      return {ident::methods::identify_gravity(records)};
    case Method::kConstantAcceleration:
      return {ident::methods::identify_constant_acceleration(records)};
    case Method::kAuto:
      break;
  }
  return by_motion(o, axis, depth);
}

/// Constant speeds, standstill and ramps do not determine the mass; the result says so.
bool tells_mass(Method method) {
  return method != Method::kJog && method != Method::kPositionMap && method != Method::kBreakAway &&
         method != Method::kGravity;
}

/// A unit that is off by a thousand makes a mass that few machines have.
void doubt_size(ident::Result& r) {
  constexpr double kLightest = 1e-3, kHeaviest = 150e3;  // [kg]
  if (r.rotary || r.position_unit != "m" || r.force_unit != "N" || !std::isfinite(r.mass)) return;
  if (r.mass > kLightest && r.mass < kHeaviest) return;
  r.warnings.insert(
      r.warnings.begin(),
      fmt::format(
          "a mass of {} kg is one that few machines have: check --gain (N/A for N/mA?), --lead and the "
          "units of the columns",
          ident::digits(r.mass)));
}

}  // namespace

void check_options(const IdentifyOptions& options) {
  check_taken(options, options.method, "--method " + std::string(enum_name(options.method)));
}

Identification identify(const AxisRecords& axis, const IdentifyOptions& options) {
  check_options(options);
  Identification found = diagnosed(axis, [&options](const AxisRecords& records, Depth depth) {
    return by_method(options, records, depth);
  });
  ident::Result& result = found.result;
  if (!axis.irregular.empty() && !found.holding_only)
    throw ident::Refused(
        axis.irregular +
        ": the rows were taken at irregular times, so that neither speeds nor accelerations are known; only force over position at "
        "rest could be told (record with a fixed period, or with the times at which the rows were taken; leave this log out where there "
        "are others)");
  if (!axis.commanded.empty())
    result.cannot_tell.push_back(
        "mass and friction of the axis: in " + axis.commanded +
        " the position is the command, so that all numbers and their intervals are those of an axis that follows its command exactly; "
        "record the position of the encoder");
  result.rotary = axis.rotary;
  if (tells_mass(result.method) || std::isfinite(result.mass)) require_determined(result, axis.sources);
  doubt_size(result);
  if (!axis.encoders.empty()) found.lost_motion = ident::lost_motion::identify(axis.encoders);
  std::vector<std::string> logs;
  for (const ident::log::Record& r : axis.records) logs.push_back(r.source);
  result.warnings = report::said_once(result.warnings, logs);
  result.warnings.insert(result.warnings.begin(), axis.notes.begin(), axis.notes.end());
  return found;
}

namespace {

/// Whether friction opposes the motion: with the wrong sign of the force it would drive it.
bool takes_energy(const ident::Result& result) {
  double work = 0.0;
  for (const ident::CurvePoint& p : result.curve) work += p.velocity * p.friction;
  return work > 0.0;
}

}  // namespace

void require_determined(const ident::Result& result, const std::string& source) {
  const bool metres = result.position_unit == "m";
  const bool mass = metres && result.force_unit == "N";
  const double scale = metres && !mass ? 1e-3 : 1.0;
  const std::string unit = mass     ? std::string(result.rotary ? "kg m2" : "kg")
                           : metres ? result.force_unit + " s2/mm"
                                    : result.force_unit + " s2/" + result.position_unit;
  if (!std::isfinite(result.mass)) {
    throw ident::Refused(
        fmt::format("{}: these data do not give a mass: force and motion do not belong together", source));
  }
  if (!(result.mass > 0.0) && takes_energy(result)) {
    throw ident::Refused(fmt::format(
        "{}: the mass comes out as {:.4g} {}, expected above 0; the sign of the force is right, as friction opposes the motion: a "
        "force that changes with position (a spring or balance, the unbalance of an axis that turns) looks like a mass on one "
        "sine; add constant-acceleration or jogs to the same call",
        source, scale * result.mass, unit));
  }
  if (!(result.mass > 0.0)) {
    throw ident::Refused(
        fmt::format("{}: the mass comes out as {:.4g} {}, expected above 0: force and motion have "
                    "opposite signs, or columns are exchanged (see --map and --gain)",
                    source, scale * result.mass, unit));
  }
  if (!(result.mass_interval.low > 0.0)) {
    throw ident::Refused(fmt::format(
        "{}: the mass is not determined, {:.4g} {} with a 95 % interval from {:.4g} to {:.4g}: the log "
        "has too little acceleration (add a log of pulses), a force that changes with position (spring, cable chain, balance) looks like a mass "
        "in it (add strokes at constant speed over the travel), the time shift between force and motion is not known (record the "
        "commanded position too, or give --force-shift), or its columns are not the quantities that their names say",
        source, scale * result.mass, unit, scale * result.mass_interval.low,
        scale * result.mass_interval.high));
  }
  for (const ident::CurvePoint& p : result.curve) {
    if (!std::isfinite(p.friction))
      throw ident::Refused(fmt::format("{}: these data do not give any friction", source));
  }
}

}  // namespace stribeck::workflow
