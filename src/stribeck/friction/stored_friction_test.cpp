// Every function of the friction laws and maps on the same numbers, against sums that were stored: a change that no closed form tells is
// seen here. Where a change is meant, STRIBECK_PRINT_FORCES=1 prints the new sums.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stribeck/core/test_numbers.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/friction/dynamics.hpp>
#include <stribeck/friction/table.hpp>
#include <stribeck/friction/uncertainty.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::friction::stored_friction_test {
namespace {

constexpr double kSame = 1e-6;  // a relative difference of 1e-9 of a typical force is seen

/// Adds values with weights that differ from one to the next.
class Sum {
 public:
  void add(double value) {
    EXPECT_TRUE(std::isfinite(value));
    sum_ += weights_.next() * value;
  }
  [[nodiscard]] double value() const {
    if (std::getenv("STRIBECK_PRINT_FORCES") != nullptr)
      std::printf("%s: %.12g\n", ::testing::UnitTest::GetInstance()->current_test_info()->name(), sum_);
    return sum_;
  }

 private:
  stribeck::test::Numbers weights_{39};
  double sum_ = 0.0;
};

Gms<double> gms() {
  Gms<double> law;
  law.elements = {GmsElement<double>{2.1e6, 0.45}, GmsElement<double>{0.9e6, 0.3},
                  GmsElement<double>{0.4e6, 0.15}, GmsElement<double>{0.1e6, 0.1}};
  law.attraction = 700.0;
  law.damping_coefficient = 3e3;
  law.damping_velocity = 0.7e-3;
  return law;
}
LuGre<double> lugre() { return {3.3e6, 5e3, 0.6e-3}; }

Gaussian<double> gaussian() {
  Gaussian<double> map;
  map.positive = {20.0, 900.0, {}};
  map.positive.gaussians = {GaussianTerm<double>{6.0, 0.2e-3, 2e-3}, GaussianTerm<double>{-2.0, 6e-3, 3e-3}};
  map.negative = {-23.0, 700.0, {}};
  map.negative.gaussians = {GaussianTerm<double>{-4.0, -0.1e-3, 1.5e-3}};
  map.velocity_range = {-20e-3, 15e-3};
  return map;
}
Conventional<double> conventional() { return {19.0, 800.0, Stribeck<double>{27.0, 1.3e-3, 1.6}}; }

/// What an integrator, a controller and an observer ask of a law.
template <class Law>
void walk(const Law& law, Sum& sum) {
  const Conventional<double> map = conventional();
  stribeck::test::Numbers n{39};
  typename Law::State s{}, before{};
  Integrated<Law> inside(law);
  std::vector<double> q(Integrated<Law>::kCount), rate(Integrated<Law>::kCount);
  double v = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const double earlier = v;
    v = 3e-3 * std::sin(2e-3 * k) + 0.4e-3 * n.next();
    if (k % 97 == 0) v = 0.0;
    const SteadyParts<double> p{map.parts(v, 0.0).level, 800.0 * v, 3.0 * n.next()};
    before = s;
    law.advance(s, v, p.level, 1e-3);
    if constexpr (requires { law.force(s, v, p); })
      sum.add(law.force(s, v, p));
    else
      sum.add(law.force(s.z, law.rate(s.z, v, p), v, p));
    sum.add(law.bristle(s, v, p.level, 1.0 + 0.3 * n.next()));
    sum.add(law.mean_bristle(before, s, v, 1e-3));
    sum.add(law.damping(v) * 1e-3);
    sum.add(law.rate_bound(std::abs(v), p.level) * 1e-3);
    if (k % 50 == 49) {
      inside.place(s, q.data());
      for (int j = 0; j < 30; ++j) {
        sum.add(inside.evaluate(q.data(), v, p, rate.data()));
        for (std::size_t i = 0; i < q.size(); ++i) q[i] += 1e-5 * rate[i];
        if constexpr (Integrated<Law>::kSettles) inside.settle(q.data(), j == 0 ? earlier : v, v, p);
        for (const double one : q) sum.add(one);
      }
    }
    if (k % 211 == 210) law.slide(s, 0.7 * p.level * n.next());
    if (k % 307 == 306) law.carry(s, 0.9 * p.level * n.next());
    if (k % 131 == 130) sum.add(law.shift(s, 0.8 * p.level * n.next(), p.level));
  }
  const Law other = law.stiffened(1.7);
  sum.add(1e-6 * law.stiffness());
  sum.add(1e-6 * other.stiffness());
  sum.add(1e-3 * law.damping());
  sum.add(1e-3 * other.damping());
  typename Law::State t{};
  for (int k = 0; k < 100; ++k) sum.add(other.step(map, t, 1e-3 * n.next(), 0.0, 0.7e-3));
  if constexpr (requires { law.stops(); }) {
    for (const Stop& one : law.stops()) {
      sum.add(one.weight);
      sum.add(1e6 * one.reach);
    }
  }
}

TEST(StoredFriction, Gms) {
  Sum sum;
  walk(gms(), sum);
  EXPECT_NEAR(sum.value(), -24.995980505, kSame);
}

TEST(StoredFriction, LuGre) {
  Sum sum;
  walk(lugre(), sum);
  LuGre<double> lasting = lugre();
  lasting.damping_velocity.reset();
  walk(lasting, sum);
  EXPECT_NEAR(sum.value(), 1862.83050074, kSame);
}

template <class Map>
void walk_map(const Map& map, Sum& sum) {
  for (int k = -60; k <= 60; ++k) {
    const double v = 0.45e-3 * k;
    for (const Map& one : {map, map.scaled(1.4), map.viscous_alone()}) {
      const auto p = one.parts(v, 0.0);
      sum.add(p.level);
      sum.add(p.viscous);
      sum.add(p.additive);
      sum.add(steady_force(one, v));
      sum.add(1e-3 * one.viscous_coefficient(v < 0.0 ? -1.0 : 1.0));
    }
  }
}

TEST(StoredFriction, MapsAndTables) {
  Sum sum;
  walk_map(gaussian(), sum);
  walk_map(conventional(), sum);
  Conventional<double> plain = conventional();
  plain.stribeck.reset();
  walk_map(plain, sum);
  for (const Table& table : {Table::build(gaussian(), 30e-3), Table::build(conventional(), 12e-3)}) {
    for (int k = -90; k <= 90; ++k) {
      const double v = 0.31e-3 * k, by = 0.01 * std::abs(v);
      sum.add(table.parts(v, 0.0).level + table.parts(v, 0.0).viscous + table.parts(v, 0.0).additive);
      sum.add(table.near(v).parts(v + by, 0.0).level);
    }
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const Table::Side s = table.side(side);
      for (int i = 0; i < 4; ++i) sum.add(s.border[i]);
      sum.add(Table::cubic(s.cells[0], s.cells[1], s.cells[2], s.cells[3], 1e-4));
      sum.add(s.scale * 1e-2);
      sum.add(s.viscous * 1e-2);
    }
  }
  EXPECT_NEAR(sum.value(), 161.875535129, kSame);
}

ModelDeviation change(stribeck::test::Numbers& n) {
  ModelDeviation d;
  d.mass = 20.0 * n.next();
  for (std::size_t s = 0; s < 2; ++s) {
    d.level[s] = 8.0 * n.next();
    d.viscous[s] = 300.0 * n.next();
    d.rise[s] = 9.0 * n.next();
  }
  d.stiffness = 0.5 * n.next();
  d.damping = 0.6 * n.next();
  return d;
}

/// Figures of a model, at a few speeds.
void add_model(const AxisModel& m, Sum& sum) {
  sum.add(m.mass);
  sum.add(m.load);
  sum.add(m.delay_or_none());
  for (const double v : {-14e-3, -4e-3, -0.5e-3, -1e-5, 1e-5, 0.4e-3, 3e-3, 12e-3}) {
    const auto p = m.friction.parts(v, 1e-3);
    sum.add(p.level);
    sum.add(p.viscous);
  }
  std::visit(
      [&](const auto& law) {
        if constexpr (requires { law.stiffness(); }) {
          sum.add(1e-6 * law.stiffness());
          sum.add(1e-3 * law.damping());
        }
      },
      m.friction.dynamics);
}

TEST(StoredFriction, Deviations) {
  Sum sum;
  stribeck::test::Numbers n{39};
  std::vector<AxisModel> models(4);
  models[0].friction.steady = gaussian();
  models[1].friction.steady = gaussian();
  models[2].friction.steady = conventional();
  models[3].friction.steady = Conventional<double>{19.0, 800.0, {}};
  models[0].friction.dynamics = lugre();
  models[1].friction.dynamics = gms();
  models[2].friction.dynamics = lugre();
  for (AxisModel& m : models) {
    m.mass = 55.0;
    m.load = 7.0;
    m.delay = 0.3e-3;
    for (int k = 0; k < 40; ++k) {
      ModelDeviation d = change(n);
      d.add(0.4, change(n));
      if (k % 5 == 4) d.rise = {0.0, 0.0};
      if (k % 7 == 6) {  // leaves no mass or no friction: halved
        d.mass *= 40.0;
        for (double& level : d.level) level *= 20.0;
      }
      const AxisModel other = deviated(m, d, 0.9e-3);
      EXPECT_TRUE(is_possible(other));
      add_model(other, sum);
    }
  }
  AxisModel none = models[2];
  none.mass = 0.0;
  EXPECT_FALSE(is_possible(none));
  none.mass = 1e-3;
  EXPECT_TRUE(is_possible(none));
  // Below zero in a narrow dip close to standstill, on one side, and at the end of the range only.
  Gaussian<double> dip = gaussian();
  dip.positive.gaussians = {GaussianTerm<double>{-21.0, 0.05e-3, 0.03e-3}};
  none.friction.steady = dip;
  EXPECT_FALSE(is_possible(none));
  dip = gaussian();
  dip.negative.gaussians = {GaussianTerm<double>{24.0, -20e-3, 1e-3}};
  none.friction.steady = dip;
  EXPECT_FALSE(is_possible(none));
  dip = gaussian();
  dip.negative.gaussians = {GaussianTerm<double>{22.5, -20e-3, 1e-3}};
  none.friction.steady = dip;
  EXPECT_TRUE(is_possible(none));
  EXPECT_NEAR(sum.value(), -1227.03133136, kSame);
}

/// Keys of what a parameter set says to be wrong.
template <class Params>
std::string complaints(const Params& p) {
  std::string all;
  p.validate([&](std::string_view key, std::string_view) { all += std::string(key) + ";"; });
  return all;
}

TEST(StoredFriction, WhatIsRefused) {
  EXPECT_EQ(complaints(gaussian()), "");
  Gaussian<double> g = gaussian();
  g.velocity_range = {0.0, 1.0};
  EXPECT_EQ(complaints(g), "velocity_range;");
  g.velocity_range = {-1.0, 0.0};
  EXPECT_EQ(complaints(g), "velocity_range;");
  // A dip at one end of the range, of either branch.
  g = gaussian();
  g.positive.gaussians = {GaussianTerm<double>{-21.0, 15e-3, 0.2e-3}};
  EXPECT_EQ(complaints(g), "positive;");
  g = gaussian();
  g.negative.gaussians = {GaussianTerm<double>{24.0, -20e-3, 0.2e-3}};
  EXPECT_EQ(complaints(g), "negative;");
  g.negative.gaussians = {GaussianTerm<double>{22.9, -20e-3, 0.2e-3}};
  EXPECT_EQ(complaints(g), "");
  Gms<double> law = gms();
  EXPECT_EQ(complaints(law), "");
  law.elements[1].share = 0.29;
  EXPECT_EQ(complaints(law), "elements;");
  law.elements[1].share = 0.31;
  EXPECT_EQ(complaints(law), "elements;");
  EXPECT_EQ(complaints(Gms<double>{}), "elements;");
  DriveLoop loop;
  EXPECT_EQ(complaints(loop), "");
  loop.mode = DriveMode::kPosition;
  EXPECT_EQ(complaints(loop), "position_gain;velocity_feedforward;");
  loop.position_gain = 30.0;
  EXPECT_EQ(complaints(loop), "velocity_feedforward;");
  loop.velocity_feedforward = 0.5;
  EXPECT_EQ(complaints(loop), "");
  // Ripple in proportion may be as large as the level of friction where that is smallest, and no larger.
  AxisModel m;
  m.friction.steady = Conventional<double>{10.0, 100.0, Stribeck<double>{14.0, 1e-3, 2.0}};
  m.friction.eccentric = {Eccentric<double>{4.0, 5e-3, 0.0, EccentricForm::kProportional},
                          Eccentric<double>{5.9, 2e-3, 0.0, EccentricForm::kProportional},
                          Eccentric<double>{30.0, 2e-3, 0.0}};
  EXPECT_EQ(complaints(m.friction), "");
  m.friction.eccentric[1].amplitude = 6.1;
  EXPECT_EQ(complaints(m.friction), "eccentric;");
  // At every place: nine tenths of 10 N are below 4 N + 5.9 N, and 1.1 times 10 N above 4 N + 6.1 N.
  m.friction.places = {Place{0.0, 1.1, 1.0}, Place{1e-3, 1.2, 1.0}};
  EXPECT_EQ(complaints(m.friction), "");
  m.friction.places.push_back(Place{2e-3, 0.9, 1.0});
  EXPECT_EQ(complaints(m.friction), "eccentric;");
  m.friction.eccentric[1].amplitude = 4.9;
  EXPECT_EQ(complaints(m.friction), "");
  m.friction.places = {Place{0.0, 1.0, 1.0}, Place{1e-3, 1.1, 1.0}, Place{1e-3, 1.2, 1.0}};
  EXPECT_EQ(complaints(m.friction), "places;");
  // And at every speed: with v0 = 0.5 m/s the level is below 25 N from 0.72 m/s on.
  m.friction.places = {};
  m.friction.steady = Conventional<double>{20.0, 0.0, Stribeck<double>{60.0, 0.5, 2.0}};
  m.friction.eccentric = {Eccentric<double>{25.0, 5e-3, 0.0, EccentricForm::kProportional}};
  EXPECT_EQ(complaints(m.friction), "eccentric;");
  m.friction.eccentric[0].amplitude = 19.0;
  EXPECT_EQ(complaints(m.friction), "");
}

}  // namespace
}  // namespace stribeck::friction::stored_friction_test
