#pragma once
/// What is lost between motor and table, and how its compensation (lost_motion_move.hpp) moves the set-point of the motor: the same
/// keys in axis files and wherever they are read.
///
///   backlash        whole width of the play at position 0 [m], and its change along the travel
///   stiffness       of screw, nut and coupling [N/m], wound up by the friction of the table [N]: half the wind-up is their ratio
///
/// Where only the sum of both is known, it stands as backlash.
/// Real time: configure only. Errors: validate() says which values are missing.

#include <optional>
#include <stribeck/core/fields.hpp>

namespace stribeck::control {

/// How the set-point moves. Left out: as fast as the axis may.
struct LostMotionShape {
  std::optional<double> distance;  ///< [m]
  std::optional<int> cycles;
  std::optional<double> speed;         ///< [m/s]
  std::optional<double> acceleration;  ///< [m/s²]
  std::optional<double> jerk;          ///< [m/s³]

  static constexpr auto fields() {
    using S = LostMotionShape;
    return std::tuple{
        field(
            "distance", &S::distance, quantity("m", "um").positive(),
            "distance of the reference after a reversal over which the backlash is taken up; left out: at once, within the bounds")
            .or_default(),
        field("cycles", &S::cycles, pure_number().at_least(3.0).at_most(1000.0),
              "control periods that the move takes at least; left out: as few as the bounds permit")
            .or_default(),
        field("speed", &S::speed, quantity("m/s", "mm/s").positive(),
              "largest speed of the move; left out: that of the axis")
            .or_default(),
        field("acceleration", &S::acceleration, quantity("m/s2", "mm/s2").positive(),
              "largest acceleration of the move; left out: that of the axis")
            .or_default(),
        field("jerk", &S::jerk, quantity("m/s3", "mm/s3").positive(),
              "largest jerk of the move; left out: that of the axis")
            .or_default()};
  }
};

/// What is lost, as it was identified, and how it is compensated.
struct LostMotionParams {
  double backlash = 0.0;
  double backlash_slope = 0.0;
  std::optional<double> stiffness;
  double table_friction = 0.0;
  double table_mass = 0.0;
  double build_up = 3e-6;
  LostMotionShape move;

  static constexpr auto fields() {
    using P = LostMotionParams;
    return std::tuple{
        field("backlash", &P::backlash, quantity("m", "um").not_negative(),
              "play between motor and table at position 0, the whole width")
            .or_default(),
        field("backlash_slope", &P::backlash_slope, quantity("m/m", "um/m"),
              "change of the backlash along the travel; it never falls below 0")
            .or_default(),
        field("stiffness", &P::stiffness, quantity("N/m", "N/um").positive(),
              "wind-up: stiffness between motor and table; left out: no wind-up is compensated")
            .or_default(),
        field("table_friction", &P::table_friction, quantity("N", "N").not_negative(),
              "friction of the table alone while it slides slowly, which winds the stiffness up")
            .or_default(),
        field("table_mass", &P::table_mass, quantity("kg", "N s2/mm").not_negative(),
              "mass of the table alone, which stands while the motor crosses the play; 0: unknown")
            .or_default(),
        field("build_up", &P::build_up, quantity("m", "um").positive(),
              "distance after a reversal in which friction builds up to 1 - 1/e of its change")
            .or_default(),
        field("move", &P::move, "how the set-point of the motor moves").or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (stiffness && !(table_friction > 0.0))
      report("table_friction",
             "missing, expected the force that winds the stiffness up; or leave out stiffness");
    if (!stiffness && table_friction > 0.0)
      report("stiffness",
             "missing, expected the stiffness that table_friction winds up; or leave out table_friction");
  }
};

/// What the axis may do, where the parameters do not say it: its limits.
struct LostMotionBounds {
  double speed = 0.0;         ///< [m/s]
  double acceleration = 0.0;  ///< [m/s²]
  double jerk = 0.0;          ///< [m/s³]
  double travel_min = 0.0;    ///< [m]
  double travel_max = 0.0;    ///< [m]
};

}  // namespace stribeck::control
