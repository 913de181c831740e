#pragma once
/// A virtual machine as its file describes it: the true parameters of every axis, and the data that a commissioning engineer
/// may have. Controllers and compensators are built from `limits`, `commissioning`, `published` and identified
/// axis files, never from `plant`. Everybody knows the data on the name plates of drive and encoder (NamePlate).
/// Real time: no.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <stribeck/control/compensation/compensation_settings.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/plant/params.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::sim {

/// Limits of the axis.
struct AxisLimits {
  double travel_min = 0.0;
  double travel_max = 0.0;
  double speed = 0.0;
  double acceleration = 0.0;
  std::optional<double> jerk{};   ///< absent: the acceleration within kJerkTime
  std::optional<double> force{};  ///< largest force of the drive; absent: see NamePlate

  /// [m/s³]
  [[nodiscard]] double jerk_or_default() const { return jerk ? *jerk : acceleration / kJerkTime; }

  static constexpr double kJerkTime = 0.1;  ///< [s]
  // No axis goes there: what is beyond is a slip of the pen or of the unit.
  static constexpr double kFarthest = 1e5;   ///< [m]
  static constexpr double kFastest = 1e4;    ///< [m/s]
  static constexpr double kSteepest = 1e6;   ///< [m/s²]
  static constexpr double kStrongest = 1e9;  ///< [N]

  static constexpr auto fields() {
    return std::tuple{field("travel_min", &AxisLimits::travel_min,
                            quantity("m", "mm").at_least(-kFarthest).at_most(kFarthest), "lowest position"),
                      field("travel_max", &AxisLimits::travel_max,
                            quantity("m", "mm").at_least(-kFarthest).at_most(kFarthest), "highest position"),
                      field("speed", &AxisLimits::speed, quantity("m/s", "mm/s").positive().at_most(kFastest),
                            "largest speed, both directions"),
                      field("acceleration", &AxisLimits::acceleration,
                            quantity("m/s2", "mm/s2").positive().at_most(kSteepest), "largest acceleration"),
                      field("jerk", &AxisLimits::jerk, quantity("m/s3", "mm/s3").positive(),
                            "largest jerk on a part program; left out: the acceleration in 0.1 s")
                          .or_default(),
                      field("force", &AxisLimits::force, quantity("N", "N").positive().at_most(kStrongest),
                            "largest force of the drive; left out: what plant.drive makes at the end of "
                            "plant.converter.range")
                          .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (!(travel_max > travel_min)) report("travel_max", "expected a position above travel_min");
  }
};

/// Rough data before identification: enough to move the axis and record a log.
struct Commissioning {
  double mass = 0.0;                           ///< nominal, from data sheets [kg]
  double friction = 0.0;                       ///< rough level, from a first push by hand or a slow ramp [N]
  double omega = 40.0;                         ///< double pole of the position loop while recording [rad/s]
  double observer_pole = 20.0;                 ///< of the disturbance observer while recording [1/s]
  double sine_offset = 0.0;                    ///< [m]
  double sine_amplitude = 0.0;                 ///< [m]
  double sine_frequency = 0.0;                 ///< [rad/s]
  std::optional<double> encoder_resolution{};  ///< [m]; absent: see NamePlate

  static constexpr auto fields() {
    return std::tuple{
        field("mass", &Commissioning::mass, quantity("kg", "N s2/mm").positive(),
              "nominal equivalent mass, from data sheets"),
        field("friction", &Commissioning::friction, quantity("N", "N").positive(),
              "rough level of friction, from a slow ramp of force"),
        field("omega", &Commissioning::omega, quantity("rad/s", "rad/s").positive(),
              "double pole of the position loop while recording")
            .or_default(),
        field("observer_pole", &Commissioning::observer_pole, control::kObserverPole,
              "poles of the disturbance observer while recording")
            .or_default(),
        field("sine_offset", &Commissioning::sine_offset, quantity("m", "mm"),
              "middle of the sine excitation"),
        field("sine_amplitude", &Commissioning::sine_amplitude, quantity("m", "mm").positive(),
              "amplitude of the sine excitation"),
        field("sine_frequency", &Commissioning::sine_frequency, quantity("rad/s", "rad/s").positive(),
              "angular frequency of the sine excitation"),
        field("encoder_resolution", &Commissioning::encoder_resolution, quantity("m", "nm").positive(),
              "step of the encoder, from its data sheet; left out: plant.encoder.resolution")
            .or_default()};
  }
};

/// Parameters printed for this machine, for comparison.
struct Published {
  std::optional<friction::AxisModel> conventional;
  std::optional<friction::AxisModel> gaussian;
  std::optional<friction::AxisModel> eccentric;

  static constexpr auto fields() {
    return std::tuple{
        field("conventional", &Published::conventional, "printed conventional model").or_default(),
        field("gaussian", &Published::gaussian, "printed Gaussian-augmented model").or_default(),
        field("eccentric", &Published::eccentric, "printed model with terms periodic in position")
            .or_default()};
  }
};

/// Data on the name plates of drive and encoder.
struct NamePlate {
  double force = 0.0;               ///< largest of the drive [N]
  double encoder_resolution = 0.0;  ///< [m]

  /// From the true drive, for machine files that do not give them. Outside the simulation, only this function reads the true
  /// parameters.
  static NamePlate of(const plant::AxisParams& truth) {
    return {truth.force_gain() * truth.converter.range, truth.encoder.resolution};
  }
};

struct MachineAxis {
  plant::AxisParams plant;
  AxisLimits limits;
  Commissioning commissioning;
  Published published;
  /// Settings of the drive's own loops as its user knows them; absent: those of plant.drive_loop.
  std::optional<friction::DriveLoop> drive_loop{};
  bool rotary = false;  ///< carried as a linear axis at a radius of 1 m; no key here: the machine file's own
  std::string
      truth_from{};  ///< file of the identified model that stands for the truth; empty: the machine file has it

  static constexpr auto fields() {
    return std::tuple{
        field("plant", &MachineAxis::plant, "the truth; no controller sees it"),
        field("limits", &MachineAxis::limits, "what the axis may do"),
        field("commissioning", &MachineAxis::commissioning, "known before identification"),
        field("published", &MachineAxis::published, "printed parameters, for --parameters thesis")
            .or_default(),
        field("drive_loop", &MachineAxis::drive_loop,
              "velocity or position loop of the drive as its user knows it; left out: plant.drive_loop")
            .or_default()};
  }
  /// What a controller knows of the drive's own loops: they are settings that its user can read.
  [[nodiscard]] std::optional<friction::DriveLoop> known_loop() const {
    if (drive_loop) return drive_loop;
    if (plant.drive_loop) return plant.drive_loop->loop;
    return {};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (limits.force && *limits.force > NamePlate::of(plant).force)
      report("limits.force", "above what plant.drive makes at the end of plant.converter.range");
  }

  /// The values of limits and commissioning; where they are absent, the drive's own.
  [[nodiscard]] NamePlate name_plate() const {
    const NamePlate own = NamePlate::of(plant);
    return {limits.force.value_or(own.force),
            commissioning.encoder_resolution.value_or(own.encoder_resolution)};
  }
  /// Largest force of the drive [N].
  [[nodiscard]] double force_limit() const { return name_plate().force; }
};

/// Whether an axis can have this name, which becomes part of file and column names: 1 to 16 letters and digits.
constexpr bool is_axis_name(std::string_view name) {
  constexpr std::string_view kPermitted = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  return !name.empty() && name.size() <= 16 && name.find_first_not_of(kPermitted) == std::string_view::npos;
}

struct Machine {
  std::string name;
  std::string origin;
  double sample_time = 0.0;  ///< control period [s]
  std::vector<std::pair<std::string, MachineAxis>> axes;
  std::vector<std::string>
      left_out{};  ///< axes of the file that are not simulated, because nothing tells their truth

  static constexpr auto fields() {
    return std::tuple{field("name", &Machine::name, "name of the machine"),
                      field("origin", &Machine::origin, "where the numbers come from"),
                      field("sample_time", &Machine::sample_time, quantity("s", "ms").positive().at_most(0.1),
                            "control period"),
                      field("axes", &Machine::axes, "one table per axis: [axes.x], [axes.y], …")};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (axes.empty()) report("axes", "expected at least one axis");
    for (const auto& [axis, unused] : axes) {
      if (!is_axis_name(axis)) report("axes", "an axis name has 1 to 16 letters and digits, e.g. x or c2");
    }
  }
};

/// Number of trials that differ: they do so by their noise alone, so that one is all of them on axes without any.
inline std::uint32_t trials_that_differ(const Machine& machine, std::span<const std::size_t> axes,
                                        std::uint32_t trials) {
  const bool noise = std::any_of(axes.begin(), axes.end(), [&](std::size_t i) {
    const std::optional<plant::ForceNoise>& n = machine.axes[i].second.plant.noise;
    return n && n->rms > 0.0;
  });
  return noise ? trials : std::min(trials, 1U);
}

}  // namespace stribeck::sim
