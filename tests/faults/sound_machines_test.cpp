// No machine that is sound is stopped, and no sample of one is bridged.
#include <gtest/gtest.h>

#include <random>

#include "drill.hpp"

namespace stribeck::test::sound_machines_test {
namespace {

TEST(SoundMachines, NoExperimentTrips) {
  for (const sim::Experiment& e : sim::experiments()) {
    for (Drill d : drills_of(e.id)) {
      d.duration = 15.0;
      const Drilled o = run(d);
      EXPECT_EQ(o.fault, control::Fault::kNone)
          << e.id << " (" << d.controller.id << ") at " << o.tripped << " s: " << control::describe(o.fault);
      EXPECT_EQ(o.bridged, 0u) << e.id << " (" << d.controller.id << ")";
    }
  }
}

TEST(SoundMachines, NoneDrawnAroundTheOnesIdentifiedTrips) {
  std::mt19937 random(20261122);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  for (int n = 0; n < 60; ++n) {
    const char* ids[] = {"beyond-bi-table", "beyond-tri-circle", "beyond-smc-circle", "five-axis",
                         "beyond-bi-trifolium"};
    const auto drills = drills_of(ids[n % 5]);
    Drill d = drills[random() % drills.size()];
    d.duration = 8.0;
    d.friction = between(0.5, 1.5);
    d.mass = between(0.7, 1.3);
    d.seed = random();
    const Drilled o = run(d);
    EXPECT_EQ(o.fault, control::Fault::kNone)
        << n << ": " << ids[n % 5] << " (" << d.controller.id << ") friction " << d.friction << " mass "
        << d.mass << " at " << o.tripped << " s: " << control::describe(o.fault);
    EXPECT_LE(o.bridged, 2u) << n;
  }
}

}  // namespace
}  // namespace stribeck::test::sound_machines_test
