#pragma once
/// Laps under a disturbance that depends on the place, for the laws that learn from lap to lap. Included by tests only.

#include <cmath>
#include <complex>
#include <stribeck/control/test_axes.hpp>

namespace stribeck::control::test {

/// Laps on a line there and back, φ at a constant rate, under a disturbance that depends on the place in the lap.
template <class Params>
class Laps {
 public:
  using Law = typename Params::template Controller<1>;

  Laps(const Params& params, double period, double lap_seconds, bool wrapped = false,
       double true_mass = test::kMass)
      : law_(params, setup(period)),
        period_(period),
        seconds_(lap_seconds),
        wrapped_(wrapped),
        true_mass_(true_mass) {}

  /// One lap; force(angle) [N] opposes motion towards +x. RMS error [m], and the harmonic n of the error.
  template <class F>
  double lap(F force, int n = 0) {
    const int ticks = static_cast<int>(std::lround(seconds_ / period_));
    const double w = 2.0 * kPi / seconds_;
    double square = 0.0;
    harmonic = {};
    for (int k = 0; k < ticks; ++k) {
      const double angle = w * period_ * k;
      path::PathPoint<1> r;
      r.phi = wrapped_ ? angle : angle + 2.0 * kPi * done_;
      const double e = mass.x;  // a reference at rest; the laps are those of φ
      square += e * e;
      harmonic += e * std::complex<double>(std::cos(n * angle), -std::sin(n * angle));
      const double u = law_.step(state, r, {{mass.x}})[0];
      mass.move(u - force(angle), period_, true_mass_);
    }
    ++done_;
    return std::sqrt(square / ticks);
  }

  test::Mass mass;
  typename Law::State state;
  std::complex<double> harmonic;

 private:
  static Setup<1> setup(double period) {
    auto s = test::masses<1>(period);
    s.lap = 2.0 * kPi;
    return s;
  }
  Law law_;
  double period_;
  double seconds_;
  bool wrapped_;
  double true_mass_;
  int done_ = 0;
};

/// Like friction on a table with a screw: two reversals per lap, and a ripple with 25 periods per lap.
inline double table(double angle) {
  return 80.0 * (std::sin(angle) > 0.0 ? 1.0 : -1.0) + 20.0 * std::sin(25.0 * angle + 0.4);
}

}  // namespace stribeck::control::test
