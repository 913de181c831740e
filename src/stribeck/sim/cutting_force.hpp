#pragma once
/// A milling-like force between tool and workpiece: a mean with ripples at once per turn of the spindle (run-out) and at the
/// tooth-passing frequency with one harmonic, from entry to exit.
///
///   f_along(t)  = w(t)·F_t·(1 + r cos Ωt + p cos zΩt + h cos 2zΩt)                 against the feed
///   f_across(t) = w(t)·F_n·(1 + r cos Ωt + p sin zΩt + h sin 2zΩt)                 towards minus the path's first normal
///
///   F_t, F_n means [N], r, p, h shares [1], z teeth, Ω = 2π·spindle speed [rad/s], w rises and falls linearly over the ramp.
///   An axis gets f_along·t_i + f_across·n_i; a positive force brakes a motion in +x, as friction does. On a path with a tool axis
///   the normal is o×t in the workpiece, and Jᵀ transforms the force to the axes.
///
/// The force depends on time alone, so it is the same in every trial and for every controller. A plant gets its exact mean over
/// each control period, held. The momentum at every tick is then exact, even of parts faster than half the sampling rate (there the
/// encoder aliases, as a real one does). The ripple inside a period is lost: F/(m·ω²), 8 nm for 50 N at 400 Hz on 1000 kg.
/// Source: Altintas, Manufacturing Automation, 2nd ed., 2012, chapter 2 (means and tooth-passing harmonics).
/// Not modelled: regeneration (chatter), feed per tooth, engagement that follows the path.
/// Real time: no.

#include <array>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/scalar.hpp>

namespace stribeck::sim {

struct CuttingForce {
  double spindle_speed = 25.0;  ///< [1/s]
  int teeth = 4;
  double along = 0.0;                                     ///< F_t [N]
  double across = 0.0;                                    ///< F_n [N]
  double run_out = 0.2;                                   ///< r
  double tooth_passing = 0.5;                             ///< p
  double second = 0.15;                                   ///< h
  double entry = 0.0;                                     ///< [s]
  double exit = std::numeric_limits<double>::infinity();  ///< [s]
  double ramp = 0.1;                                      ///< [s]

  static constexpr auto fields() {
    return std::tuple{
        field("spindle_speed", &CuttingForce::spindle_speed, quantity("1/s", "1/min").positive(),
              "turns of the spindle"),
        field("teeth", &CuttingForce::teeth, pure_number().at_least(1).at_most(64), "teeth of the cutter")
            .or_default(),
        field("along", &CuttingForce::along, quantity("N", "N"), "mean force against the feed"),
        field("across", &CuttingForce::across, quantity("N", "N"), "mean force across the path").or_default(),
        field("run_out", &CuttingForce::run_out, pure_number().not_negative(),
              "share of the mean, once per turn")
            .or_default(),
        field("tooth_passing", &CuttingForce::tooth_passing, pure_number().not_negative(),
              "share of the mean, once per tooth")
            .or_default(),
        field("second", &CuttingForce::second, pure_number().not_negative(),
              "share of the mean, twice per tooth")
            .or_default(),
        field("entry", &CuttingForce::entry, quantity("s", "s").not_negative(), "begin of the cut")
            .or_default(),
        field("exit", &CuttingForce::exit, quantity("s", "s").not_negative(),
              "end of the cut; left out: it does not end")
            .or_default(),
        field("ramp", &CuttingForce::ramp, quantity("s", "s").positive(), "time to enter and to leave")
            .or_default()};
  }

  [[nodiscard]] double turn_frequency() const noexcept { return 2.0 * kPi * spindle_speed; }  ///< Ω [rad/s]

  /// Mean of (f_along, f_across) from t to t + period [N]; w is evaluated in the middle.
  [[nodiscard]] std::array<double, 2> mean_over(double t, double period) const noexcept;
};

}  // namespace stribeck::sim
