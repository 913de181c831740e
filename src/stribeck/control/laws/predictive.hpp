#pragma once
/// Model predictive contouring control: forces within the limits of the drives that best bring the predicted errors to zero. Where
/// the path needs more force than the drives have, the machine slows down and stays on the path.
///
///   F = m·(r̄̈ + u_0) + F_friction + load + d̂                     |F_j| ≤ limit over the whole horizon
///   u: least of Σ (q_e·e² + q_v·ė² + u²) + value of what follows   per axis (bounded_moves.hpp)
///   r = r(θ), θ̇ ≤ 1: the fastest that the limits allow             for all axes together (progress.hpp)
///
///   e = x − r at the samples to come, r̄̈ mean of r̈ over a period. Friction along the path, load and d̂ are subtracted from the
///   limit first; progress gets the rest less a reserve for the errors. θ falls behind the programme by `lag` [s] and
///   catches up. A single axis has no path to keep and is not slowed. If no limit is active, u = −k_p e − k_v ė.
///   Delay (CompensationParams::delay): errors are predicted to the time at which the force begins to act.
///
/// With points ahead (kPreview) the law sees corners in advance; with the present point alone it assumes a constant acceleration.
/// Source: after Lam, Manzie, Good 2010, doi:10.1109/CDC.2010.5717042, with progress found first (docs/theory/predictive.md).
/// Not modelled: elasticity; jerk of progress; limits of axes with different delays; slowing for an axis at its limit because of a
/// disturbance alone.
/// Real time: safe, time bounded by `iterations`; the constructor configure only. State: 23 KiB for two axes, 50 for five.
/// Errors: setup.hpp.

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <stribeck/control/laws/bounded_moves.hpp>
#include <stribeck/control/laws/progress.hpp>
#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/control/setup.hpp>

namespace stribeck::control {

template <std::size_t N>
class Predictive;

struct PredictiveParams {
  template <std::size_t N>
  using Controller = Predictive<N>;
  static constexpr std::string_view kKind = "predictive";
  static constexpr std::string_view kLabel = "model predictive contouring";
  static constexpr int kMostIterations = 200;
  static constexpr std::size_t kMostMoves = 64;

  double omega = 40.0;
  double horizon = 0.08;
  int iterations = 30;
  bool slows = true;
  double catch_up = 0.1;
  double reserve = 0.1;
  PerAxis speed_limit{};
  ErrorRate error_rate = ErrorRate::kDifferenceOfError;
  bool rate_at_sample = false;

  static constexpr auto fields() {
    using P = PredictiveParams;
    return std::tuple{
        field("omega", &P::omega, quantity("rad/s", "rad/s").positive(),
              "stiffness ω² of the loop away from limits; times the control period below 1")
            .or_default(),
        field("horizon", &P::horizon, quantity("s", "ms").positive(),
              "how far ahead limits are seen; at most 64 control periods")
            .or_default(),
        field("iterations", &P::iterations, pure_number().at_least(1).at_most(kMostIterations),
              "of the solver, at most, per axis and tick")
            .or_default(),
        field("slows", &P::slows, "slow down along the path where its forces exceed the limits").or_default(),
        field(
            "catch_up", &P::catch_up, pure_number().not_negative().at_most(1.0),
            "how much faster than programmed the axes may move to catch up, as a share of the programmed speed")
            .or_default()
            .when([](const P& p) { return p.slows; }, "goes with slows = true"),
        field("reserve", &P::reserve, pure_number().not_negative().at_most(0.9),
              "share of the force limit that is kept for feedback when the speed along the path is chosen")
            .or_default()
            .when([](const P& p) { return p.slows; }, "goes with slows = true"),
        field("speed_limit", &P::speed_limit, quantity("m/s", "mm/s").positive(),
              "largest speed, one per axis; the last one applies to the others too; none: no limit")
            .or_default(),
        field("error_rate", &P::error_rate, kErrorRateHelp).or_default(),
        field("rate_at_sample", &P::rate_at_sample,
              "carry a differenced rate on to the sample by the model: the exact regulator, and less stiff")
            .or_default()};
  }

  /// Whether the loop is stable while no limit is active, sampled with this period [s].
  [[nodiscard]] bool stable(double period) const noexcept {
    if (!(omega * period < 1.0)) return false;
    if (rate_at_sample || error_rate == ErrorRate::kObserved) return true;
    const MassRegulator q(omega, period);
    return sampled_loop_stable(q.kp, q.kv, 0.0, period);
  }
};

template <std::size_t N>
class Predictive {
 public:
  using Params = PredictiveParams;
  using V = Vec<double, N>;
  using Point = path::PathPoint<N>;

  /// Largest number of moves of a horizon; number of points needed beyond the present one.
  static constexpr std::size_t kMost = Params::kMostMoves;
  static constexpr std::size_t kPreview = kMost + kMostDelay + 1;
  /// Longest lag in periods.
  static constexpr std::size_t kMostLag = 128;

  /// A point of the path as programmed.
  struct Knot {
    V position;      ///< [m]
    V velocity;      ///< [m/s]
    V acceleration;  ///< [m/s²]
  };
  using Moves = BoundedMoves<kMost>;
  using Row = typename Moves::Row;

  struct State : Common<N>::State {
    double lag = 0.0;    ///< of the reference behind its programme [s]
    double rate = 1.0;   ///< θ̇
    double pull = 0.0;   ///< θ̈ [1/s]
    int iterations = 0;  ///< iterations of the last step, maximum over the axes
    std::array<Knot, kMostLag> past{};
    std::size_t newest = 0;
    std::size_t known = 0;
    std::array<V, kMost + 1> position{};  ///< reference over the horizon [m]
    std::array<V, kMost + 1> velocity{};  ///< [m/s]
    std::array<V, kMost> added{};         ///< friction, load and d̂ over it [N]
    Row move{};                           ///< u over it, of the last axis [m/s²]
    Row drift{};
    Row low{};
    Row high{};
    typename Moves::Work work;
    typename Progress<N, kMost>::Work stages;
  };

  Predictive(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, params.error_rate),
        setup_(setup),
        params_(params),
        moves_(MassRegulator(params.omega, setup.period), periods(params.horizon / setup.period)),
        progress_(setup.period),
        speed_limit_(spread<N>(params.speed_limit, std::numeric_limits<double>::infinity())) {
    for (const double f : setup.force_limit.c) limited_ = limited_ || isfinite(f);
    for (const double v : speed_limit_.c) limited_ = limited_ || isfinite(v);
  }

  /// Forces for the coming period [N], from the present point alone, whose acceleration is assumed to stay constant.
  V step(State& s, const Point& r, const V& measured) const noexcept {
    return step_on(s, std::span<const Point>(&r, 1), measured, 1);
  }
  /// The same with the points ahead, one per period, the present one first; after the last one its acceleration stays constant.
  template <std::convertible_to<std::span<const Point>> Points>
  V step(State& s, const Points& points, const V& measured) const noexcept {
    const std::span<const Point> ahead = points;
    if (ahead.empty()) {
      s.status.raise(Status::kNotFinite);
      return s.force;
    }
    return step_on(s, ahead, measured, moves_.moves());
  }

 private:
  /// A lag is finally reduced with this time constant [1/s], and set to zero below this time [s].
  static constexpr double kClosing = 20.0;
  static constexpr double kForgotten = 1e-8;
  /// Number of periods over which the longest lag is approached.
  static constexpr double kApproach = 20.0;
  /// Share of the speed limit that is kept for feedback.
  static constexpr double kSpeedReserve = 0.02;
  /// Bounds of the first move are wider by this, so that the force limit itself acts, and raises its status.
  static constexpr double kWider = 1e-9;

  static std::size_t periods(double n) noexcept {
    return static_cast<std::size_t>(clamp_to(std::ceil(n - 1e-6), 1.0, static_cast<double>(kMost)));
  }

  /// `ahead`: the present point and those after it. `stages`: periods for which progress is planned. Times along the programme count in
  /// periods from the present point; the reference is behind it by the lag.
  V step_on(State& s, std::span<const Point> ahead, const V& measured, std::size_t stages) const noexcept {
    const double t = setup_.period;
    Point r = ahead[0];
    if (s.lag > 0.0 || s.rate != 1.0) {
      const Knot k = at_time(s, ahead, -s.lag / t);
      r.position = k.position;
      r.velocity = s.rate * k.velocity;
      r.acceleration = s.rate * s.rate * k.acceleration + s.pull * k.velocity;
    }
    const double sum = sum_of(ahead);
    if (!isfinite(sum)) r.position[0] = sum;
    const bool first = !s.error[0].started;
    if (!common_.begin(s, r, measured)) return s.force;

    // Error and speed at the time at which the force of now begins to act.
    std::array<typename Moves::Begin, N> x;
    V speed;
    const double delay = setup_.compensation[0].delay();
    const double place =
        s.rate * (delay / t) - s.lag / t;  // of the beginning of the hold, on the programme [periods]
    read(s, ahead, place);
    for (std::size_t i = 0; i < N; ++i) {
      const Motion m = begin_of_hold(s, r, measured, i, first);
      // An axis with a longer delay than the first has its error predicted to a later place of the reference.
      const double later = setup_.compensation[i].delay() - delay;
      const double v = s.rate * s.velocity[0][i];
      const double a = later == 0.0 ? 0.0 : mean(s, i, 0);
      x[i] = {m.position - (s.position[0][i] + later * (v + 0.5 * later * a)), m.velocity - (v + later * a)};
      speed[i] = m.speed;
    }

    typename Progress<N, kMost>::Moved next;
    bool slowed = s.lag > 0.0 || s.rate != 1.0;
    if (limited_) {
      add_up(s);
      if (N > 1 && params_.slows && (slowed || exceeds(s))) {
        next = slow(s, ahead, place, stages);
        slowed = true;
      }
    }
    V move;
    s.iterations = 0;
    for (std::size_t i = 0; i < N; ++i) {
      drifts(s, i);
      moves_.free(x[i], s.drift, s.move);
      move[i] = limited_ ? bound(s, x[i], i) : s.move[0];
      // The speed at the end of the hold is decided now.
      const double a = clamp_to(move[i] + mean(s, i, 0), (-speed_limit_[i] - speed[i]) / t,
                                (speed_limit_[i] - speed[i]) / t);
      // What the law hands on contains the acceleration of the reference; a feed-forward that takes the mean over the hold by itself
      // replaces it, and must find the same value in r. That of a slowed reference changes in steps, so that its mean is used.
      if (takes_mean(i)) {
        if (slowed) r.acceleration[i] = mean(s, i, 0);
        move[i] = a - mean(s, i, 0) + r.acceleration[i];
      } else {
        move[i] = a;
      }
    }
    remember(s, ahead[0]);
    if (slowed) fall_behind(s, next);
    return common_.finish(s, r, move);
  }

  // ---- the path ahead and behind

  [[nodiscard]] double sum_of(std::span<const Point> ahead) const noexcept {
    double sum = 0.0;
    const std::size_t n = ahead.size() < kPreview + 1 ? ahead.size() : kPreview + 1;
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i < N; ++i)
        sum += ahead[j].position[i] + ahead[j].velocity[i] + ahead[j].acceleration[i];
    }
    return sum;
  }

  /// The programmed point n periods from now.
  [[nodiscard]] Knot at(const State& s, std::span<const Point> ahead, long n) const noexcept {
    if (n < 0) {
      const auto back = static_cast<std::size_t>(-n);
      const std::size_t k = back < s.known ? back : s.known;
      return s.past[(s.newest + kMostLag + 1 - k) % kMostLag];
    }
    const long last = static_cast<long>(ahead.size()) - 1;
    const Point& p = ahead[static_cast<std::size_t>(n < last ? n : last)];
    Knot k{p.position, p.velocity, p.acceleration};
    if (n > last) {
      const double t = static_cast<double>(n - last) * setup_.period;
      k.position = k.position + t * (k.velocity + 0.5 * t * k.acceleration);
      k.velocity = k.velocity + t * k.acceleration;
    }
    return k;
  }

  /// A point between two of them, by the cubic through positions and velocities.
  [[nodiscard]] Knot at_time(const State& s, std::span<const Point> ahead, double periods) const noexcept {
    const double below = std::floor(periods);
    const double f = periods - below;
    const auto n = static_cast<long>(below);
    const Knot a = at(s, ahead, n);
    if (f == 0.0) return a;
    const Knot b = at(s, ahead, n + 1);
    const double t = setup_.period;
    const double g = 1.0 - f;
    Knot k;
    const V chord = b.position - a.position;
    k.position =
        a.position + (f * f * (3.0 - 2.0 * f)) * chord + (t * f * g) * (g * a.velocity - f * b.velocity);
    k.velocity =
        (6.0 * f * g / t) * chord + (g * (1.0 - 3.0 * f)) * a.velocity + (f * (3.0 * f - 2.0)) * b.velocity;
    k.acceleration = g * a.acceleration + f * b.acceleration;
    return k;
  }

  /// The programmed path from a place on [periods], one point per period.
  void read(State& s, std::span<const Point> ahead, double place) const noexcept {
    for (std::size_t j = 0; j <= moves_.moves(); ++j) {
      const Knot k = at_time(s, ahead, place + static_cast<double>(j));
      s.position[j] = k.position;
      s.velocity[j] = k.velocity;
    }
  }

  void remember(State& s, const Point& r) const noexcept {
    s.newest = (s.newest + 1) % kMostLag;
    s.past[s.newest] = {r.position, r.velocity, r.acceleration};
    if (s.known < kMostLag) ++s.known;
  }

  // ---- prediction

  struct Motion {
    double position;
    double velocity;  ///< with the selected rate of the error
    double speed;     ///< predicted to the sample by the model
  };
  /// State of an axis at the time at which the force of now begins to act.
  [[nodiscard]] Motion begin_of_hold(const State& s, const Point& r, const V& measured, std::size_t i,
                                     bool first) const noexcept {
    const double t = setup_.period;
    const auto& c = s.compensation[i];
    // Commanded accelerations, newest first, reach the mass later by the delay.
    const auto acceleration = [&](std::size_t n) {
      return (c.force[n] - c.feedforward_history[n] - c.estimate) / common_.mass(i);
    };
    const double periods = clamp_to(setup_.compensation[i].delay() / t, 0.0, static_cast<double>(kMostDelay));
    const auto whole = static_cast<std::size_t>(periods);
    const double rest = periods - static_cast<double>(whole);
    Motion m{measured[i], r.velocity[i] + s.error[i].rate, r.velocity[i] + s.error[i].rate};
    if (!first && !observed(s, i)) {
      // The difference is the mean over the last period; this is what the velocity gained since its middle.
      m.speed = s.error[i].velocity + 0.5 * t *
                                          ((1.0 - rest * rest) * acceleration(whole) +
                                           (rest == 0.0 ? 0.0 : rest * rest * acceleration(whole + 1)));
      if (params_.rate_at_sample) m.velocity = m.speed;
    }
    const auto go = [&](double dt, double a) {
      m.position += dt * (m.velocity + 0.5 * dt * a);
      m.velocity += dt * a;
      m.speed += dt * a;
    };
    if (rest > 0.0) go(rest * t, acceleration(whole));
    for (std::size_t n = whole; n-- > 0;) go(t, acceleration(n));
    return m;
  }

  /// Whether the feed-forward itself takes the mean of the reference's acceleration over the hold.
  [[nodiscard]] bool takes_mean(std::size_t i) const noexcept {
    const auto f = setup_.compensation[i].feedforward;
    return f != Feedforward::kNone && f != Feedforward::kSteady;
  }

  [[nodiscard]] bool observed(const State& s, std::size_t i) const noexcept {
    return params_.error_rate == ErrorRate::kObserved && !setup_.compensation[i].model.drive_loop &&
           Compensation::observes_velocity(setup_.compensation[i], s.compensation[i]);
  }

  /// Mean acceleration of the reference over a period of the horizon.
  [[nodiscard]] double mean(const State& s, std::size_t i, std::size_t j) const noexcept {
    return (s.velocity[j + 1][i] - s.velocity[j][i]) / setup_.period;
  }

  /// Deviation of the reference from its mean accelerations.
  void drifts(State& s, std::size_t i) const noexcept {
    for (std::size_t j = 0; j < moves_.moves(); ++j)
      s.drift[j] = s.position[j][i] - s.position[j + 1][i] +
                   0.5 * setup_.period * (s.velocity[j][i] + s.velocity[j + 1][i]);
  }

  /// Friction, load and disturbance over the horizon.
  void add_up(State& s) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const auto& p = setup_.compensation[i];
      const double constant = p.model.load + s.compensation[i].guard.trust * s.compensation[i].estimate;
      const bool feeds = p.feedforward != Feedforward::kNone && isfinite(setup_.force_limit[i]);
      for (std::size_t j = 0; j < moves_.moves(); ++j) {
        double f = constant;
        if (feeds) {
          const double v = 0.5 * (s.velocity[j][i] + s.velocity[j + 1][i]);
          const auto parts = p.model.friction.parts(v, s.position[j][i]);
          f += parts.level * sign(v) + parts.viscous + parts.additive;
        }
        s.added[j][i] = f;
      }
    }
  }

  // ---- progress

  /// Whether the programme needs more than the limits of progress.
  [[nodiscard]] bool exceeds(const State& s) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const double most = (1.0 - params_.reserve) * setup_.force_limit[i];
      const double fastest = (1.0 - kSpeedReserve) * speed_limit_[i];
      for (std::size_t j = 0; j < moves_.moves(); ++j) {
        const double force = common_.mass(i) * mean(s, i, j) + s.added[j][i];
        if (abs(force) > most || abs(s.velocity[j][i]) > fastest) return true;
      }
    }
    return false;
  }

  /// Plans progress, and replaces the programmed reference by the one that follows from it.
  typename Progress<N, kMost>::Moved slow(State& s, std::span<const Point> ahead, double place,
                                          std::size_t n) const noexcept {
    const double t = setup_.period;
    for (std::size_t i = 0; i < N; ++i) {
      const double most = (1.0 - params_.reserve) * setup_.force_limit[i];
      for (std::size_t j = 0; j < n; ++j) {
        auto& stage = s.stages.stage[j];
        stage.high[i] = (most - s.added[j][i]) / common_.mass(i);
        stage.low[i] = (-most - s.added[j][i]) / common_.mass(i);
        stage.d[i] = 0.5 * (s.velocity[j][i] + s.velocity[j + 1][i]);
        stage.c[i] = mean(s, i, j);
      }
    }
    const double wanted = 1.0 + min_of(params_.catch_up, kClosing * s.lag);
    for (std::size_t j = 0; j < n; ++j) {
      auto& stage = s.stages.stage[j];
      double rate = wanted;
      for (std::size_t i = 0; i < N; ++i)
        rate = min_of(rate, (1.0 - kSpeedReserve) * speed_limit_[i] /
                                abs(stage.d[i]));  // ∞ where the axis does not move
      stage.most = rate * rate;
    }
    progress_.reach(s.stages, n, wanted * wanted);
    // Not slower than the memory of the path permits.
    const double longest = static_cast<double>(s.known < kMostLag - 2 ? s.known : kMostLag - 2) * t;
    const double least = 1.0 - clamp_to((longest - s.lag) / (kApproach * t), 0.0, 1.0);
    typename Progress<N, kMost>::Moved m{s.rate, 0.0, 0.0};
    typename Progress<N, kMost>::Moved first = m;
    const Knot begin = at_time(s, ahead, place);
    s.position[0] = begin.position;
    s.velocity[0] = s.rate * begin.velocity;
    for (std::size_t j = 0; j < moves_.moves(); ++j) {
      m = progress_.advance(s.stages, n, m, least);
      if (j == 0) first = m;
      const Knot k = at_time(s, ahead, place + m.place);
      s.position[j + 1] = k.position;
      s.velocity[j + 1] = m.rate * k.velocity;
    }
    add_up(s);
    return first;
  }

  void fall_behind(State& s, const typename Progress<N, kMost>::Moved& next) const noexcept {
    s.lag = max_of(s.lag + setup_.period * (1.0 - next.place), 0.0);
    s.rate = next.rate;
    s.pull = next.pull;
    if (s.lag < kForgotten && s.rate >= 1.0) {
      s.lag = 0.0;
      s.rate = 1.0;
      s.pull = 0.0;
    }
  }

  // ---- moves

  /// Finds the moves of an axis within its limits where the free ones violate them; returns the first.
  double bound(State& s, typename Moves::Begin x, std::size_t i) const noexcept {
    const std::size_t n = moves_.moves();
    bool outside = false;
    for (std::size_t j = 0; j < n; ++j) {
      const double r = mean(s, i, j);
      const double most = setup_.force_limit[i] * (j == 0 ? 1.0 + kWider : 1.0);
      s.high[j] = (most - s.added[j][i]) / common_.mass(i) - r;
      s.low[j] = (-most - s.added[j][i]) / common_.mass(i) - r;
      outside = outside || s.move[j] > s.high[j] || s.move[j] < s.low[j];
    }
    if (outside) {
      // Starts from the law, limited at each step: this is nearly optimal, and does not depend on earlier periods.
      typename Moves::Begin y = x;
      for (std::size_t j = 0; j < n; ++j) {
        s.move[j] = clamp_to(moves_.regulator().law(y.e, y.v), s.low[j], s.high[j]);
        y = moves_.next(y, s.move[j], s.drift[j]);
      }
      const int k = moves_.bounded(x, s.drift, s.low, s.high, s.move, params_.iterations, s.work);
      s.iterations = k > s.iterations ? k : s.iterations;
    }
    return s.move[0];
  }

  Common<N> common_;
  Setup<N> setup_;
  Params params_;
  Moves moves_;
  Progress<N, kMost> progress_;
  V speed_limit_;
  bool limited_ = false;
};

}  // namespace stribeck::control
