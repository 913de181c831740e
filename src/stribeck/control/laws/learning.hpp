#pragma once
/// Iterative learning: contouring control with feed-forward. At each place of the path it learns the force that was missing in the
/// last pass, and adds it in the next one.
///
///   F = m·(r̈ + a_fb) + F_friction + load + d̂ + F_j(φ)                a_fb = −R(K_v ė_l + K_p e_l + R̈ᵀe + 2Ṙᵀė)
///   F_{j+1}(φ) = Q{ F_j(φ) + γ_j·M_j(φ) },   M = m·(ā_fb − δ²e/T²),   F_1 = 0                  j: pass (lap)
///
///   M [N]: missing force around a tick, from the second difference of the error and the mean of the feedback that acted in the
///   two periods beside it: the exact inverse of the sampled loop. φ parameter of the path; F_j is read for the middle of the
///   coming hold, delay included. Q: zero-phase low-pass of lap_memory.hpp, ½ at the cut-off. γ_j falls from γ to its smallest
///   value when passes no longer improve. It converges where factor() is below 1 at every frequency.
///
/// If a pass is twice as bad as the first, the memory is cleared and γ halved (State::given_up). Where the velocity differs by more
/// than 2 % from the last pass (other speed or path, run-in), the learned force is not added and is learned anew. A φ that jumps or
/// runs back clears the memory. Without a lap (Setup::lap NaN) it is contouring control. Axes at their force limit do not learn.
/// Source: Bristow, Tharayil, Alleyne 2006, doi:10.1109/MCS.2006.1636313 (plant inversion, Q); Saab 2001, IEEE
/// Trans. Automatic Control 46, 877–887 (a gain that falls, against noise). docs/theory/learning.md.
/// Not modelled: differences from pass to pass; a path that is only moved to another place.
/// Real time: safe, a tick reads 11 to 726 cells; the constructor configure only. State: up to 230 kB.

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/lap_memory.hpp>
#include <stribeck/control/sampled_loop.hpp>

namespace stribeck::control {

template <std::size_t N>
class Learning;

struct LearningParams {
  template <std::size_t N>
  using Controller = Learning<N>;
  static constexpr std::string_view kKind = "learning";
  static constexpr std::string_view kLabel = "iterative learning";

  PerAxis kp{1600.0};
  PerAxis kv{80.0};
  double learning = 1.0;
  double least_learning = 0.2;
  double cutoff = 200.0;
  ErrorRate error_rate = ErrorRate::kDifferenceOfError;

  static constexpr auto fields() {
    using P = LearningParams;
    return std::tuple{
        field(
            "kp", &P::kp, quantity("1/s2", "1/s2").positive(),
            "proportional gains, along the path first, then across it; the last one applies to the others too")
            .or_default(),
        field("kv", &P::kv, quantity("1/s", "1/s").positive(), "derivative gains, in the same order")
            .or_default(),
        field("learning", &P::learning, pure_number().not_negative().at_most(1.5),
              "share of the missing force that is learned in a pass, at first")
            .or_default(),
        field("least_learning", &P::least_learning, pure_number().not_negative().at_most(1.5),
              "the same once passes no longer get better")
            .or_default(),
        field("cutoff", &P::cutoff, quantity("rad/s", "rad/s").positive(),
              "frequency above which nothing is learned (half)")
            .or_default(),
        field("error_rate", &P::error_rate, kErrorRateHelp).or_default()};
  }

  /// Deviation of a machine from its model.
  struct Truth {
    double mass = 1.0;       ///< in masses of the model
    double stiffness = 0.0;  ///< of pre-sliding, by mass [1/s²]
    int delay = 0;           ///< delay beyond the one that the controller knows [periods]
  };

  /// Remaining share of an error of frequency ω [rad/s] after a pass, along (0) or across (1, …) the path, sampled with this
  /// period [s]: Q·|1 − γ·cos²(ωT/2)·(C + m z²/h)/(C + m' z^d z²/h + κ)|, C the feedback, m z²/h the mass under a hold.
  [[nodiscard]] double factor(std::size_t direction, double omega, double period) const noexcept {
    return factor(direction, omega, period, Truth{});
  }
  [[nodiscard]] double factor(std::size_t direction, double omega, double period,
                              const Truth& truth) const noexcept {
    const double x = omega * period;
    const std::complex<double> z(cos(x), sin(x));
    const double p = spread<kMostAxes>(kp)[direction];
    const double v = spread<kMostAxes>(kv)[direction] / period;
    // Times z: feedback p + v(1 − 1/z); mass 2(z − 1)²/(T²(z + 1)).
    const std::complex<double> feedback = (p + v) * z - v;
    const std::complex<double> inertia = 2.0 * z * (z - 1.0) * (z - 1.0) / (period * period * (z + 1.0));
    std::complex<double> late = 1.0;
    for (int k = 0; k < truth.delay; ++k) late *= z;
    const std::complex<double> there = feedback + late * (truth.mass * inertia + truth.stiffness * z);
    const double half_hold = cos(0.5 * x);
    return low_pass(omega, learning) *
           std::abs(1.0 - learning * half_hold * half_hold * (feedback + inertia) / there);
  }
  /// Q at ω [rad/s] with this gain.
  [[nodiscard]] double low_pass(double omega, double gain) const noexcept {
    const double y = omega * half(gain) / cutoff;
    const double missing = 1.0 - exp(-0.5 * y * y);
    return 1.0 - missing * missing;
  }
  /// Whether every frequency is learned on such a machine, provided that the loop is stable there. Configure only.
  [[nodiscard]] bool converges(double period, const Truth& truth) const noexcept {
    constexpr int kFrequencies = 512;
    if (!(learning > 0.0)) return false;
    for (std::size_t direction = 0; direction < kMostAxes; ++direction) {
      for (int k = 1; k < kFrequencies; ++k) {
        if (!(factor(direction, k * kPi / (kFrequencies * period), period, truth) < 1.0)) return false;
      }
    }
    return true;
  }
  /// Whether the loop is stable and every frequency is learned on a machine that equals its model. Configure only.
  [[nodiscard]] bool stable(double period) const noexcept {
    const auto p = spread<kMostAxes>(kp);
    const auto v = spread<kMostAxes>(kv);
    for (std::size_t i = 0; i < kMostAxes; ++i) {
      if (!sampled_loop_stable(p[i], v[i], 0.0, period)) return false;
    }
    return learning == 0.0 || converges(period, {});
  }

  /// ωσ at which the final learned share, Qγ/(1 − Q(1 − γ)), is ½.
  static double half(double gain) noexcept {
    const double g = 1.0 - sqrt(gain / (1.0 + gain));
    return sqrt(-2.0 * log(g));
  }
};

template <std::size_t N>
class Learning {
 public:
  using Params = LearningParams;
  using V = Vec<double, N>;

  static constexpr std::int64_t kCells = N <= 3 ? 8192 : 4096;  ///< per lap
  static constexpr std::size_t kHistory = kMostDelay + 5;
  using Memory = LapMemory<2 * N, kCells, kCells + 768, float>;

  struct Command {
    double place = 0.0;  ///< middle of its hold [cells]
    V learned;           ///< [N]
    V velocity;          ///< of the reference there [m/s]
    V feedback;          ///< [m/s²]
  };
  struct State : Common<N>::State {
    typename Memory::State memory;
    std::array<Command, kHistory> command{};  ///< newest first
    std::size_t known = 0;                    ///< commands given without a gap in φ or in the samples
    std::array<V, 3> e{};                     ///< tracking errors, newest first [m]
    V missing;                                ///< M of the tick before the last one [N]
    std::array<int, N> held{};                ///< ticks for which an axis does not learn
    double moved = 0.0;                       ///< of the last tick [cells]
    double trust = 0.0;                       ///< share of the learned force that is applied
    V learned;                                ///< F_j of the last step [N]
    // Progress of the learning.
    std::uint32_t passes = 0;    ///< passes that were learned from
    double gain = 0.0;           ///< γ_j
    double width = 0.0;          ///< σ of G [periods]
    double share = 1.0;          ///< of γ; smaller after passes became worse
    std::uint32_t given_up = 0;  ///< how often passes became worse than without
    double update = 0.0;         ///< RMS of Q{M} over the last whole pass, all axes [N]
    double best = 0.0;           ///< smallest of these updates [N]
    double first = 0.0;          ///< of the first pass [N]
    double error = 0.0;          ///< RMS tracking error of the last whole pass [m]
    double begun = 0.0;          ///< place at which this pass began
    double squares_m = 0.0;
    double squares_e = 0.0;
    double ticks = 0.0;
    double strange = 0.0;       ///< ticks whose motion differed from that of the last pass
    std::array<V, 2> smooth{};  ///< M under a low-pass [N]
  };

  Learning(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, params.error_rate),
        feedback_(params.kp, params.kv),
        params_(params),
        period_(setup.period),
        cutoff_(params.cutoff * setup.period),
        follow_(1.0 - exp(-params.cutoff * setup.period)),
        cells_per_phi_(static_cast<double>(kCells) / setup.lap),
        limit_(setup.force_limit) {
    double delay = 0.0;
    for (const auto& c : setup.compensation) delay = max_of(delay, c.delay() / setup.period);
    delay = clamp_to(delay, 0.0, static_cast<double>(kMostDelay));
    whole_ = static_cast<std::size_t>(delay);
    part_ = delay - static_cast<double>(whole_);
    ahead_ = delay + 0.5;
    behind_ = static_cast<std::size_t>(ahead_);
    late_ = ahead_ - static_cast<double>(behind_);
  }

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  V step(State& s, const path::PathPoint<N>& r, const V& measured) const noexcept {
    if (!common_.begin(s, r, measured)) {
      s.known = 0;  // differences over missing ticks would be wrong
      return s.force;
    }
    if (s.periods > 1) s.known = 0;
    const V e = common_.error(s);
    const V feedback = feedback_(r, e, common_.rate(s));
    s.learned = {};
    if (isfinite(r.phi * cells_per_phi_)) {
      learn(s, r.phi, e);
      recall(s, r, feedback);
    } else {
      s.known = 0;  // differences over a gap would be wrong
    }
    V wanted = r.acceleration + feedback;
    for (std::size_t i = 0; i < N; ++i) wanted[i] += s.learned[i] / common_.mass(i);
    const V force = common_.finish(s, r, wanted);
    for (std::size_t i = 0; i < N; ++i) {
      if (!(abs(force[i]) < limit_[i]) || s.cut[i]) s.held[i] = static_cast<int>(whole_) + 4;
    }
    return force;
  }

 private:
  enum class Motion { kSame, kNearly, kOther };

  /// Largest σ; with a wider one a lap is too short to be learned [cells].
  static constexpr double kMostWidth = 64.0;
  /// Velocities within this share count as the same motion.
  static constexpr double kSame = 0.02;
  /// Ratio of an update to the smallest so far below which passes improve; factor on the gain when they do not.
  static constexpr double kBetter = 0.85;
  static constexpr double kFall = 0.6;
  /// Share of a pass with a different motion, from which it counts as the first pass of a new motion.
  static constexpr double kOther = 0.25;
  /// Ratio of an update to that of the first pass at which the learning gives up.
  static constexpr double kWorse = 2.0;
  static constexpr double kLeastShare = 0.125;

  void learn(State& s, double phi, const V& e) const noexcept {
    const double moved = Memory::advance(s.memory, phi, cells_per_phi_);
    s.moved = moved;
    if (Memory::breaks(moved)) {
      start_over(s);
      s.known = 0;
    }
    s.e[2] = s.e[1];
    s.e[1] = s.e[0];
    s.e[0] = e;
    if (s.known < whole_ + 4 || !(s.width * abs(moved) < kMostWidth)) return;
    // M around the last tick. s.command[whole_] was given `whole_` ticks before the last one; a and b are what acted in the last period and
    // in the one before it, each of two commands where the delay has a fraction.
    V missing;
    for (std::size_t i = 0; i < N; ++i) {
      const double a =
          (1.0 - part_) * s.command[whole_].feedback[i] + part_ * s.command[whole_ + 1].feedback[i];
      const double b =
          (1.0 - part_) * s.command[whole_ + 1].feedback[i] + part_ * s.command[whole_ + 2].feedback[i];
      missing[i] =
          common_.mass(i) * (0.5 * (a + b) - (s.e[0][i] - 2.0 * s.e[1][i] + s.e[2][i]) / (period_ * period_));
      if (s.held[i] > 0) {
        missing[i] = 0.0;
        --s.held[i];
      }
    }
    if (s.passes == 0) {
      s.passes = 1;
      set_gain(s, params_.learning * s.share);
      begin_pass(s);
    }
    // The command whose hold has its middle between the last two M, and M there: late_ is the share of the newer one.
    const Command& then = s.command[behind_ + 1];
    Vec<double, 2 * N> entry;
    for (std::size_t i = 0; i < N; ++i) {
      const double m = (1.0 - late_) * s.missing[i] + late_ * missing[i];
      entry[i] = clamp_to(then.learned[i] + s.gain * m, -limit_[i], limit_[i]);
      entry[N + i] = then.velocity[i];
    }
    Memory::write(s.memory, then.place, entry);
    s.missing = missing;
    judge(s, missing, e);
  }

  void judge(State& s, const V& missing, const V& e) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      s.smooth[0][i] += follow_ * (missing[i] - s.smooth[0][i]);
      s.smooth[1][i] += follow_ * (s.smooth[0][i] - s.smooth[1][i]);
    }
    s.squares_m += dot(s.smooth[1], s.smooth[1]);
    s.squares_e += dot(e, e);
    s.ticks += 1.0;
    if (s.memory.place - s.begun < static_cast<double>(kCells)) return;
    s.update = sqrt(s.squares_m / s.ticks);
    s.error = sqrt(s.squares_e / s.ticks);
    const bool other = s.strange > kOther * s.ticks;
    begin_pass(s);
    if (other) s.passes = 1;
    if (s.passes == 1) {
      set_gain(s, params_.learning * s.share);
      s.best = s.update;
      s.first = s.update;
      ++s.passes;
      return;
    }
    if (s.update > kWorse * s.first) {
      // Worse than without learning: the machine differs too much from the model for this gain.
      s.share = max_of(0.5 * s.share, kLeastShare);
      ++s.given_up;
      start_over(s);
      return;
    }
    if (s.update > kBetter * s.best)
      set_gain(s, max_of(min_of(params_.least_learning, s.gain), kFall * s.gain));
    s.best = min_of(s.best, s.update);
    ++s.passes;
  }
  static void start_over(State& s) noexcept {
    Memory::forget(s.memory);
    s.passes = 0;
    s.trust = 0.0;
    begin_pass(s);
  }
  void set_gain(State& s, double gain) const noexcept {
    s.gain = gain;
    s.width = Params::half(gain) / cutoff_;
  }
  static void begin_pass(State& s) noexcept {
    s.begun = s.memory.place;
    s.squares_m = 0.0;
    s.squares_e = 0.0;
    s.ticks = 0.0;
    s.strange = 0.0;
  }

  void recall(State& s, const path::PathPoint<N>& r, const V& feedback) const noexcept {
    for (std::size_t k = kHistory - 1; k > 0; --k) s.command[k] = s.command[k - 1];
    Command& now = s.command[0];
    now.place = s.memory.place + ahead_ * s.moved;
    now.feedback = feedback;
    now.velocity = r.velocity + (ahead_ * period_) * r.acceleration;
    now.learned = {};
    if (s.known < kHistory) ++s.known;
    const double width = max_of(s.width * abs(s.moved), Memory::kLeastWidth);
    const double place = now.place - static_cast<double>(kCells);
    const Motion motion =
        width < kMostWidth ? motion_at(s, place, now.velocity, r.acceleration) : Motion::kOther;
    if (motion == Motion::kOther) {
      s.trust = 0.0;
      s.strange += 1.0;
      return;
    }
    if (motion == Motion::kSame) s.trust = min_of(1.0, s.trust + 0.2 * cutoff_);
    now.learned = s.trust * Memory::template read<N>(s.memory, place, width);
    s.learned = now.learned;
  }

  /// Compares the velocity of the last pass at a place with a velocity [m/s]: same, same within a tick (a corner), or different.
  Motion motion_at(const State& s, double place, const V& velocity, const V& acceleration) const noexcept {
    const double step = max_of(1.0, abs(s.moved));
    if (!Memory::knows(s.memory, place - step)) return Motion::kOther;
    const double most = kSame * norm(velocity) + period_ * norm(acceleration);
    const auto like = [&](double there) {
      const auto then = Memory::between(s.memory, there);
      double square = 0.0;
      for (std::size_t i = 0; i < N; ++i) {
        const double d = then[N + i] - velocity[i];
        square += d * d;
      }
      return square <= most * most;
    };
    if (like(place)) return Motion::kSame;
    return like(place - step) || like(place + step) ? Motion::kNearly : Motion::kOther;
  }

  Common<N> common_;
  ContouringFeedback<N> feedback_;
  Params params_;
  double period_;
  double cutoff_;  ///< [rad per period]
  double follow_;  ///< of the low-pass of judge()
  double cells_per_phi_;
  V limit_;
  std::size_t whole_ = 0;   ///< delay: whole periods
  double part_ = 0.0;       ///< fractional part of the delay
  double ahead_ = 0.5;      ///< from the tick to the middle of its hold [periods]
  std::size_t behind_ = 0;  ///< whole part of ahead_
  double late_ = 0.5;       ///< fractional part of ahead_
};

}  // namespace stribeck::control
