#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stribeck/ident/drive/load/lost_share.hpp>

namespace stribeck::ident::drive::lost_share_test {
namespace {

constexpr double kPeriod = 2e-3;

/// What the motor makes at a force of the axis without loss.
double at_motor(double force, double v, double share) {
  return force * v > 0.0 ? force / (1.0 - share) : force / (1.0 + share);
}

/// 300 kg, 80 N and 150 N s/m, moves to and fro at four speeds with 1.5 m/s²; `load` against +x [N].
log::Record moves(double share, double load = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  log::Record r;
  r.sample_time = kPeriod;
  double x = 0.0;
  const auto row = [&](double v, double a) {
    const double friction = v == 0.0 ? 0.0 : std::copysign(80.0 + 150.0 * std::abs(v), v);
    r.t.push_back(kPeriod * static_cast<double>(r.t.size()));
    r.x.push_back(x);
    r.f.push_back(at_motor(300.0 * a + friction + load, v, share) + noise(random));
    x += kPeriod * v;
  };
  for (int lap = 0; lap < 6; ++lap) {
    for (const double top : {0.02, 0.05, 0.1, 0.2}) {
      for (const double side : {1.0, -1.0}) {
        const int ramp = static_cast<int>(top / 1.5 / kPeriod);
        for (int k = 0; k < ramp; ++k) row(side * top * (k + 0.5) / ramp, side * 1.5);
        for (int k = 0; k < 150; ++k) row(side * top, 0.0);
        for (int k = ramp; k > 0; --k) row(side * top * (k - 0.5) / ramp, -side * 1.5);
        for (int k = 0; k < 100; ++k) row(0.0, 0.0);
      }
    }
  }
  return r;
}

TEST(LostShare, IsThatOfAScrewOfLimitedEfficiency) {
  for (const double share : {0.05, 0.1, 0.2}) {
    const auto found = lost_share({moves(share)});
    ASSERT_TRUE(found) << share;
    EXPECT_NEAR(found->share, share, 0.01) << share;
    EXPECT_GT(found->half_width, std::abs(found->share - share)) << share;
  }
}

TEST(LostShare, IsNoneWhereNothingIsLost) {
  EXPECT_FALSE(lost_share({moves(0.0)}));
  // A weight makes the motor drive one way and brake the other, and is no loss.
  EXPECT_FALSE(lost_share({moves(0.0, 200.0)}));
  // Nor is a force that the model does not have: |f| holds it, the motion does not.
  log::Record ripple = moves(0.0);
  for (std::size_t k = 0; k < ripple.f.size(); ++k) ripple.f[k] += 30.0 * std::sin(ripple.x[k] / 1e-3);
  EXPECT_FALSE(lost_share({ripple}));
  EXPECT_FALSE(lost_share({}));
}

// Two sines: the acceleration is hardly ever without speed, and |a|·sgn v tells little. The axis brakes in a seventh of the rows.
TEST(LostShare, WhereTheMotionAloneDoesNotShowIt) {
  for (const double share : {0.0, 0.12}) {
    log::Record r;
    r.sample_time = kPeriod;
    std::mt19937 random(3);
    std::normal_distribution<double> noise;
    for (int k = 0; k < 15000; ++k) {
      const double t = kPeriod * k, slow = 2.0 * 0.7, fast = 2.0 * 2.1;
      const double v = 0.15 * std::sin(slow * t) + 0.05 * std::sin(fast * t);
      const double a = 0.15 * slow * std::cos(slow * t) + 0.05 * fast * std::cos(fast * t);
      const double friction = std::copysign(120.0 + 600.0 * std::abs(v), v);
      r.t.push_back(t);
      r.x.push_back(-0.15 / slow * std::cos(slow * t) - 0.05 / fast * std::cos(fast * t));
      r.f.push_back(at_motor(900.0 * a + friction, v, share) + noise(random));
    }
    const auto found = lost_share({r});
    ASSERT_EQ(found.has_value(), share > 0.0);
    if (found) {
      EXPECT_NEAR(found->share, share, found->half_width);
    }
  }
}

// What is lost while driving is in the force that stays.
TEST(LostShare, AsDrivingTheForceIsThatOfOneMass) {
  log::Record r = moves(0.1);
  as_driving(0.1, r);
  double most = 0.0;
  for (std::size_t k = 10; k + 10 < r.x.size(); ++k) {
    const double before = r.x[k] - r.x[k - 10], behind = r.x[k + 10] - r.x[k];
    const double v = (r.x[k + 1] - r.x[k - 1]) / (2.0 * kPeriod);
    const double a = (r.x[k + 1] - 2.0 * r.x[k] + r.x[k - 1]) / (kPeriod * kPeriod);
    // Away from reversals and from the ends of ramps.
    if (std::abs(before) < 1e-4 || std::abs(behind) < 1e-4 ||
        (std::abs(a) > 1e-6 && std::abs(std::abs(a) - 1.5) > 1e-6))
      continue;
    const double wanted = (300.0 * a + std::copysign(80.0 + 150.0 * std::abs(v), v)) / 0.9;
    most = std::max(most, std::abs(r.f[k] - wanted));
  }
  EXPECT_LT(most, 8.0);  // noise of 1 N, five standard deviations and the change of speed within a row
}

}  // namespace
}  // namespace stribeck::ident::drive::lost_share_test
