#include <gtest/gtest.h>

#include <stribeck/friction/gms.hpp>
#include <stribeck/friction/lugre.hpp>
#include <stribeck/friction/test_maps.hpp>

/// A mass under a force below break-away: where does it go?

namespace stribeck::friction::drift_test {
namespace {

constexpr double kMass = 57650.0;
constexpr double kLevel = 1000.0;

/// Position after `time` under force(t), small steps of 20 us.
template <class Law, class Force>
double position_after(const Law& law, double time, Force&& force) {
  typename Law::State s;
  const test::Flat map{kLevel};
  double x = 0.0;
  double v = 0.0;
  double friction = 0.0;
  constexpr double kStep = 2e-5;
  for (int i = 0; i < static_cast<int>(time / kStep); ++i) {
    v += kStep * (force(i * kStep) - friction) / kMass;
    x += kStep * v;
    friction = law.step(map, s, v, x, kStep);
  }
  return x;
}

const LuGre<double> kLuGre{3e8, 8e6, {}};

Gms<double> gms() {
  Gms<double> law;
  law.elements = {GmsElement<double>{1.6e8, 0.25}, GmsElement<double>{0.8e8, 0.25},
                  GmsElement<double>{0.4e8, 0.25}, GmsElement<double>{0.2e8, 0.25}};
  law.attraction = 1e5;
  law.damping_coefficient = 8e6;
  return law;
}

const auto kConstant = [](double t) { return 0.6 * kLevel * std::min(1.0, t / 0.2); };
// 0.6 of break-away with 0.25 of it oscillating at 10 Hz: never above 0.85.
const auto kOscillating = [](double t) {
  return kConstant(t) + 0.25 * kLevel * std::sin(2 * kPi * 10.0 * t) * std::min(1.0, t);
};

TEST(Drift, NeitherModelCreepsUnderAConstantForceBelowBreakAway) {
  // Everything within the elastic deflection, and nothing moves between 2 s and 4 s.
  for (const double held : {position_after(kLuGre, 4.0, kConstant) - position_after(kLuGre, 2.0, kConstant),
                            position_after(gms(), 4.0, kConstant) - position_after(gms(), 2.0, kConstant)}) {
    EXPECT_LT(std::abs(held), 1e-9);
  }
  EXPECT_GT(position_after(kLuGre, 2.0, kConstant), 0.6 * kLevel / kLuGre.sigma0);
}

TEST(Drift, LuGreCreepsUnderAnOscillatingForceAndGmsDoesNot) {
  // Whole periods of 0.1 s apart. LuGre's drift is its known flaw (Swevers et al. 2000); it must be there, or
  // the law is not LuGre.
  const double lugre = position_after(kLuGre, 12.0, kOscillating) - position_after(kLuGre, 7.0, kOscillating);
  const double maxwell = position_after(gms(), 12.0, kOscillating) - position_after(gms(), 7.0, kOscillating);
  EXPECT_GT(lugre, 0.3e-6);
  EXPECT_LT(std::abs(maxwell), 1e-9);
}

}  // namespace
}  // namespace stribeck::friction::drift_test
