#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/control/observers/cutting_force_observer.hpp>

namespace stribeck::control::cutting_force_observer_test {
namespace {

constexpr double kT = 1e-3;
constexpr double kMass = 1000.0;
/// 1500 turns a minute with four teeth [rad/s].
constexpr double kTurn = 2.0 * kPi * 25.0;
constexpr double kTooth = 4.0 * kTurn;

using Observer = CuttingForceObserver<2>;

Observer::Params params(double coulomb = 18.0) {
  Observer::Params p;
  p.model.mass = kMass;
  p.model.load = 10.0;
  p.model.friction.steady = friction::Conventional<double>{coulomb, 4500.0, {}};
  p.frequency = {kTurn, kTooth};
  p.period = kT;
  return p;
}

/// d₀ + a cos Ωt + b sin zΩt, and its first two integrals over time.
struct Truth {
  double mean = 40.0;
  double turn = 8.0;
  double tooth = 20.0;

  [[nodiscard]] double force(double t) const {
    return mean + turn * std::cos(kTurn * t) + tooth * std::sin(kTooth * t);
  }
  [[nodiscard]] double once(double t) const {
    return mean * t + turn / kTurn * std::sin(kTurn * t) + tooth / kTooth * (1.0 - std::cos(kTooth * t));
  }
  [[nodiscard]] double twice(double t) const {
    return 0.5 * mean * t * t + turn / (kTurn * kTurn) * (1.0 - std::cos(kTurn * t)) +
           tooth / kTooth * (t - std::sin(kTooth * t) / kTooth);
  }
};

/// An axis of 1000 kg at about 10 mm/s with the friction of the model and a slow oscillating force; its motion is exact.
struct Drive {
  Truth truth;
  double coulomb = 18.0;  ///< true
  double believed = 18.0;
  double side = 1.0;  ///< −1: everything mirrored
  double resolution = 0.0;

  struct Seen {
    double t, slow, turn, tooth, coming;
  };
  [[nodiscard]] std::vector<Seen> operator()(double seconds) const {
    Observer::Params p = params(believed);
    p.model.load *= side;
    const Observer observer(p);
    Observer::State s;
    std::vector<Seen> seen;
    constexpr double kFeed = 10e-3;
    const double rubbing = coulomb + 4500.0 * kFeed;
    double push = 0.0;    // integral of the pushing force
    double pushed = 0.0;  // of that
    double force = 0.0;
    const auto ticks = static_cast<std::size_t>(std::lround(seconds / kT));
    for (std::size_t k = 0; k <= ticks; ++k) {
      const double t = static_cast<double>(k) * kT;
      const double x = side * (kFeed * t + (pushed - truth.twice(t)) / kMass);
      observer.step(s, side * force, 0.0, side * kFeed,
                    resolution > 0.0 ? resolution * std::nearbyint(x / resolution) : x);
      seen.push_back(
          {t, observer.slow(s), observer.amplitude(s, 0), observer.amplitude(s, 1), observer.coming(s)});
      // About the cutting force, held; friction and load are carried on top, and cancel the true ones.
      const double net = truth.mean + 3.0 * std::cos(5.0 * t);
      pushed += push * kT + 0.5 * net * kT * kT;
      push += net * kT;
      force = net + rubbing + 10.0;
    }
    return seen;
  }
};

TEST(CuttingForceObserver, WithoutWavesItsPolesTendToButterworths) {
  CuttingForceObserver<0>::Params p;
  p.model.mass = 7.0;
  p.slow_bandwidth = 40.0;
  // s³ + 2ω₀s² + 2ω₀²s + ω₀³; what is left is of first order in ω₀T.
  for (const double step : {1e-2, 1e-3}) {
    p.period = step / 40.0;
    const auto k = CuttingForceObserver<0>(p).gain();
    EXPECT_NEAR(k[0] / (2.0 * step), 1.0, 2.0 * step);
    EXPECT_NEAR(k[1] / (2.0 * step * step), 1.0, 2.0 * step);
    EXPECT_NEAR(k[2] / -(step * step * step), 1.0, 2.0 * step);
  }
}

TEST(CuttingForceObserver, GainIsSciPys) {
  // SciPy 1.10: solve_discrete_are for expm(A_c T), variances of the walks (ω₀T)⁶ and 2(σT)²(ω_kT)⁴, noise 1.
  const std::array<double, 7> scipy{0.2001293327549928,     0.02225285807600497,     -0.0008943548888696355,
                                    2.0902222188663156e-05, -0.00021968106144658895, 0.0033164620607697808,
                                    -0.0012113741544440752};
  const auto k = Observer(params()).gain();
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(k[i], scipy[i], 1e-7 * std::abs(scipy[i]) + 1e-12) << i;
}

TEST(CuttingForceObserver, WavesSettleAtTheirBandwidth) {
  const auto seen = Drive{}(2.4);
  const auto error = [&](double t, auto of) {
    double worst = 0.0;
    for (const auto& s : seen) {
      if (s.t >= t && s.t < t + 0.04) worst = std::max(worst, std::abs(of(s)));
    }
    return worst;
  };
  // Closed loop, SciPy: −4.73 ± 157.33j and −5.00 ± 628.40j; the slow poles have decayed after 0.5 s. The error rotates relative to
  // the oscillation by 0.25 and 0.08 rad/s, which shows in its amplitude.
  const auto turn = [](const auto& s) { return s.turn - 8.0; };
  const auto tooth = [](const auto& s) { return s.tooth - 20.0; };
  EXPECT_NEAR(std::log(error(1.0, turn) / error(2.2, turn)) / 1.2, 4.73, 0.3);
  EXPECT_NEAR(std::log(error(1.0, tooth) / error(2.2, tooth)) / 1.2, 5.0, 0.3);
}

TEST(CuttingForceObserver, ForetellsTheMeanOverTheComingPeriod) {
  const Truth truth;
  const auto seen = Drive{}(5.2);
  for (const auto& s : seen) {
    if (s.t > 5.0) {
      EXPECT_NEAR(s.coming, (truth.once(s.t + kT) - truth.once(s.t)) / kT, 1e-6) << s.t;
    }
  }
}

TEST(CuttingForceObserver, FindsMeanAndAmplitudesThroughTheEncoder) {
  Drive run;
  run.resolution = 25e-9;
  double slow = 0.0;
  double turn = 0.0;
  double tooth = 0.0;
  for (const auto& s : run(4.0)) {
    if (s.t > 2.0) {
      slow = std::max(slow, std::abs(s.slow - 40.0));
      turn = std::max(turn, std::abs(s.turn - 8.0));
      tooth = std::max(tooth, std::abs(s.tooth - 20.0));
    }
  }
  // White noise of 25 nm/√12 gives 0.0125, 0.012 and 0.20 N RMS (Lyapunov equation of the loop, SciPy); at most four times
  // that, and not nothing.
  EXPECT_LT(slow, 0.05);
  EXPECT_LT(turn, 0.05);
  EXPECT_LT(tooth, 0.8);
  EXPECT_GT(tooth, 0.1);
}

TEST(CuttingForceObserver, WrongFrictionIsTakenForMeanCuttingForceAndForNothingElse) {
  Drive run;
  run.believed = 18.0 * 0.9;
  const auto last = run(5.0).back();
  EXPECT_NEAR(last.slow, 40.0 + 0.1 * 18.0, 1e-6);
  EXPECT_NEAR(last.turn, 8.0, 1e-6);
  EXPECT_NEAR(last.tooth, 20.0, 1e-6);
}

TEST(CuttingForceObserver, MirrorsWithTheMotion) {
  Drive run;
  const auto a = run(0.3);
  run.side = -1.0;
  const auto b = run(0.3);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].slow, -b[k].slow);
    EXPECT_EQ(a[k].turn, b[k].turn);
    EXPECT_EQ(a[k].coming, -b[k].coming);
  }
}

TEST(CuttingForceObserver, SaysWhatItCannotSee) {
  EXPECT_TRUE(params().determinable());
  Observer::Params p = params();
  p.frequency[1] = p.frequency[0] + 19.0;  // nearer than four times the bandwidth of an oscillation
  EXPECT_FALSE(p.determinable());
  p = params();
  p.frequency[1] = kPi / kT;  // half the sampling rate
  EXPECT_FALSE(p.determinable());
  p = params();
  p.slow_bandwidth = 160.0;  // includes the slowest oscillation
  EXPECT_FALSE(p.determinable());
  p = params();
  p.frequency[0] = std::nan("");
  EXPECT_FALSE(p.determinable());
}

TEST(CuttingForceObserver, AsksForEachOfItsSettings) {
  for (const double wrong : {0.0, -1.0, std::nan("")}) {
    for (const auto setting :
         {&Observer::Params::slow_bandwidth, &Observer::Params::wave_bandwidth, &Observer::Params::period}) {
      Observer::Params p = params();
      p.*setting = wrong;
      EXPECT_FALSE(p.determinable()) << wrong;
    }
    Observer::Params p = params();
    p.model.mass = wrong;
    EXPECT_FALSE(p.determinable()) << wrong;
  }
  // Small numbers are not none: a mass of a gram, and everything a thousand times as slow.
  Observer::Params p = params();
  p.model.mass = 1e-3;
  EXPECT_TRUE(p.determinable());
  p.period = 1.0;
  p.slow_bandwidth = 0.1;
  p.wave_bandwidth = 5e-3;
  p.frequency = {1e-3 * kTurn, 1e-3 * kTooth};
  EXPECT_TRUE(p.determinable());
  // A slow bandwidth of a radian per period or more.
  CuttingForceObserver<0>::Params fast;
  fast.model.mass = 1.0;
  fast.slow_bandwidth = 1001.0;
  EXPECT_FALSE(fast.determinable());
}

TEST(CuttingForceObserver, AReferenceAtRestSaysNothingOfTheSignOfFriction) {
  const Observer observer(params());
  Observer::State s;
  for (int k = 0; k < 3000; ++k) observer.step(s, 10.0 + 5.0, 0.0, 0.0, 0.25);
  EXPECT_NEAR(observer.slow(s), 5.0, 1e-4);  // which friction holds, for all that it can tell
}

TEST(CuttingForceObserver, ALoadAndAFrictionThatAreKnownAreNoCuttingForce) {
  // An axis that stands where the load and the friction hold it, for both directions in which the reference creeps.
  for (const double creep : {1e-9, -1e-9}) {
    const Observer observer(params());
    Observer::State s;
    for (int k = 0; k < 3000; ++k) observer.step(s, 10.0 + sign(creep) * 18.0, 0.0, creep, 0.25);
    EXPECT_NEAR(observer.slow(s), 0.0, 1e-4);
    EXPECT_NEAR(observer.coming(s), 0.0, 1e-4);
  }
}

}  // namespace
}  // namespace stribeck::control::cutting_force_observer_test
