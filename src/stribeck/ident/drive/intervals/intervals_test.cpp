#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/intervals/intervals.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::intervals_test {
namespace {

struct Fitted {
  test::SyntheticLog log;
  Rows rows;
  LinearFit fit;
  MapChoice choice;
  Intervals intervals;
};

/// `scale`: unit of the force.
Fitted fitted(unsigned seed, double noise, double scale = 1.0) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Fitted out;
  out.log = test::synthetic_log([&](double, double v, double a) {
    return scale * (250.0 * a + (v > 0.0 ? 40.0 : -40.0) + 900.0 * v + noise * normal(engine));
  });
  out.rows = gather(out.log.log, extent_of(out.log.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit first = solve(out.log.log, out.rows, {});
  out.fit = solve(out.log.log, out.rows, {}, &first);
  out.choice = choose_map(out.log.log, out.rows, {}, out.fit, {});
  out.intervals = intervals(out.log.log, out.rows, {}, out.fit, out.choice, true);
  return out;
}

// White noise: the closed form σ/√Σ(a − ā)² about the means of the bins.
TEST(Intervals, WhiteNoiseGivesTheClosedFormForTheMass) {
  const Fitted f = fitted(1, 2.0);
  const double closed = 2.0 / std::sqrt(f.fit.moments(0, 0));
  EXPECT_NEAR(f.intervals.error_at(0), closed, 0.2 * closed);
  EXPECT_NEAR(f.intervals.factor, 1.96, 0.01);  // thousands of independent rows
}

// Of 40 noises the masses scatter as the standard error says: χ² with 39 degrees of freedom, 1 in 1000.
TEST(Intervals, TheErrorOfTheMassIsItsScatter) {
  double mean = 0.0, square = 0.0, error = 0.0;
  constexpr int kRuns = 40;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const Fitted f = fitted(seed + 10, 2.0);
    mean += (f.fit.mass - 250.0) / kRuns;
    square += std::pow(f.fit.mass - 250.0, 2.0);
    error += f.intervals.error_at(0) / kRuns;
  }
  const double scatter = std::sqrt((square - kRuns * mean * mean) / (kRuns - 1));
  EXPECT_GT(scatter / error, 0.61);
  EXPECT_LT(scatter / error, 1.42);
}

// A force that was measured at the instant of the position: a shift of half a row explains too little to be taken, and moves mass and
// viscous friction by three half widths.
TEST(Intervals, HoldTheTruthBesideAShiftThatIsNotTaken) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> noise(0.0, 0.5);
    log::Record r;
    r.source = "log.csv";
    r.sample_time = 1e-3;
    for (int k = 0; k < 20'000; ++k) {
      const double t = 1e-3 * k;
      const double A = 0.02 + 0.015 * std::sin(0.9 * t), dA = 0.0135 * std::cos(0.9 * t);
      const double s = std::sin(2.5 * t), c = std::cos(2.5 * t), q = std::sin(11.0 * t);
      const double v = dA * s + 2.5 * A * c + 0.044 * std::cos(11.0 * t);
      const double a = (-0.01215 * std::sin(0.9 * t) - 6.25 * A) * s + 5.0 * dA * c - 0.484 * q;
      r.t.push_back(t);
      r.x.push_back(A * s + 0.004 * q);
      r.f.push_back(60.0 * a + 80.0 * v + (v > 0.0 ? 12.0 : -12.0) + noise(engine));
    }
    DriveFitOptions options;
    options.dynamics = false;
    const Result found = identify_drive({r}, options);
    EXPECT_EQ(found.find("force_shift"), nullptr);
    for (const auto& [name, truth] : {std::pair{"mass", 60.0}, std::pair{"viscous_positive", 80.0}}) {
      const Parameter* p = found.find(name);
      ASSERT_NE(p, nullptr) << name;
      EXPECT_LE(p->ci_low, truth) << name << ", seed " << seed;
      EXPECT_GE(p->ci_high, truth) << name << ", seed " << seed;
    }
    EXPECT_LT(found.mass_interval.high - found.mass_interval.low, 0.2);
    EXPECT_THAT(
        found.warnings,
        ::testing::Contains(::testing::HasSubstr("ms or more later than a force that is held for its row")));
  }
}

TEST(Intervals, FollowTheUnitOfTheForce) {
  const Fitted newton = fitted(1, 2.0), kilo = fitted(1, 2.0, 1e-3);
  ASSERT_EQ(newton.intervals.long_run.rows(), kilo.intervals.long_run.rows());
  EXPECT_NEAR(1e3 * kilo.intervals.error_at(0), newton.intervals.error_at(0),
              1e-3 * newton.intervals.error_at(0));
  EXPECT_NEAR(1e3 * kilo.intervals.residual[5], newton.intervals.residual[5], 1e-3);
}

TEST(Intervals, TheResidualIsWhatModelAndMassLeave) {
  const Fitted f = fitted(3, 2.0);
  const log::Motion& m = f.log.log.motions[0];
  for (std::size_t i = 0; i < f.rows.size(); i += 101) {
    const std::size_t k = f.rows.at[i], s = f.rows.side[i];
    const double friction = f.choice.map.fit.force(static_cast<int>(s), std::abs(m.v[k]));
    ASSERT_NEAR(f.intervals.residual[i], m.f[k] - f.fit.mass * m.a[k] - map::kDirection[s] * friction, 0.01)
        << i;
  }
}

// A term at speeds that no bin has: the data say nothing about it, and nothing else gets wider for it.
TEST(Intervals, ADirectionWithoutDataIsUnseen) {
  Fitted f = fitted(1, 2.0);
  map::StaticFit& fit = f.choice.map.fit;
  fit = {};
  fit.top = {f.rows.grid[0].high, f.rows.grid[1].high};
  for (std::size_t s = 0; s < map::kSides; ++s)
    fit.branch[s] = {40.0, 900.0 * fit.top[s], {{1.0, 9.0, 0.1}}, false, 0.0};
  const Intervals wide = intervals(f.log.log, f.rows, {}, f.fit, f.choice, true);
  ASSERT_EQ(wide.unseen.size(), 10u);
  for (const std::size_t i : {0u, 1u, 5u, 6u}) EXPECT_LT(wide.unseen[i], 1e-6) << i;
  for (const std::size_t i : {2u, 3u, 4u, 7u, 8u, 9u}) EXPECT_GT(wide.unseen[i], 0.9) << i;
  EXPECT_NEAR(wide.error_at(0), f.intervals.error_at(0), 0.05 * f.intervals.error_at(0));
}

/// A straight line, which the data contradict by `more`.
Fitted with_a_line(const std::function<double(double)>& more) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  Fitted out;
  out.log = test::synthetic_log([&](double, double v, double a) {
    return 250.0 * a + (v > 0.0 ? 1.0 : -1.0) * (40.0 + more(std::abs(v))) + 900.0 * v + 0.2 * normal(engine);
  });
  out.rows = gather(out.log.log, extent_of(out.log.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit first = solve(out.log.log, out.rows, {});
  out.fit = solve(out.log.log, out.rows, {}, &first);
  map::StaticFit& fit = out.choice.map.fit;
  fit.family = map::StaticFit::Family::kSymmetric;
  fit.coulomb = 40.0, fit.viscous = 900.0;
  fit.top = {out.rows.grid[0].high, out.rows.grid[1].high};
  out.intervals = intervals(out.log.log, out.rows, {}, out.fit, out.choice, true);
  return out;
}

// The mean over ±5 % and ±15 % of the speed, triangular, of a bump of 3 N whose width is 20 mm/s.
TEST(Intervals, TheMisfitIsWhatAMapOfFewParametersLeaves) {
  const Fitted f =
      with_a_line([](double speed) { return 3.0 * std::exp(-std::pow((speed - 0.06) / 0.02, 2.0)); });
  for (const int side : {0, 1}) {
    EXPECT_NEAR(f.intervals.misfit.at(side, 0.06), 3.0, 0.1) << side;
    EXPECT_NEAR(f.intervals.misfit.at(side, 0.08), 3.0 * std::exp(-1.0), 0.15) << side;
    EXPECT_LT(f.intervals.misfit.at(side, 0.11), 0.05) << side;
  }
  // Nothing but noise, whose mean over the rows around a speed is below 0.02 N.
  const Fitted line = with_a_line([](double) { return 0.0; });
  for (const double speed : {0.01, 0.03, 0.06, 0.11}) EXPECT_LT(line.intervals.misfit.at(0, speed), 0.04);
}

// Friction that has not settled follows the acceleration at low speed: every period the same, so that noise does not tell.
TEST(Intervals, AllowForFrictionThatHasNotSettled) {
  Fitted f;
  f.log = test::synthetic_log([&](double, double v, double a) {
    const double slow = std::exp(-std::pow(v / 0.015, 2.0));
    return 250.0 * a + (v > 0.0 ? 40.0 : -40.0) + 900.0 * v + 20.0 * slow * a;
  });
  f.rows = gather(f.log.log, extent_of(f.log.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit first = solve(f.log.log, f.rows, {});
  f.fit = solve(f.log.log, f.rows, {}, &first);
  f.choice = choose_map(f.log.log, f.rows, {}, f.fit, {});
  const Intervals i = intervals(f.log.log, f.rows, {}, f.fit, f.choice, true);
  const double off = std::abs(f.fit.mass - 250.0);
  EXPECT_GT(off, 0.2);
  EXPECT_LT(off, i.factor * i.error_at(0));
}

TEST(Intervals, AJointFitTakesItsOwnLinearTerms) {
  Fitted f = fitted(1, 2.0);
  MapChoice joint = f.choice;
  joint.joint = VectorXd::Constant(1, 251.0);
  EXPECT_EQ(with_terms_of(joint, {}, f.fit).mass, 251.0);
  EXPECT_EQ(with_terms_of(f.choice, {}, f.fit).mass, f.fit.mass);
  const Intervals i = intervals(f.log.log, f.rows, {}, with_terms_of(joint, {}, f.fit), joint, true);
  // Fitted together, the mass is told apart from a whole map instead of from free bins: no worse.
  EXPECT_GT(i.error_at(0), 0.0);
  EXPECT_LT(i.error_at(0), 1.5 * f.intervals.error_at(0));
}

/// Two logs whose gain differs by `share`.
Fitted two_logs(unsigned seed, double share) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Fitted out;
  for (const double mass : {250.0 * (1.0 - share), 250.0 * (1.0 + share)}) {
    test::SyntheticLog one = test::synthetic_log([&](double, double v, double a) {
      return mass * a + (v > 0.0 ? 40.0 : -40.0) + 900.0 * v + 2.0 * normal(engine);
    });
    if (!out.log.log.motions.empty()) {
      out.log.records->push_back(one.records->front());
      out.log.log.force.push_back(one.log.force.front());
      out.log.log.predicted.emplace_back();
      out.log.log.motions.push_back(one.log.motions.front());
    } else {
      out.log = std::move(one);
    }
    out.log.log.records = *out.log.records;
  }
  out.rows = gather(out.log.log, extent_of(out.log.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit first = solve(out.log.log, out.rows, {});
  out.fit = solve(out.log.log, out.rows, {}, &first);
  out.choice = choose_map(out.log.log, out.rows, {}, out.fit, {});
  out.intervals = intervals(out.log.log, out.rows, {}, out.fit, out.choice, true);
  return out;
}

// Student's factor for three records, 4.3, and half of the difference: of two the spread itself is hardly known.
TEST(Intervals, TwoLogsThatDifferTellLittleOfTheSpread) {
  const Fitted f = two_logs(3, 0.02);
  const double half = f.intervals.factor * f.intervals.error_at(0);
  EXPECT_NEAR(half, 4.3 * 0.02 * 250.0, 0.15 * 4.3 * 0.02 * 250.0);
}

TEST(Intervals, TwoLogsThatAgreeAreNotWidened) {
  const Fitted f = two_logs(3, 0.0), one = fitted(1, 2.0);
  EXPECT_LT(f.intervals.error_at(0), 1.5 * one.intervals.error_at(0));
}

}  // namespace
}  // namespace stribeck::ident::drive::intervals_test
