#pragma once
/// One axis of a model, moved by a given force, for replay.hpp.
///
///   m·v̇ = f − F(v, x) − load         f force, held; F friction of the model, with pre-sliding or without
///
/// The law of the model decides which of the two kinds of axis runs; a law that is not built in needs no change here.
/// Integrated by Kutta's third order; sub-steps follow from the fastest rate of the equations.
/// Sign: f > 0 pushes in +x, friction and load against it.
/// Not modelled: elasticity of the axis.
/// Real time: no. Errors: Refused where a hold needs more sub-steps than make sense.

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/vec.hpp>
#include <stribeck/friction/model.hpp>
#include <stribeck/plant/integrator.hpp>

namespace stribeck::ident::replay {

inline constexpr double kFewestSubsteps = 4.0;
inline constexpr double kLongestSubstep =
    0.5e-3;  ///< [s]; a Stribeck part of 1 mm/s passed at 1 m/s² takes 1 ms

/// Sub-steps for a hold of dt when the fastest rate of the equations is `rate` [1/s].
inline double substeps(double dt, double rate) {
  return std::max({kFewestSubsteps, std::ceil(dt / kLongestSubstep), std::ceil(dt * rate)});
}

/// Diverged where n sub-steps in a hold of dt [s] are too many, as of a run that has left the speeds of its model; `what` names what
/// needs them.
void check_substeps(double n, double dt, const char* what);

/// Greatest slope of friction over velocity, on either side of standstill [N·s/m].
template <class Map>
double steepness(const Map& map, double speed) {
  constexpr int kPoints = 2000;
  double most = 0.0;
  for (const double s : {-1.0, 1.0}) {
    double before = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i <= kPoints; ++i) {
      const double v = s * speed * (i + 1e-6) / kPoints;
      const double force = friction::steady_force(map, v);
      if (i > 0) most = std::max(most, std::abs(force - before) * kPoints / speed);
      before = force;
    }
  }
  return most;
}

/// An axis whose friction is always at its steady state. Standstill is exact: it is a state of its own, left only when the
/// force leaves the level of friction.
template <class Map>
class StaticAxis {
 public:
  StaticAxis(double mass, double load, const Map& map, double speed)
      : map_(map), mass_(mass), load_(load), rate_(2.0 * steepness(map, speed) / mass) {}

  void place(double x, double v) {
    y_[0] = x;
    y_[1] = v;
  }
  void settle(double) {}
  [[nodiscard]] double x() const { return y_[0]; }
  [[nodiscard]] double v() const { return y_[1]; }

  void advance(double force, double dt) {
    const double n = substeps(dt, rate_);
    check_substeps(n, dt, "friction as steep as this over so small a mass needs");
    const double push = force - load_;
    for (int i = 0; i < static_cast<int>(n); ++i) {
      if (!pass(push, dt / n)) return;
    }
  }

 private:
  using State = Vec<double, 2>;
  static constexpr double kTiny = 1e-12;  ///< velocity that only gives a direction [m/s]
  static constexpr int kMostEvents = 8;

  /// Direction in which the axis leaves standstill; 0: it stays.
  [[nodiscard]] int breaks(double push) const {
    const auto forward = map_.parts(kTiny, y_[0]);
    if (push - forward.additive > forward.level) return 1;
    const auto backward = map_.parts(-kTiny, y_[0]);
    return push - backward.additive < -backward.level ? -1 : 0;
  }

  /// One step while the direction s does not change; beyond v = 0, friction keeps its value at standstill.
  [[nodiscard]] State step(double push, double h, double s) const {
    const auto rhs = [&](const State& y) {
      const double v = y[1] * s > kTiny ? y[1] : s * kTiny;
      return State{{y[1], (push - friction::steady_force(map_, v, y[0])) / mass_}};
    };
    return plant::rk3_step(y_, rhs(y_), h, rhs);
  }

  /// Instant in (0, h] at which the velocity reaches zero; it is past zero at h (Illinois).
  [[nodiscard]] double stop_time(double push, double h, double s, double v_end) const {
    double a = 0.0;
    double b = h;
    double fa = y_[1] * s;
    double fb = v_end * s;
    double t = h;
    for (int i = 0; i < 40; ++i) {
      t = (a * fb - b * fa) / (fb - fa);
      const double ft = step(push, t, s)[1] * s;
      if (std::abs(ft) <= kTiny) break;
      if (ft > 0.0) {
        a = t;
        fa = ft;
        fb *= 0.5;
      } else {
        b = t;
        fb = ft;
        fa *= 0.5;
      }
    }
    return t;
  }

  /// False: the axis stands still, and stays so while the force is held.
  bool pass(double push, double h) {
    for (int events = 0; events < kMostEvents; ++events) {
      const bool standing = y_[1] == 0.0;
      const int direction = standing ? breaks(push) : (y_[1] > 0.0 ? 1 : -1);
      if (direction == 0) return false;
      const double s = direction;
      const State end = step(push, h, s);
      if (end[1] * s > 0.0) {
        y_ = end;
        return true;
      }
      if (standing) return false;  // friction rises at once by more than the force exceeds it
      const double t = stop_time(push, h, s, end[1]);
      y_ = step(push, t, s);
      y_[1] = 0.0;
      h -= t;
      if (!(h > 0.0)) return true;
    }
    y_[1] = 0.0;  // to rounding, the force is at the border of standstill
    return true;
  }

  Map map_;
  double mass_;
  double load_;
  double rate_;  ///< [1/s]
  State y_{};
};

/// An axis whose law has pre-sliding, over the steady map.
template <class Map, friction::PreSlidingLaw Law>
class DynamicAxis {
 public:
  DynamicAxis(double mass, double load, const Map& map, const Law& law)
      : map_(map), law_(law), friction_(law), mass_(mass), load_(load) {}

  void place(double x, double v) {
    y_[0] = x;
    y_[1] = v;
  }
  /// Bristles as sliding leaves them; at rest they carry `force`.
  void settle(double force) {
    const auto p = map_.parts(v(), x());
    const double carried = v() != 0.0 ? p.level * (v() > 0.0 ? 1.0 : -1.0)
                                      : std::clamp(force - load_ - p.additive, -p.level, p.level);
    typename Law::State state{};
    if (v() != 0.0) {
      friction_.law().slide(state, carried);
    } else {
      friction_.law().carry(state, carried);
    }
    friction_.place(state, &y_[2]);
  }
  [[nodiscard]] double x() const { return y_[0]; }
  [[nodiscard]] double v() const { return y_[1]; }

  void advance(double force, double dt) {
    const double push = force - load_;
    if (!map_.places.empty())
      friction_.set_law(law_.stiffened(friction::shares_at(map_.places, x()).stiffness));
    const Law& law = friction_.law();
    const auto p = map_.parts(v(), x());
    // The highest speed that can occur in the hold decides how fast bristles may decay in it.
    const double reach = std::abs(v()) + (std::abs(push) + p.level) / mass_ * dt;
    const double rate = std::max(2.0 * std::sqrt(law.stiffness() / mass_) + law.damping() / mass_,
                                 law.rate_bound(reach, p.level));
    const double n = substeps(dt, kSafety * rate);
    check_substeps(n, dt, "bristles of this stiffness need");
    const double h = dt / n;
    const auto rhs = [&](const State& y) {
      State d;
      d[0] = y[1];
      d[1] = (push - friction_.evaluate(&y[2], y[1], map_.parts(y[1], y[0]), &d[2])) / mass_;
      return d;
    };
    for (int i = 0; i < static_cast<int>(n); ++i) {
      const double before = v();
      y_ = plant::rk3_step(y_, rhs(y_), h, rhs);
      if constexpr (Friction::kSettles) friction_.settle(&y_[2], before, v(), map_.parts(v(), x()));
    }
  }

 private:
  using Friction = friction::Integrated<Law>;
  static constexpr double kSafety =
      1.0 / 0.8;  ///< Kutta's third order is stable up to 2.5; with 0.8 it is accurate as well
  using State = Vec<double, 2 + Friction::kCount>;

  Map map_;
  Law law_;
  Friction friction_;
  double mass_;
  double load_;
  State y_{};
};

/// Calls run(axis) with the kind of axis that the model needs; `Model` is any friction::BasicModel, `speed` [m/s] the largest.
template <class Model, class Run>
void with_axis(double mass, double load, const Model& model, double speed, Run&& run) {
  std::visit(
      [&]<class Base, class Law>(const Base& base, const Law& law) {
        using Map = friction::Composed<Base>;
        const Map map = composed(base, model);
        if constexpr (friction::PreSlidingLaw<Law>) {
          DynamicAxis<Map, Law> axis(mass, load, map, law);
          run(axis);
        } else {
          StaticAxis<Map> axis(mass, load, map, speed);
          run(axis);
        }
      },
      model.steady, model.dynamics);
}

}  // namespace stribeck::ident::replay
