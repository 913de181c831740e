#include <cmath>
#include <limits>
#include <stribeck/plant/axis_parts.hpp>

namespace stribeck::plant {

Axis::Axis(const AxisParams& params, double period, double v_max)
    : implementation_(std::make_unique<Implementation>(params, period, v_max)) {}
Axis::~Axis() = default;
Axis::Axis(Axis&&) noexcept = default;
Axis& Axis::operator=(Axis&&) noexcept = default;

void Axis::start(double x, const Fidelity& fidelity, const Stream& stream) {
  Implementation& s = *implementation_;
  std::visit([&](auto& m) { m.reset(x); }, s.mechanics);
  s.waiting = {};
  s.waiting_offsets = {};
  if (s.loop) {
    const double weight = s.params.unbalance ? s.params.unbalance->at(x) : 0.0;
    const double spring = s.params.friction.spring ? s.params.friction.spring->at(x) : 0.0;
    s.loop->start(x, s.params.load + weight + spring, fidelity.quantised);
    if (s.params.drive_loop->loop.mode == friction::DriveMode::kPosition) s.waiting.fill(x);
  }
  s.voltage = 0.0;
  s.last_held = 0.0;
  s.last_acting = 0.0;
  s.begin_period(0.0);
  s.ticks = 0.0;
  s.fidelity = fidelity;
  s.noise.reset();
  if (s.params.noise && fidelity.noisy) s.noise.emplace(*s.params.noise, s.period, stream);
}

void Axis::step(double command, double cutting, double offset) {
  Implementation& s = *implementation_;
  s.vary();
  if (s.loop) return s.step_with_loop(command, cutting, offset);
  s.advance(s.held(command, cutting));
}

void Axis::step_together(Axis& a, double voltage_a, Axis& b, double voltage_b, double cutting_a,
                         double cutting_b) {
  Implementation& one = *a.implementation_;
  Implementation& other = *b.implementation_;
  if (one.mechanics.index() != other.mechanics.index() || one.loop || other.loop ||
      one.params.delay_fraction || other.params.delay_fraction) {
    a.step(voltage_a, cutting_a);
    b.step(voltage_b, cutting_b);
    return;
  }
  one.vary();
  other.vary();
  const Held held_a = one.held(voltage_a, cutting_a);
  const Held held_b = other.held(voltage_b, cutting_b);
  std::visit(
      [&](auto& m) {
        auto& n = *std::get_if<std::remove_reference_t<decltype(m)>>(&other.mechanics);
        advance_together(m, held_a, one.fidelity.substeps, n, held_b, other.fidelity.substeps, one.period);
      },
      one.mechanics);
}

double Axis::encoder() const {
  const Implementation& s = *implementation_;
  const double x = std::visit(
      [&](const auto& m) {
        return s.params.encoder.side == EncoderSide::kTable ? m.table_position() : m.drive_position();
      },
      s.mechanics);
  const double read = s.params.encoder_error ? x + s.params.encoder_error->at(x) : x;
  return s.fidelity.quantised ? rounded_to(read, s.params.encoder.resolution) : read;
}
EncoderSide Axis::feedback() const { return implementation_->params.encoder.side; }
double Axis::second_encoder() const {
  const Implementation& s = *implementation_;
  if (!s.params.second_encoder) return std::numeric_limits<double>::quiet_NaN();
  const double x = std::visit(
      [&](const auto& m) {
        return s.params.encoder.side == EncoderSide::kTable ? m.drive_position() : m.table_position();
      },
      s.mechanics);
  return s.fidelity.quantised ? rounded_to(x, s.params.second_encoder->resolution) : x;
}
double Axis::position() const {
  return std::visit([](const auto& m) { return m.table_position(); }, implementation_->mechanics);
}
double Axis::velocity() const {
  return std::visit([](const auto& m) { return m.drive_velocity(); }, implementation_->mechanics);
}
double Axis::friction_force() const {
  return std::visit([](const auto& m) { return m.friction_force(); }, implementation_->mechanics);
}
double Axis::force() const {
  const Implementation& s = *implementation_;
  const auto* motor = std::get_if<VoltageDrive>(&s.params.drive);
  if (motor == nullptr) return s.params.force_gain() * s.acting;
  // The equation of the current, integrated over the period:  L·Δi = (k_u·u − R·i)·T − K_e·r_g·Δx  with means u, i.
  return std::visit(
      [&](const auto& m) {
        const double induced =
            motor->inductance * (m.current() - s.begin_current) +
            motor->back_emf * motor->screw_ratio() * (m.drive_position() - s.begin_position);
        const double current = (motor->amplifier_gain * s.acting - induced / s.period) / motor->resistance;
        return motor->torque_constant * motor->screw_ratio() * current;
      },
      s.mechanics);
}
bool Axis::has_loop() const { return implementation_->loop.has_value(); }
bool Axis::reports_force() const {
  const auto& loop = implementation_->params.drive_loop;
  return loop && loop->loop.force_feedback;
}
double Axis::voltage() const { return implementation_->voltage; }
double Axis::current() const {
  if (implementation_->amplifier_gain) return *implementation_->amplifier_gain * implementation_->voltage;
  return std::visit([](const auto& m) { return m.current(); }, implementation_->mechanics);
}
double Axis::power() const {
  const auto* motor = std::get_if<VoltageDrive>(&implementation_->params.drive);
  if (motor == nullptr) return std::numeric_limits<double>::quiet_NaN();
  const double i = current();
  return motor->resistance * i * i + motor->back_emf * motor->screw_ratio() * velocity() * i;
}
double Axis::rate_bound() const {
  const double rate = std::visit([](const auto& m) { return m.rate_bound(); }, implementation_->mechanics);
  return implementation_->loop ? rate / implementation_->loop->cycles() : rate;
}

}  // namespace stribeck::plant
