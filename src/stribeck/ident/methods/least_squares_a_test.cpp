#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::methods::least_squares_a_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kPeriod = 0.005;

test::Drive straight(double noise) {
  test::Drive drive;
  drive.friction.velocity_range = {-1.0, 1.0};
  drive.friction.positive = {1255.38, 105.54e3, {}};
  drive.friction.negative = {-1105.0, 105.54e3, {}};
  drive.noise_rms = noise;
  if (noise == 0.0) drive.encoder = drive.bits = 0.0;
  return drive;
}

log::Record pulses(const test::Drive& drive, std::uint64_t seed) {
  const auto e =
      excitation::design_pulses({-0.05, 0.05, 0.010, 0.2, 10480.0}, {60e3, 1250.0, 110e3}, kPeriod);
  return test::run(drive, e.t.back(), seed, [&](std::size_t k, double, double) { return e.force[k]; });
}

// Limit: no noise. What is left: bristle at 0.5 mm/s (about 6 N of lag) and the trapezoidal mean of a
// decaying exponential.
TEST(LeastSquaresA, RecoversCoulombAndViscousFrictionOfPulses) {
  const test::Drive drive = straight(0.0);
  const LeastSquaresA a = identify_least_squares_a({pulses(drive, 1)});
  EXPECT_NEAR(a.mass_exact / drive.mass, 1.0, 0.002);
  EXPECT_NEAR(a.alpha2 / 105.54e3, 1.0, 0.005);
  EXPECT_NEAR(a.alpha0_positive, 1255.38, 6.0);
  EXPECT_NEAR(a.alpha0_negative, -1105.0, 6.0);
}

// Closed form: θ1 = exp(−α2·T/m), so forward Euler reads y/(1 − exp(−y)) − 1 ≈ y/2 too much mass, y = α2·T/m.
TEST(LeastSquaresA, ForwardEulerReadsHalfAPoleTooMuchMass) {
  const LeastSquaresA a = identify_least_squares_a({pulses(straight(0.0), 1)});
  const double y = a.alpha2 * kPeriod / a.mass_exact;
  EXPECT_NEAR(a.mass_euler / a.mass_exact, y / (1.0 - std::exp(-y)), 1e-9);
  EXPECT_NEAR(a.theta[0], std::exp(-y), 1e-12);
}

TEST(LeastSquaresA, TheSimpleFitTakesCoulombFrictionForInertia) {
  const test::Drive drive = straight(20.0);
  const LeastSquaresA a = identify_least_squares_a({pulses(drive, 3)});
  EXPECT_GT(a.simple_mass, 1.3 * drive.mass);
  EXPECT_GT(a.simple_alpha2, 2.0 * 105.54e3);
}

TEST(LeastSquaresA, IntervalsCoverTheTruthUnderColouredNoise) {
  int mass = 0;
  int viscous = 0;
  const test::Drive drive = straight(20.0);
  constexpr int kRuns = 20;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const LeastSquaresA a = identify_least_squares_a({pulses(drive, seed)});
    EXPECT_NEAR(a.mass_exact / drive.mass, 1.0, 0.01);
    const auto& m = a.result.parameters[0];
    const auto& c = a.result.parameters[1];
    mass += m.ci_low <= drive.mass && drive.mass <= m.ci_high;
    viscous += c.ci_low <= 105.54e3 && 105.54e3 <= c.ci_high;
  }
  // 95 %: of 20 fewer than 16 happen once in 400.
  EXPECT_GE(mass, 15);
  EXPECT_GE(viscous, 15);
}

TEST(LeastSquaresA, MirroredMotionSwapsTheDirections) {
  log::Record rec = pulses(straight(20.0), 4);
  const LeastSquaresA a = identify_least_squares_a({rec});
  for (double& x : rec.x) x = -x;
  for (double& f : rec.f) f = -f;
  const LeastSquaresA b = identify_least_squares_a({rec});
  EXPECT_NEAR(a.mass_exact, b.mass_exact, 1e-6 * a.mass_exact);
  EXPECT_NEAR(a.alpha0_positive, -b.alpha0_negative, 1e-6 * a.alpha0_positive);
}

TEST(LeastSquaresA, RefusesWhenNothingMoves) {
  const test::Drive drive = straight(20.0);
  const log::Record still = test::run(drive, 2.0, 1, [](std::size_t, double, double) { return 500.0; });
  EXPECT_THAT([&] { identify_least_squares_a({still}); },
              ThrowsMessage<Refused>(HasSubstr("motion beyond the dead band, expected at least")));
}

// Independent reference: jogs of the virtual drive. Pulses alone misjudge the viscous coefficient of a drive with a
// Stribeck rise; both observers read the same friction, and the slope of it is right.
TEST(LeastSquaresA, JogsCorrectTheViscousCoefficient) {
  test::Drive drive = straight(20.0);
  drive.friction.positive = {1000.0, 105.54e3, {}};
  drive.friction.positive.gaussians.push_back({300.0, 0.0, 0.4e-3});
  drive.friction.negative = {-1000.0, 105.54e3, {}};
  drive.friction.negative.gaussians.push_back({-300.0, 0.0, 0.4e-3});
  excitation::JogDesign design;
  for (double& v : design.speeds = {0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 4.0, 6.0, 8.0}) v *= 1e-3;
  const log::Record jogs = test::run_closed(
      drive, 55e3, excitation::design_jog({-0.05, 0.05, 0.010, 0.2, 10480.0}, kPeriod, design).r, 7);
  for (const Solver solver : {Solver::kDerivatives, Solver::kSimplex}) {
    LeastSquaresAOptions options;
    options.solver = solver;
    const LeastSquaresA a = identify_least_squares_a({pulses(drive, 7)}, {jogs}, options);
    ASSERT_EQ(a.jogs.size(), 18u);
    for (const ObservedFriction& j : a.jogs) {
      EXPECT_NEAR(j.observer, j.kalman, 10.0) << j.speed;
      EXPECT_NEAR(j.observer, drive.steady(j.speed), 30.0) << j.speed;
    }
    EXPECT_NEAR(a.observer->alpha2 / 105.54e3, 1.0, 0.03);
    EXPECT_NEAR(a.kalman->alpha2 / 105.54e3, 1.0, 0.03);
    EXPECT_NEAR(a.observer->alpha0_positive, 1000.0, 20.0);
    EXPECT_NEAR(a.observer->alpha0_negative, -1000.0, 20.0);
    ASSERT_TRUE(a.observer->stribeck.has_value());
    EXPECT_NEAR(a.observer->stribeck->alpha1, 1300.0, 60.0);
    EXPECT_NEAR(a.observer->stribeck->v0, 0.4e-3, 0.08e-3);
  }
}

TEST(LeastSquaresA, KeepsTheUnitsOfTheLog) {
  log::Record rec = pulses(straight(20.0), 1);
  rec.force_unit = "A", rec.position_unit = "rad";
  const Result r = identify_least_squares_a({rec}).result;
  EXPECT_EQ(r.force_unit, "A");
  EXPECT_EQ(r.position_unit, "rad");
}

// Half the Coulomb force bends the bristles by 2 um: the fit sees a hundred times the mass, driven by friction.
TEST(LeastSquaresA, RefusesPulsesThatOnlyBendTheBristles) {
  const auto weak = [](std::size_t k, double, double) {
    return k % 400 < 100 ? (k % 800 < 400 ? 600.0 : -600.0) : 0.0;
  };
  const log::Record r = test::run(straight(5.0), 16.0, 1, weak);
  EXPECT_THAT([&] { static_cast<void>(identify_least_squares_a({r})); },
              ThrowsMessage<Refused>(HasSubstr("hardly slides and springs back")));
}

// All lengths a fiftieth: the top speed of 0.2 mm/s is below the usual dead band.
TEST(LeastSquaresA, ReadsAMicroStageAsItsLargerTwin) {
  log::Record rec = pulses(straight(0.0), 1);
  const LeastSquaresA large = identify_least_squares_a({rec});
  for (double& x : rec.x) x /= 50.0;
  const LeastSquaresA small = identify_least_squares_a({rec});
  EXPECT_NEAR(small.mass_exact / large.mass_exact, 50.0, 0.5);
  EXPECT_NEAR(small.alpha0_positive, large.alpha0_positive, 5.0);
}

}  // namespace
}  // namespace stribeck::ident::methods::least_squares_a_test
