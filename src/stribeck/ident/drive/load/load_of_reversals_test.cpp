#include <gtest/gtest.h>

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/load/load_of_reversals.hpp>
#include <stribeck/ident/test_drive.hpp>
#include <variant>

namespace stribeck::ident::drive::load_of_reversals_test {
namespace {

constexpr double kWeight = 10.0;  // N

/// Friction that differs by direction: 24 N forward and 32 N backward from rest.
test::Drive uneven() {
  test::Drive drive;
  drive.mass = 1000.0;
  drive.sample_time = 0.002;
  drive.encoder = 2e-8;
  drive.friction.velocity_range = {-1.0, 1.0};
  drive.friction.positive = {14.0, 4500.0, {}};
  drive.friction.positive.gaussians.push_back({10.0, 0.0, 0.6e-3});
  drive.friction.negative = {-22.0, 3500.0, {}};
  drive.friction.negative.gaussians.push_back({-10.0, 0.0, 0.6e-3});
  drive.sigma0 = 7.2e6;
  drive.sigma1 = 8.5e4;
  drive.noise_rms = 0.1;
  drive.noise_time = 0.0095;
  drive.force_per_volt = 25.0;
  return drive;
}

Result identified(double weight, const test::Drive& drive = uneven()) {
  log::Record rec =
      test::run_closed(drive, drive.mass, test::sine_reference(drive.sample_time, 0.01, 1.0, 6.0), 7);
  for (double& f : rec.f) f += weight;
  return identify_drive({rec}, {});
}

bool holds(const Parameter* p, double truth) {
  return p != nullptr && p->ci_low <= truth && truth <= p->ci_high;
}

// The two directions need 34 and 22 N. As friction alone this fits while sliding, but not after reversals.
TEST(LoadOfReversals, IsTheWeightBesideUnevenFriction) {
  const Result r = identified(kWeight);
  ASSERT_TRUE(std::holds_alternative<friction::Gaussian<double>>(r.friction.steady)) << r.model;
  EXPECT_NEAR(r.load, kWeight, 0.1 * kWeight);  // half of its interval is 8 % here
  EXPECT_TRUE(holds(r.find("load"), kWeight));
  EXPECT_TRUE(holds(r.find("sigma0"), uneven().sigma0));
  const auto& map = std::get<friction::Gaussian<double>>(r.friction.steady);
  EXPECT_NEAR(map.positive.eta0, 14.0, 1.0);
  EXPECT_NEAR(map.negative.eta0, -22.0, 1.0);
}

// Uneven friction without a weight stays friction.
TEST(LoadOfReversals, InventsNone) {
  const Result r = identified(0.0);
  EXPECT_NEAR(r.load, 0.0, 0.5);
  EXPECT_TRUE(holds(r.find("sigma0"), uneven().sigma0));
}

// Forward, friction rises towards rest where no row of the map is. After reversals that looks like a load, and the interval of
// the level at rest says that it need not be one.
TEST(LoadOfReversals, IsNotTakenFromALevelAtRestThatTheMapDoesNotTell) {
  test::Drive drive = uneven();
  drive.friction.positive.gaussians[0] = {10.0, 0.0, 0.05e-3};
  const Result r = identified(0.0, drive);
  EXPECT_NEAR(r.load, 0.0, 0.5);
}

// What slides forward and backward is the same force, whatever the load is called.
TEST(LoadOfReversals, MovesNoForce) {
  MapChoice choice;
  choice.map.fit.family = map::StaticFit::Family::kByDirection;
  choice.map.fit.branch[0].eta0 = 34.0;
  choice.map.fit.branch[1].eta0 = 22.0;
  const MapChoice moved = with_load(choice, kWeight);
  EXPECT_EQ(moved.map.fit.load, kWeight);
  for (int side = 0; side < map::kSides; ++side)
    EXPECT_DOUBLE_EQ(moved.map.fit.force(side, 0.3), choice.map.fit.force(side, 0.3));
}

}  // namespace
}  // namespace stribeck::ident::drive::load_of_reversals_test
