#pragma once
/// From the forces of a law to the commands of drives that close their velocity or position loop themselves.
///
///   v_m' = a                                  velocity that the law wants: its acceleration, integrated [m/s]; x_m its integral [m]
///   w    = C⁻¹·U                              C(s) = K·(1 + 1/(T_n s)); w = 0 where the drive takes U as an offset
///   v_c  = v_m + w                            velocity command for the coming period [m/s]
///   x_c  = x_m(end of the period) + δ         position command; the drive goes there in a straight line over the period [m]
///          (c/K_v)·δ̇ + δ = ((1 − c)·v_m + w)/K_v
///   F    = U + C·(v_m − v + [K_v·(x_m − x)])  what acts then
///
///   U force that the law wants, a = (U − friction, load and estimate in it)/m its acceleration in the coming hold; C, K_v, c loops of
///   the drive (friction/drive_loop.hpp). With the right mass ẍ = a, as if the drive took forces: the loop that the law closes, its gains
///   and its margins stay the same, and the drive's own loop holds against what the model does not explain.
///
/// Observers and adaptation of the law need F. It cannot be computed from set points and encoder: a lateness τ of the drive's own
/// velocity is a force K·v·τ/T_n to its integral, thousands of newtons for a tenth of a millisecond. If the drive reports F, they get it;
/// if not, they rest (setup.hpp), and the integral of the drive takes what the model does not explain.
/// The integral of the drive holds the axis before the first period. The first U is taken as that force, so that nothing jumps; a
/// constant part of U is left to the integral anyway.
/// After a fault the axis stops by its own loop: set points run out with constant deceleration within the stop time. A force offset
/// goes with them to 0, or to the load where the drive has no integral that could hold it; after a wrong sign to 0 at once.
/// Source: Stribeck's own; docs/theory/drive-modes.md.
/// Not modelled: cycle, delay, filters and limits of the drive.
/// Real time: safe; the constructor configure only. Errors: none of its own; inputs must be finite.

#include <stribeck/control/setup.hpp>
#include <stribeck/friction/drive_loop.hpp>

namespace stribeck::control {

/// One axis.
class DriveCommand {
 public:
  struct State {
    double command = 0.0;  ///< of the coming period [m/s] or [m]
    double offset = 0.0;   ///< force beside it [N]
    /// U in the first period: the drive's integral holds it already, the offset must not add it again [N].
    double base = 0.0;
    /// Part of U that the drive's integral has taken over by now, where there is no offset [N].
    double held = 0.0;
    double lead = 0.0;      ///< δ [m]
    double position = 0.0;  ///< x_m [m]
    double velocity = 0.0;  ///< v_m [m/s]
    bool started = false;
    int left = -1;  ///< periods until the end of a stop; -1: none has begun
  };

  /// Where an axis starts: encoder [m], velocity [m/s] and acceleration [m/s²] of the reference.
  struct Start {
    double position = 0.0;
    double velocity = 0.0;
    double acceleration = 0.0;
  };

  DriveCommand() = default;
  DriveCommand(const friction::DriveLoop& loop, double load, double delay, double period) noexcept
      : loop_(loop),
        stiffness_(loop.stiffness()),
        load_(load),
        delay_(delay),
        period_(period),
        integral_step_(stiffness_ * period) {
    if (loop.mode == friction::DriveMode::kPosition) {
      const double lag = *loop.velocity_feedforward / *loop.position_gain;
      if (lag > 0.0) follow_ = 1.0 - exp(-period / lag);
    }
  }

  /// The command for a force [N] that accelerates by a [m/s²]. `start` counts in the first period alone.
  void step(State& s, double force, double a, const Start& start) const noexcept {
    if (!s.started) {
      s.started = true;
      if (stiffness_ > 0.0) s.base = s.held = force;
      s.velocity = start.velocity + delay_ * start.acceleration;
      s.position = start.position + delay_ * start.velocity;
    }
    double added = 0.0;
    if (loop_.force_offset) {
      s.offset = stiffness_ > 0.0 ? force - s.base : force;
    } else {
      // w, which is constant over the period, makes K·w at once and K·T/T_n·w more until its end: on average K·w + K·T/(2T_n)·w.
      added = (force - s.held) / (loop_.gain + 0.5 * integral_step_);
      s.held += integral_step_ * added;
    }
    const double mean = s.velocity + 0.5 * period_ * a;
    s.position += period_ * mean;
    s.velocity += period_ * a;
    if (loop_.mode == friction::DriveMode::kVelocity) {
      s.command = mean + added;
      return;
    }
    const double wanted = ((1.0 - *loop_.velocity_feedforward) * mean + added) / *loop_.position_gain;
    s.lead += follow_ * (wanted - s.lead);
    s.command = s.position + s.lead;
  }

  /// Before the first step: a drive that takes a position is told where the axis is, or else where it should be. A command of 0 would move it to 0.
  void wait(State& s, double measured, double reference) const noexcept {
    if (s.started || loop_.mode != friction::DriveMode::kPosition) return;
    if (isfinite(measured)) {
      s.command = measured;
    } else if (isfinite(reference)) {
      s.command = reference;
    }
  }

  /// A period without a sample: the set point of a drive that takes a position goes on with its velocity. Held, it would stop dead.
  void coast(State& s) const noexcept {
    if (loop_.mode != friction::DriveMode::kPosition) return;
    s.position += period_ * s.velocity;
    s.command += period_ * s.velocity;
  }

  /// One period of a stop that takes `periods` in all. `cut`: no force offset from now on.
  void stop(State& s, int periods, bool cut) const noexcept {
    if (s.left < 0) s.left = periods;
    const double share = s.left > 0 ? static_cast<double>(s.left - 1) / s.left : 0.0;
    if (s.left > 0) --s.left;
    if (cut) {
      s.offset = 0.0;
    } else if (loop_.force_offset) {
      const double rest = stiffness_ > 0.0 ? 0.0 : load_;
      s.offset = rest + share * (s.offset - rest);
    }
    const double velocity = share * s.velocity;
    s.command = loop_.mode == friction::DriveMode::kVelocity
                    ? velocity
                    : s.command + 0.5 * period_ * (s.velocity + velocity);
    s.velocity = velocity;
  }

 private:
  friction::DriveLoop loop_;
  double stiffness_ = 0.0;  ///< K/T_n [N/m]
  double load_ = 0.0;       ///< [N]
  double delay_ = 0.0;      ///< from the sample to the beginning of the hold [s]
  double period_ = 1e-3;
  double integral_step_ = 0.0;  ///< K·T/T_n [N·s/m]
  double follow_ = 1.0;         ///< share by which δ follows in a period
};

/// All axes of a machine. An axis without a loop of its own keeps the law's force.
template <std::size_t N>
class DriveInterface {
 public:
  using V = Vec<double, N>;
  using Law = typename Common<N>::State;
  using State = std::array<DriveCommand::State, N>;

  DriveInterface() = default;
  explicit DriveInterface(const Setup<N>& setup) noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const CompensationParams& c = setup.compensation[i];
      mass_[i] = c.model.mass;
      present_[i] = c.model.drive_loop.has_value();
      reports_[i] = present_[i] && c.model.drive_loop->force_feedback;
      if (present_[i]) axes_[i] = DriveCommand(*c.model.drive_loop, c.model.load, c.delay, setup.period);
      limit_[i] = setup.force_limit[i];
      late_[i] = Compensation::whole_periods(c.delay, setup.period);
    }
  }

  /// Before the law: tells it the mean forces of the past period that the drives report [N]; NaN: none.
  void admit(const State& s, Law& law, const V& acted) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (!reports_[i] || !s[i].started || !isfinite(acted[i])) continue;
      // What acted was commanded a delay ago. Of a delay that is no whole number of periods two commands are read.
      auto& commanded = law.compensation[i].force;
      commanded[late_[i]] = commanded[late_[i] + 1] = acted[i];
    }
  }
  /// After the law, for the forces that are to act. Where an input is not finite, a velocity command stays, and a position command goes on with
  /// its velocity.
  void command(State& s, const Law& law, const path::PathPoint<N>& r, const V& measured,
               const V& force) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (!present_[i]) {
        s[i].command = force[i];
        continue;
      }
      const DriveCommand::Start start{measured[i], r.velocity[i], r.acceleration[i]};
      const double a = (force[i] - law.compensation[i].balance) / mass_[i];
      if (isfinite(start.position + start.velocity + start.acceleration + a)) {
        axes_[i].step(s[i], force[i], a, start);
        s[i].offset = clamp_to(s[i].offset, -limit_[i], limit_[i]);
      } else if (s[i].started) {
        axes_[i].coast(s[i]);
      } else {
        axes_[i].wait(s[i], measured[i], r.position[i]);
      }
    }
  }
  /// Instead of command() after a fault, for a stop that takes `periods` of each axis in all. force: of axes without a loop [N]; cut: see
  /// DriveCommand.
  void stop(State& s, const path::PathPoint<N>& r, const V& measured, const V& force,
            const std::array<int, N>& periods, bool cut) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (present_[i]) {
        axes_[i].wait(s[i], measured[i], r.position[i]);
        axes_[i].stop(s[i], periods[i], cut);
      } else {
        s[i].command = force[i];
      }
    }
  }
  [[nodiscard]] bool present(std::size_t i) const noexcept { return present_[i]; }
  /// After a fault: whether the set points of all drives with a loop have come to the end of their stop.
  [[nodiscard]] bool at_rest(const State& s) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (present_[i] && s[i].left != 0) return false;
    }
    return true;
  }

 private:
  std::array<DriveCommand, N> axes_;
  std::array<bool, N> present_{};
  std::array<bool, N>
      reports_{};  ///< the drive reports its force; the force that a host passes is ignored for others
  V mass_;         ///< [kg]
  V limit_;        ///< of the force offset [N]
  std::array<std::size_t, N> late_{};  ///< delay in whole periods
};

}  // namespace stribeck::control
