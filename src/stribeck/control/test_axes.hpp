#pragma once
/// Setups of masses, and a path with torsion, for the tests of this folder. Included by tests only.

#include <stribeck/control/setup.hpp>
#include <stribeck/control/test_mass.hpp>
#include <stribeck/path/curve.hpp>
#include <stribeck/path/fourier.hpp>

namespace stribeck::control::test {

template <std::size_t N>
Setup<N> masses(double period) {
  Setup<N> s;
  s.period = period;
  for (auto& c : s.compensation) c.model.mass = kMass;
  return s;
}

/// 10 (cos φ, sin φ) and 3 sin 2φ, in mm.
inline path::Fourier<3> saddle() {
  path::Fourier<3> c;
  c.axis[0].terms = {path::Harmonic{10e-3, 1.0, 0.0}};
  c.axis[1].terms = {path::Harmonic{10e-3, 1.0, -0.5 * kPi}};
  c.axis[2].terms = {path::Harmonic{3e-3, 2.0, -0.5 * kPi}};
  return c;
}

/// Masses that follow a reference under a controller; they begin with a tracking error at rest in the frame of the path.
template <class C, class Controller>
class Followers {
 public:
  static constexpr std::size_t kAxes = C::kAxes;
  using V = Vec<double, kAxes>;

  Followers(const C& curve, const path::SpeedLaw& law, double begin, const V& local, double period,
            path::FrameKind frame = path::FrameKind::kTransported)
      : reference_(curve, law, path::Pace::kSpeed, frame), period_(period) {
    while (reference_.time() < begin) reference_.advance(period);
    const auto r = reference_.point();
    const V e = to_machine(r.frame, local);
    const V rate = to_machine(r.frame_rate, local);  // e = R e_l with e_l at rest
    for (std::size_t i = 0; i < kAxes; ++i) {
      mass[i] = {r.position[i] + e[i], r.velocity[i] + rate[i]};
      // Primes the difference of the error with the sample before.
      state.error[i].update(mass[i].x - period * mass[i].v, r.position[i] - period * r.velocity[i], 0.0,
                            period, ErrorRate::kDifferenceOfError);
    }
  }
  V step(const Controller& controller) {
    V x;
    for (std::size_t i = 0; i < kAxes; ++i) x[i] = mass[i].x;
    const V force = controller.step(state, reference_.point(), x);
    for (std::size_t i = 0; i < kAxes; ++i) mass[i].move(force[i], period_);
    reference_.advance(period_);
    return force;
  }
  /// Tracking error in the frame of the path.
  [[nodiscard]] V local() const {
    const auto r = reference_.point();
    V e;
    for (std::size_t i = 0; i < kAxes; ++i) e[i] = mass[i].x - r.position[i];
    return r.frame * e;
  }

  std::array<Mass, kAxes> mass;
  typename Controller::State state;

 private:
  path::Reference<C> reference_;
  double period_;
};

}  // namespace stribeck::control::test
