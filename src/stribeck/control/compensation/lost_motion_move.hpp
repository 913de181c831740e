#pragma once
/// Compensation of lost motion where the control sees the motor: after a reversal of the reference, the set-point of the motor moves
/// by backlash and wind-up, as a move within bounds and never as a step.
///
///   r_m = r + p                          p = Box₁·Box₂·Box₃·p*          p* = h_b·b/2 + φ·(g·h_t + c·v)/k
///   f   = law(r_m) + F_own − F_law       F_own = (1 − φ)·(g·h_m + c·v_m) + k·w − m_t·p̈
///
///   b backlash [m], k stiffness [N/m], φ = (friction of the table)/g share of friction on the table, g level and c·v viscous part of
///   the friction map [N], m_t mass of the table [kg]; w [m] wind-up: the part of p beyond ±b/2, else 0. h: share of a reversal, −1 … 1. h_b: at once, or
///   linear over `distance`; h_t, h_m build up over `build_up` of table and motor. F_law: what the law feeds forward of its friction
///   model at r_m, which does not know that the table still stands.
///
/// The boxes are means over n₁ ≥ n₂ + n₃ periods: the move is the classical one in seven pieces, with speed D/n₁T, acceleration
/// D/n₁n₂T², jerk D/n₁n₂n₃T³, and D the lost motion. They follow from the bounds; `cycles` may make the move longer. It begins half
/// its time before the reversal, which is predicted from velocity, acceleration and jerk. A reversal during a move waits for its end.
/// Sign: p > 0 while the table moves in +x. Source: Biagiotti, Melchiorri 2012, doi:10.1016/j.conengprac.2012.01.005 (boxes).
/// Not modelled: load, cutting force and acceleration of the table in the wind-up; where in the play the axis starts (the middle).
/// Real time: safe, 2 evaluations of the map and those of the law; the constructor configure only.
/// Errors: a reference that is not finite gives the last output; lost_motion_move_fits() tells whether the memory suffices.

#include <algorithm>
#include <cmath>
#include <stribeck/control/compensation/compensation.hpp>
#include <stribeck/control/compensation/lost_motion_params.hpp>

namespace stribeck::control {

/// Lengths of the boxes in periods.
struct LostMotionBoxes {
  double first = 1.0;
  double second = 1.0;
  double third = 1.0;

  [[nodiscard]] double sum() const noexcept { return first + second + third; }
};

/// For a move of D [m] within bounds, in periods T [s], taking at least `least` periods.
inline LostMotionBoxes lost_motion_boxes(double D, const LostMotionBounds& most, double T,
                                         double least) noexcept {
  // Of a move limited by jerk alone: D = 2·J·τ³.
  double third = std::cbrt(0.5 * D / most.jerk);
  double second = third;
  if (third > most.acceleration / most.jerk) {
    third = most.acceleration / most.jerk;
    second = 0.5 * (std::sqrt(third * third + 4.0 * D / most.acceleration) - third);
  }
  double first = second + third;
  if (first * most.speed < D) {
    first = D / most.speed;
    third = std::min(most.acceleration / most.jerk, std::sqrt(most.speed / most.jerk));
    second = std::max(third, most.speed / most.acceleration);
  }
  const double stretch = std::max(1.0, least * T / (first + second + third));
  LostMotionBoxes n;
  n.third = std::max(1.0, std::ceil(stretch * third / T));
  n.second = std::max(n.third, std::ceil(stretch * second / T));
  n.first = std::max(n.second + n.third, std::ceil(stretch * first / T));
  return n;
}

class LostMotionMove {
 public:
  /// Longest boxes in periods.
  static constexpr std::size_t kMostFirst = 512;
  static constexpr std::size_t kMostLater = 256;

  struct Output {
    double position = 0.0;      ///< p [m]
    double velocity = 0.0;      ///< [m/s]
    double acceleration = 0.0;  ///< [m/s²]
    double force = 0.0;         ///< beside that of the law [N]
  };

  /// A mean over the last periods. A sum that is formed anew with every turn of the ring takes the place of the running one, so that
  /// rounding does not add up.
  template <std::size_t kMost>
  struct Box {
    std::array<double, kMost> past{};
    std::size_t at = 0;
    double sum = 0.0;
    double fresh = 0.0;

    double step(double in, std::size_t n) noexcept {
      sum += in - past[at];
      fresh += in;
      past[at] = in;
      if (++at == n) {
        at = 0;
        sum = fresh;
        fresh = 0.0;
      }
      return sum / static_cast<double>(n);
    }
  };

  struct State {
    Box<kMostFirst> first;
    Box<kMostLater> second;
    Box<kMostLater> third;
    Compensation::State law;
    std::array<double, 3> p{};       ///< of the next, this and the last period [m]
    double direction = 0.0;          ///< ς ahead; 0: none yet
    double wait = 0.0;               ///< periods until a reversal may begin another move
    double backlash_share = 0.0;     ///< h_b
    double table_share = 0.0;        ///< h_t
    double motor_share = 0.0;        ///< h_m
    double ahead = 0.0;              ///< reference at the end of the last prediction [m]
    double last_velocity = 0.0;      ///< of the reference [m/s]
    double last_acceleration = 0.0;  ///< of the reference [m/s²]
    bool started = false;
    Output out;
  };

  LostMotionMove() = default;
  /// `law`: the compensation of the controller, with the friction model of the axis.
  LostMotionMove(const LostMotionParams& params, const CompensationParams& law, const LostMotionBounds& axis,
                 double period) noexcept
      : params_(params), model_(law.model.friction), period_(period) {
    feeds_ = law.feedforward != Feedforward::kNone;
    CompensationParams plain = law;
    plain.observer = Observer::kNone;
    plain.adaptation.enabled = false;
    plain.guarded = false;
    plain.model.load = 0.0;
    law_ = Compensation(plain, period);
    const LostMotionBounds most = bounds(params, axis);
    const double level = slow_level(model_);
    share_ = params.stiffness && level > 0.0 ? min_of(1.0, params.table_friction / level) : 0.0;
    boxes_ = lost_motion_boxes(lost(params, axis), most, period,
                               params.move.cycles ? static_cast<double>(*params.move.cycles) : 0.0);
    lead_ = 0.5 * (boxes_.sum() - 3.0) * period + period;
  }

  /// One period: the reference of the table now, position [m], velocity [m/s], acceleration [m/s²].
  Output step(State& s, double position, double velocity, double acceleration) const noexcept {
    if (!isfinite(position + velocity + acceleration)) return s.out;
    const MotionAhead now{position, velocity, acceleration, jerk_of(s, velocity, acceleration)};
    const MotionAhead later = now.later(lead_);
    turn(s, later);
    const double half = half_backlash(later.position);
    double wanted = s.backlash_share * half;
    if (share_ > 0.0) {
      const auto f = model_.parts(later.velocity, later.position);
      wanted += share_ * (f.level * s.table_share + f.viscous) / *params_.stiffness;
    }
    const double next = s.third.step(
        s.second.step(s.first.step(wanted, count(boxes_.first)), count(boxes_.second)), count(boxes_.third));
    s.p = {next, s.p[0], s.p[1]};
    s.out.position = s.p[1];
    s.out.velocity = (s.p[0] - s.p[2]) / (2.0 * period_);
    s.out.acceleration = (s.p[0] - 2.0 * s.p[1] + s.p[2]) / (period_ * period_);
    s.out.force = force(s, now);
    s.last_velocity = velocity;
    s.last_acceleration = acceleration;
    s.started = true;
    return s.out;
  }

  [[nodiscard]] const LostMotionBoxes& boxes() const noexcept { return boxes_; }
  /// By how much the move begins before the reversal [s].
  [[nodiscard]] double lead() const noexcept { return lead_; }

  /// The largest move [m].
  [[nodiscard]] static double lost(const LostMotionParams& p, const LostMotionBounds& axis) noexcept {
    const double b = max_of(
        0.0, p.backlash + max_of(p.backlash_slope * axis.travel_min, p.backlash_slope * axis.travel_max));
    return b + (p.stiffness ? 2.0 * p.table_friction / *p.stiffness : 0.0);
  }
  /// Bounds of the move: its own, and those of the axis for the rest.
  [[nodiscard]] static LostMotionBounds bounds(const LostMotionParams& p,
                                               const LostMotionBounds& axis) noexcept {
    LostMotionBounds most = axis;
    if (p.move.speed) most.speed = *p.move.speed;
    if (p.move.acceleration) most.acceleration = *p.move.acceleration;
    if (p.move.jerk) most.jerk = *p.move.jerk;
    return most;
  }

 private:
  /// Slow, where a level of the map holds for a sliding axis [m/s].
  static constexpr double kSlow = 1e-3;

  static double slow_level(const friction::Model& model) noexcept {
    return 0.5 * (model.parts(kSlow, 0.0).level + model.parts(-kSlow, 0.0).level);
  }
  static std::size_t count(double n) noexcept { return static_cast<std::size_t>(n); }

  [[nodiscard]] double half_backlash(double x) const noexcept {
    return 0.5 * max_of(0.0, params_.backlash + params_.backlash_slope * x);
  }

  /// As in compensation.hpp: a step of acceleration is no jerk.
  [[nodiscard]] double jerk_of(const State& s, double velocity, double acceleration) const noexcept {
    if (!s.started || (velocity == 0.0 && acceleration == 0.0)) return 0.0;
    const double change = (acceleration - s.last_acceleration) / period_;
    const double felt = 2.0 * ((velocity - s.last_velocity) / period_ - s.last_acceleration) / period_;
    return clamp_to(felt, min_of(change, 0.0), max_of(change, 0.0));
  }

  /// Direction and shares, where the reference will be `lead` later.
  void turn(State& s, const MotionAhead& later) const noexcept {
    if (s.wait > 0.0) s.wait -= 1.0;
    const double moved = s.started ? abs(later.position - s.ahead) : 0.0;
    s.ahead = later.position;
    const double to = sign(later.velocity);
    if (to != 0.0 && to != s.direction && !(s.wait > 0.0)) {
      s.direction = to;
      s.wait = boxes_.sum();
    }
    s.table_share = s.direction + (s.table_share - s.direction) * exp(-moved / params_.build_up);
    // The table follows the motor, held by its friction, until that is gone: there the motor leaves it.
    const double side = sign(s.table_share);
    s.backlash_share =
        params_.move.distance
            ? clamp_to(s.backlash_share + 2.0 * side * moved / *params_.move.distance, -1.0, 1.0)
            : side;
  }

  /// Force beside that of the law.
  [[nodiscard]] double force(State& s, const MotionAhead& r) const noexcept {
    // Motor in the middle of the coming hold.
    const double p = 0.5 * (s.p[0] + s.p[1]);
    const double v = r.velocity_at(0.5 * period_) + (s.p[0] - s.p[1]) / period_;
    const double x = r.position_at(0.5 * period_) + p;
    const double inertia = -params_.table_mass * s.out.acceleration;
    if (!feeds_ || share_ == 0.0) return inertia;
    s.motor_share = sign(v) == 0.0
                        ? s.motor_share
                        : sign(v) + (s.motor_share - sign(v)) * exp(-abs(v) * period_ / params_.build_up);
    const auto f = model_.parts(v, x);
    const double half = half_backlash(r.position);
    const double passed = *params_.stiffness * (p > half ? p - half : p < -half ? p + half : 0.0);
    const double own = (1.0 - share_) * (f.level * s.motor_share + f.viscous) + f.additive + passed;
    StatusCounter unused;
    law_.step(s.law, r.position + s.out.position, r.velocity + s.out.velocity,
              r.acceleration + s.out.acceleration, unused);
    return inertia + own - s.law.friction;
  }

  LostMotionParams params_;
  friction::Model model_;
  Compensation law_;
  double period_ = 1e-3;
  double share_ = 0.0;  ///< φ
  double lead_ = 0.0;   ///< [s]
  bool feeds_ = false;
  LostMotionBoxes boxes_;
};

/// Whether a move fits into the memory: where not, its bounds are too low for these periods.
inline bool lost_motion_move_fits(const LostMotionParams& p, const LostMotionBounds& axis,
                                  double period) noexcept {
  const LostMotionBoxes n =
      lost_motion_boxes(LostMotionMove::lost(p, axis), LostMotionMove::bounds(p, axis), period,
                        p.move.cycles ? static_cast<double>(*p.move.cycles) : 0.0);
  return n.first <= static_cast<double>(LostMotionMove::kMostFirst) &&
         n.second <= static_cast<double>(LostMotionMove::kMostLater);
}

}  // namespace stribeck::control
