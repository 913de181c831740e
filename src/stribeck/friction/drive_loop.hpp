#pragma once
/// The loops that a drive closes itself, as far as a controller above it knows them.
///
///   velocity   F = K·{ (v_c − v) + (1/T_n)·∫(v_c − v)dt } + F_o
///   position   the same with  v_c = K_v·(x_c − x) + c·ẋ_c
///
///   v_c, x_c command [m/s, m], v, x of the motor, seen at the axis, F force on the axis [N], F_o force offset beside the command
///   [N] (torque offset, CiA 402 object 60B2h), K [N·s/m], T_n [s], K_v [1/s], c [1].
///
/// Source: Altintas, Verl, Brecher, Uriarte, Pritschow 2011, Machine tool feed drives, doi:10.1016/j.cirp.2011.05.010.
/// Not modelled here: cycle, delay and filters of the drive (plant/drive_loop.hpp simulates them).
/// Real time: safe.

#include <optional>
#include <stribeck/core/fields.hpp>

namespace stribeck::friction {

enum class DriveMode { kVelocity, kPosition };

struct DriveLoop {
  DriveMode mode = DriveMode::kVelocity;
  double gain = 0.0;                             ///< K [N·s/m]
  std::optional<double> integral_time{};         ///< T_n [s]; absent: no integral part
  std::optional<double> position_gain{};         ///< K_v [1/s]
  std::optional<double> velocity_feedforward{};  ///< c
  bool force_offset = false;
  bool force_feedback = false;

  static constexpr auto fields() {
    using D = DriveLoop;
    constexpr auto kPositionMode = [](const D& d) { return d.mode == DriveMode::kPosition; };
    return std::tuple{
        field("mode", &D::mode, "what the drive takes as its command: velocity or position"),
        field("gain", &D::gain, quantity("N s/m", "N s/mm").positive(),
              "gain of the velocity loop: force per velocity error"),
        field("integral_time", &D::integral_time, quantity("s", "ms").positive(),
              "integral time of the velocity loop; left out: no integral part")
            .or_default(),
        field("position_gain", &D::position_gain, quantity("1/s", "1/s").positive(),
              "gain of the position loop (Kv factor)")
            .or_default()
            .when(kPositionMode, "belongs to mode = \"position\""),
        field("velocity_feedforward", &D::velocity_feedforward, pure_number().not_negative().at_most(1.0),
              "share of the velocity of the commanded position that the drive feeds forward")
            .or_default()
            .when(kPositionMode, "belongs to mode = \"position\""),
        field("force_offset", &D::force_offset,
              "whether the drive takes a force (torque) offset beside its command")
            .or_default(),
        field(
            "force_feedback", &D::force_feedback,
            "whether the drive reports the force (torque) that it makes; without it observers and adaptation rest")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (mode != DriveMode::kPosition) return;
    if (!position_gain) report("position_gain", "missing, mode = \"position\" needs it");
    if (!velocity_feedforward)
      report(
          "velocity_feedforward",
          "missing, mode = \"position\" needs it: 0 for a drive that feeds no velocity forward, 1 for all of it");
  }

  /// K/T_n [N/m]
  [[nodiscard]] double stiffness() const noexcept { return integral_time ? gain / *integral_time : 0.0; }
};

}  // namespace stribeck::friction

template <>
struct stribeck::EnumNames<stribeck::friction::DriveMode> {
  static constexpr std::array names{
      std::pair{stribeck::friction::DriveMode::kVelocity, std::string_view{"velocity"}},
      std::pair{stribeck::friction::DriveMode::kPosition, std::string_view{"position"}}};
};
