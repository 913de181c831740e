#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/friction/table.hpp>
#include <stribeck/plant/any_mechanics.hpp>
#include <stribeck/plant/axis.hpp>

namespace stribeck::plant {
namespace {

using Map = friction::Composed<friction::Table>;

auto make(const AxisParams& p, double v_max) {
  const friction::Table table = std::visit(
      [&](const auto& steady) { return friction::Table::build(steady, v_max); }, p.friction.steady);
  Map map = friction::composed(table, p.friction);
  if (p.unbalance) map.eccentric.push_back(p.unbalance->term());
  return make_mechanics(p, map, p.friction.dynamics);
}

double rounded(double x, double step) { return step * std::nearbyint(x / step); }

}  // namespace

struct Axis::Implementation {
  Implementation(const AxisParams& p, double period_s, double v_max)
      : params(p), period(period_s), mechanics(make(p, v_max)) {
    if (const auto* c = std::get_if<CurrentDrive>(&p.drive)) amplifier_gain = c->amplifier_gain;
    if (p.drive_loop) loop.emplace(*p.drive_loop, period_s, p.force_gain() * p.converter.range);
  }

  /// Sets what changes slowly to its value in the coming period: warmth, place, viscous part.
  void vary() {
    const std::optional<Warming>& warming = params.warming;
    const std::optional<FrictionAlongTravel>& along = params.friction_along_travel;
    const std::optional<ViscousExponent>& exponent = params.viscous_exponent;
    const friction::Places& places = params.friction.places;
    if (!warming && !along && !exponent && places.empty()) return;
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
    if (fidelity.quantised) out = clamp_to(rounded(out, da.step()), -da.range, da.range - da.step());
    voltage = out;
    return {ripple() * delayed(waiting, out), against(), against_table(cutting)};
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
  }

  AxisParams params;
  double period;
  Fidelity fidelity{};
  AnyMechanics<Map> mechanics;
  std::optional<NoiseSource> noise;
  std::optional<double> amplifier_gain;
  std::optional<RunningLoop> loop;
  std::array<double, 8> waiting{};  ///< commands that wait for their delay, oldest first
  std::array<double, 8> waiting_offsets{};
  double voltage = 0.0;
  double last_held = 0.0;  ///< voltage of the period before, after delay_periods
  double ticks = 0.0;      ///< since start() [periods]
};

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
        advance_together(m, held_a, n, held_b, one.period, one.fidelity.substeps);
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
  return s.fidelity.quantised ? rounded(read, s.params.encoder.resolution) : read;
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
  return s.fidelity.quantised ? rounded(x, s.params.second_encoder->resolution) : x;
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
