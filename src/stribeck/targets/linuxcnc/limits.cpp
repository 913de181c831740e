#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/report/text.hpp>
#include <stribeck/targets/linuxcnc/limits.hpp>

namespace stribeck::targets::linuxcnc {
namespace {

/// Share of the drive's force for motion and friction; the rest is for feedback.
constexpr double kShare = 0.9;
/// Smallest share of the drive's force for acceleration.
constexpr double kForAcceleration = 0.2;

/// Rounds down to three digits.
double rounded_down(double x) {
  const double step = std::pow(10.0, std::floor(std::log10(x)) - 2.0);
  return std::floor(x / step) * step;
}

/// Largest force at a speed: the force of a voltage amplifier decreases with the speed of the motor.
double force_at(const sim::MachineAxis& a, double speed) {
  const auto* v = std::get_if<plant::VoltageDrive>(&a.plant.drive);
  if (v == nullptr) return a.force_limit();
  return a.force_limit() -
         v->torque_constant * v->back_emf * v->screw_ratio() * v->screw_ratio() / v->resistance * speed;
}

/// Largest force of friction and load at any speed up to this one, in either direction [N].
double friction_up_to(const sim::MachineAxis& a, double speed) {
  constexpr int kSamples = 400;
  double most = 0.0;
  for (int i = 1; i <= kSamples; ++i) {
    // Closer together towards zero, where the curve bends.
    const double share = static_cast<double>(i) / kSamples;
    for (const double v : {speed * share * share, -speed * share * share}) {
      const double force = std::visit([&](const auto& map) { return friction::steady_force(map, v, 0.0); },
                                      a.plant.friction.steady);
      most = std::max(most, std::abs(force));
    }
  }
  for (const auto& term : a.plant.friction.eccentric) most += term.amplitude;
  if (const auto& spring = a.plant.friction.spring)
    most += std::max(std::abs(spring->at(a.limits.travel_min)), std::abs(spring->at(a.limits.travel_max)));
  return most + std::abs(a.plant.load);
}

}  // namespace

DrivableLimits drivable_limits(const sim::MachineAxis& a) {
  DrivableLimits d{a.limits, friction_up_to(a, a.limits.speed), 0.0};
  const auto left = [&](double speed, double friction) { return kShare * force_at(a, speed) - friction; };
  const double least = kForAcceleration * a.force_limit();
  if (left(d.limits.speed, d.friction) < least) {
    double low = 0.0;
    double high = d.limits.speed;
    constexpr int kHalvings = 40;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (left(middle, friction_up_to(a, middle)) < least ? high : low) = middle;
    }
    d.limits.speed = low > 0.0 ? rounded_down(low) : 0.0;
    if (!(d.limits.speed > 0.0)) return d;
    d.friction = friction_up_to(a, d.limits.speed);
  }
  d.force = force_at(a, d.limits.speed);
  const double acceleration = left(d.limits.speed, d.friction) / a.plant.total_mass();
  if (acceleration < d.limits.acceleration) d.limits.acceleration = rounded_down(acceleration);
  return d;
}

std::string limits_words(const DrivableLimits& d, const sim::MachineAxis& a) {
  const double inertia = a.plant.total_mass() * d.limits.acceleration;
  std::string out = fmt::format(
      "Of the drive's {:.6g} N, friction takes {} N at most up to this speed, this acceleration {} N",
      d.force, report::significant(d.friction, 3), report::significant(inertia, 3));
  std::vector<std::string> lowered;
  if (d.limits.speed < a.limits.speed) lowered.push_back(fmt::format("{:.6g} mm/s", 1e3 * a.limits.speed));
  if (d.limits.acceleration < a.limits.acceleration)
    lowered.push_back(fmt::format("{:.6g} mm/s2", 1e3 * a.limits.acceleration));
  if (lowered.empty()) return out + "; both as in the machine file.";
  return out + fmt::format(
                   ".\n# The machine file has {}, for which that force is too small; {:.0f} % of it are "
                   "counted on.",
                   report::joined(lowered, " and "), 100.0 * kShare);
}

}  // namespace stribeck::targets::linuxcnc
