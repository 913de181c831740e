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
};

std::vector<Case> cases_of(const Doubt& d) {
  std::vector<Case> all;
  const double skew = std::sqrt(d.uneven);
  const auto within = [&](double f) { return std::clamp(f, d.friction_low, d.friction_high); };
  for (const double mass : {d.mass_low, d.mass_high}) {
    for (const double level :
         {d.friction_low, std::sqrt(d.friction_low * d.friction_high), d.friction_high}) {
      for (const double s : {1.0, skew, 1.0 / skew})
        all.push_back({mass, {within(level / s), within(level * s)}});
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

Reach play(const std::vector<double>& force, double sample_time, double start, const Case& c, double load) {
  Reach r{start, start, 0.0, {}};
  Motion m{start, 0.0};
  const int parts = std::max(1, static_cast<int>(std::ceil(sample_time / kFinestStep)));
  const double dt = sample_time / parts;
  const auto hold = [&](double f) {
    for (int i = 0; i < parts; ++i) m.step(f - load, c, dt);
    r.lowest = std::min(r.lowest, m.x);
    r.highest = std::max(r.highest, m.x);
    r.speed = std::max(r.speed, std::abs(m.v));
  };
  for (const double f : force) hold(f);
  for (double t = 0.0; m.v != 0.0 && t < kForever; t += sample_time) hold(0.0);
  return r;
}

}  // namespace

bool Doubt::may_fall() const noexcept { return std::abs(load) >= friction_low; }

Reach reach_of(const std::vector<double>& force, double sample_time, double start, const Doubt& doubt,
               const Limits& limits) {
  Reach all{start, start, 0.0, {}};
  double most = -1.0;
  for (const Case& c : cases_of(doubt)) {
    const Reach one = play(force, sample_time, start, c, doubt.load);
    all.lowest = std::min(all.lowest, one.lowest);
    all.highest = std::max(all.highest, one.highest);
    all.speed = std::max(all.speed, one.speed);
    if (const double now = used(one, start, limits); now > most) {
      most = now;
      all.farthest =
          fmt::format("{} kg with {} N of friction in the positive direction, {} N in the negative",
                      digits(c.mass), digits(c.friction[1]), digits(c.friction[0]));
    }
  }
  return all;
}

std::string beyond(const Reach& r, const Limits& l) {
  if (r.speed > l.speed * (1.0 + 1e-9)) {
    return fmt::format("an axis of {} would reach {:.4g} mm/s, the limit of speed is {:.4g} mm/s", r.farthest,
                       r.speed * 1e3, l.speed * 1e3);
  }
  if (r.lowest < l.travel_min || r.highest > l.travel_max) {
    return fmt::format("an axis of {} would move from {:.4g} to {:.4g} mm, the travel is {:.4g} to {:.4g} mm",
                       r.farthest, r.lowest * 1e3, r.highest * 1e3, l.travel_min * 1e3, l.travel_max * 1e3);
  }
  return {};
}

double force_needed(const std::vector<double>& position, double sample_time, const Doubt& doubt) {
  double fastest = 0.0;
  for (std::size_t k = 1; k + 1 < position.size(); ++k)
    fastest = std::max(fastest, std::abs(position[k + 1] - 2.0 * position[k] + position[k - 1]));
  return doubt.mass_high * fastest / (sample_time * sample_time) + doubt.friction_high + std::abs(doubt.load);
}

namespace {

void refuse_to_fall(const char* method, const Doubt& doubt) {
  if (!doubt.may_fall()) return;
  throw Refused(fmt::format(
      "{}: the axis may fall: its load of {:.4g} N is not below the least friction, {:.4g} N, and forces in open "
      "loop do not hold it; choose jog and sine for friction, constant-acceleration for the mass: they hold the "
      "position",
      method, std::abs(doubt.load), doubt.friction_low));
}

void tell(Excitation& e, const Reach& reach, double start) {
  // The axis settles a hair below its start.
  const auto away = [](double distance) { return digits(std::abs(distance) < 1e-9 ? 0.0 : distance * 1e3); };
  e.says += fmt::format(
      " Worst case of all that is not known: {} mm from the start in the positive direction, {} mm in the "
      "negative, {} mm/s ({}).",
      away(reach.highest - start), away(start - reach.lowest), digits(reach.speed * 1e3), reach.farthest);
}

}  // namespace

SafeExcitation design_safe_pulses(const Limits& limits, const RoughDrive& drive, const Doubt& doubt,
                                  double sample_time, const PulseDesign& design) {
  refuse_to_fall("pulses", doubt);
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
            " Pulses are short, as friction and mass are known roughly: the axis may hardly move. Identify, "
            "then design again with --known, or write ranges for mass and friction.";
      }
      tell(e, reach, design.start);
      return {std::move(e), reach};
    }
    if (i > 0) asked.speed *= kShorter;
  }
  throw Refused(
      "pulses: " + why +
      "; write ranges for mass and friction, e.g. friction = [\"30 N\", \"50 N\"], after a jog, or choose "
      "constant-acceleration, jog and sine, which hold the position");
}

SafeExcitation design_safe_ramp(const Limits& limits, const RoughDrive& drive, const Doubt& doubt,
                                double sample_time, const RampDesign& design) {
  refuse_to_fall("ramp", doubt);
  Excitation e = design_ramp(limits, drive, sample_time, design);
  const Reach reach = reach_of(e.force, sample_time, design.start, doubt, limits);
  Limits rounded = limits;
  rounded.speed *= kOfPrediction;
  if (const std::string why = beyond(reach, rounded); !why.empty()) {
    throw Refused(
        "ramp: " + why +
        "; write a range for friction, e.g. friction = [\"30 N\", \"50 N\"], after a jog, or give --known");
  }
  tell(e, reach, design.start);
  return {std::move(e), reach};
}

}  // namespace stribeck::ident::excitation
