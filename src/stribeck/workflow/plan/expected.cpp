#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/plan/expected.hpp>

namespace stribeck::workflow {
namespace {

using ident::excitation::ExcitationMethod;

constexpr double kInfinite = ExpectedHalf::kOpen;
constexpr std::uint64_t kNoiseSeed = 1;
/// Half widths that are narrow enough: 2 % of mass, 3 % of friction, 20 % of the break-away distance, a fifth of a period.
constexpr std::array<double, kWantedCount> kGood{0.02, 0.03, 0.2, 0.2};
/// The curve must reach from this share of the speed limit to that one, or the fast or slow end is not determined.
constexpr double kSlowShare = 0.1;
constexpr double kFastShare = 0.5;

/// One direction of the friction that is assumed: it rises below a hundredth of the speed limit, has a hill in the middle, and grows
/// with speed.
friction::GaussianBranch<double> usual_branch(double level, double speed) {
  constexpr double kRise = 0.2;
  constexpr double kHill = 0.06;
  constexpr double kViscous = 0.3;
  friction::GaussianBranch<double> branch;
  branch.eta0 = level;
  branch.eta1 = kViscous * std::abs(level) / speed;
  branch.gaussians.push_back({kRise * level, 0.0, 0.01 * speed});
  branch.gaussians.push_back({kHill * level, std::copysign(0.4 * speed, level), 0.15 * speed});
  return branch;
}

sim::AxisFile rough_model(const AxisDescription& axis) {
  constexpr double kUneven = 0.08;  // of both directions
  constexpr double kScrew = 0.03;
  constexpr double kTurns = 30.0;  // over the travel, where the data sheet names no turn
  constexpr double kSteps = 4.0;
  constexpr double kDamping = 0.1;  // ratio, of the mass on the bristles
  const double level = axis.commissioning.friction.middle();
  const double speed = axis.limits.speed;
  friction::Gaussian<double> map;
  map.positive = usual_branch((1.0 + kUneven) * level, speed);
  map.negative = usual_branch(-(1.0 - kUneven) * level, speed);
  map.velocity_range = {-speed, speed};
  friction::LuGre<double> bristles;
  bristles.sigma0 = level / std::max(kBreakAway, kSteps * axis.name_plate().encoder_resolution);
  bristles.sigma1 = 2.0 * kDamping * std::sqrt(bristles.sigma0 * axis.commissioning.mass.middle());
  bristles.damping_velocity = 1e-3 * speed;
  const std::optional<double> radius = axis.drive ? axis.drive->radius() : std::nullopt;
  const double turn = radius ? 2.0 * kPi * axis.drive->gear * *radius
                             : (axis.limits.travel_max - axis.limits.travel_min) / kTurns;
  sim::AxisFile file;
  file.model.mass = axis.commissioning.mass.middle();
  file.model.load = axis.commissioning.load_force();
  file.model.friction.steady = map;
  file.model.friction.dynamics = bristles;
  file.model.friction.eccentric.push_back({kScrew * level, turn, 0.5});
  return file;
}

double half_of(const ident::Parameter* p, double unit) {
  if (p == nullptr || !p->identifiable) return kInfinite;
  const double half = 0.5 * (p->ci_high - p->ci_low) / unit;
  return std::isfinite(half) ? half : kInfinite;
}

/// The median of the half widths over the curve, if it reaches from slow to fast.
double half_of_curve(const ident::Result& r, double speed) {
  std::vector<double> halves;
  double slowest = kInfinite;
  double fastest[2] = {0.0, 0.0};
  for (const ident::CurvePoint& p : r.curve) {
    const double v = std::abs(p.velocity);
    if (v == 0.0 || p.friction == 0.0) continue;
    slowest = std::min(slowest, v);
    double& end = fastest[p.velocity > 0.0 ? 1 : 0];
    end = std::max(end, v);
    halves.push_back(0.5 * (p.ci_high - p.ci_low) / std::abs(p.friction));
  }
  if (halves.empty() || slowest > kSlowShare * speed || std::min(fastest[0], fastest[1]) < kFastShare * speed)
    return kInfinite;
  const auto middle = halves.begin() + static_cast<std::ptrdiff_t>(halves.size() / 2);
  std::nth_element(halves.begin(), middle, halves.end());
  return std::isfinite(*middle) ? *middle : kInfinite;
}

}  // namespace

ExpectedHalf told_by(const Identification& found, const AxisDescription& axis, double period) {
  const ident::Result& r = found.result;
  ExpectedHalf out;
  const double mass = 0.5 * (r.mass_interval.high - r.mass_interval.low) / r.mass;
  if (r.mass > 0.0 && std::isfinite(mass)) out[Wanted::kMass] = mass;
  const auto open = [&](const char* name) {
    const ident::Parameter* p = r.find(name);
    return p != nullptr && !p->identifiable;
  };
  out[Wanted::kFriction] = half_of_curve(r, axis.limits.speed);
  out.at_rest = !open("static_positive") && !open("static_negative");
  if (const ident::Parameter* p = r.find("break_away_distance"))
    out[Wanted::kBristles] = half_of(p, std::abs(p->value));
  out[Wanted::kDelay] = half_of(r.find("force_shift"), period);
  return out;
}

std::vector<Wanted> not_yet(const Identification& found, const AxisDescription& axis, double period) {
  const ExpectedHalf told = told_by(found, axis, period);
  std::vector<Wanted> open;
  for (const Wanted w : {Wanted::kMass, Wanted::kFriction, Wanted::kBristles}) {
    if (w == Wanted::kBristles && found.result.bristles_too_fine) continue;
    if (!told.good(w)) open.push_back(w);
  }
  return open;
}

bool ExpectedHalf::good(Wanted w) const { return (*this)[w] <= kGood[static_cast<std::size_t>(w)]; }

StandIn::StandIn(const MachineDescription& machine, const std::string& file, std::size_t axis,
                 const std::string& known)
    : machine_(machine), real_(machine), axis_(axis), known_(known) {
  auto& [name, a] = machine_.axes[axis];
  sim::AxisFile model = known.empty() ? rough_model(a) : read_axis_file(known);
  constexpr double kDelay = 1.5;  // [periods]: how well a delay would be told shows where there is one
  if (!(model.model.delay_or_none() > 0.0)) model.model.delay = kDelay * machine.sample_time;
  plant::AxisParams plant =
      model_as_truth(a, name, machine.sample_time, file, known.empty() ? file : known, model);
  constexpr double kNoise = 0.02;  // of friction
  constexpr double kCorrelation = 0.02;
  constexpr double kWhere = 0.1;  // of the speed limit: where friction counts for it
  const double level = model.model.friction.parts(kWhere * a.limits.speed, 0.0).level;
  plant.noise = plant::ForceNoise{kNoise * level, kCorrelation};
  a.plant = plant;
}

std::vector<CandidateLog> StandIn::logs_of(std::span<const ExcitationMethod> methods, double longest,
                                           const Progress& progress) {
  std::vector<std::pair<CandidateLog, ident::log::Record>> logs(methods.size());
  sim::parallel_for(
      methods.size(), 0, [] { return 0; }, [&](int, std::size_t i) { logs[i] = log_of(methods[i], longest); },
      progress);
  std::vector<CandidateLog> out;
  for (auto& [log, record] : logs) {
    if (!record.t.empty()) records_[log.method] = std::move(record);
    out.push_back(std::move(log));
  }
  return out;
}

std::pair<CandidateLog, ident::log::Record> StandIn::log_of(ExcitationMethod method, double longest) const {
  CandidateLog out;
  ident::log::Record record;
  out.method = method;
  try {
    ExcitationOptions options;
    options.method = method;
    if (method == ExcitationMethod::kPulses) options.known = known_;
    const ident::excitation::Excitation e = make_excitation(options, real_, axis_).excitation;
    out.duration = e.t.back();
    if (out.duration > longest) {
      out.refused = fmt::format("{:.0f} s of motion, more than there is time for", out.duration);
      return {out, record};
    }
    const sim::Recording played = play(as_machine(machine_), axis_, e.r, e.force, kNoiseSeed);
    record = as_record(played, std::string(enum_name(method)));
    out.expected = told_together({&record});
  } catch (const ident::Refused& why) {
    out.refused = why.what();
  } catch (const sim::Refused& why) {
    out.refused = why.what();
  } catch (const io::InputError& why) {
    out.refused = why.problems().front().message;
  }
  return {std::move(out), std::move(record)};
}

ExpectedHalf StandIn::together(const std::vector<ExcitationMethod>& methods) const {
  std::vector<const ident::log::Record*> records;
  for (const ExcitationMethod m : methods) {
    const auto found = records_.find(m);
    if (found == records_.end()) return {};
    records.push_back(&found->second);
  }
  return told_together(records);
}

ExpectedHalf StandIn::told_together(const std::vector<const ident::log::Record*>& records) const {
  AxisRecords axis;
  for (const ident::log::Record* r : records) axis.records.push_back(*r);
  axis.runs = axis.records.size();
  axis.axis = machine_.axes[axis_].first;
  axis.sources = "logs of the plan";
  try {
    return told_by(identify(axis, {}), machine_.axes[axis_].second, machine_.sample_time);
  } catch (const ident::Refused&) {
    return {};
  }
}

}  // namespace stribeck::workflow
