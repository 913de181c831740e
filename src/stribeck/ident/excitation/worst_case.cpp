#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>
#include <stribeck/ident/excitation/worst_case.hpp>
#include <utility>

namespace stribeck::ident::excitation {
namespace {

constexpr double kFinestStep = 0.25e-3;  // of the simulation [s]
constexpr double kOfPrediction = 1.02;   // a ramp is designed to the limit of speed with steps of 1 ms
constexpr double kForever = 30.0;        // an axis that still moves then does not stop by itself [s]

struct Case {
  double mass = 0.0;
  std::array<double, 2> friction{};  // against motion to −x, to +x
  double load = 0.0;
  double unbalance = 0.0;
  double hangs_at = 0.0;

  [[nodiscard]] double load_at(double x) const {
    return unbalance == 0.0 ? load : load + unbalance * std::sin(x - hangs_at);
  }
};

std::vector<double> angles_of(const Doubt& d) {
  if (d.unbalance == 0.0) return {0.0};
  if (d.hangs_at) return {*d.hangs_at};
  return {0.0, 0.5 * kPi, kPi, 1.5 * kPi};
}

std::vector<double> loads_of(const Doubt& d) {
  if (d.load_spread == 0.0) return {d.load};
  return {d.load - d.load_spread, d.load + d.load_spread};
}

std::vector<Case> cases_of(const Doubt& d) {
  std::vector<Case> all;
  const double skew = std::sqrt(d.uneven);
  const auto within = [&](double f) { return std::clamp(f, d.friction_low, d.friction_high); };
  for (const double mass : {d.mass_low, d.mass_high}) {
    for (const double level :
         {d.friction_low, std::sqrt(d.friction_low * d.friction_high), d.friction_high}) {
      for (const double s : {1.0, skew, 1.0 / skew}) {
        for (const double angle : angles_of(d)) {
          for (const double load : loads_of(d))
            all.push_back({mass, {within(level / s), within(level * s)}, load, d.unbalance, angle});
        }
      }
    }
  }
  return all;
}

struct Motion {
  double x = 0.0;
  double v = 0.0;

  void step(double acting, const Case& c, double dt) {
    if (v == 0.0) {
      const double held = c.friction[acting > 0.0];
      if (std::abs(acting) <= held) return;
      v = dt * (acting - sign(acting) * held) / c.mass;
    } else {
      const double next = v + dt * (acting - sign(v) * c.friction[v > 0.0]) / c.mass;
      v = next * v > 0.0 ? next : 0.0;
    }
    x += dt * v;
  }
};

/// Used share of the limits; above 1 one of them is exceeded.
double used(const Reach& r, double start, const Limits& l) {
  return std::max({(r.highest - start) / std::max(l.travel_max - start, 1e-12),
                   (start - r.lowest) / std::max(start - l.travel_min, 1e-12), r.speed / l.speed});
}

Reach play(const std::vector<double>& force, double sample_time, double start, const Case& c) {
  Reach r{start, start, 0.0, {}};
  Motion m{start, 0.0};
  const int parts = std::max(1, static_cast<int>(std::ceil(sample_time / kFinestStep)));
  const double dt = sample_time / parts;
  const auto hold = [&](double f) {
    for (int i = 0; i < parts; ++i) m.step(f - c.load_at(m.x), c, dt);
    r.lowest = std::min(r.lowest, m.x);
    r.highest = std::max(r.highest, m.x);
    r.speed = std::max(r.speed, std::abs(m.v));
  };
  for (const double f : force) hold(f);
  for (double t = 0.0; m.v != 0.0 && t < kForever; t += sample_time) hold(0.0);
  return r;
}

}  // namespace

double Doubt::weight(double lowest, double highest) const noexcept {
  if (unbalance == 0.0) return std::abs(load) + load_spread;
  if (!hangs_at) return std::abs(load) + load_spread + unbalance;
  constexpr int kPlaces = 200;
  double most = 0.0;
  for (int i = 0; i <= kPlaces; ++i) {
    const double x = lowest + (highest - lowest) * i / kPlaces;
    most = std::max(most, std::abs(load + unbalance * std::sin(x - *hangs_at)));
  }
  return most + load_spread;
}

bool Doubt::may_fall(const Limits& limits) const noexcept {
  return weight(limits.travel_min, limits.travel_max) >= friction_low;
}

Reach reach_of(const std::vector<double>& force, double sample_time, double start, const Doubt& doubt,
               const Limits& limits) {
  Reach all{start, start, 0.0, {}};
  double most = -1.0;
  const Shown u = shown(limits);
  for (const Case& c : cases_of(doubt)) {
    const Reach one = play(force, sample_time, start, c);
    all.lowest = std::min(all.lowest, one.lowest);
    all.highest = std::max(all.highest, one.highest);
    all.speed = std::max(all.speed, one.speed);
    if (const double now = used(one, start, limits); now > most) {
      most = now;
      all.farthest =
          fmt::format("{} {} with {} {} of friction in the positive direction, {} {} in the negative",
                      digits(c.mass), u.mass, digits(c.friction[1]), u.force, digits(c.friction[0]), u.force);
    }
  }
  return all;
}

std::string beyond(const Reach& r, const Limits& l) {
  const Shown u = shown(l);
  if (r.speed > l.speed * (1.0 + 1e-9)) {
    return fmt::format("an axis of {} would reach {:.4g} {}/s, the limit of speed is {:.4g} {}/s", r.farthest,
                       r.speed * u.per_metre, u.travel, l.speed * u.per_metre, u.travel);
  }
  if (r.lowest < l.travel_min || r.highest > l.travel_max) {
    return fmt::format("an axis of {} would move from {:.4g} to {:.4g} {}, the travel is {:.4g} to {:.4g} {}",
                       r.farthest, r.lowest * u.per_metre, r.highest * u.per_metre, u.travel,
                       l.travel_min * u.per_metre, l.travel_max * u.per_metre, u.travel);
  }
  return {};
}

double force_needed(const std::vector<double>& position, double sample_time, const Doubt& doubt) {
  double fastest = 0.0;
  for (std::size_t k = 1; k + 1 < position.size(); ++k)
    fastest = std::max(fastest, std::abs(position[k + 1] - 2.0 * position[k] + position[k - 1]));
  const auto [low, high] = std::minmax_element(position.begin(), position.end());
  const double weight =
      position.empty() ? std::abs(doubt.load) + doubt.load_spread : doubt.weight(*low, *high);
  return doubt.mass_high * fastest / (sample_time * sample_time) + doubt.friction_high + weight;
}

namespace {

void refuse_to_fall(const char* method, const Doubt& doubt, const Limits& limits) {
  if (!doubt.may_fall(limits)) return;
  const Shown u = shown(limits);
  throw Refused(fmt::format(
      "{}: the axis may fall: its {} of {:.4g} {} is not below the least friction, {:.4g} {}, and forces in open "
      "loop do not hold it; choose jog and sine for friction, constant-acceleration for the mass: they hold the "
      "position",
      method, doubt.unbalance > 0.0 ? "load with the unbalance" : "load",
      doubt.weight(limits.travel_min, limits.travel_max), u.force, doubt.friction_low, u.force));
}

void tell(Excitation& e, const Reach& reach, double start, const Shown& u) {
  // The axis settles a hair below its start.
  const auto away = [&](double distance) {
    return digits(std::abs(distance) < 1e-9 ? 0.0 : distance * u.per_metre);
  };
  e.says += fmt::format(
      " Worst case over the ranges of mass, friction and load: {} {} from the start in the positive direction, {} {} in the "
      "negative, {} {}/s ({}).",
      away(reach.highest - start), u.travel, away(start - reach.lowest), u.travel,
      digits(reach.speed * u.per_metre), u.travel, reach.farthest);
}

}  // namespace

SafeExcitation design_safe_pulses(const Limits& limits, const RoughDrive& drive, const Doubt& doubt,
                                  double sample_time, const PulseDesign& design) {
  refuse_to_fall("pulses", doubt, limits);
  constexpr int kTries = 16;
  constexpr double kShorter = 0.75;
  std::string why;
  Limits asked = limits;
  for (int i = 0; i < kTries; ++i) {
    const RoughDrive easiest{doubt.mass_low, doubt.friction_low, 0.0};
    Excitation e = i == 0 ? design_pulses(limits, drive, sample_time, design)
                          : pulses_for(asked, drive, easiest, true, sample_time, design);
    const Reach reach = reach_of(e.force, sample_time, design.start, doubt, limits);
    why = beyond(reach, limits);
    if (why.empty()) {
      if (i > 0) {
        e.says +=
            " Pulses are short, because friction, mass and load may be other than said: the axis may hardly move. Identify, then design "
            "again with --known (or with the file of a longer log), or write ranges for mass and friction.";
      }
      tell(e, reach, design.start, shown(limits));
      return {std::move(e), reach};
    }
    if (i > 0) asked.speed *= kShorter;
  }
  const std::string unit = shown(limits).force;
  throw Refused("pulses: " + why + "; write ranges for mass and friction, e.g. friction = [\"30 " + unit +
                "\", \"50 " + unit +
                "\"], after a jog, or choose "
                "constant-acceleration, jog and sine, which hold the position");
}

SafeExcitation design_safe_ramp(const Limits& limits, const RoughDrive& drive, const Doubt& doubt,
                                double sample_time, const RampDesign& design) {
  refuse_to_fall("ramp", doubt, limits);
  Excitation e = design_ramp(limits, drive, sample_time, design);
  const Reach reach = reach_of(e.force, sample_time, design.start, doubt, limits);
  Limits rounded = limits;
  rounded.speed *= kOfPrediction;
  if (const std::string why = beyond(reach, rounded); !why.empty()) {
    const std::string unit = shown(limits).force;
    throw Refused("ramp: " + why + "; write a range for friction, e.g. friction = [\"30 " + unit +
                  "\", \"50 " + unit + "\"], after a jog, or give --known");
  }
  tell(e, reach, design.start, shown(limits));
  return {std::move(e), reach};
}

}  // namespace stribeck::ident::excitation
