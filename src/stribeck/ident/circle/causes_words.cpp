#include <stribeck/ident/circle/causes.hpp>

namespace stribeck::ident::circle {

CauseWords words_of(const Diagnosis& d, CauseKind kind) {
  if (kind == CauseKind::kRadius && d.own_encoder)
    return {
        "the positions stay inside the commanded circle, or outside, in both axes alike: the axes lag behind their commands, or are fed "
        "forward too much",
        "switch on velocity and acceleration feed-forward, or raise the position gain of both axes; where the circle is too large, "
        "lower the acceleration feed-forward",
        true};
  if (!d.own_encoder) return words_of(kind);
  // The encoder of an axis sees this axis alone, and no instrument stands beside it.
  switch (kind) {
    case CauseKind::kSquareness:
      return {
          "the positions have the form of axes that are not square, which their own encoders cannot see: the loops make it, where one axis disturbs the other",
          "enter no angle; look at the loops at several feeds, and measure the squareness with a ball-bar or a grid encoder",
          false};
    case CauseKind::kStraightness:
      return {
          "the positions have the form of a bent guide, which their own encoders cannot see: what friction and the loops leave beside the spikes",
          "enter no correction; compensate the friction and repeat the circle, and measure the straightness with a straight edge or a laser",
          false};
    case CauseKind::kLateralPlay:
      return {
          "the positions have the form of a slide that moves sideways, which their own encoders cannot see: the reversal of one axis disturbs the other",
          "look at the loops of both axes at several feeds; measure play of a guide with a ball-bar or an indicator",
          false};
    case CauseKind::kCentre:
      return {
          "the middle of the positions is not the commanded one: friction, or a load, holds the axes on one side",
          "nothing where it is small; else integral action in the loops, or compensation of friction and load",
          false};
    default:
      break;
  }
  if (kind != CauseKind::kBacklash) return words_of(kind);
  return {
      "the position stays behind its command by this distance after each reversal: friction that the loop lets through, or play where its encoder is a scale at the table; negative: its compensation pushes too far",
      "do not enter it as backlash: identify the friction (stribeck identify) and compensate it, or give the loop more gain or integral action; measure play with a ball-bar, an indicator or a scale",
      true};
}

CauseWords words_of(const Diagnosis& d, const Cause& cause) {
  if (cause.kind == CauseKind::kReversalSpike && cause.broad)
    return {
        "the error behind a reversal reaches over 45 degrees: friction that builds up slowly, a soft loop, or an axis that sticks and slips all along",
        "look at the error over time first: a sawtooth is stick-slip (lubrication, stiffness of the drive, speed of the feed); else identify the friction of this axis (stribeck identify)",
        false};
  // Of two tops the first one tells what the axis does, the second what its loop makes of that.
  if (cause.kind == CauseKind::kReversalSpike && cause.before > 0.0)
    return {
        "the axis sticks for a moment after it has reversed, and goes too far when it comes loose, by what the integral part of its loop has gathered meanwhile",
        "identify the friction of this axis (stribeck identify) and switch on friction compensation, or give it more force where it is on: with it both parts go; check lubrication first",
        true};
  if (cause.kind == CauseKind::kReversalSpike && cause.before < 0.0)
    return {
        "the axis goes too far as soon as it has reversed, and its loop swings back: its friction compensation pushes too early or too much",
        "the friction compensation of this axis is too strong or comes too early: reduce its force or let it come later, then repeat the circle",
        true};
  if (cause.size < 0.0 && cause.kind == CauseKind::kReversalSpike)
    return {"the axis goes too far after it has reversed: its friction compensation pushes too much",
            "the friction compensation of this axis is too strong: reduce its force, then repeat the circle",
            true};
  if (cause.size < 0.0 && cause.kind == CauseKind::kBacklash && d.own_encoder)
    return {
        "the position is ahead of its command by this distance after each reversal: a compensation of this axis pushes too far",
        "the compensation of friction or backlash of this axis is too strong: reduce it, then repeat the circle",
        true};
  return words_of(d, cause.kind);
}

CauseWords words_of(CauseKind kind) {
  switch (kind) {
    case CauseKind::kReversalSpike:
      return {
          "the axis sticks for a moment after it has reversed; negative: its compensation pushes too much",
          "identify the friction of this axis (stribeck identify) and switch on friction compensation; check lubrication first",
          true};
    case CauseKind::kBacklash:
      return {
          "the slide follows the drive late by this distance after each reversal, beside what is compensated; negative: it is compensated too much",
          "check coupling, nut and bearings for play, and the positions of the control: what they show too is friction that the loop lets through; then add this value to the backlash compensation that is set (a negative one lowers it)",
          true};
    case CauseKind::kLateralPlay:
      return {"the slide moves sideways when it reverses",
              "adjust the gibs or the preload of the guide of this axis", false};
    case CauseKind::kCyclic:
      return {
          "the position error of this axis repeats with this pitch",
          "compare the pitch with lead, gear, belt and scale; repair the part with that pitch, or enter it in the screw error table",
          true};
    case CauseKind::kServoMismatch:
      return {"one axis follows later than the other",
              "set both axes to the same position gain, or to the lower of the two", true};
    case CauseKind::kScaleMismatch:
      return {"one axis travels farther than the other for the same command",
              "check temperature and scale of both axes; then correct the scale factor or the error table",
              true};
    case CauseKind::kSquareness:
      return {"the axes are not square to each other",
              "align the guides; where the control has it, enter the angle in its squareness compensation",
              true};
    case CauseKind::kStraightness:
      return {"a guide is bent along the other axis, or the scale errs with the square of the travel",
              "measure the straightness along the whole travel; align the guide, or fill a cross-error table",
              true};
    case CauseKind::kRadius:
      return {"the circle is larger or smaller than commanded in both axes alike",
              "check temperature, the calibrated length of the instrument and the scales of both axes", true};
    case CauseKind::kLag:
      return {"the circle shrinks with the square of the feed because the axes lag",
              "switch on velocity and acceleration feed-forward, or raise the position gain of both axes",
              true};
    case CauseKind::kVibration:
      return {
          "the tool swings at this frequency between the reversals",
          "compare the frequency with motor, pump and gear; lower the velocity gain or set a notch filter",
          true};
    case CauseKind::kCentre:
      return {"set-up: the instrument stood off the centre of the circle, the machine is not to blame",
              "nothing on the machine; centre the instrument better", false};
    case CauseKind::kDrift:
      return {
          "the centre of the circle moved evenly by this distance while the log was made: the machine warms up, or the instrument "
          "or its magnet slips",
          "repeat the measurement with a warm machine and a tight instrument", false};
  }
  return {};
}

}  // namespace stribeck::ident::circle
