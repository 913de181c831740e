#pragma once
/// Two-stage backlash acceleration of Fanuc servo axes: friction of the motor, then friction of the machine.
///
///   stage 1   at the reversal: the estimated friction × coefficient is reversed at once, a step of force
///   stage 2   an addition to the commanded speed, from a distance d after the reversal to 2·d (d written positive) or 3·d (negative)
///
/// Sources: B-65150E/04, 4.6.5; B-65270EN/05, 4.6.7. That the estimated friction is that of slow motion, that the distance is one of the
/// commanded position, and that stage 2 adds to the commanded speed is assumed: no manual at hand says so.
/// Not modelled: offset of stage 2, amounts by direction, its limit.
/// Real time: no.

#include <string>

namespace stribeck::targets {

struct TwoStages {
  double coefficient = 0.0;  ///< of stage 1; 1: all of the estimated friction
  double amount = 0.0;       ///< of stage 2 [m/s]
  double start = 0.0;        ///< distance d [m]
  double end = 2.0;          ///< end of stage 2 in d: 2 or 3
};

/// Lines for one axis, rounded as the text shows, and back.
std::string servo_parameters(const TwoStages& s, const std::string& axis);
TwoStages read_servo_parameters(const std::string& text, const std::string& axis);

}  // namespace stribeck::targets
