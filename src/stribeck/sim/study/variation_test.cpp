#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stribeck/sim/contour_run.hpp>
#include <stribeck/sim/study/variation.hpp>
#include <stribeck/sim/test_machine.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace stribeck::sim::variation_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kPeriod = 5e-3;

plant::AxisParams biaxial_x() {
  plant::AxisParams p = test::biaxial_table().axes.front().second.plant;
  p.noise.reset();
  return p;
}

friction::Gms<double> gms() {
  friction::Gms<double> law;
  for (const double k : {1.6e8, 0.8e8, 0.4e8, 0.2e8}) law.elements.push_back({k, 0.25});
  law.attraction = 1e5;
  law.damping_coefficient = 600e3;
  law.damping_velocity = 0.05e-3;
  return law;
}

plant::Axis started(const plant::AxisParams& p) {
  plant::Axis axis(p, kPeriod, 9.5e-3);
  axis.start(0.0, {32, false, false}, {});
  return axis;
}

/// Where a force leads within a time [s], the first of it a ramp if so wanted.
plant::Axis pushed(const plant::AxisParams& p, double force, double time, double ramp = 0.0) {
  plant::Axis axis = started(p);
  for (int k = 0; k < static_cast<int>(time / kPeriod); ++k) {
    const double share = k * kPeriod < ramp ? k * kPeriod / ramp : 1.0;
    axis.step(share * force / p.force_gain());
  }
  return axis;
}

bool same(const Deviation& a, const Deviation& b) {
  return a.friction == b.friction && a.stiffness == b.stiffness && a.mass == b.mass && a.delay == b.delay &&
         a.encoder == b.encoder && a.axial_mode.has_value() == b.axial_mode.has_value() &&
         (!a.axial_mode || a.axial_mode->frequency == b.axial_mode->frequency) &&
         a.periodic->phase == b.periodic->phase && a.warming->time_constant == b.warming->time_constant;
}

// ---- what is drawn

TEST(Draw, DependsOnSeedMachineAndAxisAlone) {
  const Variation v;
  const Deviation one = draw(v, 7, 3, 1);
  EXPECT_TRUE(same(one, draw(v, 7, 3, 1)));
  EXPECT_FALSE(same(one, draw(v, 8, 3, 1)));
  EXPECT_FALSE(same(one, draw(v, 7, 4, 1)));
  EXPECT_FALSE(same(one, draw(v, 7, 3, 0)));
  const Machine machine = vary(test::biaxial_table(), v, 7, 3);
  EXPECT_EQ(machine.axes[1].second.plant.mass, 58930.0 * one.mass);
  EXPECT_NE(machine.axes[0].second.plant.mass / 57650.0, one.mass);
}

TEST(Draw, FillsItsRangesAndStaysWithinThem) {
  constexpr int kCount = 4000;
  const Variation v;
  std::vector<Deviation> drawn;
  for (std::uint32_t i = 0; i < kCount; ++i) drawn.push_back(draw(v, 1, i, 0));
  const auto sorted = [&](const std::function<double(const Deviation&)>& of) {
    std::vector<double> all;
    for (const Deviation& d : drawn) all.push_back(of(d));
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto expect_range = [](const std::vector<double>& all, double low, double high, double middle) {
    const double width = high - low;
    EXPECT_GE(all.front(), low);
    EXPECT_LE(all.back(), high);
    // 4000 draws miss the last hundredth of a range with a probability of 4e-18; the median is off by four deviations of
    // 0.8 % of the range (uniform), more on the flat side of a logarithm.
    EXPECT_LT(all.front(), low + 0.01 * width);
    EXPECT_GT(all.back(), high - 0.01 * width);
    EXPECT_NEAR(all[kCount / 2], middle, 0.04 * width);
  };
  expect_range(sorted([](const Deviation& d) { return d.friction; }), 0.7, 1.3, 1.0);
  expect_range(sorted([](const Deviation& d) { return d.stiffness; }), 0.5, 1.5, 1.0);
  expect_range(sorted([](const Deviation& d) { return d.mass; }), 0.8, 1.2, 1.0);
  expect_range(sorted([](const Deviation& d) { return d.encoder; }), 1.0, 10.0, std::sqrt(10.0));
  expect_range(sorted([](const Deviation& d) { return d.periodic->share; }), 0.0, 0.05, 0.025);
  expect_range(sorted([](const Deviation& d) { return d.periodic->period; }), 2e-3, 10e-3, 6e-3);
  expect_range(sorted([](const Deviation& d) { return d.periodic->phase; }), 0.0, 2.0 * kPi, kPi);
  expect_range(sorted([](const Deviation& d) { return d.warming->change; }), -0.2, 0.0, -0.1);
  expect_range(sorted([](const Deviation& d) { return d.warming->time_constant; }), 5.0, 20.0, 12.5);
  // Four deviations of √(4000/4) = 32 about a half.
  int late = 0;
  int flexible = 0;
  for (const Deviation& d : drawn) {
    EXPECT_TRUE(d.delay == 0 || d.delay == 1);
    late += d.delay;
    if (!d.axial_mode) continue;
    ++flexible;
    EXPECT_TRUE(d.axial_mode->frequency >= 60.0 && d.axial_mode->frequency <= 300.0);
    EXPECT_TRUE(d.axial_mode->damping_ratio >= 0.02 && d.axial_mode->damping_ratio <= 0.05);
    EXPECT_TRUE(d.axial_mode->table_share >= 0.05 && d.axial_mode->table_share <= 0.2);
  }
  EXPECT_NEAR(late, kCount / 2, 128);
  EXPECT_NEAR(flexible, kCount / 2, 128);
}

TEST(Draw, AnotherRangeOfOneFactorLeavesTheOthers) {
  const Deviation all = draw({}, 1, 5, 0);
  Variation v = Variation::none();
  v.warming = 0.2;
  v.encoder = 10.0;
  const Deviation some = draw(v, 1, 5, 0);
  EXPECT_EQ(some.encoder, all.encoder);
  EXPECT_EQ(some.warming->change, all.warming->change);
  EXPECT_EQ(some.mass, 1.0);
  EXPECT_FALSE(some.axial_mode || some.periodic);
}

TEST(VaryOnly, LeavesAllFactorsButOne) {
  for (const std::string& factor : variation_factors()) {
    const Variation v = vary_only(factor);
    const Variation none = Variation::none();
    int changed = 0;
    for_each_field<Variation>([&](const auto& f) {
      using M = std::decay_t<decltype(v.*f.member)>;
      if constexpr (std::is_arithmetic_v<M>) {
        changed += v.*f.member != none.*f.member ? 1 : 0;
      } else if constexpr (std::is_same_v<M, std::optional<AxialModeVariation>>) {
        changed += (v.*f.member).has_value() ? 1 : 0;
      }
    });
    EXPECT_EQ(changed, 1) << factor;
  }
  EXPECT_EQ(vary_only("encoder").encoder, 10.0);
  EXPECT_THAT([&] { vary_only("wear"); }, ThrowsMessage<Refused>(HasSubstr("there is no factor wear")));
}

// ---- what it does to the plant

TEST(Vary, NothingIsTheNominalMachineToTheLastBit) {
  const Machine nominal = test::biaxial_table();
  const Route<2> route = sample<2>(test::circle(9.5e-3, 0.3), kPeriod);
  const auto c = biaxial_controllers().back();
  const auto controller = make_controller<2>(c.law, make_setup<2>(nominal, test::printed(), {0, 1}, c));
  const auto trace = [&](const Machine& machine) {
    Drives drives(machine, {0, 1}, 1e-2);
    std::vector<ContourSample> seen;
    drives.run<2>(controller, route, {6, true, true}, 1, 0, &seen);
    return seen;
  };
  const auto a = trace(nominal);
  const auto b = trace(vary(nominal, Variation::none(), 1, 0));
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k].contour_error, b[k].contour_error) << k;
  EXPECT_NE(trace(vary(nominal, {}, 1, 0)).back().position[0], a.back().position[0]);
}

TEST(Deviated, TwiceTheFrictionTakesTwiceTheForce) {
  Deviation d;
  d.friction = 2.0;
  auto stribeck = biaxial_x();
  stribeck.friction.steady =
      friction::Conventional<double>{1000.0, 1e5, friction::Stribeck<double>{1300.0, 1e-3, 1.0}};
  for (const plant::AxisParams& p : {biaxial_x(), stribeck}) {
    const double force =
        std::visit([](const auto& map) { return friction::steady_force(map, 2e-3); }, p.friction.steady);
    EXPECT_NEAR(pushed(p, force, 40.0).velocity(), 2e-3, 1e-8);
    EXPECT_NEAR(pushed(deviated(p, d), 2.0 * force, 40.0).velocity(), 2e-3, 1e-8);
  }
}

TEST(Deviated, ProportionalTermsFollowTheLevelAndAdditiveOnesStay) {
  auto p = biaxial_x();
  p.friction.eccentric.push_back({40.0, 1e9, -0.5 * kPi, friction::EccentricForm::kProportional});
  p.friction.eccentric.push_back({50.0, 1e9, -0.5 * kPi, friction::EccentricForm::kAdditive});
  Deviation d;
  d.friction = 0.7;
  const auto before = p.friction.parts(3e-3, 0.0);
  const auto after = deviated(p, d).friction.parts(3e-3, 0.0);
  EXPECT_NEAR(after.level, 0.7 * before.level, 1e-9);
  EXPECT_NEAR(after.viscous, 0.7 * before.viscous, 1e-9);
  EXPECT_EQ(after.additive, before.additive);
}

TEST(Deviated, StiffnessIsForceOverPresliding) {
  // 5 N of 1142 N: the bristle has given way by 0.5 % at most. A ramp, or the axis rings on its bristles, and they drift.
  Deviation d;
  d.stiffness = 1.5;
  auto gms_axis = biaxial_x();
  gms_axis.friction.dynamics = gms();
  for (const plant::AxisParams& p : {biaxial_x(), gms_axis}) {
    EXPECT_NEAR(pushed(p, 5.0, 8.0, 5.0).position(), 5.0 / 3e8, 0.005 * 5.0 / 3e8);
    EXPECT_NEAR(pushed(deviated(p, d), 5.0, 8.0, 5.0).position(), 5.0 / 4.5e8, 0.005 * 5.0 / 4.5e8);
  }
  // The same damping ratio σ1/(2√(σ0 m)).
  const auto law = std::get<friction::LuGre<double>>(deviated(biaxial_x(), d).friction.dynamics);
  EXPECT_NEAR(law.sigma1 / std::sqrt(law.sigma0), 600e3 / std::sqrt(3e8), 1e-9);
}

TEST(Deviated, MassIsForceOverAcceleration) {
  auto p = biaxial_x();
  p.friction.steady = friction::Conventional<double>{1e-6, 0.0, {}};
  p.friction.dynamics = friction::LuGre<double>{1e-3, 0.0, {}};
  Deviation d;
  d.mass = 1.2;
  EXPECT_NEAR(pushed(deviated(p, d), 100.0, 1.0).velocity(), 100.0 / (1.2 * 57650.0), 1e-9);
  p.drive = plant::VoltageDrive{2.0, 1.5, 3e-3, 0.05, 0.05, 5e-3};
  p.rotor_inertia = 1e-3;
  EXPECT_NEAR(deviated(p, d).total_mass(), 1.2 * p.total_mass(), 1e-9 * p.total_mass());
}

TEST(Deviated, DelayShiftsTheMotion) {
  Deviation d;
  d.delay = 1;
  plant::Axis prompt = started(biaxial_x());
  plant::Axis late = started(deviated(biaxial_x(), d));
  double before = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double u = 1.5 + std::sin(0.1 * k);
    before = prompt.position();
    prompt.step(u);
    late.step(u);
    ASSERT_EQ(late.position(), before) << k;
  }
}

TEST(Deviated, EncoderHasCoarserSteps) {
  Deviation d;
  d.encoder = 10.0;
  plant::Axis axis(deviated(biaxial_x(), d), kPeriod, 9.5e-3);
  axis.start(130e-9, {8, true, false}, {});
  EXPECT_EQ(axis.encoder(), 250e-9);
}

TEST(Deviated, ModeLetsTheTableLagByAccelerationOverFrequencySquared) {
  // Under a steady acceleration the spring carries m_t·a: x − x_t = a/ω².
  auto p = biaxial_x();
  p.friction.steady = friction::Conventional<double>{1e-6, 0.0, {}};
  p.friction.dynamics = friction::LuGre<double>{1e-3, 0.0, {}};
  Deviation d;
  d.axial_mode = plant::AxialMode{60.0, 0.05, 0.2};
  const plant::Axis axis = pushed(deviated(p, d), 1000.0, 2.0);
  const double omega = 2.0 * kPi * 60.0;
  EXPECT_NEAR(axis.encoder() - axis.position(), 1000.0 / 57650.0 / (omega * omega), 1e-12);
}

TEST(Deviated, ModeOfALostMotionIsThatOfTheTableInContact) {
  auto p = biaxial_x();
  p.friction.steady = friction::Conventional<double>{1e-6, 0.0, {}};
  p.friction.dynamics = friction::LuGre<double>{1e-3, 0.0, {}};
  p.lost_motion = plant::LostMotion{8e-6, 0.0, 1e9, 0.1, 0.5, 0.0};
  Deviation d;
  d.axial_mode = plant::AxialMode{60.0, 0.05, 0.2};
  const auto other = deviated(p, d);
  EXPECT_FALSE(other.axial_mode);
  EXPECT_EQ(other.lost_motion->backlash, 8e-6);
  // As above, behind half of the backlash.
  const plant::Axis axis = pushed(other, 1000.0, 2.0);
  const double omega = 2.0 * kPi * 60.0;
  EXPECT_NEAR(axis.encoder() - axis.position() - 4e-6, 1000.0 / 57650.0 / (omega * omega), 1e-9);
}

TEST(Deviated, PeriodicTermIsAShareOfTheLevelAtRest) {
  // At rest on the way up: 768.6 + Σ a·exp(−(b/c)²) of Table 2.3 by hand, 1142.34 and 920.55 N; mean of both.
  Deviation d;
  d.friction = 1.1;
  d.periodic = PeriodicDeviation{0.05, 4e-3, 0.0};
  const auto p = deviated(biaxial_x(), d);
  EXPECT_NEAR(p.friction.parts(1e-3, 1e-3).additive, 0.05 * 1.1 * 0.5 * (1142.34 + 920.55), 1e-3);
  EXPECT_NEAR(p.friction.parts(-1e-3, 1e-3).additive, p.friction.parts(1e-3, 1e-3).additive, 0.0);
  EXPECT_NEAR(p.friction.parts(1e-3, 3e-3).additive, -p.friction.parts(1e-3, 1e-3).additive, 1e-9);
}

TEST(Deviated, WarmingReachesThePlant) {
  Deviation d;
  d.warming = plant::Warming{-0.2, 0.5};
  const double force = friction::steady_force(friction::test::table_2_3_x(), 2e-3);
  EXPECT_NEAR(pushed(deviated(biaxial_x(), d), 0.8 * force, 40.0).velocity(), 2e-3, 1e-8);
}

TEST(NearbyMachines, AreTheRangesOfTheVariationWithoutChance) {
  const Machine nominal = test::biaxial_table();
  const std::vector<NearbyMachine> all = nearby_machines(nominal);
  ASSERT_EQ(all.size(), 9U);
  const auto named = [&](std::string_view name) -> const plant::AxisParams& {
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& m) { return m.name == name; });
    EXPECT_NE(found, all.end()) << name;
    return found->machine.axes[1].second.plant;
  };
  const plant::AxisParams& own = nominal.axes[1].second.plant;
  const auto level = [](const plant::AxisParams& p) { return p.friction.parts(0.01, 0.0).level; };
  EXPECT_NEAR(named("mass +20 %").mass, 1.2 * own.mass, 1e-9);
  EXPECT_NEAR(level(named("mass +20 %")), level(own), 1e-9);
  EXPECT_NEAR(level(named("friction -30 %")), 0.7 * level(own), 1e-9);
  EXPECT_NEAR(named("mass -20 %, friction -30 %").mass, 0.8 * own.mass, 1e-9);
  EXPECT_EQ(named("one period later").delay_periods, own.delay_periods + 1);
  EXPECT_NEAR(named("mode at 134 Hz").axial_mode->frequency, std::sqrt(60.0 * 300.0), 1e-9);
  // Eight periods are the most, and a mode of its own stays.
  Machine late = nominal;
  late.axes[0].second.plant.delay_periods = 8;
  late.axes[0].second.plant.axial_mode = plant::AxialMode{80.0, 0.02, 0.1};
  EXPECT_EQ(nearby_machines(late).size(), 7U);
}

TEST(Vary, RefusesWhatIsNoRange) {
  const auto refused = [](const Variation& v, const Machine& m = test::biaxial_table()) {
    try {
      for (std::uint32_t i = 0; i < 20; ++i) vary(m, v, 1, i);
    } catch (const Refused& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  Variation v;
  v.friction = 1.0;
  EXPECT_EQ(refused(v), "variation.friction: got 1, expected at least 0 and at most 0.9");
  v = {};
  v.mass = std::nan("");
  EXPECT_NE(refused(v).find("variation.mass"), std::string::npos);
  v = {};
  v.encoder = 0.5;
  EXPECT_NE(refused(v).find("variation.encoder"), std::string::npos);
  v = {};
  v.axial_mode->frequency = {300.0, 60.0};
  EXPECT_EQ(refused(v), "variation.frequency: expected the lower end first");
  Machine full = test::biaxial_table();
  for (int i = 0; i < 4; ++i)
    full.axes[0].second.plant.friction.eccentric.push_back(
        {1.0, 5e-3, 0.0, friction::EccentricForm::kAdditive});
  EXPECT_NE(refused({}, full).find("variation.periodic"), std::string::npos);
  Machine late = test::biaxial_table();
  late.axes[0].second.plant.delay_periods = 8;
  EXPECT_NE(refused({}, late).find("variation.delay"), std::string::npos);
}

}  // namespace
}  // namespace stribeck::sim::variation_test
