#pragma once
/// Friction of one axis at the motion of the reference: the identified model with its pre-sliding.
///
///   F̄ = (1/T)·∫ F(r(τ)) dτ over the coming hold,   F = bristle + χ·viscous(ṙ) + additive(r)
///   LuGre   bristle = σ0·z + σ1·ż,   ż = ṙ − σ0|ṙ|z/g        GMS   bristle = Σ F_i        static   bristle = g·sgn ṙ
///
///   Adaptation scales the identified model: level g by ψ₊ or ψ₋ (direction of ṙ), stiffness by ρ, viscous friction by χ; places of
///   the model scale level and stiffness further. The break-away distance is g·ψ/(σ0·ρ). A stiffness ρ times higher acts like the same bristle in a motion ρ times as fast.
///
/// The bristle follows the reference, not the encoder: the force cannot chatter and closes no loop. Its state continues through
/// partial reversals, short moves and dwell. It starts relaxed at rest, and fully deflected in motion. A static model that switches
/// within a hold gives the mean. The motion ahead is predicted anew in each period from a copy of the state, so that a wrong
/// prediction leaves no trace.
/// Sign: positive for ṙ > 0, as friction. Source: Canudas de Wit et al. 1995, doi:10.1109/9.376053; Al-Bender, Lampaert, Swevers
/// 2005, doi:10.1109/TAC.2005.858676; the hold as in motion_ahead.hpp.
/// Not modelled: effect of the tracking error on the bristle; relaxation during a long dwell.
/// Real time: safe; three evaluations of the map and four exponentials for each step, one of each more for a reversal and for each
/// period of delay begun (two if it contains a reversal), at most ten periods; the constructor configure only.

#include <stribeck/control/compensation/motion_ahead.hpp>
#include <stribeck/friction/model.hpp>

namespace stribeck::control {

/// Corrections by adaptation, as shares of the identified model.
struct FrictionScales {
  double positive = 1.0;   ///< ψ₊, of the level for ṙ > 0
  double negative = 1.0;   ///< ψ₋, of the level for ṙ < 0
  double viscous = 1.0;    ///< χ
  double stiffness = 1.0;  ///< ρ

  [[nodiscard]] constexpr double level(double v) const noexcept { return v < 0.0 ? negative : positive; }
};

/// Works with any friction::BasicModel; FrictionFeedforward is the one for the built-in laws.
template <class Model>
class BasicFrictionFeedforward {
 public:
  using Bristle = typename friction::StateOf<decltype(Model::dynamics)>::Type;

  struct State {
    Bristle bristle;        ///< state at the reference of now
    double position = 0.0;  ///< of the reference [m]
    double velocity = 0.0;  ///< [m/s]
    bool started = false;
  };

  /// Mean over the hold, split into its parts [N].
  struct Force {
    double bristle = 0.0;
    double viscous = 0.0;
    double additive = 0.0;
    [[nodiscard]] double sum() const noexcept { return bristle + viscous + additive; }
  };

  BasicFrictionFeedforward() = default;
  BasicFrictionFeedforward(const Model& model, double period) noexcept : model_(model), period_(period) {}

  /// One period. `delay` [s]: from the sample to the beginning of the hold.
  Force step(State& s, const MotionAhead& r, double delay = 0.0,
             const FrictionScales& scales = {}) const noexcept {
    if (s.started) {
      follow(s.bristle, {s.position, s.velocity}, {r.position, r.velocity}, period_, scales);
    } else {
      s.started = true;
      start(s.bristle, model_.parts(r.velocity, r.position), r.velocity, scales);
    }
    s.position = r.position;
    s.velocity = r.velocity;

    Bristle ahead = s.bristle;
    for (double t = 0.0; t < delay; t += period_) {
      const double dt = min_of(period_, delay - t);
      follow(ahead, at(r, t), at(r, t + dt), dt, scales);
    }
    constexpr int kParts = 2;
    const double h = period_ / kParts;
    Force mean;
    for (int part = 0; part < kParts; ++part) {
      const double middle = delay + (part + 0.5) * h;
      const double v = r.velocity_at(middle);
      auto p = model_.parts(v, r.position_at(middle));
      p.level *= scales.level(v);
      const double early = r.velocity_at(middle - 0.25 * h);
      const double late = r.velocity_at(middle + 0.25 * h);
      const double stiffness = stiffness_at(r.position_at(middle), scales);
      mean.bristle += force_after(ahead, p, early, v, 0.5 * h, stiffness) / kParts;
      if (part + 1 < kParts) advance(ahead, p, late, 0.5 * h, stiffness);
      mean.viscous += scales.viscous * p.viscous / kParts;
      mean.additive += p.additive / kParts;
    }
    return mean;
  }

  /// Mean force over the last hold, in which the axis moved by `travel` [m] to its present place, for several sets of scales. Level
  /// and viscous friction are evaluated at velocity v [m/s]: that of the reference, which has no noise.
  std::array<Force, 4> follow(Bristle* bristles, const FrictionScales* scales, std::size_t count,
                              bool& started, double travel, double v, double x) const noexcept {
    std::array<Force, 4> force{};
    auto p = model_.parts(v, x - 0.5 * travel);
    if (!started) {
      started = true;
      for (std::size_t i = 0; i < count; ++i) start(bristles[i], p, v, scales[i]);
    }
    const double level = p.level;
    const double moved = travel / period_;
    for (std::size_t i = 0; i < count; ++i) {
      p.level = level * scales[i].level(v);
      const double stiffness = stiffness_at(x - 0.5 * travel, scales[i]);
      force[i] = {force_after(bristles[i], p, moved, moved, 0.5 * period_, stiffness),
                  scales[i].viscous * p.viscous, p.additive};
      advance(bristles[i], p, moved, 0.5 * period_, stiffness);
    }
    return force;
  }

  /// Shifts the force of the bristle by up to `force` [N], within the level of friction; returns the shift. Used at rest, where an
  /// observer sees the force that friction holds.
  double shift(Bristle& b, double force, double position, const FrictionScales& scales) const noexcept {
    const double level = model_.parts(0.0, position).level * min_of(scales.positive, scales.negative);
    return with_law(b, [&](const auto& law, auto& s) noexcept { return law.shift(s, force, level); });
  }

  [[nodiscard]] const Model& model() const noexcept { return model_; }

 private:
  void start(Bristle& b, const friction::SteadyParts<double>& p, double v,
             const FrictionScales& scales) const noexcept {
    const double level = v == 0.0 ? 0.0 : p.level * scales.level(v) * sign(v);
    with_law(b, [&](const auto& law, auto& s) noexcept {
      s = {};
      if (v != 0.0) law.slide(s, level);
    });
  }

  struct Point {
    double position = 0.0;
    double velocity = 0.0;
  };
  static Point at(const MotionAhead& r, double t) noexcept { return {r.position_at(t), r.velocity_at(t)}; }

  /// Advances a bristle from one point of the reference to another, dt later. If the velocity changes its sign, the turn lies where a
  /// velocity that changes linearly is zero.
  void follow(Bristle& b, const Point& from, const Point& to, double dt,
              const FrictionScales& scales) const noexcept {
    Point begin = from;
    if (from.velocity * to.velocity < 0.0) {
      const double t = dt * from.velocity / (from.velocity - to.velocity);
      const Point turn{from.position + 0.5 * t * from.velocity, 0.0};
      if ((to.position - turn.position) * to.velocity > 0.0) {
        along(b, begin, turn, t, scales);
        begin = turn;
        dt -= t;
      }
    }
    along(b, begin, to, dt, scales);
  }
  void along(Bristle& b, const Point& from, const Point& to, double dt,
             const FrictionScales& scales) const noexcept {
    if (!(dt > 0.0)) return;
    const double v = 0.5 * (from.velocity + to.velocity);
    const double middle = 0.5 * (from.position + to.position);
    auto p = model_.parts(v, middle);
    p.level *= scales.level(v);
    const double moved = (to.position - from.position) / dt;
    advance(b, p, moved, dt, stiffness_at(middle, scales));
  }
  /// ρ at position x.
  [[nodiscard]] double stiffness_at(double x, const FrictionScales& scales) const noexcept {
    if (model_.places.empty()) return scales.stiffness;
    return scales.stiffness * friction::shares_at(model_.places, x).stiffness;
  }

  template <class Act>
  decltype(auto) with_law(Bristle& b, Act&& act) const noexcept {
    return friction::with_law(model_.dynamics, b, act);
  }

  /// Advances a bristle by dt at velocity v.
  void advance(Bristle& b, const friction::SteadyParts<double>& p, double v, double dt,
               double stiffness) const noexcept {
    with_law(b, [&](const auto& law, auto& s) noexcept { law.advance(s, stiffness * v, p.level, dt); });
  }
  /// The same; returns the bristle's force at the end, with the damping of velocity v_end.
  double force_after(Bristle& b, const friction::SteadyParts<double>& p, double v, double v_end, double dt,
                     double stiffness) const noexcept {
    return with_law(b, [&](const auto& law, auto& s) noexcept {
      law.advance(s, stiffness * v, p.level, dt);
      return law.bristle(s, v_end, p.level, stiffness);
    });
  }

  Model model_;
  double period_ = 1e-3;
};

using FrictionFeedforward = BasicFrictionFeedforward<friction::Model>;

}  // namespace stribeck::control
