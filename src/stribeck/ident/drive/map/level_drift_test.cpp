#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <stribeck/ident/drive/intervals/intervals.hpp>
#include <stribeck/ident/drive/map/level_drift.hpp>
#include <string>

namespace stribeck::ident::drive::level_drift_test {
namespace {

constexpr double kStep = 2e-3;       // s
constexpr double kWarmingTime = 40;  // s
constexpr int kJogs = 10;
constexpr double kSlowest = 0.01;  // m/s, of the jogs: kSlowest, 2·kSlowest, …
constexpr double kJogTime = 8.0;   // s to and fro

/// An axis that is cold at the beginning of each record: friction falls by `warming` with the time constant above.
struct Axis {
  std::unique_ptr<std::vector<log::Record>> records = std::make_unique<std::vector<log::Record>>();
  AlignedLog log;
  double warming = 0.0;
  std::mt19937_64 engine{7};

  static double cold(double v) { return 40.0 + 300.0 * std::abs(v); }
  [[nodiscard]] double level(double t) const { return 1.0 - warming * (1.0 - std::exp(-t / kWarmingTime)); }

  void add(double duration, const std::function<double(double)>& velocity) {
    std::normal_distribution<double> normal;
    log::Record rec;
    log::Motion m;
    rec.source = "formula " + std::to_string(records->size()), rec.sample_time = m.sample_time = kStep;
    double x = 0.0, reversal = 0.0;
    int stretch = 0;
    for (double t = 0.0; t < duration; t += kStep) {
      const double v = velocity(t), a = (velocity(t + 0.5 * kStep) - velocity(t - 0.5 * kStep)) / kStep;
      const auto direction = static_cast<std::int8_t>(v > 0.0 ? 1 : -1);
      if (!m.direction.empty() && direction != m.direction.back()) {
        ++stretch, reversal = x;
        m.reversals.push_back(m.rows());
      }
      m.x.push_back(x), m.v.push_back(v), m.a.push_back(a), m.instrument.push_back(a);
      m.direction.push_back(direction), m.stretch.push_back(stretch),
          m.distance.push_back(std::abs(x - reversal));
      m.f.push_back(100.0 * a + direction * cold(v) * level(t) + 0.4 * normal(engine));
      rec.t.push_back(t), rec.x.push_back(x), rec.f.push_back(m.f.back());
      x += v * kStep;
    }
    m.stroke = 0.4, m.reach = 1;
    records->push_back(std::move(rec));
    log.force.push_back(m.f);
    log.predicted.emplace_back();
    log.motions.push_back(std::move(m));
    log.records = *records;
  }
};

/// Jogs from slow to fast, and a sine through all speeds as a log of its own.
Axis jogs_and_sine(double warming) {
  Axis axis;
  axis.warming = warming;
  axis.add(kJogs * kJogTime, [](double t) {
    const double speed = kSlowest * (1.0 + std::floor(t / kJogTime));
    return std::fmod(t, kJogTime) < 0.5 * kJogTime ? speed : -speed;
  });
  axis.add(40.0, [](double t) { return 0.105 * std::sin(0.7 * t + 0.3); });
  return axis;
}

struct Fitted {
  Rows rows;
  MapChoice choice;
  LevelDrift drift;
};
Fitted fitted(const Axis& axis) {
  Fitted out;
  out.rows = gather(axis.log, extent_of(axis.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit first = solve(axis.log, out.rows, {});
  const LinearFit fit = solve(axis.log, out.rows, {}, &first);
  out.choice = choose_map(axis.log, out.rows, {}, fit, {});
  const Intervals found = intervals(axis.log, out.rows, {}, fit, out.choice, true);
  out.drift = LevelDrift(axis.log, out.rows, out.choice.map.fit, found.residual);
  return out;
}

// Friction falls by a tenth; the slow jogs are cold, the fast ones warm.
TEST(LevelDrift, ReachesFromTheFrictionOfTheRowsToTheMeanOverTime) {
  const Axis axis = jogs_and_sine(0.15);
  const Fitted f = fitted(axis);
  ASSERT_TRUE(f.drift.found());
  double mean = 0.0, rows = 0.0, widest = 0.0;
  for (const log::Record& r : *axis.records) {
    for (const double t : r.t) mean += axis.level(t), rows += 1.0;
  }
  mean /= rows;
  for (int s = 0; s < map::kSides; ++s) {
    for (int j = 1; j <= kJogs; ++j) {
      const double speed = kSlowest * j;
      const double error = f.choice.map.fit.force(s, speed) / (Axis::cold(speed) * mean) - 1.0;
      // 0.5 %: what noise and the choice of the map leave on a log without drift.
      EXPECT_LT(std::abs(error), f.drift.at(s, speed) + 0.005) << speed << " m/s";
      widest = std::max(widest, f.drift.at(s, speed));
    }
  }
  EXPECT_LT(widest, 0.15);  // of the mean no time is farther away than the whole drift
  EXPECT_GT(widest, 0.02);
}

// The same log at its mean level: the slow jogs come down, the fast ones go up.
TEST(LevelDrift, IsTakenOutOfTheForce) {
  Axis axis = jogs_and_sine(0.15);
  const Fitted before = fitted(axis);
  ASSERT_TRUE(before.drift.found());
  const std::vector<log::Record> level = at_mean_level(axis.log, before.drift, 100.0, 0.0);
  double mean = 0.0, rows = 0.0;
  for (const log::Record& r : *axis.records) {
    for (const double t : r.t) mean += axis.level(t), rows += 1.0;
  }
  mean /= rows;
  for (std::size_t n = 0; n < level.size(); ++n) axis.log.force[n] = axis.log.motions[n].f = level[n].f;
  const Fitted after = fitted(axis);
  double worst_before = 0.0, worst_after = 0.0;
  for (int s = 0; s < map::kSides; ++s) {
    for (int j = 1; j <= kJogs; ++j) {
      const double truth = Axis::cold(kSlowest * j) * mean;
      const auto error = [&](const Fitted& f) {
        return std::abs(f.choice.map.fit.force(s, kSlowest * j) / truth - 1.0);
      };
      worst_before = std::max(worst_before, error(before)), worst_after = std::max(worst_after, error(after));
      EXPECT_LT(before.drift.unsure(s, kSlowest * j), before.drift.at(s, kSlowest * j));
    }
  }
  EXPECT_GT(worst_before, 0.02);
  EXPECT_LT(worst_after, 0.5 * worst_before);
}

// Single strokes, each at a speed of its own: no speed occurs at two times.
TEST(LevelDrift, ShowsBetweenNeighbouringSpeeds) {
  constexpr int kStrokes = 40;
  for (const double warming : {0.25, 0.0}) {
    Axis axis;
    axis.warming = warming;
    axis.add(2.0 * kStrokes, [](double t) {
      const double k = std::floor(0.5 * t);
      const double speed = 0.01 + 0.09 * std::fmod(0.618 * k, 1.0);
      return std::fmod(t, 2.0) < 1.0 ? speed : -speed;
    });
    const Fitted f = fitted(axis);
    EXPECT_EQ(f.drift.found(), warming > 0.0);
    const double mean = 0.25 * (axis.level(0.0) + 2.0 * axis.level(40.0) + axis.level(80.0));
    EXPECT_NEAR(f.drift.rise(0), (axis.level(80.0) - axis.level(0.0)) / mean, 0.03);
  }
}

TEST(LevelDrift, IsNothingWhereTheLevelStays) {
  const Fitted f = fitted(jogs_and_sine(0.0));
  EXPECT_FALSE(f.drift.found());
  EXPECT_EQ(f.drift.at(0, 0.05), 0.0);
}

}  // namespace
}  // namespace stribeck::ident::drive::level_drift_test
