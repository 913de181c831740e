#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/frequency/plant_fit.hpp>
#include <stribeck/ident/frequency/response.hpp>
#include <stribeck/ident/frequency/test_two_mass.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::frequency::response_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

bool within(const Value& v, double truth) { return truth >= v.low() && truth <= v.high(); }

TEST(Response, FindsMassDelayAndBothResonancesOfTwoMasses) {
  TwoMass p;
  p.late = 0.4;
  p.noise = 20.0;
  const Response response = estimate({recorded(p, short_multisine(p.period), 1)});
  ASSERT_TRUE(response.period);
  EXPECT_NEAR(*response.period, 1.0, 1e-9);
  EXPECT_TRUE(response.closed_loop);
  EXPECT_EQ(response.stretches, 8U);
  const PlantFit fit = fit_plant(response);
  ASSERT_EQ(fit.plant.structure, Structure::kTwoMassDrive) << fit.reason;
  EXPECT_TRUE(within(fit.mass, p.mass())) << fit.mass.low() << " … " << fit.mass.high();
  EXPECT_TRUE(within(*fit.resonance, p.resonance()))
      << fit.resonance->low() << " … " << fit.resonance->high();
  // This log is one of the five in a hundred that miss their interval; how many do is the next test.
  EXPECT_NEAR(fit.antiresonance->value, p.antiresonance(), 2.0 * fit.antiresonance->half_width);
  EXPECT_TRUE(within(fit.delay, 0.4e-3));
  // A hundredth, and a tenth of a period: what the user was promised.
  EXPECT_NEAR(fit.mass.value, p.mass(), 0.01 * p.mass());
  EXPECT_NEAR(fit.resonance->value, p.resonance(), 0.01 * p.resonance());
  EXPECT_NEAR(fit.antiresonance->value, p.antiresonance(), 0.01 * p.antiresonance());
  EXPECT_NEAR(fit.delay.value, 0.4e-3, 0.1e-3);
}

// The resonance of a belt lies above the lines that a coarse encoder determines, its antiresonance inside: a resonance at 7 Hz, a mass
// half too large and a delay of -19 ms were said.
TEST(Response, AnAntiresonanceInsideTheLinesTellsTwoMasses) {
  TwoMass p;
  p.drive = 1.2, p.table = 5.3, p.stiffness = 60e3, p.damping = 12.0;
  p.friction = 4.0, p.noise = 0.1, p.encoder = 1e-6, p.omega = 25.0;
  Response response = estimate({recorded(p, short_multisine(p.period), 1)});
  for (Line& line : response.lines) {
    if (line.omega > 2.0 * kPi * 24.0) line.half_width = 10.0;
  }
  const PlantFit fit = fit_plant(response);
  ASSERT_EQ(fit.plant.structure, Structure::kTwoMassDrive) << fit.reason;
  EXPECT_NEAR(fit.mass.value, p.mass(), 0.02 * p.mass());
  EXPECT_TRUE(within(*fit.resonance, p.resonance()))
      << fit.resonance->low() << " … " << fit.resonance->high();
  EXPECT_NEAR(fit.antiresonance->value, p.antiresonance(), 0.02 * p.antiresonance());
}

// A coarse encoder and a soft loop: at high frequency both signals are the noise of the encoder through the controller, whose inverse was
// taken for a determined plant, and left a loop of 75 degrees a phase margin of 1.
TEST(Response, TheNoiseOfTheEncoderThroughTheControllerIsNoPlant) {
  TwoMass p;
  p.drive = 10.0, p.table = 0.0, p.friction = 31.0, p.noise = 1.0, p.encoder = 10e-6, p.omega = 25.0,
  p.fed = 0.0;
  const Response response = estimate({recorded(p, short_multisine(p.period, 4, 400.0), 1)});
  int noise = 0;
  for (const Line& line : response.lines) {
    const double plant = 1.0 / (p.mass() * line.omega * line.omega);
    if (std::abs(line.plant) < 3.0 * plant) continue;
    ++noise;
    EXPECT_FALSE(line.determined()) << line.omega / (2.0 * kPi);
  }
  EXPECT_GT(noise, 5);
}

// Four strokes of twelve periods: chance goes by the segments, of which there are many, not by the strokes; all lines were left out.
TEST(Response, LinesOfFewStrokesWithManyPeriodsCount) {
  TwoMass p;
  p.drive = 100.0, p.table = 0.0, p.friction = 10.0, p.noise = 20.0, p.fed = 0.0;
  excitation::MultisineDesign design;
  design.period = 0.5, design.lowest = 4.0, design.highest = 100.0;
  design.periods = 12, design.repeats = 2, design.speed = 0.03;
  const std::vector<double> r =
      excitation::design_multisine({-0.3, 0.3, 0.05, 1.0, 500.0}, {100.0, 10.0, 0.0}, p.period, design).r;
  const Response response = estimate({recorded(p, r, 1)});
  const auto sound = std::count_if(response.lines.begin(), response.lines.end(),
                                   [](const Line& l) { return l.determined(); });
  EXPECT_GT(2 * sound, static_cast<std::ptrdiff_t>(response.lines.size()))
      << response.stretches << " strokes, " << response.segments << " segments";
}

// A pure delay in its place made masses 2 to 8 % too large, with intervals of 0.4 %.
TEST(Response, ACurrentLoopOfFirstOrderIsNoMass) {
  const std::vector<double> r = short_multisine(1e-3, 2);
  constexpr int kDraws = 20;
  for (const double lag : {0.8e-3, 2e-3}) {
    int mass = 0;
    int time = 0;
    for (int i = 0; i < kDraws; ++i) {
      TwoMass p;
      p.drive = 1000.0;
      p.table = 0.0;
      p.late = 0.4;
      p.lag = lag;
      p.noise = 20.0;
      const PlantFit fit = fit_plant(estimate({recorded(p, r, 300 + static_cast<std::uint64_t>(i))}));
      ASSERT_EQ(fit.plant.structure, Structure::kRigidLag) << fit.reason;
      EXPECT_NEAR(fit.mass.value, 1000.0, 10.0);
      EXPECT_NEAR(fit.delay.value + fit.lag->value, 0.4e-3 + lag, 0.05e-3);
      mass += within(fit.mass, 1000.0) ? 1 : 0;
      time += within(*fit.lag, lag) ? 1 : 0;
    }
    EXPECT_GE(mass, 17) << lag;
    EXPECT_GE(time, 17) << lag;
  }
}

TEST(Response, IntervalsHoldTheTruthInNineteenOfTwentyLogs) {
  const std::vector<double> r = short_multisine(1e-3, 2);
  constexpr int kDraws = 40;
  int mass = 0;
  int resonance = 0;
  int delay = 0;
  int antiresonance = 0;
  for (int i = 0; i < kDraws; ++i) {
    TwoMass p;
    p.late = 0.02 * i;
    p.noise = 60.0;
    p.stiffness = 2.0e7 + 0.05e7 * i;
    const PlantFit fit = fit_plant(estimate({recorded(p, r, 100 + static_cast<std::uint64_t>(i))}));
    mass += within(fit.mass, p.mass());
    resonance += fit.resonance && within(*fit.resonance, p.resonance());
    antiresonance += fit.antiresonance && within(*fit.antiresonance, p.antiresonance());
    delay += within(fit.delay, p.late * p.period);
  }
  std::cout << "coverage of 40: mass " << mass << ", resonance " << resonance << ", anti-resonance "
            << antiresonance << ", delay " << delay << '\n';
  // Of 40 draws at 95 %, 33 or fewer have a probability of 0.3 %.
  EXPECT_GE(mass, 34);
  EXPECT_GE(resonance, 34);
  EXPECT_GE(antiresonance, 34);
  EXPECT_GE(delay, 34);
}

// In a closed loop the force answers to the noise: the plain ratio tends to the inverse of the controller.
TEST(Response, IsNotBiasedByTheClosedLoopAsThePlainRatioIs) {
  TwoMass p;
  p.table = 0.0;
  p.drive = 1000.0;
  p.noise = 300.0;
  p.omega = 120.0;
  const Response response = estimate({recorded(p, short_multisine(p.period), 3)});
  double plain = 0.0;
  double honest = 0.0;
  int lines = 0;
  int inside = 0;
  for (const Line& l : response.lines) {
    if (!l.determined() || l.omega > 2.0 * kPi * 20.0) continue;
    const double truth = 1.0 / (p.mass() * l.omega * l.omega);
    plain += std::abs(l.plain) / truth - 1.0;
    honest += std::abs(l.plant) / truth - 1.0;
    inside += std::abs(std::abs(l.plant) / truth - 1.0) < l.half_width;
    ++lines;
  }
  ASSERT_GE(lines, 10);
  EXPECT_LT(plain / lines, -0.1);
  EXPECT_NEAR(honest / lines, 0.0, 0.05);
  EXPECT_GE(inside, lines * 8 / 10);
  EXPECT_TRUE(within(fit_plant(response).mass, 1000.0));
}

// Set-points with four or five decimals of a millimetre, as controls log them: their rounding is periodic too, and was taken for an
// excitation up to the highest frequency, with a mass of a half.
TEST(Response, TheRoundingOfTheReferenceIsNoExcitation) {
  TwoMass p;
  p.table = 0.0;
  p.noise = 20.0;
  const log::Record exact = recorded(p, short_multisine(p.period), 3);
  const Response all = estimate({exact});
  for (const double step : {1e-8, 1e-7, 1e-6}) {
    log::Record record = exact;
    for (double& r : record.r) r = step * std::round(r / step);
    const Response response = estimate({record});
    EXPECT_LE(response.lines.size(), all.lines.size()) << step;
    EXPECT_GE(response.lines.size(), 10U) << step;
    EXPECT_NEAR(fit_plant(response).mass.value, p.mass(), 0.02 * p.mass()) << step;
  }
}

TEST(Response, IsTheSameForMirroredMotionAndScaledForce) {
  TwoMass p;
  p.noise = 20.0;
  const log::Record one = recorded(p, short_multisine(p.period, 2), 5);
  log::Record other = one;
  for (std::size_t k = 0; k < one.x.size(); ++k) {
    other.x[k] = -one.x[k];
    other.r[k] = -one.r[k];
    other.f[k] = -2.0 * one.f[k];
  }
  const Response a = estimate({one});
  const Response b = estimate({other});
  ASSERT_EQ(a.lines.size(), b.lines.size());
  for (std::size_t i = 0; i < a.lines.size(); ++i)
    EXPECT_LT(std::abs(a.lines[i].plant - 2.0 * b.lines[i].plant), 1e-9 * std::abs(a.lines[i].plant));
}

TEST(Response, FindsThePlantWithoutAPeriodToo) {
  TwoMass p;
  p.table = 0.0;
  p.drive = 1000.0;
  p.noise = 20.0;
  std::vector<double> r = short_multisine(p.period);
  // A stroke that is shaken at random: the increments repeat nowhere.
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  double shake = 0.0;
  double speed = 0.0;
  for (double& place : r) {
    speed += p.period * (-60.0 * speed - 900.0 * shake) + 2e-4 * normal(random);
    shake += p.period * speed;
    place += shake;
  }
  const Response response = estimate({recorded(p, r, 6)});
  EXPECT_FALSE(response.period);
  const PlantFit fit = fit_plant(response);
  EXPECT_NEAR(fit.mass.value, 1000.0, 50.0);  // lines are means over bands
}

TEST(Response, RefusesAMotionThatExcitesNothing) {
  const TwoMass p;
  std::vector<double> r;
  for (int k = 0; k < 8000; ++k) r.push_back(1e-5 * std::min(k, 4000));
  EXPECT_THAT([&] { fit_plant(estimate({recorded(p, r, 1)})); },
              ThrowsMessage<Refused>(HasSubstr("stribeck excite MACHINE.toml --method multisine")));
}

TEST(Response, RefusesAnAxisThatFrictionHolds) {
  TwoMass p;
  p.holds = 1.0;
  std::vector<double> r = short_multisine(p.period, 2);
  for (double& place : r) place *= 1e-3;
  EXPECT_THAT([&] { estimate({recorded(p, r, 1)}); },
              ThrowsMessage<Refused>(AllOf(HasSubstr("stands or reverses"), HasSubstr("hides the plant"))));
}

TEST(Response, RefusesAClosedLoopWithoutReference) {
  const TwoMass p;
  log::Record record = recorded(p, short_multisine(p.period, 2), 1);
  record.r.clear();
  EXPECT_THAT([&] { estimate({record}); }, ThrowsMessage<Refused>(HasSubstr("log the reference position")));
}

TEST(Response, MarksLinesThatTheEncoderHidesAsNotDetermined) {
  TwoMass p;
  p.encoder = 20e-6;
  p.noise = 20.0;
  const Response response = estimate({recorded(p, short_multisine(p.period), 1)});
  EXPECT_TRUE(response.lines.front().determined());
  EXPECT_FALSE(response.lines.back().determined());
  EXPECT_LT(response.highest(), response.lines.back().omega);
}

TEST(SampledResponse, IsTheClosedFormOfADoubleIntegrator) {
  // T²·(z + 1)/(2m·(z − 1)²): Åström, Wittenmark 1997, table 2.1.
  const double T = 2e-3;
  for (const double omega : {3.0, 100.0, 1200.0}) {
    const Complex z = std::polar(1.0, omega * T);
    const Complex expected = T * T * (z + 1.0) / (2.0 * 50.0 * (z - 1.0) * (z - 1.0));
    EXPECT_LT(std::abs(sampled_response({.mass = 50.0}, omega, T) - expected), 1e-10 * std::abs(expected));
    // A whole period of delay turns by z⁻¹.
    EXPECT_LT(std::abs(sampled_response({.mass = 50.0, .delay = T}, omega, T) - expected / z),
              1e-9 * std::abs(expected));
  }
}

TEST(SampledResponse, OfTwoMassesTendsToBothRigidLimits) {
  const Plant p{Structure::kTwoMassDrive, 100.0, 0.0, 0.0, 300.0, 600.0, 0.02, 0.04};
  const double T = 1e-4;
  EXPECT_NEAR(std::abs(sampled_response(p, 10.0, T)) * 100.0 * 100.0, 1.0, 2e-3);
  // Far above the resonance the drive side moves alone: m·(ωz/ωp)².
  EXPECT_NEAR(std::abs(sampled_response(p, 6000.0, T)) * 25.0 * 36e6, 1.0, 0.05);
}

}  // namespace
}  // namespace stribeck::ident::frequency::response_test
