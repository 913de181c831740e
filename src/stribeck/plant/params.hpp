#pragma once
/// Parameters of a virtual drive. They are the truth of the simulation; no controller may read them.
///
///   control word → D/A (bits, range) → delay → amplifier and motor → screw → axis with friction, noise
///   → encoder
///   with a drive_loop: velocity or position command, force offset → delay → loops of the drive → amplifier and motor → …
///
/// Real time: configure only.

#include <algorithm>
#include <cmath>
#include <optional>
#include <stribeck/friction/model.hpp>
#include <stribeck/friction/unbalance.hpp>
#include <stribeck/plant/drive_loop.hpp>

namespace stribeck::plant {

/// A drive whose amplifier makes the current follow the voltage at once: f_u = gain·u.
struct CurrentDrive {
  static constexpr std::string_view kKind = "current";

  double gain = 0.0;                     ///< [N/V]
  std::optional<double> amplifier_gain;  ///< k_a [A/V], for the electrical power only

  static constexpr auto fields() {
    return std::tuple{
        field("gain", &CurrentDrive::gain, quantity("N/V", "N/V").positive(), "force per volt, k_a·K_t·r_g"),
        field("amplifier_gain", &CurrentDrive::amplifier_gain, quantity("A/V", "A/V").positive(),
              "current per volt k_a; left out: no electrical power is reported")
            .or_default()};
  }
};

/// A motor on a voltage amplifier: L di/dt + R i = k_u u − K_e θ̇, f_u = K_t r_g i, θ = r_g x, r_g = 2π/lead.
struct VoltageDrive {
  static constexpr std::string_view kKind = "voltage";

  double amplifier_gain = 1.0;
  double resistance = 0.0;
  double inductance = 0.0;
  double torque_constant = 0.0;
  double back_emf = 0.0;
  double lead = 0.0;

  static constexpr auto fields() {
    return std::tuple{
        field("amplifier_gain", &VoltageDrive::amplifier_gain, pure_number().positive(),
              "voltage gain k_u of the amplifier")
            .or_default(),
        field("resistance", &VoltageDrive::resistance, quantity("ohm", "ohm").positive(),
              "armature resistance R"),
        field("inductance", &VoltageDrive::inductance, quantity("H", "mH").positive(),
              "armature inductance L"),
        field("torque_constant", &VoltageDrive::torque_constant, quantity("N m/A", "N m/A").positive(),
              "torque constant K_t"),
        field("back_emf", &VoltageDrive::back_emf, quantity("V s/rad", "V s/rad").positive(),
              "back-EMF constant K_e"),
        field("lead", &VoltageDrive::lead, quantity("m", "mm").positive(), "lead of the screw")};
  }
  [[nodiscard]] double screw_ratio() const noexcept { return 2.0 * kPi / lead; }
};

using Drive = std::variant<CurrentDrive, VoltageDrive>;

/// First axial mode: the table is held to the drive side by a spring and a damper.
struct AxialMode {
  double frequency = 0.0;      ///< of the table against a fixed drive side [Hz]
  double damping_ratio = 0.0;  ///< of the same vibration
  double table_share = 0.5;    ///< share of the equivalent mass that is the table

  static constexpr auto fields() {
    return std::tuple{field("frequency", &AxialMode::frequency, quantity("Hz", "Hz").positive(),
                            "natural frequency of the table against a fixed drive side"),
                      field("damping_ratio", &AxialMode::damping_ratio, pure_number().not_negative(),
                            "damping ratio of the mode"),
                      field("table_share", &AxialMode::table_share, pure_number().positive().at_most(0.99),
                            "share of the equivalent mass that belongs to the table")};
  }
};

/// Backlash and wind-up between drive side and table, each with a part of the mass and of friction. In contact the table is held
/// by a spring and a damper; within the backlash nothing holds it.
struct LostMotion {
  double backlash = 0.0;        ///< b at position 0: whole width [m]
  double backlash_slope = 0.0;  ///< change of b per travel; b never falls below 0
  double stiffness = 0.0;       ///< between motor and table, in contact [N/m]
  double damping_ratio = 0.0;   ///< of the table on this spring against a fixed drive side
  double table_share = 0.5;     ///< share of the equivalent mass that is the table
  double table_friction = 0.5;  ///< share of friction that acts on the table

  static constexpr auto fields() {
    using L = LostMotion;
    return std::tuple{field("backlash", &L::backlash, quantity("m", "um").not_negative(),
                            "play between motor and table at position 0, the whole width"),
                      field("backlash_slope", &L::backlash_slope, quantity("m/m", "um/m"),
                            "change of the backlash along the travel; it never falls below 0")
                          .or_default(),
                      field("stiffness", &L::stiffness, quantity("N/m", "N/um").positive(),
                            "wind-up: stiffness between motor and table"),
                      field("damping_ratio", &L::damping_ratio, pure_number().not_negative(),
                            "damping ratio of the table on this stiffness against a fixed drive side"),
                      field("table_share", &L::table_share, pure_number().positive().at_most(0.99),
                            "share of the equivalent mass that belongs to the table"),
                      field("table_friction", &L::table_friction, pure_number().not_negative().at_most(1.0),
                            "share of friction on the table side")};
  }
};

enum class NoiseKind { kGaussian, kUniform };

/// Force noise, drawn per control period and held. Gaussian: first-order coloured, by standard deviation and
/// correlation time. Uniform: independent from period to period within ±√3·rms.
struct ForceNoise {
  double rms = 0.0;
  double correlation_time = 0.0;
  NoiseKind distribution = NoiseKind::kGaussian;

  static constexpr auto fields() {
    return std::tuple{field("rms", &ForceNoise::rms, quantity("N", "N").not_negative(), "standard deviation"),
                      field("correlation_time", &ForceNoise::correlation_time, quantity("s", "ms").positive(),
                            "time to 1/e of gaussian noise")
                          .or_default(),
                      field("distribution", &ForceNoise::distribution,
                            "gaussian (coloured), or uniform: independent values within sqrt(3) times rms")
                          .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (distribution == NoiseKind::kGaussian && !(correlation_time > 0.0)) {
      report("correlation_time", "missing, expected a time above 0; or set distribution to uniform");
    }
    if (distribution == NoiseKind::kUniform && correlation_time != 0.0) {
      report("correlation_time",
             "uniform noise is independent from period to period; leave correlation_time out");
    }
  }
};

/// Friction that changes as the axis warms up: level and viscous part, times 1 + change·(1 − exp(−t/τ)), t from the
/// start of a run. Additive friction that is periodic in position does not change.
struct Warming {
  double change = -0.2;
  double time_constant = 0.0;

  static constexpr auto fields() {
    return std::tuple{
        field("change", &Warming::change, pure_number().at_least(-0.9).at_most(10.0),
              "share by which friction has changed in the end; negative: it falls"),
        field("time_constant", &Warming::time_constant, quantity("s", "s").positive(), "time constant τ")};
  }
  /// Friction at time t [s], as a share of its initial value.
  [[nodiscard]] double share(double t) const noexcept {
    return 1.0 + change * (1.0 - std::exp(-t / time_constant));
  }
};

/// Friction that differs from place to place, in waves of the travel that are long against pre-sliding: its level, and the stiffness of
/// the bristles, times 1 + share·sin(2π·x/period + phase).
struct FrictionAlongTravel {
  double level = 0.0;      ///< share
  double stiffness = 0.0;  ///< share
  double period = 0.0;     ///< [m]
  double phase = 0.0;      ///< [rad]

  static constexpr auto fields() {
    using F = FrictionAlongTravel;
    return std::tuple{
        field("level", &F::level, pure_number().not_negative().at_most(0.9),
              "largest change of the level, as a share"),
        field("stiffness", &F::stiffness, pure_number().not_negative().at_most(0.9),
              "largest change of the stiffness of the bristles, as a share")
            .or_default(),
        field("period", &F::period, quantity("m", "mm").positive(), "length of a wave"),
        field("phase", &F::phase, quantity("rad", "rad"), "phase of the wave at position 0").or_default()};
  }
  [[nodiscard]] double wave(double x) const noexcept { return std::sin(2.0 * kPi * x / period + phase); }
};

/// A viscous part that does not grow in proportion to the speed: that of the map, times (|v|/speed)^(exponent − 1).
struct ViscousExponent {
  double exponent = 1.0;
  double speed = 0.0;  ///< where the viscous part is that of the map [m/s]

  static constexpr auto fields() {
    return std::tuple{field("exponent", &ViscousExponent::exponent, pure_number().positive().at_most(3.0),
                            "exponent of the speed"),
                      field("speed", &ViscousExponent::speed, quantity("m/s", "mm/s").positive(),
                            "speed at which the viscous part is that of friction.steady")};
  }
  /// Below a thousandth of speed the factor stays: the viscous part is nothing there.
  [[nodiscard]] double share(double v) const noexcept {
    return std::pow(std::max(std::abs(v) / speed, 1e-3), exponent - 1.0);
  }
};

/// A motor whose force depends on its angle: f_u·(1 + share·sin(2π·x/period + phase)).
struct TorqueRipple {
  double share = 0.0;
  double period = 0.0;  ///< [m]
  double phase = 0.0;   ///< [rad]

  static constexpr auto fields() {
    using R = TorqueRipple;
    return std::tuple{field("share", &R::share, pure_number().not_negative().at_most(0.5),
                            "largest change of the drive's force, as a share"),
                      field("period", &R::period, quantity("m", "mm").positive(),
                            "period in position: travel per turn over periods per turn"),
                      field("phase", &R::phase, quantity("rad", "rad"), "phase at position 0").or_default()};
  }
  [[nodiscard]] double factor(double x) const noexcept {
    return 1.0 + share * std::sin(2.0 * kPi * x / period + phase);
  }
};

enum class EncoderSide { kDrive, kTable };

struct Encoder {
  double resolution = 0.0;
  EncoderSide side = EncoderSide::kDrive;

  static constexpr auto fields() {
    return std::tuple{
        field("resolution", &Encoder::resolution, quantity("m", "nm").positive(), "step of the position"),
        field("side", &Encoder::side, "drive (rotary) or table (linear scale)").or_default()};
  }
};

/// An encoder that reads x + amplitude·sin(2π·x/period) before it rounds: an error within a period of its signal.
struct EncoderError {
  double amplitude = 0.0;  ///< [m]
  double period = 0.0;     ///< [m]

  static constexpr auto fields() {
    return std::tuple{field("amplitude", &EncoderError::amplitude, quantity("m", "nm").not_negative(),
                            "amplitude of the error within a signal period"),
                      field("period", &EncoderError::period, quantity("m", "um").positive(),
                            "period of the encoder's signal, e.g. the lines of a scale")};
  }
  [[nodiscard]] double at(double x) const noexcept { return amplitude * std::sin(2.0 * kPi * x / period); }
};

/// The encoder on the other side, which is logged only.
struct SecondEncoder {
  double resolution = 0.0;

  static constexpr auto fields() {
    return std::tuple{field("resolution", &SecondEncoder::resolution, quantity("m", "nm").positive(),
                            "step of the position")};
  }
};

struct Converter {
  int bits = 16;
  double range = 10.0;

  static constexpr auto fields() {
    return std::tuple{
        field("bits", &Converter::bits, pure_number().at_least(4).at_most(32),
              "resolution of the D/A converter"),
        field("range", &Converter::range, quantity("V", "V").positive(), "largest output, both signs")};
  }
  [[nodiscard]] double step() const noexcept { return 2.0 * range / static_cast<double>(1LL << bits); }
};

struct AxisParams {
  double mass = 0.0;                             ///< equivalent mass without rotor_inertia [kg]
  std::optional<double> rotor_inertia;           ///< [kg·m²], adds J·r_g²; needs a drive with a lead
  double load = 0.0;                             ///< constant force against +x [N]
  std::optional<friction::Unbalance> unbalance;  ///< of a rotary axis
  Drive drive;
  Converter converter;
  Encoder encoder;
  int delay_periods = 0;  ///< of the control word, in addition to the hold [control periods]
  friction::Model friction;
  std::optional<DriveLoop> drive_loop;
  std::optional<AxialMode> axial_mode;
  std::optional<ForceNoise> noise;
  std::optional<Warming> warming;
  std::optional<LostMotion> lost_motion;
  std::optional<SecondEncoder> second_encoder;
  std::optional<FrictionAlongTravel> friction_along_travel;
  std::optional<ViscousExponent> viscous_exponent;
  std::optional<TorqueRipple> torque_ripple;
  std::optional<EncoderError> encoder_error;
  std::optional<double> delay_fraction;  ///< in addition to delay_periods [control periods]

  static constexpr auto fields() {
    return std::tuple{
        field("mass", &AxisParams::mass, quantity("kg", "N s2/mm").positive(),
              "equivalent mass with all reflected inertia but rotor_inertia"),
        field("rotor_inertia", &AxisParams::rotor_inertia, quantity("kg m2", "kg m2").positive(),
              "inertia that comes on top of the mass through the screw; needs a drive with a lead")
            .or_default(),
        field("load", &AxisParams::load, quantity("N", "N"),
              "constant force against the positive direction, e.g. weight")
            .or_default(),
        field("unbalance", &AxisParams::unbalance,
              "weight of a rotary axis that is not balanced, as a sine of the angle; left out: balanced")
            .or_default(),
        field("drive", &AxisParams::drive, "amplifier and motor"),
        field("converter", &AxisParams::converter, "D/A converter of the control word"),
        field("encoder", &AxisParams::encoder, "position measurement"),
        field("delay_periods", &AxisParams::delay_periods, pure_number().not_negative().at_most(8.0),
              "whole control periods of delay of the control word, in addition to the hold")
            .or_default(),
        field("friction", &AxisParams::friction, "true friction; needs dynamics"),
        field("drive_loop", &AxisParams::drive_loop,
              "velocity or position loop that the drive closes itself; left out: it takes a force (voltage)")
            .or_default(),
        field("axial_mode", &AxisParams::axial_mode, "first axial mode; left out: rigid").or_default(),
        field("noise", &AxisParams::noise, "force noise; left out: none").or_default(),
        field("warming", &AxisParams::warming, "change of friction during a run; left out: none")
            .or_default(),
        field("lost_motion", &AxisParams::lost_motion,
              "backlash and wind-up between motor and table; left out: none")
            .or_default(),
        field("second_encoder", &AxisParams::second_encoder,
              "a second encoder, on the side where encoder is not, for logs only; left out: none")
            .or_default(),
        field("friction_along_travel", &AxisParams::friction_along_travel,
              "friction that differs from place to place; left out: none")
            .or_default(),
        field("viscous_exponent", &AxisParams::viscous_exponent,
              "a viscous part that is not in proportion to the speed; left out: it is")
            .or_default(),
        field("torque_ripple", &AxisParams::torque_ripple,
              "force of the drive that depends on the motor's angle; left out: none")
            .or_default(),
        field("encoder_error", &AxisParams::encoder_error,
              "error of the encoder within a period of its signal; left out: none")
            .or_default(),
        field("delay_fraction", &AxisParams::delay_fraction, pure_number().not_negative().at_most(1.0),
              "share of a control period that the delay is longer than delay_periods; left out: none")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (unbalance && friction.eccentric.size() == friction::kMaxEccentricTerms)
      report("unbalance",
             "needs a place among the terms of friction.eccentric, which is full; leave one out");
    if (!friction::has_pre_sliding(friction.dynamics)) {
      report("friction.dynamics",
             "a virtual machine needs lugre or gms: a step of friction at rest cannot be simulated");
    }
    if (rotor_inertia && !std::holds_alternative<VoltageDrive>(drive)) {
      report("rotor_inertia",
             "needs a drive of kind \"voltage\", whose lead reflects it; or include it in mass");
    }
    if (drive_loop && delay_fraction) {
      report("delay_fraction", "not with drive_loop; its delay_cycles are finer than a control period");
    }
    if (lost_motion && axial_mode) {
      report(
          "axial_mode",
          "beside lost_motion, whose stiffness and table_share already make the mode; leave one of them out");
    }
  }

  /// Force per volt in steady state at standstill [N/V].
  [[nodiscard]] double force_gain() const noexcept {
    if (const auto* c = std::get_if<CurrentDrive>(&drive)) return c->gain;
    const auto& v = std::get<VoltageDrive>(drive);
    return v.amplifier_gain / v.resistance * v.torque_constant * v.screw_ratio();
  }
  /// Mass with the rotor's [kg].
  [[nodiscard]] double total_mass() const noexcept {
    const auto* v = std::get_if<VoltageDrive>(&drive);
    if (!rotor_inertia || v == nullptr) return mass;
    return mass + *rotor_inertia * v->screw_ratio() * v->screw_ratio();
  }
};

}  // namespace stribeck::plant

template <>
struct stribeck::EnumNames<stribeck::plant::EncoderSide> {
  static constexpr std::array names{
      std::pair{stribeck::plant::EncoderSide::kDrive, std::string_view{"drive"}},
      std::pair{stribeck::plant::EncoderSide::kTable, std::string_view{"table"}}};
};

template <>
struct stribeck::EnumNames<stribeck::plant::NoiseKind> {
  static constexpr std::array names{
      std::pair{stribeck::plant::NoiseKind::kGaussian, std::string_view{"gaussian"}},
      std::pair{stribeck::plant::NoiseKind::kUniform, std::string_view{"uniform"}}};
};
