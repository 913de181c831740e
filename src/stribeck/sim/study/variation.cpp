#include <fmt/core.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <cmath>
#include <random>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/sim/contour_run.hpp>
#include <stribeck/sim/study/variation.hpp>

namespace stribeck::sim {
namespace {

/// Random numbers of one axis of one machine.
class Draws {
 public:
  Draws(std::uint64_t seed, std::uint32_t machine, std::uint32_t axis) {
    // The last word separates the stream from that of the force noise (plant/noise.hpp).
    constexpr std::uint32_t kVariation = 0x76617279;
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), machine,
                           axis, kVariation};
    generator_.seed(sequence);
  }

  /// Uniform in [0, 1): 53 random bits, the same on every platform.
  double share() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }
  double within(const std::array<double, 2>& range) { return range[0] + (range[1] - range[0]) * share(); }
  double within_log(const std::array<double, 2>& range) {
    return range[0] * std::pow(range[1] / range[0], share());
  }
  /// 1 ± width.
  double factor(double width) { return 1.0 + width * (2.0 * share() - 1.0); }

 private:
  boost::random::mt19937_64 generator_;
};

/// Mean of both directions [N].
double level_at_rest(const friction::Model& model) {
  constexpr double kAtRest = 1e-12;
  return 0.5 * (model.parts(kAtRest, 0.0).level + model.parts(-kAtRest, 0.0).level);
}

/// The mode of the table. With lost motion, its stiffness makes the mode while it is in contact.
void take_mode(plant::AxisParams& p, const plant::AxialMode& mode) {
  if (!p.lost_motion) {
    p.axial_mode = mode;
    return;
  }
  const double w = 2.0 * kPi * mode.frequency;
  p.lost_motion->table_share = mode.table_share;
  p.lost_motion->damping_ratio = mode.damping_ratio;
  p.lost_motion->stiffness = mode.table_share * p.total_mass() * w * w;
}

[[noreturn]] void refuse(std::string_view key, std::string_view message) {
  throw Refused("variation." + std::string(key) + ": " + std::string(message));
}

void check_fields(const Value& group);

void check_value(const Value& value, const FieldInfo& info) {
  if (value.is_scalar()) {
    const double x = value.number();
    if (info.quantity.permits(x)) return;
    refuse(info.name, fmt::format("got {:.6g}, expected {} {:.6g} and at most {:.6g}", x,
                                  info.quantity.min_excluded ? "above" : "at least", info.quantity.min,
                                  info.quantity.max));
  }
  if (value.kind() == Kind::kGroup) return check_fields(value);
  for (std::size_t i = 0; i < value.size(); ++i) check_value(value[i], info);
}

void check_fields(const Value& group) {
  for_each_member(group, [](const Member& m) { check_value(m.value, m.info); });
  validate(group, [](std::string_view key, std::string_view message) { refuse(key, message); });
}

}  // namespace

Deviation draw(const Variation& variation, std::uint64_t seed, std::uint32_t machine, std::uint32_t axis) {
  Draws draws(seed, machine, axis);
  Deviation d;
  d.friction = draws.factor(variation.friction);
  d.stiffness = draws.factor(variation.stiffness);
  d.mass = draws.factor(variation.mass);
  d.delay = static_cast<int>(draws.share() * (variation.delay + 1));
  d.encoder = draws.within_log({1.0, variation.encoder});
  const AxialModeVariation modes = variation.axial_mode.value_or(AxialModeVariation{});
  const bool has_mode = draws.share() < modes.probability;
  const plant::AxialMode mode{draws.within_log(modes.frequency), draws.within(modes.damping_ratio),
                              draws.within(modes.table_share)};
  if (has_mode && variation.axial_mode) d.axial_mode = mode;
  const double amplitude = variation.periodic * draws.share();
  const PeriodicDeviation periodic{amplitude, draws.within(variation.periodic_period),
                                   2.0 * kPi * draws.share()};
  if (variation.periodic > 0.0) d.periodic = periodic;
  const double fall = variation.warming * draws.share();
  const plant::Warming warming{-fall, draws.within(variation.warming_time)};
  if (variation.warming > 0.0) d.warming = warming;
  return d;
}

plant::AxisParams deviated(const plant::AxisParams& nominal, const Deviation& deviation) {
  plant::AxisParams p = nominal;
  std::visit([&](auto& map) { map = map.scaled(deviation.friction); }, p.friction.steady);
  for (auto& term : p.friction.eccentric) {
    if (term.form == friction::EccentricForm::kProportional) term.amplitude *= deviation.friction;
  }
  std::visit([&](auto& law) { law = law.stiffened(deviation.stiffness); }, p.friction.dynamics);
  p.mass *= deviation.mass;
  if (p.rotor_inertia) *p.rotor_inertia *= deviation.mass;
  p.delay_periods += deviation.delay;
  if (p.delay_periods > 8) throw Refused("variation.delay: with that of the machine above 8 control periods");
  p.encoder.resolution *= deviation.encoder;
  if (deviation.axial_mode) take_mode(p, *deviation.axial_mode);
  if (deviation.periodic) {
    if (p.friction.eccentric.size() == friction::kMaxEccentricTerms)
      throw Refused(
          "variation.periodic: the machine has four periodic terms already, which is the most it can have");
    p.friction.eccentric.push_back({deviation.periodic->share * level_at_rest(p.friction),
                                    deviation.periodic->period, deviation.periodic->phase,
                                    friction::EccentricForm::kAdditive});
  }
  if (deviation.warming) p.warming = deviation.warming;
  return p;
}

namespace {

/// `deviation(i)` is that of axis i. The data on the name plates stay the same, whatever the machine is like.
template <class DeviationOf>
Machine with_deviations(const Machine& nominal, const DeviationOf& deviation) {
  Machine m = nominal;
  for (std::uint32_t i = 0; i < m.axes.size(); ++i) {
    MachineAxis& axis = m.axes[i].second;
    const NamePlate plate = axis.name_plate();
    axis.limits.force = plate.force;
    axis.commissioning.encoder_resolution = plate.encoder_resolution;
    axis.plant = deviated(axis.plant, deviation(i));
  }
  return m;
}

double middle_of_log(const std::array<double, 2>& range) { return std::sqrt(range[0] * range[1]); }

}  // namespace

Machine vary(const Machine& nominal, const Variation& variation, std::uint64_t seed, std::uint32_t machine) {
  check(variation);
  return with_deviations(nominal, [&](std::uint32_t i) { return draw(variation, seed, machine, i); });
}

std::vector<NearbyMachine> nearby_machines(const Machine& nominal) {
  const Variation v;
  std::vector<NearbyMachine> all{{"nominal", nominal}};
  const auto add = [&](std::string name, const Deviation& d) {
    all.push_back({std::move(name), with_deviations(nominal, [&](std::uint32_t) { return d; })});
  };
  const auto scaled = [&](double mass, double friction) {
    Deviation d;
    d.mass = 1.0 + mass * v.mass;
    d.friction = 1.0 + friction * v.friction;
    std::string name;
    const auto say = [&](const char* what, double share) {
      if (share != 0.0) name += fmt::format("{}{} {:+.0f} %", name.empty() ? "" : ", ", what, 100.0 * share);
    };
    say("mass", mass * v.mass);
    say("friction", friction * v.friction);
    add(std::move(name), d);
  };
  for (const double sign : {1.0, -1.0}) {
    scaled(sign, 0.0);
    scaled(0.0, sign);
    scaled(sign, sign);
  }
  const auto every = [&](auto&& can) {
    return std::all_of(nominal.axes.begin(), nominal.axes.end(),
                       [&](const auto& axis) { return can(axis.second.plant); });
  };
  if (every([](const plant::AxisParams& p) { return p.delay_periods < 8; })) {
    Deviation d;
    d.delay = 1;
    add("one period later", d);
  }
  if (every([](const plant::AxisParams& p) { return !p.axial_mode && !p.lost_motion && !p.drive_loop; })) {
    const AxialModeVariation m;
    Deviation d;
    d.axial_mode = plant::AxialMode{middle_of_log(m.frequency), middle_of_log(m.damping_ratio),
                                    middle_of_log(m.table_share)};
    add(fmt::format("mode at {:.0f} Hz", d.axial_mode->frequency), d);
  }
  return all;
}

std::vector<std::string> variation_factors() {
  return {"friction", "stiffness", "mass", "delay", "encoder", "axial_mode", "periodic", "warming"};
}

Variation vary_only(std::string_view factor) {
  const auto factors = variation_factors();
  if (std::find(factors.begin(), factors.end(), factor) == factors.end())
    throw Refused("variation: there is no factor " + std::string(factor));
  const Variation all;
  Variation one = Variation::none();
  for_each_field<Variation>([&](const auto& f) {
    if (f.name == factor) one.*f.member = all.*f.member;
  });
  return one;
}

void check(const Variation& variation) { check_fields(value_of(variation)); }

}  // namespace stribeck::sim
