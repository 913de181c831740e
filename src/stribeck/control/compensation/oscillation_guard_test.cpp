#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/compensation/oscillation_guard.hpp>
#include <vector>

namespace stribeck::control::oscillation_guard_test {
namespace {

/// Steps a guard with amplitude·sin(2π·frequency·t) for so many seconds; how often it found something.
std::uint32_t found(double amplitude, double frequency, double seconds, double reversal_every = 0.0) {
  const OscillationGuard guard(100.0, 1e-3);
  OscillationGuard::State s;
  for (int k = 0; k < seconds * 1e3; ++k) {
    const double t = k * 1e-3;
    const double v =
        reversal_every > 0.0 && std::fmod(t, 2.0 * reversal_every) >= reversal_every ? -1e-3 : 1e-3;
    guard.step(s, amplitude * std::sin(2.0 * kPi * frequency * t), v);
  }
  return s.found;
}

TEST(OscillationGuard, CountsSwings) {
  // Nine turns at 10 Hz take half a second.
  EXPECT_EQ(found(100.0, 10.0, 0.40), 0U);
  EXPECT_EQ(found(100.0, 10.0, 0.60), 1U);
  EXPECT_EQ(found(40.0, 10.0, 10.0), 0U);       // swings of 80 N are below the threshold
  EXPECT_EQ(found(100.0, 0.5, 60.0), 0U);       // too slow
  EXPECT_EQ(found(100.0, 500.0, 10.0), 0U);     // the encoder's rattle
  EXPECT_EQ(found(100.0, 2.0, 60.0, 0.5), 0U);  // swings that reversals make
}

TEST(OscillationGuard, HalvesTrustAndKeepsItDown) {
  const OscillationGuard guard(100.0, 1e-3);
  OscillationGuard::State s;
  std::vector<double> trust;
  for (int k = 0; k < 6000; ++k) {
    if (guard.step(s, 200.0 * std::sin(2.0 * kPi * 10.0 * k * 1e-3), 1e-3)) trust.push_back(s.trust);
  }
  ASSERT_GE(trust.size(), 5U);
  EXPECT_EQ((std::vector<double>{trust.begin(), trust.begin() + 5}),
            (std::vector<double>{0.5, 0.25, 0.125, 0.0, 0.0}));
  for (int k = 0; k < 10000; ++k) guard.step(s, 0.0, 1e-3);
  EXPECT_EQ(s.trust, 0.0);
}

TEST(OscillationGuard, TheFirstMotionIsNoReversalInEitherDirection) {
  // An axis at rest swings, and then begins to move: the swings go on counting.
  for (const double direction : {1.0, -1.0}) {
    const OscillationGuard guard(100.0, 1e-3);
    OscillationGuard::State s;
    for (int k = 0; k < 600; ++k)
      guard.step(s, 100.0 * std::sin(2.0 * kPi * 10.0 * k * 1e-3), k < 300 ? 0.0 : direction * 1e-3);
    EXPECT_EQ(s.found, 1U) << direction;
  }
}

TEST(OscillationGuard, AReversalEndsARunAlsoAfterARest) {
  for (const double back : {1.0, -1.0}) {
    const OscillationGuard guard(100.0, 1e-3);
    OscillationGuard::State s;
    for (int k = 0; k < 750; ++k) {
      const double v = k < 350 ? 1e-3 : k < 400 ? 0.0 : back * 1e-3;
      guard.step(s, 100.0 * std::sin(2.0 * kPi * 10.0 * k * 1e-3), v);
    }
    EXPECT_EQ(s.found, back > 0.0 ? 1U : 0U);
  }
}

}  // namespace
}  // namespace stribeck::control::oscillation_guard_test
