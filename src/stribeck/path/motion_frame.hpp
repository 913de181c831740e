#pragma once
/// The moving frame of a motion from another planner: from position, velocity and acceleration, sample by sample.
///
///   t = ṙ/|ṙ|,  ṫ, ẗ by the series of the motion in time (jerk: difference of the accelerations);  normals transported (frame.hpp)
///
///   Slower than `slowest` [m/s]: the last frame is kept, and Ṙ = R̈ = 0. They fade in up to twice that speed.
///   Turning faster than `fastest` [rad/s], as in a corner: R still follows, Ṙ and R̈ stay within fastest and fastest².
///   Turned by more than 60° from one sample to the next: the smallest rotation; by more than 120°, as where the motion
///   reverses: the normals nearest to the last ones.
///
/// With Ṙ = R̈ = 0 a contouring law is PD along and across the path, which is stable: only the terms of the turning frame fade
/// out. A planner with unlimited jerk makes ẗ a row of pulses; the limit cuts them.
/// Not modelled: the motion after the sample.
/// Real time: safe; the constructor configure only.

#include <stribeck/path/reference.hpp>

namespace stribeck::path {

template <std::size_t N>
class MotionFrame {
  static_assert(N > 1);

 public:
  struct State {
    Mat<double, N> rt = identity<N>();
    Vec<double, N> position;
    Vec<double, N> acceleration;
    bool started = false;
    bool moved = false;
  };

  MotionFrame() = default;
  MotionFrame(double period, double slowest, double fastest) noexcept
      : period_(period), slowest_(slowest), fastest_(fastest) {}

  /// Fills the frame of a point whose position, velocity and acceleration are given and finite.
  void step(State& s, PathPoint<N>& r) const noexcept {
    const double speed = norm(r.velocity);
    const double shown = clamp_to(speed / slowest_ - 1.0, 0.0, 1.0);
    if (shown > 0.0) {
      turn(s, r, (1.0 / speed) * r.velocity);
      if (s.started) set_rates(s, r, shown);
    }
    r.frame = s.rt;
    s.position = r.position;
    s.acceleration = r.acceleration;
    s.started = true;
  }

 private:
  static constexpr double kCorner = 0.5;  ///< cosine
  static constexpr double kBack = -0.5;

  void turn(State& s, const PathPoint<N>& r, const Vec<double, N>& t) const noexcept {
    if (!s.moved) {
      s.rt = first_frame(t, r.acceleration);
      s.moved = true;
    } else if (dot(t, s.rt[0]) > kCorner) {
      s.rt = transport(s.rt, s.position, r.position, t);
    } else if (dot(t, s.rt[0]) > kBack) {
      s.rt = rotated(s.rt, t);
    } else {
      s.rt = nearest(s.rt, t);
    }
  }

  /// The smallest rotation that takes the tangent to t; at 90° the old tangent becomes a normal.
  static Mat<double, N> rotated(const Mat<double, N>& rt, const Vec<double, N>& t) noexcept {
    Mat<double, N> m = rt;
    m[0] = t;
    const Vec<double, N> both = (1.0 / (1.0 + dot(t, rt[0]))) * (t + rt[0]);
    for (std::size_t i = 1; i < N; ++i) m[i] = rt[i] - dot(t, rt[i]) * both;
    return nearest(m, t);  // remove the effect of rounding
  }

  /// Parts of the normals across t, made orthonormal; where one vanishes, a new frame is started.
  static Mat<double, N> nearest(const Mat<double, N>& rt, const Vec<double, N>& t) noexcept {
    Mat<double, N> m = rt;
    m[0] = t;
    for (std::size_t i = 1; i < N; ++i) {
      for (std::size_t k = 0; k < i; ++k) m[i] = detail::without(m[i], m[k]);
      const double length = norm(m[i]);
      if (!(length > 0.1)) return first_frame(t, Vec<double, N>{});
      m[i] = (1.0 / length) * m[i];
    }
    return m;
  }

  void set_rates(const State& s, PathPoint<N>& r, double shown) const noexcept {
    Vec<Taylor<3>, N> q;
    for (std::size_t i = 0; i < N; ++i) {
      q[i].c[0] = r.position[i];
      q[i].c[1] = r.velocity[i];
      q[i].c[2] = 0.5 * r.acceleration[i];
      q[i].c[3] = (r.acceleration[i] - s.acceleration[i]) / (6.0 * period_);
    }
    const Frame<N> f = transported_frame(q, s.rt);
    const double rate = norm(f.first[0]);
    const double rate2 = norm(f.second[0]);
    const double first = shown * (rate > fastest_ ? fastest_ / rate : 1.0);
    const double second = shown * (rate2 > fastest_ * fastest_ ? fastest_ * fastest_ / rate2 : 1.0) *
                          (rate > fastest_ ? 0.0 : 1.0);
    for (std::size_t i = 0; i < N; ++i) {
      r.frame_rate[i] = first * f.first[i];
      r.frame_acceleration[i] = second * f.second[i];
    }
  }

  double period_ = 1e-3;
  double slowest_ = 1e-5;
  double fastest_ = 10.0;
};

}  // namespace stribeck::path
