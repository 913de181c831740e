#include <gtest/gtest.h>

#include <stribeck/sim/test_machine.hpp>

namespace stribeck::sim::travel_test {
namespace {

TEST(Travel, LapsToSettleAreTravelledAndNotScored) {
  Travel third = test::circle(9.5e-3, 1.0);
  third.settle_laps = 2.0;
  const Route<2> all = sample<2>(test::circle(9.5e-3, 3.0), 5e-3);
  const Route<2> settled = sample<2>(third, 5e-3);
  ASSERT_EQ(settled.points.size(), all.points.size());
  for (std::size_t k = 0; k < all.points.size(); ++k)
    ASSERT_EQ(settled.points[k].position[0], all.points[k].position[0]);
  const double lap = 2.0 * kPi * 10e-3 / 9.5e-3;
  EXPECT_NEAR(settled.scored_from, 1.0 + 2.0 * lap, 1e-12);
  EXPECT_NEAR(settled.scored_to, 1.0 + 3.0 * lap, 1e-12);
  EXPECT_EQ(settled.scored_to, all.scored_to);
  EXPECT_EQ(settled.first_lap, all.first_lap);
}

TEST(Travel, TheThirdLapHasTheFiguresOfTheThirdLap) {
  const Machine machine = test::biaxial_table();
  const auto c = biaxial_controllers().back();
  const auto controller = make_controller<2>(c.law, make_setup<2>(machine, test::printed(), {0, 1}, c));
  Travel third = test::circle(9.5e-3, 1.0);
  third.settle_laps = 2.0;
  const Route<2> route = sample<2>(third, machine.sample_time);
  Drives drives(machine, {0, 1}, 1e-2);
  std::vector<ContourSample> seen;
  const Metrics m = drives.run<2>(controller, route, {6, true, true}, 1, 0, &seen);
  double most = 0.0;
  std::size_t scored = 0;
  for (const ContourSample& s : seen) {
    const bool on_third = s.time >= route.scored_from && s.time <= route.scored_to;
    EXPECT_EQ(s.scored, on_third);
    if (!on_third) continue;
    ++scored;
    most = std::max(most, std::abs(s.contour_error));
  }
  EXPECT_EQ(m.max_contour_error, most);
  // A lap of 6.61 s at 5 ms.
  EXPECT_NEAR(static_cast<double>(scored), 1323.0, 1.0);
}

}  // namespace
}  // namespace stribeck::sim::travel_test
