#pragma once
/// The motion that a controller follows: a path travelled under a law of motion, sampled once per control period, with the
/// frame that moves along.
///
///   speed   ṡ from the law:  φ̇ = ṡ/|q'|,  φ̈ = (s̈ − φ̇²·(q'·q'')/|q'|)/|q'|
///   rate    φ̇, φ̈ from the law itself, as the thesis's references are printed
///   ṙ = q'φ̇,   r̈ = q''φ̇² + q'φ̈,   Ṙ = R'φ̇,   R̈ = R''φ̇² + R'φ̈
///
/// The frame comes from the geometry, so that it is defined at standstill too. Under a law of speed each step extends the present series
/// of |q'| to find φ, then integrates |q'| between both ends (Hermite, exact to the seventh power of φ); the next step corrects the
/// error of this one. φ stays within 0.1 nm of the law, 2e-10 rad over a lap (test). Where the series does not converge over
/// a step, RK4 is used. A path with one axis has Pace::kRate and no frame.
/// Real time: safe. One evaluation of the path per step.

#include <stribeck/path/frame.hpp>
#include <stribeck/path/speed_law.hpp>

namespace stribeck::path {

template <std::size_t N>
struct PathPoint {
  Vec<double, N> position;               ///< r [m]
  Vec<double, N> velocity;               ///< ṙ [m/s]
  Vec<double, N> acceleration;           ///< r̈ [m/s²]
  Mat<double, N> frame = identity<N>();  ///< Rᵀ: row 0 the tangent, the others across the path
  Mat<double, N> frame_rate{};           ///< Ṙᵀ [1/s]
  Mat<double, N> frame_acceleration{};   ///< R̈ᵀ [1/s²]
  double phi = 0.0;                      ///< parameter of the path
};

/// The quantity that the law of motion defines.
enum class Pace { kSpeed, kRate };

template <PathCurve C>
class Reference {
 public:
  static constexpr std::size_t kAxes = C::kAxes;

  /// With Pace::kRate the law's speed is φ̇ [1/s] and its distance φ. Frenet's and the printed frame need three axes; other
  /// paths have the transported one.
  Reference(const C& curve, const SpeedLaw& law, Pace pace = Pace::kSpeed,
            FrameKind frame = FrameKind::kTransported) noexcept
      : curve_(curve), law_(law), pace_(pace), kind_(frame), now_(law.at(0.0)) {
    look();
    if constexpr (kAxes > 1) rt_ = first_frame(inverse_.c[0] * at<1>(), at<2>());
  }

  /// The point at the present time.
  [[nodiscard]] PathPoint<kAxes> point() const noexcept {
    PathPoint<kAxes> r;
    r.phi = phi_;
    double rate = now_.speed;
    double rate2 = now_.acceleration;
    if (pace_ == Pace::kSpeed) {
      // |q'|' = stretch_.c[1]
      rate = now_.speed * inverse_.c[0];
      rate2 = (now_.acceleration - rate * rate * stretch_.c[1]) * inverse_.c[0];
    }
    const Vec<double, kAxes> q1 = at<1>();
    r.position = at<0>();
    r.velocity = rate * q1;
    r.acceleration = rate * rate * at<2>() + rate2 * q1;
    if constexpr (kAxes > 1) {
      const Frame<kAxes> f = frame();
      r.frame = f.rt;
      for (std::size_t i = 0; i < kAxes; ++i) {
        r.frame_rate[i] = rate * f.first[i];
        r.frame_acceleration[i] = rate * rate * f.second[i] + rate2 * f.first[i];
      }
    }
    return r;
  }

  /// Advances by dt [s].
  void advance(double dt) noexcept {
    const SpeedLaw::Point before = now_;
    time_ += dt;
    now_ = law_.at(time_);
    const Vec<double, kAxes> from = at<0>();
    if (pace_ == Pace::kRate) {
      phi_ = now_.s;
      look();
    } else {
      const double distance = now_.s - before.s + missed_;
      if (distance == 0.0) return;
      if (!extend(distance)) {
        missed_ = 0.0;
        phi_ = runge_kutta(distance);
        look();
      }
    }
    if constexpr (kAxes > 1) {
      rt_ = transport(rt_, from, at<0>(), inverse_.c[0] * at<1>());
      if (kind_ == FrameKind::kFrenet) rt_ = frame().rt;
    }
  }

  [[nodiscard]] bool finished() const noexcept { return time_ >= law_.duration(); }
  [[nodiscard]] double time() const noexcept { return time_; }

 private:
  /// Frenet's frame needs the fourth derivative of the path.
  static constexpr int kOrder = 4;

  template <int K>
  [[nodiscard]] Vec<double, kAxes> at() const noexcept {
    return detail::derivative_of<K>(here_);
  }

  void look() noexcept {
    here_ = series<kOrder>(curve_, phi_);
    if constexpr (kAxes > 1) {
      stretch_ = norm(differentiated<kOrder - 1, 1>(here_));
      inverse_ = Taylor<2>(1.0) / shortened<2>(stretch_);
    }
  }

  /// Whether a step is short enough for the series of |q'|: its last term then affects the sixth digit at most.
  [[nodiscard]] bool reaches(double step) const noexcept {
    return abs(stretch_.c[3] * step * step * step) <= 1e-5 * stretch_.c[0];
  }

  /// One step by the series; returns false and changes nothing where it does not converge.
  bool extend(double distance) noexcept {
    const Taylor<kOrder - 1> f = stretch_;
    // Reverses s(δ) = f₀δ + f₁δ²/2 + f₂δ³/3 + f₃δ⁴/4 = distance.
    const double x = distance * inverse_.c[0];
    const double a = f.c[1] * inverse_.c[0] / 2.0;
    const double b = f.c[2] * inverse_.c[0] / 3.0;
    const double c = f.c[3] * inverse_.c[0] / 4.0;
    const double step = x * (1.0 + x * (-a + x * (2.0 * a * a - b + x * (5.0 * a * (b - a * a) - c))));
    if (!reaches(step)) return false;
    const double phi = phi_;
    const auto here = here_;
    const auto inverse = inverse_;
    phi_ += step;
    look();
    if (!reaches(step)) {
      phi_ = phi;
      here_ = here;
      stretch_ = f;
      inverse_ = inverse;
      return false;
    }
    const Taylor<kOrder - 1>& g = stretch_;
    const double travelled =
        step * (0.5 * (f.c[0] + g.c[0]) +
                step * (3.0 / 28.0 * (f.c[1] - g.c[1]) +
                        step * (1.0 / 42.0 * (f.c[2] + g.c[2]) + step * (1.0 / 280.0 * (f.c[3] - g.c[3])))));
    missed_ = distance - travelled;
    return true;
  }

  /// φ after a distance [m], by RK4 in the distance.
  [[nodiscard]] double runge_kutta(double distance) const noexcept {
    constexpr int kSteps = 2;
    const double h = distance / kSteps;
    double phi = phi_;
    for (int i = 0; i < kSteps; ++i) {
      const double k1 = 1.0 / stretch(curve_, phi);
      const double k2 = 1.0 / stretch(curve_, phi + 0.5 * h * k1);
      const double k3 = 1.0 / stretch(curve_, phi + 0.5 * h * k2);
      const double k4 = 1.0 / stretch(curve_, phi + h * k3);
      phi += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return phi;
  }

  [[nodiscard]] Frame<kAxes> frame() const noexcept {
    if constexpr (kAxes == 3) {
      if (kind_ != FrameKind::kTransported) return frenet_frame(here_, kind_ == FrameKind::kPrinted, rt_);
    }
    return transported_frame(here_, inverse_, rt_);
  }

  C curve_;
  SpeedLaw law_;
  Pace pace_;
  FrameKind kind_;
  SpeedLaw::Point now_;
  double time_ = 0.0;
  double phi_ = 0.0;
  double missed_ = 0.0;              ///< distance by which φ is behind the law [m]
  Vec<Taylor<kOrder>, kAxes> here_;  ///< the path around φ
  Taylor<kOrder - 1> stretch_;       ///< |q'| around φ
  Taylor<2> inverse_;                ///< 1/|q'|
  Mat<double, kAxes> rt_ = identity<kAxes>();
};

}  // namespace stribeck::path

template <>
struct stribeck::EnumNames<stribeck::path::Pace> {
  static constexpr std::array names{std::pair{stribeck::path::Pace::kSpeed, std::string_view{"speed"}},
                                    std::pair{stribeck::path::Pace::kRate, std::string_view{"rate"}}};
};
