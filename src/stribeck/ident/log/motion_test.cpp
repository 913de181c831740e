#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <random>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::log::motion_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A free mass under a stepped force: the exact answer is piecewise quadratic.
Record free_mass(double mass, double T, std::size_t rows) {
  Record rec;
  rec.source = "free mass";
  rec.sample_time = T;
  double x = 0.0;
  double v = 0.02;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = T * static_cast<double>(k);
    const double f = 3.0 * std::sin(2.0 * t) + (k % 7 == 0 ? 1.0 : 0.0);
    rec.t.push_back(t);
    rec.x.push_back(x);
    rec.f.push_back(f);
    x += v * T + 0.5 * f / mass * T * T;
    v += f / mass * T;
  }
  return rec;
}

TEST(Motion, ForceOfARowPairsExactlyWithItsAccelerationUnderZeroOrderHold) {
  for (const int window : {0, 3}) {
    MotionOptions options;
    options.window = window;
    const Motion m = reconstruct(free_mass(10.0, 0.005, 400), options);
    for (std::size_t k = 0; k < m.rows(); ++k) {
      // Positions of 0.1 m carry 1e-17 m; a second difference divides by T² = 2.5e-5.
      if (!m.valid(k)) continue;
      EXPECT_NEAR(10.0 * m.a[k], m.f[k], 1e-9) << k;
    }
  }
}

TEST(Motion, NoiseOfAnEncoderIsItsStepOverRootTwelve) {
  std::vector<double> x;
  const double q = 25e-9;
  for (int k = 0; k < 4000; ++k) x.push_back(q * std::round((0.02 * std::cos(0.475 * 0.005 * k)) / q));
  EXPECT_NEAR(position_noise(x), q / std::sqrt(12.0), 0.05 * q / std::sqrt(12.0));
}

// At 2, 5 and 10 whole steps per row most rows show no noise; the short moves from speed to speed do.
TEST(Motion, SpeedsOfWholeStepsPerRowDoNotHideTheStepOfTheEncoder) {
  const double q = 1e-6;
  std::vector<double> x;
  double at = 0.0;
  for (const double speed : {2.0, 5.0, 10.0, 5.0, 2.0}) {
    for (int k = 0; k < 400; ++k) at += speed * q, x.push_back(std::round(at / q) * q);
    for (int k = 0; k < 100; ++k) at += (speed + 0.013 * k) * q, x.push_back(std::round(at / q) * q);
  }
  EXPECT_NEAR(position_noise(x), q / std::sqrt(12.0), 0.3 * q / std::sqrt(12.0));
  // The same motion without an encoder has none.
  std::vector<double> smooth;
  at = 0.0;
  for (const double speed : {2.0, 5.0, 10.0, 5.0, 2.0}) {
    for (int k = 0; k < 400; ++k) at += speed * q, smooth.push_back(at);
    for (int k = 0; k < 100; ++k) at += (speed + 0.013 * k) * q, smooth.push_back(at);
  }
  EXPECT_LT(position_noise(smooth), 1e-3 * q);
}

TEST(Motion, WindowGrowsWithTheNoiseAndStaysAwayWithoutIt) {
  auto sine = [](double q) {
    Record rec;
    rec.sample_time = 0.005;
    for (int k = 0; k < 6000; ++k) {
      const double t = 0.005 * k;
      const double x = 0.02 * std::cos(0.475 * t);
      rec.t.push_back(t);
      rec.x.push_back(q > 0 ? q * std::round(x / q) : x);
      rec.f.push_back(x);
    }
    return reconstruct(rec);
  };
  EXPECT_EQ(sine(0.0).window, 0);
  const int fine = sine(25e-9).window;
  const int coarse = sine(1e-6).window;
  EXPECT_GT(fine, 0);
  EXPECT_LT(fine, 4);
  EXPECT_GT(coarse, 2 * fine);
  EXPECT_LT(coarse, 20);
}

TEST(Motion, ReversalsAreTheExtremesAndTheWayCountsFromThere) {
  Record rec;
  rec.sample_time = 0.01;
  for (int k = 0; k < 1000; ++k) {
    rec.t.push_back(0.01 * k);
    rec.x.push_back(0.01 * std::sin(2.0 * 0.01 * k));
    rec.f.push_back(0.0);
  }
  const Motion m = reconstruct(rec);
  // Extremes at 2t = π/2 + nπ: rows 78.5, 235.6, …; the first entry is the start of the first stretch.
  ASSERT_THAT(m.reversals, SizeIs(7));
  EXPECT_NEAR(static_cast<double>(m.reversals[1]), 78.5, 1.0);
  EXPECT_NEAR(static_cast<double>(m.reversals[2]), 235.6, 1.0);
  EXPECT_EQ(m.direction[50], 1);
  EXPECT_EQ(m.direction[150], -1);
  EXPECT_NEAR(m.distance[157], 0.01, 1e-4);  // a quarter period after the extreme: one amplitude
  EXPECT_FALSE(m.sliding(79, 1e-4));
  EXPECT_TRUE(m.sliding(150, 1e-4));
}

TEST(Motion, QuantisationAtRestIsNoReversal) {
  Record rec;
  rec.sample_time = 0.001;
  std::mt19937_64 engine(3);
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.001 * k;
    rec.t.push_back(t);
    rec.x.push_back(1e-6 * std::round((0.01 * t + (engine() % 2 ? 2e-7 : -2e-7)) / 1e-6));
    rec.f.push_back(0.0);
  }
  EXPECT_THAT(reconstruct(rec).reversals, SizeIs(1));
}

TEST(Motion, FindsWhetherTheForceWasProgrammed) {
  test::Drive drive;
  drive.friction = test::table_2_3('x');
  const Record open =
      test::run(drive, 4.0, 1, [](std::size_t, double t, double) { return 3000.0 * std::sin(t); });
  EXPECT_EQ(reconstruct(open).loop, Loop::kOpen);
  Record closed = test::run_closed(drive, drive.mass, test::sine_reference(0.005, 0.02, 0.475, 0.5), 1);
  EXPECT_EQ(reconstruct(closed).loop, Loop::kClosed);
  closed.r.clear();
  EXPECT_EQ(reconstruct(closed).loop, Loop::kAutomatic);
}

TEST(Record, SaysWhatIsWrongWithItsRow) {
  Record good = free_mass(10.0, 0.005, 200);
  EXPECT_THAT(problems(good), IsEmpty());
  Record gap = good;
  for (std::size_t k = 120; k < gap.t.size(); ++k) gap.t[k] += 0.05;
  EXPECT_THAT(problems(gap), ::testing::ElementsAre(HasSubstr("row 120")));
  Record hole = good;
  hole.f[17] = std::nan("");
  EXPECT_THAT(problems(hole), ::testing::ElementsAre(HasSubstr("column f, row 17")));
  Record two = good;
  two.x.pop_back();
  two.r = {1.0};
  EXPECT_THAT(problems(two), SizeIs(2));
}

// Row by row or in pieces, at any shift: the same, also where the holds reach over an end.
TEST(AlignForce, OfAPieceIsThatOfTheWhole) {
  std::vector<double> f;
  for (int k = 0; k < 12; ++k) f.push_back(std::sin(1.7 * k));
  for (const double shift : {-20.3, -2.5, -0.5, 0.0, 0.35, 4.0, 20.0}) {
    const std::vector<double> whole = align_force(f, shift);
    std::vector<double> pieces(f.size(), 99.0);
    for (const std::size_t from : {0u, 3u, 9u})
      align_force(f, shift, from, from == 0 ? 3 : from == 3 ? 9 : 12, pieces);
    EXPECT_EQ(pieces, whole) << "shift " << shift;
  }
  // Beyond an end its last value holds.
  EXPECT_DOUBLE_EQ(align_force(f, -20.3)[5], f.front());
  EXPECT_DOUBLE_EQ(align_force(f, 20.0)[5], f.back());
}

}  // namespace
}  // namespace stribeck::ident::log::motion_test
