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
/// A drive at its force limit does not follow. Its set point must not run away from it: it stays within what the drive answers with twice
/// that force, and the lag that its loop may have besides,
///
///   |x_m − x| ≤ 2·U_max/(K·K_v) + λ·|ẋ_r| + λ²·|ẍ_r|        λ = τ + 1/K_v + 5 T, the second part remembered for about λ
///
/// and v_m goes with it. Both are changed by what a period of saturation can add to them at most, so that a single wild sample moves little.
///
/// After a fault the axis stops by its own loop: set points run out with constant deceleration within the stop time. A force offset
/// goes with them to 0, or to the load where the drive has no integral that could hold it; after a wrong sign to 0 at once.
/// Source: Stribeck's own; docs/theory/drive-modes.md.
/// Not modelled: cycle, delay, filters and limits of the drive.
/// Real time: safe; the constructor configure only. Errors: none of its own; inputs must be finite.

#include <limits>
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
    double last = 0.0;      ///< x_m a period before [m]
    double lag = 0.0;       ///< by which a sound table may be behind x_m [m]
    /// Set point that the drive holds from before a reset: x_m begins there where it is near the motion; NaN: none [m].
    double resumed = std::numeric_limits<double>::quiet_NaN();
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
  /// limit: of the force [N]; infinite: none is known, and set points are not held.
  DriveCommand(const friction::DriveLoop& loop, double load, double delay, double period, double mass = 1.0,
               double limit = std::numeric_limits<double>::infinity()) noexcept
      : loop_(loop),
        stiffness_(loop.stiffness()),
        load_(load),
        delay_(delay),
        period_(period),
        integral_step_(stiffness_ * period) {
    if (loop.mode == friction::DriveMode::kPosition) {
      const double lag = *loop.velocity_feedforward / *loop.position_gain;
      if (lag > 0.0) follow_ = 1.0 - exp(-period / lag);
      fast_ = kAnswer * limit / loop.gain;
      far_ = fast_ / *loop.position_gain;
      late_ = delay + 1.0 / *loop.position_gain + kPeriodsOfDrive * period;
      fading_ = exp(-period / late_);
      most_change_ = kAnswer * limit / mass * period;
    }
  }

  /// The command for a force [N] that accelerates by a [m/s²]. With `now` the motion begins in the first period; later it holds x_m.
  void step(State& s, double force, double a, const Start& now) const noexcept {
    if (!s.started) begin(s, force, now);
    if (isfinite(far_)) hold(s, now);
    double added = 0.0;
    if (loop_.force_offset) {
      s.offset = stiffness_ > 0.0 ? force - s.base : force;
    } else {
      // w, which is constant over the period, makes K·w at once and K·T/T_n·w more until its end: on average K·w + K·T/(2T_n)·w.
      added = (force - s.held) / (loop_.gain + 0.5 * integral_step_);
      s.held += integral_step_ * added;
    }
    const double mean = s.velocity + 0.5 * period_ * a;
    s.last = s.position;
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
  static constexpr double kAnswer = 2.0;  ///< of the force limit
  static constexpr double kPeriodsOfDrive =
      5.0;  ///< by which cycle, filters and delay of a drive may be late

  void begin(State& s, double force, const Start& now) const noexcept {
    s.started = true;
    if (stiffness_ > 0.0) s.base = s.held = force;
    s.velocity = now.velocity + delay_ * now.acceleration;
    s.position = now.position + delay_ * now.velocity;
    if (loop_.mode == friction::DriveMode::kPosition && isfinite(s.resumed)) {
      const double lead = (1.0 - *loop_.velocity_feedforward) * s.velocity / *loop_.position_gain;
      const double near = late_ * abs(now.velocity) + (isfinite(far_) ? far_ : 0.0);
      if (abs(s.resumed - s.position) <= near) {
        s.lead = lead;
        s.position = s.resumed - lead;
      }
    }
    s.last = s.position;
  }

  /// The set point of a drive that takes a position, near the encoder.
  void hold(State& s, const Start& now) const noexcept {
    // At a reversal, and where a motion has just ended, the table still comes.
    s.lag = max_of(late_ * (abs(now.velocity) + late_ * abs(now.acceleration)), fading_ * s.lag);
    const double most = far_ + s.lag;
    const double step = period_ * (abs(s.velocity) + fast_);
    const double near = clamp_to(s.position, now.position - most, now.position + most);
    if (near == s.position) return;
    s.position = clamp_to(near, s.position - step, s.position + step);
    s.velocity =
        clamp_to((s.position - s.last) / period_, s.velocity - most_change_, s.velocity + most_change_);
  }

  friction::DriveLoop loop_;
  double stiffness_ = 0.0;  ///< K/T_n [N/m]
  double load_ = 0.0;       ///< [N]
  double delay_ = 0.0;      ///< from the sample to the beginning of the hold [s]
  double period_ = 1e-3;
  double integral_step_ = 0.0;  ///< K·T/T_n [N·s/m]
  double follow_ = 1.0;         ///< share by which δ follows in a period
  double fast_ = std::numeric_limits<
      double>::infinity();  ///< speed that the drive answers with kAnswer times its force [m/s]
  double far_ = std::numeric_limits<double>::infinity();  ///< and distance [m]
  double late_ = 0.0;                                     ///< of the table behind the set point [s]
  double fading_ = 0.0;                                   ///< share of State::lag that is left after a period
  double most_change_ = std::numeric_limits<double>::infinity();  ///< of v_m in a period [m/s]
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
      if (present_[i])
        axes_[i] = DriveCommand(*c.model.drive_loop, c.model.load, c.delay(), setup.period, c.model.mass,
                                setup.force_limit[i]);
      limit_[i] = setup.force_limit[i];
      late_[i] = Compensation::whole_periods(c.delay(), setup.period);
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
      const DriveCommand::Start now{measured[i], r.velocity[i], r.acceleration[i]};
      const double a = (force[i] - law.compensation[i].balance) / mass_[i];
      if (isfinite(now.position + now.velocity + now.acceleration + a)) {
        for (int missed = 1; missed < min_of(law.periods, kMostMissed); ++missed) axes_[i].coast(s[i]);
        axes_[i].step(s[i], force[i], a, now);
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
  /// Periods that a host missed, up to which a set point goes on with its velocity.
  static constexpr int kMostMissed = 9;

  std::array<DriveCommand, N> axes_;
  std::array<bool, N> present_{};
  std::array<bool, N>
      reports_{};  ///< the drive reports its force; the force that a host passes is ignored for others
  V mass_;         ///< [kg]
  V limit_;        ///< of the force offset [N]
  std::array<std::size_t, N> late_{};  ///< delay in whole periods
};

}  // namespace stribeck::control
