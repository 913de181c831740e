#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include <stribeck/friction/unbalance.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/judge/diagnosis.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <utility>

namespace stribeck::workflow {

using ident::excitation::ExcitationMethod;

ident::excitation::Excitation design(const sim::Machine& machine, std::size_t axis,
                                     ident::excitation::ExcitationMethod method, int periods,
                                     const std::optional<ident::excitation::RoughDrive>& known) {
  const sim::MachineAxis& a = machine.axes[axis].second;
  const ident::excitation::Limits limits{a.limits.travel_min,   a.limits.travel_max, a.limits.speed,
                                         a.limits.acceleration, a.force_limit(),     a.rotary};
  const sim::Commissioning& c = a.commissioning;
  if (method == ExcitationMethod::kPulses) {
    ident::excitation::PulseDesign pulses;
    pulses.start = 0.5 * (limits.travel_min + limits.travel_max);
    return ident::excitation::design_pulses(
        limits, known.value_or(ident::excitation::RoughDrive{c.mass, c.friction, 0.0}), machine.sample_time,
        pulses);
  }
  if (method == ExcitationMethod::kJog) {
    ident::excitation::JogDesign jog;
    jog.start = 0.5 * (limits.travel_min + limits.travel_max);
    jog.speeds =
        ident::excitation::jog_speeds(ident::excitation::fastest_jog(limits, machine.sample_time, jog));
    return ident::excitation::design_jog(limits, machine.sample_time, jog);
  }
  if (method == ExcitationMethod::kConstantAcceleration) {
    const double middle = 0.5 * (limits.travel_min + limits.travel_max);
    return ident::excitation::design_constant_acceleration(
        limits, machine.sample_time,
        ident::excitation::acceleration_design(limits, middle, c.mass, c.friction));
  }
  if (method == ExcitationMethod::kPositionSine) {
    ident::excitation::SineDesign sine{c.sine_offset, c.sine_amplitude, c.sine_frequency, periods};
    sine.from_middle = true;
    return ident::excitation::design_sine(limits, machine.sample_time, sine);
  }
  return ident::excitation::design_sine(
      limits, machine.sample_time,
      {c.sine_offset + c.sine_amplitude, c.sine_amplitude, c.sine_frequency, periods});
}

sim::Recording play(const sim::Machine& machine, std::size_t axis, const std::vector<double>& reference,
                    const std::vector<double>& force, std::uint64_t seed) {
  const sim::MachineAxis& a = machine.axes[axis].second;
  const double middle = 0.5 * (a.limits.travel_min + a.limits.travel_max);
  sim::Recording recording = reference.empty() ? sim::record_open_loop(machine, axis, force, middle, seed)
                                               : sim::record_closed_loop(machine, axis, reference, seed);
  recording.rotary = a.rotary;
  return recording;
}

io::Log as_log(const sim::Recording& recording) {
  io::Log log;
  log.rows = recording.t.size();
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& si, double scale) {
    if (si.empty()) return;
    io::Column column{name, unit, {}};
    column.values.reserve(si.size());
    for (const double v : si) column.values.push_back(v / scale);
    log.columns.push_back(std::move(column));
  };
  add("t", "s", recording.t, 1.0);
  add("r", "mm", recording.r, 1e-3);
  add("x", "mm", recording.x, 1e-3);
  add("motor", "mm", recording.motor, 1e-3);
  add("scale", "mm", recording.scale, 1e-3);
  add("u", "V", recording.u, 1.0);
  add("f", "N", recording.f, 1.0);
  if (recording.rotary) log.metadata.emplace_back(kRotaryKey, kRotaryAsLinear);
  return log;
}

ident::log::Record as_record(const sim::Recording& recording, const std::string& source) {
  ident::log::Record record;
  record.source = source;
  record.sample_time = recording.period;
  record.t = recording.t;
  record.r = recording.r;
  record.x = recording.x;
  record.f = recording.f;
  record.rotary = recording.rotary;
  record.loop = recording.r.empty() ? ident::log::Loop::kOpen : ident::log::Loop::kClosed;
  return record;
}

void fill_in(sim::AxisKnowledge& knowledge, const sim::MachineAxis& axis) {
  const friction::AxisModel* const best = knowledge.best();
  if (best == nullptr) return;
  const friction::AxisModel given = *best;
  for (auto* model : {&knowledge.gaussian, &knowledge.eccentric, &knowledge.whole}) {
    if (!*model) *model = given;
  }
  if (knowledge.conventional) return;
  knowledge.conventional = given;
  friction::Model& own = knowledge.conventional->friction;
  own = sim::straightened(given.friction, axis.limits.speed);
  if (std::holds_alternative<friction::Conventional<double>>(given.friction.steady))
    own.steady = given.friction.steady;
}

const ident::Result* CommissionedAxis::find(std::string_view kind) const {
  for (const CommissionedModel& m : models) {
    if (m.kind == kind) return &m.result;
  }
  return nullptr;
}

Needs Needs::of(const std::vector<sim::ControllerSpec>& controllers) {
  Needs n;
  using enum sim::FrictionUse;
  for (const sim::ControllerSpec& c : controllers) {
    n.conventional = n.conventional || c.friction == kConventional || c.friction == kViscous;
    n.gaussian = n.gaussian || c.friction == kGaussian;
    n.eccentric = n.eccentric || c.friction == kEccentric || c.friction == kNominal;
    n.whole = n.whole || c.friction == kWhole;
  }
  // A controller without friction compensation also needs a mass.
  n.mass_alone = !n.conventional && !n.gaussian && !n.eccentric && !n.whole;
  if (n.mass_alone) n.conventional = true;
  return n;
}

namespace {

/// A machine of one's own with a control of at least half a millisecond, delays the same in time: jogs of minutes at 62 us are millions of
/// rows that tell no more. Absent where it has such a period.
std::optional<sim::Machine> slower_control(const sim::Machine& machine) {
  constexpr double kLeast = 0.5e-3;  // [s]
  if (is_of_thesis(machine) || machine.sample_time >= kLeast * (1.0 - 1e-6)) return {};
  sim::Machine slower = machine;
  slower.sample_time *= std::ceil(kLeast / machine.sample_time * (1.0 - 1e-9));
  for (auto& [name, axis] : slower.axes) {
    plant::AxisParams& p = axis.plant;
    if (p.drive_loop && p.delay_periods == 0) continue;
    const double delay =
        machine.sample_time * (p.delay_periods + p.delay_fraction.value_or(0.0)) / slower.sample_time;
    p.delay_periods = static_cast<int>(std::floor(delay));
    p.delay_fraction.reset();
    if (const double rest = delay - p.delay_periods; rest > 1e-6 && !p.drive_loop) p.delay_fraction = rest;
  }
  return slower;
}

/// What a jog in closed loop tells of an axis: half the sum and half the difference of its force in both directions. Of a rotary
/// axis, whose weight follows the angle, the largest of these sums.
struct Held {
  double load = 0.0;      ///< [N]
  double friction = 0.0;  ///< [N]

  /// A force that ends lets the axis run away, or nearly so.
  [[nodiscard]] bool falls() const { return std::abs(load) >= 0.5 * friction; }
};

Held held_by_place(const sim::Recording& log, double step) {
  constexpr int kPlaces = 12;
  const auto [low, high] = std::minmax_element(log.r.begin(), log.r.end());
  struct Place {
    std::array<double, 2> sum{}, rows{};
  };
  std::array<Place, kPlaces> places{};
  for (std::size_t k = 0; k + 1 < log.r.size(); ++k) {
    const double moved = log.r[k + 1] - log.r[k];
    if (std::abs(moved) < step) continue;
    const int at = std::min(kPlaces - 1, static_cast<int>(kPlaces * (log.r[k] - *low) / (*high - *low)));
    Place& place = places[static_cast<std::size_t>(at)];
    place.sum[moved > 0.0] += log.f[k];
    place.rows[moved > 0.0] += 1.0;
  }
  Held held;
  double friction = 0.0, counted = 0.0;
  for (const Place& p : places) {
    if (p.rows[0] == 0.0 || p.rows[1] == 0.0) continue;
    const double up = p.sum[1] / p.rows[1], down = p.sum[0] / p.rows[0];
    held.load = std::max(held.load, 0.5 * std::abs(up + down));
    friction += 0.5 * std::abs(up - down);
    counted += 1.0;
  }
  held.friction = counted > 0.0 ? friction / counted : 0.0;
  return held;
}

Held hold(const sim::Machine& machine, std::size_t axis, std::uint64_t seed) {
  const sim::AxisLimits& l = machine.axes[axis].second.limits;
  const ident::excitation::Limits limits{l.travel_min,
                                         l.travel_max,
                                         l.speed,
                                         l.acceleration,
                                         machine.axes[axis].second.force_limit(),
                                         machine.axes[axis].second.rotary};
  ident::excitation::JogDesign jog;
  jog.start = 0.5 * (limits.travel_min + limits.travel_max);
  const double fastest = ident::excitation::fastest_jog(limits, machine.sample_time, jog);
  const bool rotary = machine.axes[axis].second.rotary;
  jog.speeds = {rotary ? fastest : 0.1 * fastest};
  const auto e = ident::excitation::design_jog(limits, machine.sample_time, jog);
  const sim::Recording log = play(machine, axis, e.r, {}, seed);
  if (rotary) return held_by_place(log, 0.999 * jog.speeds.front() * machine.sample_time);
  double sum[2] = {0.0, 0.0};
  double rows[2] = {0.0, 0.0};
  const double step = 0.999 * jog.speeds.front() * machine.sample_time;
  for (std::size_t k = 0; k + 1 < log.r.size(); ++k) {
    const double moved = log.r[k + 1] - log.r[k];
    if (std::abs(moved) < step) continue;
    sum[moved > 0.0] += log.f[k];
    rows[moved > 0.0] += 1.0;
  }
  const double up = sum[1] / rows[1];
  const double down = sum[0] / rows[0];
  return {0.5 * (up + down), 0.5 * std::abs(up - down)};
}

/// Whether one step of the encoder in one period exceeds a small share of the speed limit: the methods of the thesis take the
/// difference of neighbouring rows for the speed, and find nothing then.
bool coarse_encoder(const sim::Machine& machine, std::size_t axis) {
  constexpr double kCounts = 0.02;
  const sim::MachineAxis& a = machine.axes[axis].second;
  return a.plant.encoder.resolution / machine.sample_time > kCounts * a.limits.speed;
}

/// The record with control periods put together to at least a millisecond. The method of the thesis takes acceleration from second
/// differences, in which the step of the encoder grows with the square of the rate: at 31 us it hid three quarters of the mass.
ident::log::Record put_together(const ident::log::Record& r) {
  constexpr double kLeast = 1e-3;  // [s]
  const auto group = static_cast<std::size_t>(std::ceil(kLeast / r.sample_time * (1.0 - 1e-9)));
  if (group < 2) return r;
  ident::log::Record out = r;
  out.sample_time = r.sample_time * static_cast<double>(group);
  for (std::vector<double>* column : {&out.t, &out.r, &out.x, &out.f, &out.v}) column->clear();
  for (std::size_t k = 0; k + group <= r.t.size(); k += group) {
    out.t.push_back(r.t[k]);
    if (!r.r.empty()) out.r.push_back(r.r[k]);
    out.x.push_back(r.x[k]);
    double force = 0.0;  // each is held for a period
    for (std::size_t i = k; i < k + group; ++i) force += r.f[i] / static_cast<double>(group);
    out.f.push_back(force);
  }
  return out;
}

/// A model by jogs: map with or without Gaussians, mass and load of the `whole` model, which other logs tell.
ident::Result jogged(const std::vector<ident::log::Record>& jogs, const ident::Result& whole,
                     bool gaussians) {
  ident::methods::JogOptions options;
  options.gaussians = gaussians;
  options.mass = whole.mass;
  ident::Result result = ident::methods::identify_jog(jogs, options).result;
  // By direction, jogs cannot separate a load from friction; the other logs can. The total force stays the same.
  if (auto* map = std::get_if<friction::Gaussian<double>>(&result.friction.steady);
      map != nullptr && result.load == 0.0) {
    map->positive.eta0 -= whole.load;
    map->negative.eta0 -= whole.load;
    result.load = whole.load;
  }
  return result;
}

/// The whole drive, with the unbalance or the spring that the records show, see judge/diagnosis.hpp.
ident::Result whole_drive(const std::vector<ident::log::Record>& records,
                          std::optional<double> mass = std::nullopt) {
  AxisRecords axis;
  axis.records = records;
  axis.rotary = records.front().rotary;
  return diagnosed(axis,
                   [&](const AxisRecords& a, Depth depth) {
                     ident::drive::DriveFitOptions options;
                     options.mass = mass;
                     options.dynamics = depth == Depth::kWhole;
                     Identification found;
                     found.result = ident::drive::identify_drive(a.records, options);
                     return found;
                   })
      .result;
}

/// The records without the unbalance and the spring that the whole drive has shown: jogs by direction would take them for friction.
std::vector<ident::log::Record> balanced(std::vector<ident::log::Record> records,
                                         const ident::Result& whole) {
  if (const auto& spring = whole.friction.spring) {
    for (ident::log::Record& r : records) {
      for (std::size_t k = 0; k < r.f.size(); ++k) r.f[k] -= spring->at(r.x[k]);
    }
  }
  for (const auto& term : whole.friction.eccentric) {
    if (!friction::is_unbalance(term)) continue;
    for (ident::log::Record& r : records) {
      for (std::size_t k = 0; k < r.f.size(); ++k) r.f[k] -= term.amplitude * std::sin(r.x[k] - term.phase);
    }
  }
  return records;
}

/// A result whose model has, of what depends on the position, the unbalance and the spring of the whole drive, which are no friction;
/// with keep_others also its own terms.
ident::Result with_balance(ident::Result result, const ident::Result& whole, bool keep_others) {
  if (!keep_others) result.friction.eccentric = {};
  result.friction.spring = whole.friction.spring;
  for (const auto& term : whole.friction.eccentric) {
    if (friction::is_unbalance(term)) result.friction.eccentric.push_back(term);
  }
  return result;
}

/// One axis while its logs are recorded and its models identified.
class Run {
 public:
  Run(const sim::Machine& machine, std::size_t axis, const Needs& needs, std::uint64_t seed)
      : machine_(machine), axis_(axis), needs_(needs), seed_(seed) {}

  CommissionedAxis in_closed_loop();
  /// From both encoders, where the axis has two and the loop closes over the motor.
  void find_lost_motion(CommissionedAxis& out);
  CommissionedAxis by_pulses();

 private:
  CommissionedAxis by_pulses_and_jogs();
  using Records = std::vector<ident::log::Record>;

  ident::log::Record add(ExcitationMethod method, int periods = 0,
                         const std::optional<ident::excitation::RoughDrive>& known = {}) {
    const ident::excitation::Excitation e = design(machine_, axis_, method, periods, known);
    out_.logs.push_back({fmt::format("{}-{}.csv", machine_.axes[axis_].first, enum_name(e.method)), e.method,
                         play(machine_, axis_, e.r, e.force, seed_)});
    return as_record(out_.logs.back().recording, out_.logs.back().file);
  }
  friction::AxisModel keep(const char* kind, const Records& records, const ident::Result& result) {
    CommissionedModel m{kind, {}, result};
    m.result.rotary = records.front().rotary;
    for (const ident::log::Record& r : records) m.sources.push_back(r.source);
    require_determined(result, records.front().source);
    out_.models.push_back(std::move(m));
    return as_model(result);
  }
  /// Jogs are recorded once.
  const ident::log::Record& jogs() {
    if (!jogs_) jogs_ = add(ExcitationMethod::kJog);
    return *jogs_;
  }
  ident::log::Record pulses();
  /// The whole drive in place of every kind of model, as on a machine that was identified from its own logs.
  CommissionedAxis alone(const Records& records, const ident::Result& whole);
  const sim::Machine& machine_;
  std::size_t axis_;
  const Needs& needs_;
  std::uint64_t seed_;
  CommissionedAxis out_;
  std::optional<ident::log::Record> jogs_;
};

/// The first run only tells the forces for the second one, which then covers the permitted speeds of the axis.
ident::log::Record Run::pulses() {
  const ident::excitation::Excitation first = design(machine_, axis_, ExcitationMethod::kPulses, 0);
  const ident::log::Record tried = as_record(play(machine_, axis_, first.r, first.force, seed_),
                                             machine_.axes[axis_].first + ", first pulses");
  return add(
      ExcitationMethod::kPulses, 0,
      ident::excitation::rough_drive(ident::methods::identify_least_squares_a({put_together(tried)}).result));
}

/// Jogs for friction, triangles of speed for the mass.
CommissionedAxis Run::in_closed_loop() {
  const ident::log::Record turns = add(ExcitationMethod::kPositionSine, kPositionPeriods);
  jogs();
  const ident::log::Record triangles = add(ExcitationMethod::kConstantAcceleration);
  ident::Result whole = whole_drive({triangles, turns, jogs()});
  if (!(whole.mass_interval.low > 0.0)) {
    // A light axis with much friction: no motion within its limits has enough inertia. What is known roughly serves the compensators.
    const auto& [name, a] = machine_.axes[axis_];
    const double known = a.commissioning.mass;
    whole = whole_drive({triangles, turns, jogs()}, known);
    out_.assumed.push_back(fmt::format(
        "axis {}: the mass could not be identified: within the limits of this axis the force of inertia is small compared with friction. "
        "The rough mass of the machine file, {:.4g} {}, is used instead",
        name, known, a.rotary ? "kg m2" : "kg"));
  }
  if (!is_of_thesis(machine_)) return alone({triangles, turns, jogs()}, whole);
  sim::AxisKnowledge& knows = out_.knowledge;
  knows.eccentric = keep("eccentric", {triangles, turns, jogs()}, whole);
  knows.whole = knows.eccentric;
  const Records steady = balanced({jogs()}, whole);
  if (needs_.conventional)
    knows.conventional = keep("conventional", {jogs(), triangles, turns},
                              with_balance(jogged(steady, whole, false), whole, false));
  if (needs_.gaussian)
    knows.gaussian =
        keep("gaussian", {jogs(), triangles, turns}, with_balance(jogged(steady, whole, true), whole, true));
  return std::move(out_);
}

CommissionedAxis Run::alone(const Records& records, const ident::Result& whole) {
  out_.knowledge.whole = keep("whole", records, whole);
  fill_in(out_.knowledge, machine_.axes[axis_].second);
  return std::move(out_);
}

/// Pulses for mass and bristles, jogs for friction at every speed.
CommissionedAxis Run::by_pulses_and_jogs() {
  const Records records{pulses(), add(ExcitationMethod::kSine, kSinePeriods), jogs()};
  return alone(records, whole_drive(records));
}

CommissionedAxis Run::by_pulses() {
  if (!is_of_thesis(machine_)) return by_pulses_and_jogs();
  const ident::log::Record strong = pulses();
  sim::AxisKnowledge& knows = out_.knowledge;
  // As in the thesis: Table 2.1 from pulses on one and two axes, Table 4.2 from jogs on the machine tool. The choice depends on the
  // machine, not on other requests.
  const bool by_jogs = machine_.axes.size() > 2;
  if (needs_.eccentric || (by_jogs && (needs_.conventional || needs_.whole))) {
    // With bristles and the sine in the fit, pulses determine the mass; without them it is some per cent too low.
    const Records records{strong, add(ExcitationMethod::kPositionSine, kPositionPeriods)};
    const ident::log::Record& turns = records.back();
    const ident::Result whole = whole_drive(records);
    knows.eccentric = keep("eccentric", records, whole);
    if (by_jogs) knows.whole = knows.eccentric;
    if (needs_.conventional && by_jogs) {
      knows.conventional = keep("conventional", {jogs(), strong, turns}, jogged({jogs()}, whole, false));
      // (2.9) has no term periodic in position. The fit of the jogs finds one, however, and is better with it.
      knows.conventional->friction.eccentric = {};
    }
  }
  if (needs_.conventional && !by_jogs) {
    knows.conventional = keep("conventional", {strong},
                              ident::methods::identify_least_squares_a({put_together(strong)}).result);
  }
  if (needs_.gaussian || (needs_.whole && !by_jogs)) {
    const Records records{strong, add(ExcitationMethod::kSine, kSinePeriods)};
    if (needs_.gaussian)
      knows.gaussian = keep("gaussian", records, ident::methods::identify_velocity_map(records));
    if (needs_.whole && !by_jogs) knows.whole = keep("whole", records, whole_drive(records));
  }
  return std::move(out_);
}

void Run::find_lost_motion(CommissionedAxis& out) {
  const plant::AxisParams& truth = machine_.axes[axis_].second.plant;
  if (!truth.second_encoder || truth.encoder.side == plant::EncoderSide::kTable) return;
  const auto sine = [](const CommissionedLog& log) {
    return log.method == ExcitationMethod::kSine || log.method == ExcitationMethod::kPositionSine;
  };
  if (std::none_of(out.logs.begin(), out.logs.end(), sine)) {
    out_ = std::move(out);
    add(ExcitationMethod::kSine, kSinePeriods);
    out = std::move(out_);
  }
  const sim::Recording& log = std::find_if(out.logs.begin(), out.logs.end(), sine)->recording;
  out.lost_motion = ident::lost_motion::identify({{log.period, log.x, log.scale, log.f}});
  out.knowledge.lost_motion =
      lost_motion_of(*out.lost_motion, out.knowledge.model(sim::FrictionUse::kNone, {}).mass);
}

}  // namespace

CommissionedAxis commission_axis(const sim::Machine& machine, std::size_t axis, const Needs& needs,
                                 std::uint64_t seed) {
  if (const auto slower = slower_control(machine)) return commission_axis(*slower, axis, needs, seed);
  try {
    Run run(machine, axis, needs, seed);
    // Where the drive takes no force, or forces in open loop would let the axis fall or a spring would pull it back, or the methods for
    // open loop do not suit the encoder, everything is recorded in closed loop.
    const plant::AxisParams& truth = machine.axes[axis].second.plant;
    const bool closed = truth.drive_loop || truth.friction.spring || coarse_encoder(machine, axis) ||
                        hold(machine, axis, seed).falls();
    if (!closed) {
      try {
        CommissionedAxis out = run.by_pulses();
        run.find_lost_motion(out);
        return out;
      } catch (const ident::Refused&) {
        // Pulses that do not move this axis enough, or not safely, are no reason to refuse it: closed loop moves it in any case.
      }
    }
    Run anew(machine, axis, needs, seed);
    CommissionedAxis out = anew.in_closed_loop();
    anew.find_lost_motion(out);
    return out;
  } catch (const ident::Refused& e) {
    throw ident::Refused(fmt::format("axis {}: {}", machine.axes[axis].first, e.what()));
  }
}

}  // namespace stribeck::workflow
