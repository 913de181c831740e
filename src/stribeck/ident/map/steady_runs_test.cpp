#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::map::steady_runs_test {
namespace {

using ::testing::HasSubstr;

constexpr double kStep = 0.002;

struct Stretch {
  double speed;  // [m/s]
  double time;   // [s]
};

/// Stretches of constant speed one after the other; force(x, v, time since the last reversal) with white noise [N].
log::Record moved(const std::vector<Stretch>& stretches,
                  const std::function<double(double, double, double)>& force, double noise = 0.5) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  log::Record rec;
  rec.source = "jog.csv";
  rec.sample_time = kStep;
  double x = 0.0, since = 0.0, before = 0.0;
  for (const Stretch& s : stretches) {
    if (s.speed * before < 0.0) since = 0.0;
    before = s.speed;
    for (int k = 0; k < static_cast<int>(std::lround(s.time / kStep)); ++k) {
      rec.t.push_back(kStep * static_cast<double>(rec.t.size()));
      rec.x.push_back(x), rec.r.push_back(x);
      rec.f.push_back(force(x, s.speed, since) + noise * normal(engine));
      x += kStep * s.speed;
      since += kStep;
    }
  }
  return rec;
}

double friction(double, double v, double) { return (v > 0.0 ? 40.0 : -40.0) + 3000.0 * v; }

const std::vector<Stretch> kJog{{1e-3, 4.0},  {-1e-3, 4.0}, {2e-3, 4.0},
                                {-2e-3, 4.0}, {5e-3, 4.0},  {-5e-3, 4.0}};

SteadyOptions without_period() {
  SteadyOptions o;
  o.period = 0.0;
  return o;
}

TEST(SteadyRuns, AreFoundByThemselves) {
  const SteadyRuns found = find_steady_runs({moved(kJog, friction)}, without_period());
  ASSERT_EQ(found.runs.size(), kJog.size());
  for (std::size_t i = 0; i < kJog.size(); ++i) {
    const SteadyRun& run = found.runs[i];
    EXPECT_NEAR(run.speed, kJog[i].speed, 1e-9);
    EXPECT_NEAR(run.force, friction(0.0, kJog[i].speed, 0.0), 5.0 * run.error) << i;
    // White noise: σ/√n.
    const double rows = static_cast<double>(run.last - run.first + 1);
    EXPECT_NEAR(run.error, 0.5 / std::sqrt(rows), 0.35 * 0.5 / std::sqrt(rows)) << i;
    EXPECT_NEAR(run.way, std::abs(run.speed) * kStep * (rows - 1.0), 1e-9);
  }
  EXPECT_FALSE(found.periodic);
}

TEST(SteadyRuns, TheBeginningSettles) {
  SteadyOptions options = without_period();
  options.settle = 0.8;
  const SteadyRuns found = find_steady_runs({moved(kJog, friction)}, options);
  ASSERT_EQ(found.runs.size(), kJog.size());
  for (std::size_t i = 1; i < found.runs.size(); ++i) {
    const double begin = kStep * static_cast<double>(found.runs[i].first);
    EXPECT_GE(begin, 4.0 * static_cast<double>(i) + 0.7) << i;
    EXPECT_LE(begin, 4.0 * static_cast<double>(i) + 1.0) << i;
  }
}

TEST(SteadyRuns, TheDistanceAfterAReversalIsLeftOut) {
  SteadyOptions options = without_period();
  options.exclude = 3e-3;
  const log::Record rec = moved(kJog, friction);
  const SteadyRuns found = find_steady_runs({rec}, options);
  EXPECT_EQ(found.exclude, 3e-3);
  ASSERT_EQ(found.runs.size(), kJog.size());
  for (std::size_t i = 1; i < found.runs.size(); ++i) {
    const auto reversal = static_cast<std::size_t>(std::lround(4.0 * static_cast<double>(i) / kStep));
    EXPECT_GE(std::abs(rec.x[found.runs[i].first] - rec.x[reversal]), 3e-3 - 1e-5) << i;
  }
}

TEST(SteadyRuns, ATooShortOneIsNamed) {
  std::vector<Stretch> stretches = kJog;
  stretches.insert(stretches.begin() + 2, {8e-3, 0.6});
  const SteadyRuns found = find_steady_runs({moved(stretches, friction)}, without_period());
  EXPECT_EQ(found.runs.size(), kJog.size());
  EXPECT_THAT(found.notes, ::testing::Contains(HasSubstr("jog.csv: 8 mm/s from")));
}

// The relaxation length of Dahl friction is seen at the slow runs, and six of it are left out.
TEST(SteadyRuns, SeeTheBristleAfterReversals) {
  constexpr double kLength = 0.2e-3;
  const auto dahl = [](double x, double v, double since) {
    return friction(x, v, 0.0) - (v > 0.0 ? 80.0 : -80.0) * std::exp(-std::abs(v) * since / kLength);
  };
  const SteadyRuns found = find_steady_runs({moved(kJog, dahl)}, without_period());
  EXPECT_NEAR(found.relaxation, kLength, 0.3 * kLength);
  EXPECT_DOUBLE_EQ(found.exclude, 6.0 * found.relaxation);
}

// The mean of a stretch that is no whole number of periods long is not biased by the term.
TEST(SteadyRuns, APeriodicTermIsTakenOff) {
  constexpr double kPeriod = 2.3e-3;
  const auto screw = [](double x, double v, double) {
    return friction(x, v, 0.0) + 6.0 * std::sin(2.0 * kPi * x / kPeriod - 0.4);
  };
  const SteadyRuns found = find_steady_runs({moved(kJog, screw)});
  ASSERT_TRUE(found.periodic);
  EXPECT_NEAR(found.periodic->period, kPeriod, 0.01 * kPeriod);
  EXPECT_NEAR(found.periodic->amplitude, 6.0, 0.2);
  EXPECT_NEAR(found.periodic->phase, 0.4, 0.1);
  EXPECT_EQ(found.periodic->form, friction::EccentricForm::kAdditive);
  for (const SteadyRun& run : found.runs)
    EXPECT_NEAR(run.force, friction(0.0, run.speed, 0.0), 0.3) << run.speed;

  SteadyOptions known;
  known.period = kPeriod;
  const SteadyRuns given = find_steady_runs({moved(kJog, screw)}, known);
  ASSERT_TRUE(given.periodic);
  EXPECT_DOUBLE_EQ(given.periodic->period, kPeriod);
}

// The top of a sine is no constant speed.
TEST(SteadyRuns, ASineHasNone) {
  log::Record rec;
  rec.source = "sine.csv";
  rec.sample_time = kStep;
  for (int k = 0; k < 10000; ++k) {
    const double t = kStep * k;
    rec.t.push_back(t);
    rec.x.push_back(0.02 * std::sin(t)), rec.r.push_back(rec.x.back());
    rec.f.push_back(std::cos(t) > 0.0 ? 40.0 : -40.0);
  }
  EXPECT_TRUE(find_steady_runs({rec}).runs.empty());
}

TEST(SteadyRuns, AVelocityIsIntegratedWhereThereIsNoPosition) {
  log::Record rec = moved(kJog, friction);
  const std::vector<double> x = rec.x;
  rec.x.clear();
  rec.r.clear();
  for (std::size_t k = 0; k < x.size(); ++k)
    rec.v.push_back(k + 1 < x.size() ? (x[k + 1] - x[k]) / kStep : 0.0);
  const log::Record whole = with_positions(rec);
  ASSERT_EQ(whole.x.size(), x.size());
  for (std::size_t k = 0; k < x.size(); k += 500) EXPECT_NEAR(whole.x[k] - whole.x[0], x[k], 2e-5) << k;
}

TEST(SteadyRuns, ABadRecordIsRefused) {
  log::Record rec = moved(kJog, friction);
  rec.f[17] = std::nan("");
  EXPECT_THAT([&] { find_steady_runs({rec}); }, ::testing::ThrowsMessage<Refused>(HasSubstr("row 17")));
}

// The fast runs were cut by the limit of the force: their rows are marked, and their means would be too low.
TEST(SteadyRuns, ARunWhoseRowsAreNotFittedIsLeftOut) {
  log::Record rec = moved(kJog, friction);
  rec.skip.assign(rec.f.size(), 0);
  for (std::size_t k = 0; k < rec.f.size(); ++k) {
    const bool fast = k + 1 < rec.x.size() && std::abs(rec.x[k + 1] - rec.x[k]) > 4e-3 * kStep;
    if (fast) rec.f[k] = std::copysign(44.0, rec.f[k]), rec.skip[k] = 1;
    if (!fast && k % 40 == 0) rec.f[k] = 1e3, rec.skip[k] = 1;  // single ones
  }
  const SteadyRuns found = find_steady_runs({rec}, without_period());
  ASSERT_EQ(found.runs.size(), kJog.size() - 2);
  for (const SteadyRun& run : found.runs)
    EXPECT_NEAR(run.force, friction(0.0, run.speed, 0.0), 5.0 * run.error) << run.speed;
  EXPECT_THAT(found.notes, ::testing::Contains(HasSubstr("rows are not fitted; left out")));
}

}  // namespace
}  // namespace stribeck::ident::map::steady_runs_test
