#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <stribeck/ident/drive/intervals/open_model.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::open_model_test {
namespace {

struct Told {
  Result result;
  std::optional<friction::ModelUncertainty> open;
};

/// `of_load`: standard error of a load that something else tells [N].
Told told(unsigned seed, double noise, double of_load = 0.0) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const test::SyntheticLog log = test::synthetic_log([&](double, double v, double a) {
    return 250.0 * a + (v > 0.0 ? 40.0 : -40.0) + 900.0 * v + noise * normal(engine);
  });
  const Rows rows = gather(log.log, extent_of(log.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit first = solve(log.log, rows, {});
  const LinearFit fit = solve(log.log, rows, {}, &first);
  const MapChoice choice = choose_map(log.log, rows, {}, fit, {});
  const Intervals errors = intervals(log.log, rows, {}, fit, choice, true);
  const Terms terms{};
  Found found{log.log, rows, terms, fit, choice, errors};
  if (of_load > 0.0) found.load = ToldLoad{0.0, of_load};
  Notes notes;
  Told out;
  out.result = describe(found, {}, notes);
  out.open = open_model(found, out.result);
  return out;
}

/// Standard deviation of Σ z_k·of(d_k).
template <class Of>
double sd(const friction::ModelUncertainty& open, const Of& of) {
  double square = 0.0;
  for (const friction::ModelDeviation& d : open.deviations) square += of(d) * of(d);
  return std::sqrt(square);
}

TEST(OpenModel, HasTheWidthOfTheIntervals) {
  const Told t = told(1, 2.0);
  ASSERT_TRUE(t.open.has_value());
  const double mass = (t.result.mass_interval.high - t.result.mass) / 1.96;
  EXPECT_NEAR(sd(*t.open, [](const auto& d) { return d.mass; }), mass, 1e-3 * mass);
  // In the mean over each direction; at a single speed a misfit of the map may be more.
  std::array<double, 2> ratio{}, count{};
  for (const CurvePoint& p : t.result.curve) {
    const std::size_t s = p.velocity < 0.0 ? 1 : 0;
    const double v = std::abs(p.velocity), printed = (p.ci_high - p.friction) / 1.96;
    const double own = sd(*t.open, [&](const auto& d) {
      return d.level[s] + d.viscous[s] * v + d.rise[s] * std::exp(-std::pow(v / t.open->rise_speed, 2.0));
    });
    ratio[s] += std::pow(own / printed, 2.0), count[s] += 1.0;
  }
  for (std::size_t s = 0; s < 2; ++s) EXPECT_NEAR(ratio[s] / count[s], 1.0, 0.1) << s;
}

// A load beside friction: their sum is what the log tells.
TEST(OpenModel, TheErrorOfALoadIsNoneOfTheFriction) {
  const Told plain = told(1, 2.0), beside = told(1, 2.0, 0.5);
  const auto level = [](const auto& d) { return d.level[0]; };
  EXPECT_NEAR(sd(*beside.open, level), sd(*plain.open, level), 0.3 * sd(*plain.open, level));
}

// Of 40 noises, level and viscous coefficient scatter together as the deviations say.
TEST(OpenModel, CorrelationsAreThoseOfRepeatedLogs) {
  constexpr int kRuns = 40;
  double level = 0.0, viscous = 0.0, ll = 0.0, vv = 0.0, lv = 0.0, said = 0.0;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const Told t = told(seed + 10, 2.0);
    ASSERT_TRUE(t.open.has_value());
    const double slow = friction::steady_force(t.result.friction, 0.01);
    const double b = (friction::steady_force(t.result.friction, 0.09) - slow) / 0.08, a = slow - 0.01 * b;
    level += a, viscous += b, ll += a * a, vv += b * b, lv += a * b;
    double s_ll = 0.0, s_vv = 0.0, s_lv = 0.0;
    for (const friction::ModelDeviation& d : t.open->deviations) {
      s_ll += d.level[0] * d.level[0], s_vv += d.viscous[0] * d.viscous[0], s_lv += d.level[0] * d.viscous[0];
    }
    said += s_lv / std::sqrt(s_ll * s_vv) / kRuns;
  }
  const double n = kRuns;
  const double seen =
      (lv - level * viscous / n) / std::sqrt((ll - level * level / n) * (vv - viscous * viscous / n));
  EXPECT_LT(seen, -0.5);
  EXPECT_NEAR(said, seen, 0.25);
}

TEST(OpenModel, PreSlidingOnlyWhereThereIsOne) {
  const Told t = told(1, 2.0);
  ASSERT_TRUE(t.open.has_value());
  EXPECT_GE(t.open->deviations.size(), 3U);
  for (const friction::ModelDeviation& d : t.open->deviations) EXPECT_EQ(d.stiffness + d.damping, 0.0);
}

}  // namespace
}  // namespace stribeck::ident::drive::open_model_test
