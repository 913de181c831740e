#pragma once
/// Machines that differ at random from a given one: every axis gets its own deviations from the identified values.
///
///   friction    level and viscous part × (1 ± 0.3)
///   stiffness   σ0 of LuGre, every k_i of GMS × s = 1 ± 0.5; their damping × √s, the same damping ratio
///   mass        × (1 ± 0.2), rotor included
///   delay       0 or 1 more control periods
///   encoder     resolution × 1 … 10, uniform in the logarithm
///   axial mode  there or not; 60 … 300 Hz, uniform in the logarithm; damping ratio 0.02 … 0.05; table 5 … 20 % of the mass
///   periodic    one more additive term, 0 … 5 % of the level at rest, period 2 … 10 mm, any phase
///   warming     level and viscous part fall by 0 … 20 % during the run, with a time constant of 5 … 20 s
///
/// Distributions are uniform unless stated, independent, with the ranges in Variation. Proportional eccentric terms scale with the
/// level; additive ones and the load do not change. A drawn mode replaces the machine's own; with lost motion it is that of the table in
/// contact, by stiffness, damping and share of the table, and the backlash stays. Published and known data of the
/// machine, its drive, converter and limits do not change.
///
/// A stream depends on (seed, machine, axis) alone. Every factor takes its numbers from it even where it is not used, so that another
/// range of one factor does not change the others.
/// Not modelled: delays of a part of a control period, which the plant does not support; correlated factors
/// (stiff and heavy); a change of the shape of the friction curve.
/// Real time: no. Errors: Refused, with the factor.

#include <array>
#include <cstdint>
#include <optional>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::sim {

struct AxialModeVariation {
  double probability = 0.5;
  std::array<double, 2> frequency{60.0, 300.0};
  std::array<double, 2> damping_ratio{0.02, 0.05};
  std::array<double, 2> table_share{0.05, 0.2};

  static constexpr auto fields() {
    using V = AxialModeVariation;
    return std::tuple{
        field("probability", &V::probability, pure_number().not_negative().at_most(1.0),
              "how often an axis has a mode")
            .or_default(),
        field("frequency", &V::frequency, quantity("Hz", "Hz").positive(), "lowest and highest frequency")
            .or_default(),
        field("damping_ratio", &V::damping_ratio, pure_number().not_negative(), "least and most damping")
            .or_default(),
        field("table_share", &V::table_share, pure_number().positive().at_most(0.99),
              "least and greatest share of the mass that is the table")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    constexpr auto kExpected = "expected the lower end first";
    if (!(frequency[0] <= frequency[1])) report("frequency", kExpected);
    if (!(damping_ratio[0] <= damping_ratio[1])) report("damping_ratio", kExpected);
    if (!(table_share[0] <= table_share[1])) report("table_share", kExpected);
  }
};

/// Ranges in which machines may differ from the identified one.
struct Variation {
  double friction = 0.3;
  double stiffness = 0.5;
  double mass = 0.2;
  int delay = 1;
  double encoder = 10.0;
  std::optional<AxialModeVariation> axial_mode = AxialModeVariation{};
  double periodic = 0.05;
  std::array<double, 2> periodic_period{2e-3, 10e-3};
  double warming = 0.2;
  std::array<double, 2> warming_time{5.0, 20.0};

  /// Every machine is the nominal one.
  static Variation none() {
    Variation v;
    v.friction = v.stiffness = v.mass = v.periodic = v.warming = 0.0;
    v.delay = 0;
    v.encoder = 1.0;
    v.axial_mode.reset();
    return v;
  }

  static constexpr auto fields() {
    using V = Variation;
    constexpr Quantity kShare = pure_number().not_negative().at_most(0.9);
    return std::tuple{
        field("friction", &V::friction, kShare, "level and viscous part, ± this share").or_default(),
        field("stiffness", &V::stiffness, kShare, "stiffness of pre-sliding, ± this share").or_default(),
        field("mass", &V::mass, kShare, "equivalent mass, ± this share").or_default(),
        field("delay", &V::delay, pure_number().not_negative().at_most(8.0),
              "most control periods by which the control word acts later than on the nominal machine")
            .or_default(),
        field("encoder", &V::encoder, pure_number().at_least(1.0).at_most(1e4),
              "coarsest encoder, times the nominal resolution")
            .or_default(),
        field("axial_mode", &V::axial_mode, "first axial mode").or_default(),
        field("periodic", &V::periodic, kShare,
              "greatest amplitude of a term periodic in position, as a share of the level at rest")
            .or_default(),
        field("periodic_period", &V::periodic_period, quantity("m", "mm").positive(),
              "shortest and longest period of that term")
            .or_default(),
        field("warming", &V::warming, kShare, "greatest share by which friction falls during the run")
            .or_default(),
        field("warming_time", &V::warming_time, quantity("s", "s").positive(),
              "shortest and longest time constant of that")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    constexpr auto kExpected = "expected the lower end first";
    if (!(periodic_period[0] <= periodic_period[1])) report("periodic_period", kExpected);
    if (!(warming_time[0] <= warming_time[1])) report("warming_time", kExpected);
  }
};

/// A periodic term that was drawn.
struct PeriodicDeviation {
  double share = 0.0;   ///< of the level at rest
  double period = 0.0;  ///< [m]
  double phase = 0.0;   ///< [rad]
};

/// The random deviations of one axis.
struct Deviation {
  double friction = 1.0;   ///< factor
  double stiffness = 1.0;  ///< factor
  double mass = 1.0;       ///< factor
  int delay = 0;           ///< additional control periods
  double encoder = 1.0;    ///< factor of the resolution
  std::optional<plant::AxialMode> axial_mode;
  std::optional<PeriodicDeviation> periodic;
  std::optional<plant::Warming> warming;
};

/// Draws for an axis of machine number `machine`. The variation must be valid.
Deviation draw(const Variation& variation, std::uint64_t seed, std::uint32_t machine, std::uint32_t axis);

/// The parameters of the axis with this deviation.
plant::AxisParams deviated(const plant::AxisParams& nominal, const Deviation& deviation);

/// Machine number `machine` of a seed.
Machine vary(const Machine& nominal, const Variation& variation, std::uint64_t seed, std::uint32_t machine);

/// One of the machines that a given one may be.
struct NearbyMachine {
  std::string name;  ///< "nominal", "mass +20 %", …
  Machine machine;
};

/// The machines for which gains should do, by the ranges of Variation without chance, the same on every axis: the given one, each of mass
/// and friction alone up and down, both up and both down, one period later, and with a mode in the middle of its ranges. Without the
/// last two where the machine cannot have them.
std::vector<NearbyMachine> nearby_machines(const Machine& nominal);

/// Factors, by name: friction, stiffness, mass, delay, encoder, axial_mode, periodic, warming.
std::vector<std::string> variation_factors();

/// Default range of one factor, the others nominal. Throws Refused for an unknown name.
Variation vary_only(std::string_view factor);

/// Throws Refused when a range is invalid.
void check(const Variation& variation);

}  // namespace stribeck::sim
