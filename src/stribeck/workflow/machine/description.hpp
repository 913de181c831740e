#pragma once
/// A machine as its file describes it. A real one has limits, a drive with its data sheet and rough values; a virtual one has
/// the truth of every axis besides (`plant`), for the verbs that simulate. as_machine() makes of it what the simulation and
/// the controllers know: values that the file leaves out are proposed from the others.
///
///   ω ≤ 0.2/T             the loop samples a double pole well
///   ω ≤ 0.3/(1.5·T + d)   and bears the delay d of a virtual drive; without one it is the same
///   ω ≤ 0.15·F·T/(2·m·q)  a step q of the encoder, differenced, moves the force by at most 15 % of the friction
///   ω ≤ 80 rad/s          elasticity of the drive is not excited
///   ω ≥ √(F/(m·e))        against friction alone the loop is off by no more than e, 0.5 % of the travel; for this the
///                         force may move by up to half of the friction with a step of the encoder
///   observer pole ω/2
///   sine: a third of the travel, 90 % of the speed limit, half of the acceleration limit; where a period would take more
///         than 30 s, a smaller amplitude
///
/// Real time: no.

#include <fmt/core.h>

#include <optional>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/workflow/machine/drive_data.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// A value that is known roughly: `"45 kg"`, which may be wrong by a factor of three either way, or a range
/// `["30 kg", "60 kg"]`, which holds the truth for certain.
class Rough : public FixedVector<double, 2> {
 public:
  static constexpr double kUnknownFactor = 3.0;

  Rough() = default;
  Rough(double value)
      : FixedVector<double, 2>(value) {}  // NOLINT(google-explicit-constructor): a value is one
  Rough(double low, double high) : FixedVector<double, 2>(low, high) {}

  [[nodiscard]] bool is_range() const noexcept { return size() == 2; }
  [[nodiscard]] double middle() const noexcept {
    return empty() ? 0.0 : is_range() ? 0.5 * ((*this)[0] + (*this)[1]) : (*this)[0];
  }
  [[nodiscard]] double low() const noexcept { return is_range() ? (*this)[0] : middle() / kUnknownFactor; }
  [[nodiscard]] double high() const noexcept { return is_range() ? (*this)[1] : middle() * kUnknownFactor; }
  /// What is wrong with it; empty: nothing.
  [[nodiscard]] std::string_view problem() const noexcept {
    if (empty()) return "got an empty list, expected a value or a range of two";
    return is_range() && !((*this)[0] < (*this)[1]) ? "a range has the smaller value first" : "";
  }
};

/// What is known of the unbalance of a rotary axis (friction/unbalance.hpp): a torque, or a mass at a distance.
struct RoughUnbalance {
  static constexpr double kGravity = 9.80665;  // [m/s²]

  Rough torque;                      ///< [N m]
  Rough mass;                        ///< [kg]
  std::optional<double> distance{};  ///< [m]
  std::optional<double> hangs_at{};  ///< [rad]; left out: at any angle

  static constexpr auto fields() {
    using I = RoughUnbalance;
    return std::tuple{
        field("torque", &I::torque, quantity("N m", "N m").positive(),
              "largest torque of the weight about the axis; one value (may be wrong by a factor of three "
              "either way) or a range of two")
            .or_default(),
        field("mass", &I::mass, quantity("kg", "kg").positive(),
              "in place of torque, with distance: what is heavy; one value or a range of two")
            .or_default(),
        field("distance", &I::distance, quantity("m", "mm").positive(),
              "from the axis of rotation to the centre of that mass")
            .or_default(),
        field("hangs_at", &I::hangs_at, quantity("rad", "deg"),
              "angle at which the heavy side hangs down; left out: not known, excitations are safe for any")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (torque.empty() == mass.empty())
      report(torque.empty() ? "torque" : "mass",
             "expected torque, or mass with distance, e.g. torque = \"110 N m\"; one of both");
    if (mass.empty() == distance.has_value())
      report("distance",
             "goes with mass: expected both or none, e.g. mass = \"25 kg\", distance = \"450 mm\"");
    for (const auto& [key, rough] : {std::pair{"torque", &torque}, std::pair{"mass", &mass}}) {
      if (rough->empty()) continue;
      if (const auto what = rough->problem(); !what.empty()) report(key, what);
    }
  }

  [[nodiscard]] double middle() const noexcept {
    return torque.empty() ? per_mass() * mass.middle() : torque.middle();
  }
  [[nodiscard]] double low() const noexcept {
    return torque.empty() ? per_mass() * mass.low() : torque.low();
  }
  [[nodiscard]] double high() const noexcept {
    return torque.empty() ? per_mass() * mass.high() : torque.high();
  }

 private:
  [[nodiscard]] double per_mass() const noexcept { return kGravity * distance.value_or(0.0); }
};

/// What is known of an axis before it is identified: enough to move it and record a log.
struct RoughAxis {
  static constexpr double kHeaviest = 1e9;  ///< a slip of the unit beyond [kg]

  Rough mass;                                  ///< nominal, from data sheets [kg]
  Rough friction;                              ///< level, from a first push by hand or a slow ramp [N]
  std::optional<double> omega{};               ///< double pole of the position loop while recording [rad/s]
  std::optional<double> observer_pole{};       ///< of the disturbance observer while recording [1/s]
  std::optional<double> sine_offset{};         ///< [m]
  std::optional<double> sine_amplitude{};      ///< [m]
  std::optional<double> sine_frequency{};      ///< [rad/s]
  std::optional<double> encoder_resolution{};  ///< [m]; left out: see AxisDescription
  Rough load{};                                ///< constant force against +x [N]; left out: none
  std::optional<RoughUnbalance> unbalance{};   ///< of a rotary axis; left out: balanced

  static constexpr auto fields() {
    using C = RoughAxis;
    return std::tuple{
        field(
            "mass", &C::mass, quantity("kg", "kg").positive().at_most(kHeaviest),
            "nominal equivalent mass with the reflected rotor, from data sheets; one value (may be wrong by a "
            "factor of three either way) or a range of two"),
        field(
            "friction", &C::friction, quantity("N", "N").positive().at_most(sim::AxisLimits::kStrongest),
            "rough level of friction, from a slow ramp of force; one value (may be wrong by a factor of three "
            "either way) or a range of two"),
        field(
            "load", &C::load, quantity("N", "N"),
            "constant force against the positive direction, e.g. weight less counterbalance; one value or a range of two, "
            "e.g. empty and with the heaviest workpiece; half of what differs by direction is then taken for a load; 0 N: nothing pulls the "
            "axis, so that it is friction; left out: none is known")
            .or_default(),
        field(
            "unbalance", &C::unbalance,
            "weight of a rotary axis that is not balanced and not upright, e.g. a trunnion; left out: balanced")
            .or_default(),
        field("omega", &C::omega, quantity("rad/s", "rad/s").positive(),
              "double pole of the position loop while recording; left out: from period, encoder and friction")
            .or_default(),
        field("observer_pole", &C::observer_pole, control::kObserverPole,
              "poles of the disturbance observer while recording; left out: half of omega")
            .or_default(),
        field("sine_offset", &C::sine_offset, quantity("m", "mm"),
              "middle of the sine excitation; left out: the middle of the travel")
            .or_default(),
        field("sine_amplitude", &C::sine_amplitude, quantity("m", "mm").positive(),
              "amplitude of the sine excitation; left out: a third of the travel")
            .or_default(),
        field(
            "sine_frequency", &C::sine_frequency, quantity("rad/s", "rad/s").positive(),
            "angular frequency of the sine excitation; left out: as the limits of speed and acceleration allow")
            .or_default(),
        field("encoder_resolution", &C::encoder_resolution, quantity("m", "nm").positive(),
              "step of the encoder, from its data sheet; left out: what drive.encoder_counts makes, or "
              "plant.encoder.resolution")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (const auto what = mass.problem(); !what.empty()) report("mass", what);
    if (const auto what = friction.problem(); !what.empty()) report("friction", what);
    if (load.is_range() && !load.problem().empty()) report("load", load.problem());
  }

  [[nodiscard]] double load_force() const noexcept { return load.middle(); }
  /// The load may differ from load_force() by that much; one value is taken as known.
  [[nodiscard]] double load_spread() const noexcept {
    return load.is_range() ? 0.5 * (load[1] - load[0]) : 0.0;
  }
};

/// A rotary axis is carried as a linear one at a radius of 1 m: its angle is the travel, its torque the force, its inertia the mass.
struct AxisDescription {
  bool rotary = false;
  std::optional<plant::AxisParams> plant;  ///< of a virtual machine
  sim::AxisLimits limits;
  RoughAxis commissioning;
  std::optional<DriveData> drive;
  std::optional<friction::DriveLoop> drive_loop;
  sim::Published published;

  static constexpr auto fields() {
    using A = AxisDescription;
    return std::tuple{
        field(
            "rotary", &A::rotary,
            "the axis turns: below it angles stand for lengths, torques for forces, an inertia for the mass; it is "
            "carried as a linear axis at a radius of 1 m")
            .or_default(),
        field("plant", &A::plant,
              "the truth of a virtual machine, for the verbs that simulate; no controller sees it")
            .or_default(),
        field("limits", &A::limits, "what the axis may do"),
        field("commissioning", &A::commissioning, "known before identification"),
        field("drive", &A::drive, "motor and transmission, from their data sheets").or_default(),
        field(
            "drive_loop", &A::drive_loop,
            "velocity or position loop that the drive closes itself, from its settings; left out: plant.drive_loop, or a "
            "drive that takes a force")
            .or_default(),
        field("published", &A::published, "printed parameters, for --parameters thesis").or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (plant && limits.force && *limits.force > sim::NamePlate::of(*plant).force)
      report("limits.force", "above what plant.drive makes at the end of plant.converter.range");
    if (drive && drive->peak() && limits.force && *limits.force > *drive->peak())
      report("limits.force", "above the peak of the drive");
    for (const bool known : {true, false}) {
      if (rotary || !(known ? commissioning.unbalance.has_value() : plant && plant->unbalance)) continue;
      report(known ? "commissioning.unbalance" : "plant.unbalance",
             "belongs to an axis that turns: write rotary = true, or load for a weight along the travel");
    }
    // Whoever writes the mass of the table alone would get a loop and an excitation for an axis that does not exist.
    const auto rotor = drive ? drive->reflected_mass() : std::nullopt;
    if (rotor && commissioning.mass.high() < *rotor) {
      report(
          "commissioning.mass",
          fmt::format(
              "less than the rotor alone, {:.4g} {} (drive.rotor_inertia through the transmission); it is all that the "
              "drive accelerates, so with the table {:.4g} {}",
              *rotor, rotary ? "kg m2" : "kg", *rotor + commissioning.mass.middle(),
              rotary ? "kg m2" : "kg"));
    }
  }

  /// As declared in limits, drive and commissioning, or else from the true drive's own data; 0: not known.
  [[nodiscard]] sim::NamePlate name_plate() const;
  /// Largest force of the drive [N]; 0: not known.
  [[nodiscard]] double force_limit() const { return name_plate().force; }
  /// Force per volt of the command [N/V]; 0: not known.
  [[nodiscard]] double force_per_volt() const;
  /// A brake is there to hold a weight, but the file says no weight: the axis may fall, and nobody knows with which force.
  [[nodiscard]] bool weight_unsaid() const noexcept {
    return drive && drive->brake && commissioning.load.empty() && !commissioning.unbalance;
  }
};

struct MachineDescription {
  std::string name;
  std::string origin;
  double sample_time = 0.0;  ///< control period [s]
  std::vector<std::pair<std::string, AxisDescription>> axes;

  static constexpr auto fields() {
    using M = MachineDescription;
    return std::tuple{
        field("name", &M::name, "name of the machine"),
        field("origin", &M::origin, "where the numbers come from").or_default(),
        field("sample_time", &M::sample_time, quantity("s", "ms").positive().at_most(0.1), "control period"),
        field("axes", &M::axes, "one table per axis: [axes.x], [axes.y], …")};
  }
  template <class Report>
  void validate(Report&& report) const {
    sim::Machine names;
    for (const auto& axis : axes) names.axes.emplace_back(axis.first, sim::MachineAxis{});
    names.validate(report);
  }

  /// An axis that exists.
  [[nodiscard]] const AxisDescription& axis(std::string_view called) const {
    std::size_t i = 0;
    while (axes[i].first != called) ++i;
    return axes[i].second;
  }
};

/// A value and why it is this one.
struct Proposed {
  double value = 0.0;
  std::string reason;
};

struct Proposal {
  Proposed omega;           ///< [rad/s]
  Proposed observer_pole;   ///< [1/s]
  Proposed sine_offset;     ///< [m]
  Proposed sine_amplitude;  ///< [m]
  Proposed sine_frequency;  ///< [rad/s]
};

/// Loop and excitation for recording logs, as the file says them or from its numbers.
Proposal propose(const AxisDescription& axis, double sample_time);

/// With every value that the file leaves out. An axis without truth has an empty plant there.
sim::Machine as_machine(const MachineDescription& description);

}  // namespace stribeck::workflow
