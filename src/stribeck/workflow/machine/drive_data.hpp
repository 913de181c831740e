#pragma once
/// A drive in the words of its data sheets: motor, transmission, limits. What a controller needs follows from it.
///
///   force at 100 %   F = motors·M/r,  r = travel per turn of the motor/(2π) = lead/(gear·2π);  linear motor: F itself
///   100 %            rated torque (force), or torque constant times rated current; 1000 per mille of it in CiA 402
///   reflected mass   m = motors·J/r²
///
/// Not modelled: efficiency of the transmission; less torque at high speed.
/// Real time: configure only.

#include <fmt/core.h>

#include <cmath>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <string>

namespace stribeck::workflow {

struct DriveData {
  std::optional<double> rated_torque;      ///< [N·m]
  std::optional<double> rated_force;       ///< of a linear motor, or at the axis [N]
  std::optional<double> torque_constant;   ///< [N·m/A]
  std::optional<double> force_constant;    ///< [N/A]
  std::optional<double> rated_current;     ///< [A]
  std::optional<double> peak_torque;       ///< [N·m]
  std::optional<double> peak_force;        ///< [N]
  std::optional<double> peak_current;      ///< [A]
  std::optional<double> torque_limit;      ///< share of rated, as set in the drive
  std::optional<double> lead;              ///< [m]
  std::optional<double> pulley_diameter;   ///< [m]
  std::optional<double> travel_per_turn;   ///< of pulley, pinion or screw [m]
  double gear = 1.0;                       ///< turns of the motor per turn of screw or pulley
  int motors = 1;                          ///< that drive the axis together
  std::optional<double> rotor_inertia;     ///< of one motor [kg·m²]
  std::optional<double> motor_speed;       ///< largest [rad/s]
  std::optional<int> encoder_counts;       ///< per turn of the motor, after evaluation
  std::optional<double> voltage_at_rated;  ///< command that gives 100 % [V]
  bool brake = false;                      ///< holds the axis without power

  static constexpr auto fields() {
    using D = DriveData;
    return std::tuple{
        field("rated_torque", &D::rated_torque, quantity("N m", "N m").positive(),
              "torque of one motor at 100 % (1000 per mille, CiA 402)")
            .or_default(),
        field("rated_force", &D::rated_force, quantity("N", "N").positive(),
              "force at 100 % of a linear motor")
            .or_default(),
        field("torque_constant", &D::torque_constant, quantity("N m/A", "N m/A").positive(),
              "torque per ampere RMS: alone for logs in A, with rated_current in place of rated_torque")
            .or_default(),
        field(
            "force_constant", &D::force_constant, quantity("N/A", "N/A").positive(),
            "force per ampere RMS of a linear motor: alone for logs in A, with rated_current in place of rated_force")
            .or_default(),
        field("rated_current", &D::rated_current, quantity("A", "A").positive(),
              "current of one motor at 100 %")
            .or_default(),
        field("peak_torque", &D::peak_torque, quantity("N m", "N m").positive(),
              "largest torque of one motor for a short time")
            .or_default(),
        field("peak_force", &D::peak_force, quantity("N", "N").positive(),
              "largest force of a linear motor for a short time")
            .or_default(),
        field("peak_current", &D::peak_current, quantity("A", "A").positive(),
              "largest current of one motor for a short time")
            .or_default(),
        field("torque_limit", &D::torque_limit, pure_number().positive().at_most(20.0),
              "limit of torque or force that is set in the drive, as a share of rated, e.g. \"150 %\"")
            .or_default(),
        field("lead", &D::lead, quantity("m", "mm").positive(),
              "lead of the screw; of a rotary axis \"360 deg\"")
            .or_default(),
        field("pulley_diameter", &D::pulley_diameter, quantity("m", "mm").positive(),
              "pitch diameter of the belt pulley or pinion")
            .or_default(),
        field("travel_per_turn", &D::travel_per_turn, quantity("m", "mm").positive(),
              "travel per turn of screw, pulley or pinion, e.g. teeth times pitch")
            .or_default(),
        field("gear", &D::gear, pure_number().positive(),
              "turns of the motor per turn of screw, pulley, pinion or table")
            .or_default(),
        field("motors", &D::motors, pure_number().at_least(1.0).at_most(8.0),
              "motors that drive this axis together, as on the two sides of a gantry")
            .or_default(),
        field("rotor_inertia", &D::rotor_inertia, quantity("kg m2", "kg m2").positive(),
              "inertia of one motor with coupling, brake and screw")
            .or_default(),
        field("motor_speed", &D::motor_speed, quantity("rad/s", "rpm").positive(),
              "largest speed of the motor")
            .or_default(),
        field("encoder_counts", &D::encoder_counts, pure_number().at_least(1.0),
              "counts of the encoder per turn of the motor, after evaluation")
            .or_default(),
        field("voltage_at_rated", &D::voltage_at_rated, quantity("V", "V").positive(),
              "analog torque command that gives 100 %")
            .or_default(),
        field("brake", &D::brake, "a brake holds the axis without power").or_default()};
  }

  template <class Report>
  void validate(Report&& report) const {
    const int ways = lead.has_value() + pulley_diameter.has_value() + travel_per_turn.has_value();
    const bool linear = rated_force || force_constant || peak_force;
    const bool rotary = rated_torque || torque_constant || peak_torque;
    if (ways > 1)
      report("lead", "lead, pulley_diameter and travel_per_turn say the same: expected one of them");
    if (linear && rotary)
      report("rated_force", "a motor has torque or force: expected one of rated_torque and rated_force");
    if (ways == 0 && gear != 1.0)
      report(
          "gear",
          "has no effect without the travel per turn: expected lead, pulley_diameter or travel_per_turn with it");
    if (linear && ways > 0)
      report("rated_force",
             "a linear motor has no lead, pulley or turn (leave them out, or write rated_torque)");
    if (rotary && ways == 0) {
      report("rated_torque",
             "needs the travel per turn: expected lead = \"10 mm\", pulley_diameter or travel_per_turn, with "
             "your value");
    }
    if (!rated() && !per_ampere() && (linear || rotary || ways > 0)) {
      report(
          linear ? "rated_force" : "rated_torque",
          "missing, expected rated_torque or rated_force, or torque_constant (force_constant), which is enough for logs in A; for logs in "
          "percent with rated_current");
    }
    std::optional<double> largest = at_axis(peak_torque, peak_force, peak_current);
    if (!largest && peak_current && per_ampere()) largest = *per_ampere() * *peak_current;
    if (rated() && largest && *largest < *rated())
      report(linear ? "peak_force" : "peak_torque", "below the rated value, expected at least that");
  }

  /// Travel per radian of the motor [m]; nothing for a linear motor.
  [[nodiscard]] std::optional<double> radius() const noexcept {
    const std::optional<double> turn = lead              ? lead
                                       : travel_per_turn ? travel_per_turn
                                       : pulley_diameter ? std::optional(kPi * *pulley_diameter)
                                                         : std::nullopt;
    if (!turn) return std::nullopt;
    return *turn / (2.0 * kPi * gear);
  }
  /// Force on the axis at 100 % [N].
  [[nodiscard]] std::optional<double> rated() const noexcept {
    return at_axis(rated_torque, rated_force, rated_current);
  }
  /// Force on the axis for one ampere in each motor [N/A].
  [[nodiscard]] std::optional<double> per_ampere() const noexcept {
    if (rated() && rated_current) return *rated() / *rated_current;
    const auto r = radius();
    if (torque_constant && r) return motors * *torque_constant / *r;
    if (force_constant) return motors * *force_constant;
    return std::nullopt;
  }
  /// Where the constant of the motor and its rated values do not belong together, in words; empty: they do, or are not both there.
  [[nodiscard]] std::string constant_doubt() const {
    constexpr double kApart = 0.15;  // saturation and a warm motor lie below
    const std::optional<double> constant = torque_constant ? torque_constant : force_constant;
    const std::optional<double> value = torque_constant ? rated_torque : rated_force;
    if (!constant || !value || !rated_current) return {};
    const double made = *value / *rated_current;
    if (std::abs(*constant - made) <= kApart * made) return {};
    const char* const what = torque_constant ? "torque" : "force";
    const char* const unit = torque_constant ? "N m/A" : "N/A";
    return fmt::format(
        "rated_{0} over rated_current is {1:.4g} {2}, and {0}_constant {3:.4g} {2}: the first is taken; correct the wrong one, or leave "
        "it out (is one current a peak value, the other an RMS value?)",
        what, made, unit, *constant);
  }
  /// Largest force on the axis [N]; of peak value and set limit the smaller.
  [[nodiscard]] std::optional<double> peak() const noexcept {
    std::optional<double> most = at_axis(peak_torque, peak_force, peak_current);
    if (!most && peak_current && per_ampere()) most = *per_ampere() * *peak_current;
    const std::optional<double> all = rated();
    if (torque_limit && all) most = std::fmin(most.value_or(INFINITY), *torque_limit * *all);
    return most;
  }
  /// Mass of the rotors as the axis feels it [kg].
  [[nodiscard]] std::optional<double> reflected_mass() const noexcept {
    const auto r = radius();
    if (!r || !rotor_inertia) return std::nullopt;
    return motors * *rotor_inertia / (*r * *r);
  }
  /// Speed of the axis at the largest speed of the motor [m/s].
  [[nodiscard]] std::optional<double> top_speed() const noexcept {
    const auto r = radius();
    if (!r || !motor_speed) return std::nullopt;
    return *motor_speed * *r;
  }
  /// Step of the encoder on the axis [m].
  [[nodiscard]] std::optional<double> resolution() const noexcept {
    const auto r = radius();
    if (!r || !encoder_counts) return std::nullopt;
    return 2.0 * kPi * *r / *encoder_counts;
  }

 private:
  [[nodiscard]] std::optional<double> at_axis(std::optional<double> torque, std::optional<double> force,
                                              std::optional<double> current) const noexcept {
    if (!torque && torque_constant && current) torque = *torque_constant * *current;
    if (!force && force_constant && current) force = *force_constant * *current;
    const auto r = radius();
    if (torque && r) return motors * *torque / *r;
    if (force) return motors * *force;
    return std::nullopt;
  }
};

}  // namespace stribeck::workflow
