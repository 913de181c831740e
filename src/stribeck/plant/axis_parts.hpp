#pragma once
/// What an axis consists of. Only axis.cpp and axis_group.cpp include this file.
/// Real time: no.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stribeck/friction/table.hpp>
#include <stribeck/plant/any_mechanics.hpp>
#include <stribeck/plant/axis.hpp>

namespace stribeck::plant {

using AxisMap = friction::Composed<friction::Table>;

inline AnyMechanics<AxisMap> mechanics_of(const AxisParams& p, double v_max) {
  const friction::Table table = std::visit(
      [&](const auto& steady) { return friction::Table::build(steady, v_max); }, p.friction.steady);
  AxisMap map = friction::composed(table, p.friction);
  if (p.unbalance) map.eccentric.push_back(p.unbalance->term());
  return make_mechanics(p, map, p.friction.dynamics);
}

inline double rounded_to(double x, double step) { return step * std::nearbyint(x / step); }

struct Axis::Implementation {
  Implementation(const AxisParams& p, double period_s, double v_max)
      : params(p), period(period_s), mechanics(mechanics_of(p, v_max)) {
    if (const auto* c = std::get_if<CurrentDrive>(&p.drive)) amplifier_gain = c->amplifier_gain;
    if (p.drive_loop) loop.emplace(*p.drive_loop, period_s, p.force_gain() * p.converter.range);
  }

  /// Whether vary() does anything.
  [[nodiscard]] bool varies() const {
    return params.warming || params.friction_along_travel || params.viscous_exponent ||
           !params.friction.places.empty();
  }

  /// Sets what changes slowly to its value in the coming period: warmth, place, viscous part.
  void vary() {
    const std::optional<Warming>& warming = params.warming;
    const std::optional<FrictionAlongTravel>& along = params.friction_along_travel;
    const std::optional<ViscousExponent>& exponent = params.viscous_exponent;
    const friction::Places& places = params.friction.places;
    if (!varies()) return;
    const double warmth = warming ? warming->share((ticks++ + 0.5) * period) : 1.0;
    std::visit(
        [&](auto& m) {
          const double wave = along ? along->wave(m.drive_position()) : 0.0;
          const double level = along ? warmth * (1.0 + along->level * wave) : warmth;
          m.set_friction_share(level, exponent ? warmth * exponent->share(m.drive_velocity()) : warmth);
          const double stiffness = along ? 1.0 + along->stiffness * wave : 1.0;
          if (along || !places.empty())
            m.set_stiffness_share(stiffness * friction::shares_at(places, m.drive_position()).stiffness);
        },
        mechanics);
  }

  /// The force of the drive at this angle of the motor, as a share.
  [[nodiscard]] double ripple() const {
    if (!params.torque_ripple) return 1.0;
    return std::visit([&](const auto& m) { return params.torque_ripple->factor(m.drive_position()); },
                      mechanics);
  }

  /// One period under what is held, of which the first part may still be that of the period before.
  void advance(const Held& held) {
    const double part = params.delay_fraction.value_or(0.0);
    std::visit(
        [&](auto& m) {
          if (part <= 0.0) return m.advance(held, period, fidelity.substeps);
          Held first = held;
          first.voltage = last_held;
          const double now = acting;
          acting += part * (last_acting - acting);
          last_acting = now;
          last_held = held.voltage;
          const int before =
              std::clamp(static_cast<int>(std::lround(part * fidelity.substeps)), 1, fidelity.substeps);
          m.advance(first, part * period, before);
          if (part < 1.0) m.advance(held, (1.0 - part) * period, std::max(1, fidelity.substeps - before));
        },
        mechanics);
  }

  /// Converts the control word to the inputs of the coming period: converter, delay, noise.
  Held held(double wanted, double cutting) {
    const Converter& da = params.converter;
    double out = clamp_to(wanted, -da.range, da.range);
    if (fidelity.quantised) out = clamp_to(rounded_to(out, da.step()), -da.range, da.range - da.step());
    voltage = out;
    const double turned = ripple();
    const double late = delayed(waiting, out);
    begin_period(seen(turned) * late);
    return {turned * late, against(), against_table(cutting)};
  }

  /// What Axis::force() needs of the period that begins; `volts`: mean voltage that acts in it, as the current shows it [V].
  void begin_period(double volts) {
    acting = volts;
    std::visit(
        [&](const auto& m) {
          begin_position = m.drive_position();
          begin_current = m.current();
        },
        mechanics);
  }
  /// The torque ripple as far as the current shows it: in a voltage drive alone.
  [[nodiscard]] double seen(double turned) const {
    return std::holds_alternative<VoltageDrive>(params.drive) ? turned : 1.0;
  }

  /// Load and noise on the drive side in the coming period [N].
  double against() {
    const double load = params.lost_motion ? 0.0 : params.load;
    return load + (noise ? noise->next() : 0.0);
  }
  /// The same for the table: where it is held with backlash, the weight is its own.
  [[nodiscard]] double against_table(double cutting) const {
    return params.lost_motion ? cutting + params.load : cutting;
  }

  /// The value of delay_periods ago; keeps this one.
  [[nodiscard]] double delayed(std::array<double, 8>& queue, double value) const {
    const auto delay = static_cast<std::size_t>(params.delay_periods);
    if (delay == 0) return value;
    const double out = queue[0];
    for (std::size_t i = 1; i < delay; ++i) queue[i - 1] = queue[i];
    queue[delay - 1] = value;
    return out;
  }

  /// One period with the loops of the drive.
  void step_with_loop(double command, double cutting, double offset) {
    loop->command(delayed(waiting, command), delayed(waiting_offsets, offset));
    const double against_now = against();
    const double per_force = 1.0 / params.force_gain();
    const double turned = ripple();
    begin_period(0.0);
    double sum = 0.0;
    for (int i = 0; i < loop->cycles(); ++i) {
      std::visit(
          [&](auto& m) {
            const double out = per_force * loop->force(i, m.drive_position());
            sum += out;
            m.advance({turned * out, against_now, against_table(cutting)}, loop->cycle(), fidelity.substeps);
          },
          mechanics);
    }
    voltage = sum / loop->cycles();
    acting = seen(turned) * voltage;
  }

  AxisParams params;
  double period;
  Fidelity fidelity{};
  AnyMechanics<AxisMap> mechanics;
  std::optional<NoiseSource> noise;
  std::optional<double> amplifier_gain;
  std::optional<RunningLoop> loop;
  std::array<double, 8> waiting{};  ///< commands that wait for their delay, oldest first
  std::array<double, 8> waiting_offsets{};
  double voltage = 0.0;
  double last_held = 0.0;  ///< voltage of the period before, after delay_periods
  double acting = 0.0;     ///< mean voltage that acts in the last period, as the current shows it
  double last_acting = 0.0;
  double begin_position = 0.0;  ///< of the drive side at the beginning of the last period [m]
  double begin_current = 0.0;   ///< [A]
  double ticks = 0.0;           ///< since start() [periods]
};

}  // namespace stribeck::plant
