#pragma once
/// What one test of an axis measures, by linear least squares: comparable from day to day because speeds, places and periods are those of
/// the first test.
///
///   f = m·a + k·(x − x₀) + Σ_k h_k(|v|)·F_k± + Σ_j sgn v·P_j(x) + Σ_λ (s_λ·sin + c_λ·cos)(2πx/λ) + noise
///
///   F_k±   friction and load at speed k of the plan, by direction. A motion that dwells at these speeds (jogs): rows within 5 % of one
///          count for it, and all others for twelve speeds of their own, so that the shape of the curve between does not matter.
///          Other motions: between two speeds on a straight line (h_k)
///   k      a spring, a cable chain or a balance, where the first test shows one; x₀ is the middle of its travel
///   M·sin(x − x₀)   the weight of an axis that turns (friction/unbalance.hpp), in place of k, where the first test shows it
///   P_j    how much more friction a quarter of the travel has than the mean of all four; sum 0
///   a, v   log::reconstruct; rows within 1/400 of the stroke after a reversal are left out
///
///   forward, backward   mean of the friction at all speeds, each against its motion, load included
///   coulomb, viscous    straight line through the mean of both directions, from a fifth of the top speed on
///   offset              half the difference of both directions: a load, positive against +x
///
/// Intervals: 95 %, under residuals that are correlated in time (stats/uncertainty.hpp). An absent value is not determined by the motion.
/// Not modelled: pre-sliding. Where the motion does not dwell: a curve between two speeds, which widens the intervals.
/// Real time: no. Errors: Refused, where a log does not hold the motion of the plan.

#include <array>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/refused.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::health {

struct Force {
  double value = 0.0;       ///< [N]
  double half_width = 0.0;  ///< [N]

  static constexpr auto fields() {
    return std::tuple{field("value", &Force::value, quantity("N", "N"), "measured value"),
                      field("half_width", &Force::half_width, quantity("N", "N").not_negative(),
                            "half of the 95 % interval")};
  }
};

struct Viscous {
  double value = 0.0;       ///< [N·s/m]
  double half_width = 0.0;  ///< [N·s/m]

  static constexpr auto fields() {
    return std::tuple{field("value", &Viscous::value, quantity("N s/m", "N s/mm"), "measured value"),
                      field("half_width", &Viscous::half_width, quantity("N s/m", "N s/mm").not_negative(),
                            "half of the 95 % interval")};
  }
};

struct Mass {
  double value = 0.0;       ///< [kg]
  double half_width = 0.0;  ///< [kg]

  static constexpr auto fields() {
    return std::tuple{field("value", &Mass::value, quantity("kg", "N s2/mm"), "measured value"),
                      field("half_width", &Mass::half_width, quantity("kg", "N s2/mm").not_negative(),
                            "half of the 95 % interval")};
  }
};

struct Stiffness {
  double value = 0.0;       ///< [N/m]
  double half_width = 0.0;  ///< [N/m]

  static constexpr auto fields() {
    return std::tuple{field("value", &Stiffness::value, quantity("N/m", "N/mm"), "measured value"),
                      field("half_width", &Stiffness::half_width, quantity("N/m", "N/mm").not_negative(),
                            "half of the 95 % interval")};
  }
};

struct AtSpeed {
  double speed = 0.0;  ///< [m/s]
  Force forward;
  Force backward;

  static constexpr auto fields() {
    return std::tuple{
        field("speed", &AtSpeed::speed, quantity("m/s", "mm/s").positive(), "speed"),
        field("forward", &AtSpeed::forward, "force against the motion towards +x, load included"),
        field("backward", &AtSpeed::backward, "force against the motion towards -x, load included")};
  }
};

struct AtPlace {
  double from = 0.0;  ///< [m]
  double to = 0.0;    ///< [m]
  Force more;

  static constexpr auto fields() {
    return std::tuple{field("from", &AtPlace::from, quantity("m", "mm"), "begin of the place"),
                      field("to", &AtPlace::to, quantity("m", "mm"), "end of the place"),
                      field("more", &AtPlace::more, "friction there less the mean of all places")};
  }
};

struct Periodic {
  double period = 0.0;  ///< [m]
  Force amplitude;

  static constexpr auto fields() {
    return std::tuple{
        field("period", &Periodic::period, quantity("m", "mm").positive(), "period of the position"),
        field("amplitude", &Periodic::amplitude, "amplitude of the force")};
  }
};

/// The motion of a test, by which two of them are compared.
struct TestMotion {
  std::array<double, 2> travel{};  ///< lowest and highest position [m]
  double top_speed = 0.0;          ///< [m/s]
  double acceleration = 0.0;       ///< RMS [m/s²]
  double duration = 0.0;           ///< of all rows [s]
  bool dwells = false;             ///< at the speeds of the plan

  static constexpr auto fields() {
    using M = TestMotion;
    return std::tuple{
        field("travel", &M::travel, quantity("m", "mm"), "lowest and highest position"),
        field("top_speed", &M::top_speed, quantity("m/s", "mm/s").positive(), "highest speed of the plan"),
        field("acceleration", &M::acceleration, quantity("m/s2", "mm/s2").not_negative(), "RMS"),
        field("duration", &M::duration, quantity("s", "s").positive(), "of the rows that were used"),
        field("dwells", &M::dwells, "whether it dwells at its speeds, as jogs do")};
  }
};

struct Measured {
  TestMotion motion;
  std::vector<AtSpeed> friction;  ///< ascending speeds
  Force forward;
  Force backward;
  Force offset;
  std::optional<Force> coulomb;
  std::optional<Viscous> viscous;
  std::optional<Mass> mass;
  std::optional<Stiffness> spring;  ///< absent: the first test showed none
  std::optional<Force> unbalance;   ///< largest torque of the weight; absent: the first test showed none
  std::vector<AtPlace> places;      ///< none: the motion does not determine them
  std::vector<Periodic> periodic;
  double residual = 0.0;  ///< RMS [N]

  static constexpr auto fields() {
    using M = Measured;
    return std::tuple{
        field("motion", &M::motion, "motion of the test"),
        field("friction", &M::friction, "friction by speed and direction"),
        field("forward", &M::forward, "mean over the speeds, motion towards +x"),
        field("backward", &M::backward, "mean over the speeds, motion towards -x"),
        field("offset", &M::offset, "load: half the difference of both directions, positive against +x"),
        field("coulomb", &M::coulomb, "friction of the straight line at rest").or_default(),
        field("viscous", &M::viscous, "slope of the straight line").or_default(),
        field("mass", &M::mass, "equivalent mass").or_default(),
        field(
            "spring", &M::spring,
            "force that grows with position, from the middle of the travel on: a spring, a cable chain or a balance")
            .or_default(),
        field("unbalance", &M::unbalance, "largest torque of the weight of an axis that turns").or_default(),
        field("places", &M::places, "friction along the travel").or_default(),
        field("periodic", &M::periodic, "forces periodic in position").or_default(),
        field("residual", &M::residual, quantity("N", "N").not_negative(), "RMS that remains")};
  }
};

/// What a test looks for.
struct Plan {
  std::vector<double> speeds;   ///< ascending [m/s]
  bool dwells = false;          ///< the motion dwells at them
  std::vector<double> borders;  ///< of the places; empty: none
  std::vector<double> periods;  ///< [m]
  bool spring = false;          ///< a force that grows with position is fitted too
  bool unbalance = false;       ///< the weight of an axis that turns is
  double middle = 0.0;          ///< of the travel [m]
};

/// From the motion of a first test. `period`: travel of one turn, 0 where none is known.
Plan plan_of(const std::vector<log::Record>& records, double period);
/// That of an earlier test.
Plan plan_of(const Measured& earlier);

/// `shift` of the force as in log::MotionOptions [rows].
Measured measure(const std::vector<log::Record>& records, const Plan& plan, double shift = -0.5);

/// Why the values of two tests cannot be compared; empty: they can.
std::vector<std::string> motion_differs(const TestMotion& motion, const TestMotion& reference,
                                        bool rotary = false);

}  // namespace stribeck::ident::health
