#pragma once
/// Supervision of a controller for N axes, around the step of any law.
///
///   admit   before the law: bridges a wild or missing sample (encoder_check.hpp); continues a reference that is NaN or infinite with its
///           last acceleration; tells the law which axes are bridged, so that their observers and adaptation rest, and which are
///           doubtful, so that adaptation rests
///   judge   after the law: checks the motion of each axis (motion_check.hpp). The forces stay as the law gave them, except for a limit
///           until the sign of an axis is proven (sign_proof.hpp), of which the law is told
///   a fault is latched with its axis; from then on all axes stop together (safe_stop.hpp), a brake is asked for, the law rests
///   checks = lost: the law sees every sample and reference unchanged; only samples and references that are NaN or infinite for too long are a fault
///   reset   keeps what adaptation had learned 1 to 2 s before the fault; everything else starts anew
///
/// Lateness and the reference belong to all axes together: for them the strictest `checks` and the shortest bridge time of any axis hold.
/// Everything else is judged for each axis by its own settings.
/// Without a fault, a bridged or doubtful sample or a limit at the start, forces are those of the law alone, bit for bit.
/// Supervised<Law, N> is a law with supervision, for callers that know the law; other callers call the three steps themselves.
/// Source: Stribeck's own; docs/theory/supervision.md.
/// Real time: safe; constructors configure only.

#include <span>
#include <stribeck/control/setup.hpp>
#include <stribeck/control/supervision/encoder_check.hpp>
#include <stribeck/control/supervision/motion_check.hpp>
#include <stribeck/control/supervision/safe_stop.hpp>
#include <stribeck/control/supervision/sign_proof.hpp>

namespace stribeck::control {

template <std::size_t N>
using Supervision = std::array<SupervisionParams, N>;

template <std::size_t N>
class Supervisor {
 public:
  using V = Vec<double, N>;
  using Law = typename Common<N>::State;

  struct Axis {
    EncoderCheck::State encoder;
    MotionCheck::State motion;
    SignProof::State proof;
    bool cut = false;  ///< the last force was limited because the sign is not proven
    SafeStop::State stop;
    /// Estimates of the adaptation, newest first, a second apart.
    std::array<FrictionRls::Learned, 2> kept;
  };
  struct State {
    Fault fault = Fault::kNone;  ///< the first one
    std::size_t axis = 0;        ///< axis of that fault; 0 for lateness and command
    std::array<Axis, N> axes;
    std::array<std::uint32_t, kFaults> counts{};  ///< number of each fault, counted over resets
    path::PathPoint<N> last;                      ///< of the reference
    V force;                                      ///< last force that was put out [N]
    bool started = false;                         ///< `last` holds a reference
    int command_lost = 0;                         ///< periods in a row
    int late_in_a_row = 0;
    std::uint32_t late = 0;           ///< steps that were late
    std::uint32_t commands_lost = 0;  ///< references that were NaN or infinite
    int quiet = 0;                    ///< periods since estimates were stored
  };

  Supervisor() = default;
  Supervisor(const Supervision<N>& params, const Setup<N>& setup) noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      limits_[i] = SupervisionLimits(params[i], setup.compensation[i], setup.force_limit[i], setup.period);
      motion_[i] = MotionCheck(limits_[i]);
      stop_[i] = SafeStop(limits_[i], setup.compensation[i].model.friction);
      adapts_[i] = setup.compensation[i].adaptation.enabled;
      if (i == 0 || limits_[i].checks > checks_) checks_ = limits_[i].checks;
    }
    samples_ = limits_[0].samples;
    for (const SupervisionLimits& l : limits_) samples_ = l.samples < samples_ ? l.samples : samples_;
    second_ = static_cast<int>(min_of(1.0 / setup.period, 1e9)) + 1;
  }

  /// Call before the law; sets what the law is to see. Returns false after a fault: take stopped(), and do not call the law. `elapsed`:
  /// time since the last step as the host measured it [s]; NaN: one period.
  bool admit(State& s, Law& law, path::PathPoint<N>& r, V& measured,
             double elapsed = std::numeric_limits<double>::quiet_NaN()) const noexcept {
    if (s.fault != Fault::kNone) return false;
    const int periods = law.periods = count_periods(s, elapsed);
    take_command(s, r);
    for (std::size_t i = 0; i < N && s.fault == Fault::kNone; ++i) {
      law.bridged[i] = law.doubtful[i] = false;
      if (limits_[i].checks == Checks::kNone) continue;
      EncoderCheck::State& e = s.axes[i].encoder;
      const double used = EncoderCheck::step(e, limits_[i], measured[i], r.position[i], r.velocity[i],
                                             r.acceleration[i], periods);
      const Fault found = EncoderCheck::judge(e, limits_[i]);
      if (limits_[i].checks == Checks::kAll) {
        measured[i] = used;
        law.bridged[i] = EncoderCheck::bridges(e);
        law.doubtful[i] = EncoderCheck::doubts(e);
        raise(s, found, i);
      } else if (found == Fault::kEncoderLost) {
        raise(s, found, i);
      }
    }
    return s.fault == Fault::kNone;
  }

  /// Call after the law: returns its forces, or those of the stop when the law's must not be used.
  V judge(State& s, Law& law, const path::PathPoint<N>& r, const V& wanted) const noexcept {
    bool quiet = true;
    V force = wanted;
    for (std::size_t i = 0; i < N && s.fault == Fault::kNone; ++i) {
      if (limits_[i].checks != Checks::kAll) continue;
      cut_at_start(s.axes[i], law, force[i], i);
      law.cut[i] = s.axes[i].cut;
      const Compensation::State& c = law.compensation[i];
      quiet = quiet && !law.bridged[i] && !c.limited;
      const EncoderCheck::State& e = s.axes[i].encoder;
      raise(s,
            motion_[i].step(s.axes[i].motion,
                            {e.used, e.smooth, law.error[i].e, r.velocity[i], force[i],
                             force[i] - c.friction - c.inertia_force, c.limited, law.bridged[i]}),
            i);
      EncoderCheck::push(s.axes[i].encoder, force[i] - limits_[i].load);
      if (!law.bridged[i]) SignProof::step(s.axes[i].proof, limits_[i], e.used, e.smooth, force[i]);
    }
    if (s.fault != Fault::kNone) return stopped(s);
    if (quiet) keep(s, law);
    return s.force = force;
  }

  /// Forces after a fault, once per period [N].
  V stopped(State& s) const noexcept {
    for (std::size_t i = 0; i < N; ++i) s.force[i] = stop_[i].step(s.axes[i].stop);
    return s.force;
  }

  /// Starts anew, with a law whose state has just been constructed. Counters stay.
  void reset(State& s, Law& law) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      Axis& a = s.axes[i];
      const std::uint32_t bridged = a.encoder.bridged;
      const auto kept = a.kept[1];
      // Also where a reset follows a reset, and for the next fault.
      const bool goes_on = (s.fault != Fault::kNone || !s.started) && adapts_[i] && kept.known;
      std::construct_at(&a);
      a.encoder.bridged = bridged;
      if (!goes_on) continue;
      FrictionRls::recall(law.compensation[i].adaptation, kept);
      a.kept[0] = a.kept[1] = kept;
    }
    s.fault = Fault::kNone;
    s.axis = 0;
    s.started = false;
    s.command_lost = s.late_in_a_row = s.quiet = 0;
    s.force = {};
  }

  [[nodiscard]] static Reaction reaction_to(const State& s) noexcept { return reaction(s.fault); }
  /// Whether a holding brake should close.
  [[nodiscard]] static bool brake_requested(const State& s) noexcept { return s.fault != Fault::kNone; }
  /// Whether the safe force has been reached on all axes.
  [[nodiscard]] static bool safe(const State& s) noexcept {
    for (const Axis& a : s.axes) {
      if (s.fault == Fault::kNone || a.stop.left > 0 || a.stop.force != a.stop.end) return false;
    }
    return true;
  }
  [[nodiscard]] const SupervisionLimits& limits(std::size_t i) const noexcept { return limits_[i]; }

 private:
  static constexpr double kLate = 1.5;  ///< in periods
  static constexpr double kMostPeriods = 1000.0;
  static constexpr int kEnough = 1000000;  ///< of late steps in a row, which are no fault without all checks

  /// Tells the law the force that was put out, as if the law itself had limited it.
  void cut_at_start(Axis& a, Law& law, double& force, std::size_t i) const noexcept {
    const double most = SignProof::limited(a.proof, limits_[i], force);
    a.cut = most != force;
    if (!a.cut) return;
    force = law.force[i] = most;
    law.compensation[i].force[0] = most;
    law.compensation[i].limited = true;
    law.status.raise(Status::kOutputLimited);
  }

  void raise(State& s, Fault f, std::size_t axis) const noexcept {
    if (f == Fault::kNone || s.fault != Fault::kNone) return;
    s.fault = f;
    s.axis = axis;
    auto& n = s.counts[static_cast<std::size_t>(f)];
    if (n != UINT32_MAX) ++n;
    // All axes stop together, within the stop time that begins with the first bad sample of any of them.
    int used = s.command_lost;
    for (const Axis& a : s.axes) used = a.encoder.in_a_row > used ? a.encoder.in_a_row : used;
    for (std::size_t i = 0; i < N; ++i)
      stop_[i].begin(s.axes[i].stop, reaction(f), s.force[i], s.axes[i].encoder.smooth, used);
  }

  [[nodiscard]] int count_periods(State& s, double elapsed) const noexcept {
    const double periods = elapsed / limits_[0].period;
    if (!(periods > kLate)) {
      s.late_in_a_row = 0;
      return 1;
    }
    if (!s.started) return 1;
    if (s.late != UINT32_MAX) ++s.late;
    if (s.late_in_a_row < kEnough) ++s.late_in_a_row;
    if (checks_ == Checks::kAll && (s.late_in_a_row > samples_ || periods > samples_ + 0.5))
      raise(s, Fault::kLate, 0);
    return static_cast<int>(min_of(periods, kMostPeriods) + 0.5);
  }

  /// Continues a reference that is NaN or infinite with its last acceleration.
  void take_command(State& s, path::PathPoint<N>& r) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < N; ++i) {
      sum += r.position[i] + r.velocity[i] + r.acceleration[i];
      for (std::size_t k = 0; k < N; ++k)
        sum += r.frame[i][k] + r.frame_rate[i][k] + r.frame_acceleration[i][k];
    }
    if (isfinite(sum)) {
      s.command_lost = 0;
    } else if (checks_ == Checks::kNone) {
      return;
    } else {
      if (s.commands_lost != UINT32_MAX) ++s.commands_lost;
      if (++s.command_lost > samples_) raise(s, Fault::kCommandLost, 0);
      if (checks_ == Checks::kLost || !s.started) return;  // the law handles it
      const double t = limits_[0].period;
      r = s.last;
      r.position = r.position + t * r.velocity + (0.5 * t * t) * r.acceleration;
      r.velocity = r.velocity + t * r.acceleration;
    }
    s.last = r;
    s.started = true;
  }

  void keep(State& s, const Law& law) const noexcept {
    if (++s.quiet < second_) return;
    s.quiet = 0;
    for (std::size_t i = 0; i < N; ++i) {
      if (!adapts_[i]) continue;
      s.axes[i].kept[1] = s.axes[i].kept[0];
      s.axes[i].kept[0] = FrictionRls::learned(law.compensation[i].adaptation);
    }
  }

  std::array<SupervisionLimits, N> limits_;
  Checks checks_ = Checks::kAll;  ///< strictest of all axes
  int samples_ = 3;               ///< fewest that an axis may bridge in a row
  std::array<MotionCheck, N> motion_;
  std::array<SafeStop, N> stop_;
  std::array<bool, N> adapts_{};
  int second_ = 1000;
};

/// A law with supervision, to be used in place of the law itself.
template <class LawOf, std::size_t N>
class Supervised {
 public:
  using V = Vec<double, N>;
  struct State {
    typename LawOf::State law;
    typename Supervisor<N>::State watch;
  };

  Supervised(const typename LawOf::Params& params, const Setup<N>& setup,
             const Supervision<N>& supervision) noexcept
      : law_(params, setup), supervisor_(supervision, setup) {}

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  V step(State& s, path::PathPoint<N> r, V measured,
         double elapsed = std::numeric_limits<double>::quiet_NaN()) const noexcept {
    if (!supervisor_.admit(s.watch, s.law, r, measured, elapsed)) return supervisor_.stopped(s.watch);
    return supervisor_.judge(s.watch, s.law, r, law_.step(s.law, r, measured));
  }

  void reset(State& s) const noexcept {
    std::construct_at(&s.law);
    supervisor_.reset(s.watch, s.law);
  }

  [[nodiscard]] const Supervisor<N>& supervisor() const noexcept { return supervisor_; }

 private:
  LawOf law_;
  Supervisor<N> supervisor_;
};

}  // namespace stribeck::control
