#pragma once
/// The velocity or position loop of a virtual drive, cycle by cycle.
///
///   v̂   = difference of the motor's encoder over a cycle
///   v_c = command,  or  K_v·(x_c − x) + c·ẋ_c  with x_c in a straight line from command to command
///   F   = K·(v_c − v̂) + I + F_o → low-pass → ± largest force → delay,     I' = K/T_n·(v_c − v̂), at rest while F is limited
///
///   K, T_n, K_v, c: friction/drive_loop.hpp; F_o force offset [N]. All of it per cycle of the drive.
///
/// The integral begins with the constant load: the drive holds the axis before a run.
/// Source: Altintas, Verl, Brecher, Uriarte, Pritschow 2011, doi:10.1016/j.cirp.2011.05.010.
/// Not modelled: the current loop (bandwidth far above the cycle), notch filters, a second encoder of the position loop.
/// Real time: safe.

#include <array>
#include <cmath>
#include <optional>
#include <stribeck/friction/drive_loop.hpp>

namespace stribeck::plant {

struct DriveLoop {
  friction::DriveLoop loop;
  double cycle = 0.0;                           ///< [s]
  int delay_cycles = 0;                         ///< from the encoder to the force
  double filter_time = 0.0;                     ///< time constant of the low-pass for the force [s]
  std::optional<double> motor_resolution{};     ///< [m]
  std::optional<double> velocity_resolution{};  ///< of the command [m/s]
  std::optional<double> position_resolution{};  ///< of the command [m]
  std::optional<double> offset_resolution{};    ///< [N]

  static constexpr auto fields() {
    using D = DriveLoop;
    return std::tuple{
        embedded(&D::loop),
        field("cycle", &D::cycle, quantity("s", "us").at_least(10e-6),
              "period of the loops in the drive; a whole number of them should fit into sample_time"),
        field("delay_cycles", &D::delay_cycles, pure_number().not_negative().at_most(8.0),
              "cycles from the encoder to the force")
            .or_default(),
        field("filter_time", &D::filter_time, quantity("s", "ms").not_negative(),
              "time constant of the low-pass for the force")
            .or_default(),
        field("motor_resolution", &D::motor_resolution, quantity("m", "nm").positive(),
              "step of the motor's encoder, seen at the axis; left out: exact")
            .or_default(),
        field("velocity_resolution", &D::velocity_resolution, quantity("m/s", "mm/s").positive(),
              "step of a commanded velocity; left out: exact")
            .or_default(),
        field("position_resolution", &D::position_resolution, quantity("m", "nm").positive(),
              "step of a commanded position; left out: exact")
            .or_default(),
        field("offset_resolution", &D::offset_resolution, quantity("N", "N").positive(),
              "step of the force offset, e.g. a thousandth of the rated force; left out: exact")
            .or_default()};
  }
};

/// The loops while they run.
class RunningLoop {
 public:
  static constexpr std::size_t kMostDelay = 8;

  /// period of the controller [s]; most: largest force [N].
  RunningLoop(const DriveLoop& d, double period, double most) noexcept
      : d_(d), most_(most), stiffness_(d.loop.stiffness()) {
    const double cycles = std::nearbyint(period / d.cycle);
    cycles_ = cycles >= 1.0 ? static_cast<int>(cycles) : 1;
    step_ = period / cycles_;
    share_ = d.filter_time > 0.0 ? 1.0 - std::exp(-step_ / d.filter_time) : 1.0;
  }

  [[nodiscard]] int cycles() const noexcept { return cycles_; }
  [[nodiscard]] double cycle() const noexcept { return step_; }  ///< [s]

  /// At rest at position x [m], holding a force [N].
  void start(double x, double force, bool quantised) noexcept {
    quantised_ = quantised;
    position_ = rounded(x, d_.motor_resolution);
    command_ = is_position() ? x : 0.0;
    integral_ = d_.loop.integral_time ? force : 0.0;  // without an integral part nothing goes on to hold it
    filtered_ = force;
    waiting_.fill(force);
  }
  /// Takes the command of a period: velocity [m/s] or position [m], and the force offset [N].
  void command(double value, double offset) noexcept {
    from_ = command_;
    command_ = rounded(value, is_position() ? d_.position_resolution : d_.velocity_resolution);
    offset_ = d_.loop.force_offset ? rounded(offset, d_.offset_resolution) : 0.0;
  }
  /// Force for cycle i of the period [N], from the motor's position [m].
  double force(int i, double x) noexcept {
    const double seen = rounded(x, d_.motor_resolution);
    const double velocity = (seen - position_) / step_;
    position_ = seen;
    double wanted = command_;
    if (is_position()) {
      const double change = (command_ - from_) / cycles_;
      wanted = *d_.loop.position_gain * (from_ + (i + 0.5) * change - seen) +
               *d_.loop.velocity_feedforward * change / step_;
    }
    const double error = wanted - velocity;
    const double integral = integral_ + stiffness_ * step_ * error;
    filtered_ += share_ * (d_.loop.gain * error + integral + offset_ - filtered_);
    const double out = filtered_ < -most_ ? -most_ : filtered_ > most_ ? most_ : filtered_;
    if (out == filtered_ || out * error < 0.0) integral_ = integral;
    filtered_ = out;
    for (std::size_t k = kMostDelay; k > 0; --k) waiting_[k] = waiting_[k - 1];
    waiting_[0] = out;
    return waiting_[static_cast<std::size_t>(d_.delay_cycles)];
  }

 private:
  [[nodiscard]] bool is_position() const noexcept { return d_.loop.mode == friction::DriveMode::kPosition; }
  [[nodiscard]] double rounded(double x, const std::optional<double>& step) const noexcept {
    return quantised_ && step ? *step * std::nearbyint(x / *step) : x;
  }

  DriveLoop d_;
  double most_;
  double stiffness_;
  int cycles_ = 1;
  double step_ = 0.0;   ///< cycle that fits into the period [s]
  double share_ = 1.0;  ///< of the low-pass per cycle
  bool quantised_ = true;
  double position_ = 0.0;
  double from_ = 0.0;
  double command_ = 0.0;
  double offset_ = 0.0;
  double integral_ = 0.0;
  double filtered_ = 0.0;
  std::array<double, kMostDelay + 1> waiting_{};
};

}  // namespace stribeck::plant
