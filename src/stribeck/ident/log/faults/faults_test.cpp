#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/faults/test_faults.hpp>
#include <stribeck/ident/refused.hpp>
#include <utility>

namespace stribeck::ident::log::faults_test {
namespace {

using test::kinds;
using test::strokes;
using test::texts;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string refusal(const RawLog& log) {
  try {
    static_cast<void>(condition(log));
  } catch (const Refused& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(LogFaults, StrokesHaveNone) {
  for (const bool reference : {true, false}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Conditioned c = condition(strokes(seed, reference));
      EXPECT_TRUE(c.findings.empty()) << texts(c);
      EXPECT_NEAR(c.rough.mass, 100.0, 1.0);
    }
  }
}

// At the end of a stroke the axis may settle by a few steps of its encoder from one row to the next: 1.5 um in 2 ms take 1.5 m/s2, twice
// the acceleration of the strokes. A jump of 15 um would take an impact. The axis mostly rests, so that few rows show its acceleration.
TEST(LogFaults, AnAxisThatSettlesByMicrometresDoesNotJump) {
  constexpr std::size_t kRest = 40000;
  for (const auto& [jump, cut] : {std::pair{1.5e-6, false}, std::pair{15e-6, true}}) {
    RawLog log = strokes(1, true);
    for (std::vector<double>* column : {&log.x.t, &log.x.y, &log.r.y, &log.f.y}) {
      for (std::size_t k = 0; 2 * k < column->size(); ++k) (*column)[k] = (*column)[2 * k];
      column->resize((column->size() + 1) / 2);
    }
    const std::size_t moving = log.x.y.size();
    const double x = log.x.y.back();
    for (std::size_t k = 0; k < kRest; ++k) {
      log.x.t.push_back(log.x.t.back() + 2e-3);
      log.x.y.push_back(x + (k % 3 == 0 ? 5e-8 : 0.0) + (k > kRest / 2 ? jump : 0.0));
      log.r.y.push_back(log.r.y.back());
      log.f.y.push_back(log.f.y[moving - 1 - k % 20]);
    }
    const Conditioned c = condition(log);
    EXPECT_EQ(texts(c).find("jumps by") != std::string::npos, cut) << jump << ": " << texts(c);
  }
}

TEST(LogFaults, WrappedPositionBecomesContinuous) {
  for (const double period : {0.02, 2.5e-3}) {
    const RawLog truth = strokes(1, true);
    RawLog log = truth;
    for (double& x : log.x.y) x -= period * std::floor(x / period);
    for (double& r : log.r.y) r -= period * std::floor(r / period);
    const Conditioned c = condition(log);
    EXPECT_THAT(kinds(c), ElementsAre("wrapped")) << texts(c);
    EXPECT_NEAR(c.findings.at(0).values.at(0), period, 1e-3 * period);
    EXPECT_NEAR(c.coverage.x_max - c.coverage.x_min, 0.1, 1e-3);
    EXPECT_NEAR(c.rough.mass, 100.0, 1.0);
  }
}

TEST(LogFaults, SquareWaveIsNotWrapped) {
  RawLog log = strokes(1, true);
  for (std::size_t k = 0; k < log.r.y.size(); ++k) log.r.y[k] = k / 500 % 2 == 0 ? 0.0 : 0.1;
  for (const std::string& kind : kinds(condition(log))) EXPECT_NE(kind, "wrapped");
}

TEST(LogFaults, SpikesOfTheForceAreReplaced) {
  RawLog log = strokes(2, true);
  std::size_t count = 0;
  for (std::size_t k = 200; k + 200 < log.f.y.size(); k += 300, ++count)
    log.f.y[k] = count % 2 == 0 ? 350.0 : -350.0;
  const Conditioned c = condition(log);
  ASSERT_THAT(kinds(c), ElementsAre("spike")) << texts(c);
  EXPECT_EQ(c.findings[0].values.at(2), static_cast<double>(count));
  EXPECT_NEAR(c.rough.coulomb, 20.0, 0.5);
}

// The loop's force is rough while the axis moves and quiet while it stands, which it does nearly always.
TEST(LogFaults, ARoughForceOfAnAxisThatMostlyStandsHasNoSpikes) {
  RawLog log = strokes(2, true);
  const std::size_t moving = log.f.y.size();
  const double T = log.x.t[1] - log.x.t[0];
  for (std::size_t k = 1; k + 1 < moving; ++k) {
    const bool moves = std::abs(log.x.y[k + 1] - log.x.y[k - 1]) > 5e-6;
    const double size = k % 50 == 0 ? 60.0 : 12.0;
    if (moves) log.f.y[k] += (k % 2 == 0 ? 1.0 : -1.0) * size;
  }
  for (std::size_t k = 0; k < 30 * moving; ++k) {
    const double by[3] = {0.0, 0.0, k % 2 == 0 ? 0.02 : -0.02};
    std::size_t i = 0;
    for (Signal* s : {&log.x, &log.r, &log.f}) {
      if (!s->t.empty()) s->t.push_back(s->t.back() + T);
      s->y.push_back(s->y[moving - 1] + by[i++]);
    }
  }
  for (const std::string& kind : kinds(condition(log))) EXPECT_NE(kind, "spike");
}

// Twenty newtons of friction beside the range of a motion that accelerates: zero is no spike, but no force either.
TEST(LogFaults, SingleZerosOfTheForceAreLostValues) {
  RawLog log = strokes(2, true);
  std::size_t count = 0;
  for (std::size_t k = 201; k + 1 < log.f.y.size(); k += 97) {
    if (std::min(std::abs(log.f.y[k - 1]), std::abs(log.f.y[k + 1])) < 15.0) continue;
    log.f.y[k] = 0.0;
    ++count;
  }
  const Conditioned c = condition(log);
  ASSERT_THAT(kinds(c), ElementsAre("spike")) << texts(c);
  EXPECT_EQ(c.findings[0].values.at(2), static_cast<double>(count));
  EXPECT_NEAR(c.rough.coulomb, 20.0, 0.5);
}

TEST(LogFaults, PushToWhichTheMotionAnswersStays) {
  // One row of 300 N gives 100 kg a speed of 3 mm/s.
  RawLog log = strokes(2, false);
  double added = 0.0;
  for (std::size_t k = 0; k < log.x.y.size(); ++k) {
    if (k == 2500) log.f.y[k] = 300.0;
    if (k > 2500 && k < 2600) added += 3e-6;
    log.x.y[k] += added;
  }
  for (const std::string& kind : kinds(condition(log))) EXPECT_NE(kind, "spike");
}

/// The log with the force of row k + late + rate·k, by straight lines between rows.
RawLog with_force_moved(const RawLog& log, double late, double rate) {
  RawLog out = log;
  const double last = static_cast<double>(log.f.y.size() - 1);
  for (std::size_t k = 0; k < out.f.y.size(); ++k) {
    const double at = std::clamp(static_cast<double>(k) * (1.0 + rate) + late, 0.0, last - 1.0);
    const auto before = static_cast<std::size_t>(at);
    const double part = at - static_cast<double>(before);
    out.f.y[k] = (1.0 - part) * log.f.y[before] + part * log.f.y[before + 1];
  }
  return out;
}

// Two devices: the fit searches delays of a drive, up to 30 ms.
TEST(LogFaults, AForceOfAnotherDeviceIsMovedToItsMotion) {
  const RawLog log = strokes(4, true);
  const double T = log.x.t[1] - log.x.t[0];
  for (const double late : {0.04, -0.15}) {
    const Conditioned c = condition(with_force_moved(log, -late / T, 0.0));
    ASSERT_THAT(kinds(c), ElementsAre("late")) << texts(c);
    EXPECT_NEAR(c.findings[0].values.at(0), late, 1.5 * T);
    EXPECT_THAT(c.findings[0].text,
                HasSubstr(late > 0.0 ? "later than the motion" : "earlier than the motion"));
    EXPECT_NEAR(c.rough.mass, 100.0, 2.0);
    EXPECT_EQ(c.records.at(0).x.size(), c.records.at(0).f.size());
  }
  EXPECT_TRUE(condition(with_force_moved(log, -0.01 / T, 0.0)).findings.empty());
}

TEST(LogFaults, AForceOfAClockThatRunsFasterIsStretched) {
  const RawLog log = strokes(4, true);
  const double rows = static_cast<double>(log.f.y.size());
  const Conditioned c = condition(with_force_moved(log, 0.0, -30.0 / rows));
  ASSERT_THAT(kinds(c), ElementsAre("late")) << texts(c);
  EXPECT_NEAR(c.findings[0].values.at(1), 30.0 / rows, 2.0 / rows);
  EXPECT_NEAR(c.rough.mass, 100.0, 2.0);
}

TEST(LogFaults, ExchangedColumnsAreChangedBack) {
  const RawLog truth = strokes(3, true);
  RawLog log = truth;
  std::swap(log.x.y, log.r.y);
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), ElementsAre("exchanged")) << texts(c);
  EXPECT_TRUE(c.findings.at(0).repaired);
  EXPECT_NEAR(c.findings.at(0).values.at(0), -6e-3, 1e-3);
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_EQ(c.records[0].x, truth.x.y);
}

// The reference itself has no encoder and answers to no force.
TEST(LogFaults, AReferenceLoggedAsPositionIsNamed) {
  const RawLog truth = strokes(3, true);
  RawLog log = truth;
  log.x.y = truth.r.y;
  log.r.y.clear();
  EXPECT_THAT(kinds(condition(log)), ElementsAre("too-smooth"));
  log.r.y = truth.r.y;  // the same command twice
  const Conditioned twice = condition(log);
  ASSERT_THAT(kinds(twice), ElementsAre("commanded")) << texts(twice);
  EXPECT_THAT(twice.findings[0].text, HasSubstr("the position has the value of its reference in"));
  log.r.y.clear();
  log.x.y = truth.x.y;
  EXPECT_THAT(kinds(condition(log)), ElementsAre());
}

TEST(LogFaults, WrongScalesAreRefused) {
  RawLog log = strokes(4, false);
  for (double& x : log.x.y) x *= 1e3;
  EXPECT_THAT(refusal(log), ::testing::AllOf(HasSubstr("a speed of 1"), HasSubstr("mm for m")));
  for (double& x : log.x.y) x *= 1e-6;
  const Conditioned small = condition(log);
  EXPECT_THAT(kinds(small), ElementsAre("scale")) << texts(small);
  log = strokes(4, false);
  for (double& t : log.x.t) t *= 1e3;
  EXPECT_THAT(refusal(log), HasSubstr("mass of"));
  log = strokes(4, false);
  for (double& t : log.x.t) t *= 1e-3;
  EXPECT_THAT(refusal(log), HasSubstr("a speed of"));
}

TEST(LogFaults, SmoothedForceIsNamed) {
  RawLog log = strokes(5, true);
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * 20.0 * 1e-3);
  double y = 0.0;
  for (double& f : log.f.y) f = y += share * (f - y);
  const Conditioned c = condition(log);
  ASSERT_THAT(kinds(c), ElementsAre("smoothed")) << texts(c);
  EXPECT_FALSE(c.findings[0].repaired);
  EXPECT_NEAR(c.findings[0].values.at(0), 8e-3, 2e-3);  // 1/(2 pi 20 Hz)
}

TEST(LogFaults, LateForceIsNotSmoothed) {
  for (const std::size_t rows : {3, 8, 20}) {
    RawLog log = strokes(5, true);
    log.f.y.insert(log.f.y.begin(), rows, log.f.y.front());
    log.f.y.resize(log.x.y.size());
    const Conditioned c = condition(log);
    EXPECT_TRUE(c.findings.empty()) << rows << "\n" << texts(c);
  }
}

TEST(LogFaults, LineIsNamed) {
  for (const double hertz : {50.0, 37.0}) {
    RawLog log = strokes(6, true);
    for (std::size_t k = 0; k < log.f.y.size(); ++k)
      log.f.y[k] += 15.0 * std::sin(2.0 * std::numbers::pi * hertz * log.x.t[k] + 0.3);
    const Conditioned c = condition(log);
    ASSERT_THAT(kinds(c), ElementsAre("line")) << texts(c);
    EXPECT_NEAR(c.findings[0].values.at(0), hertz, 0.5);
    EXPECT_NEAR(c.findings[0].values.at(1), 15.0, 3.0);
    EXPECT_EQ(c.findings[0].text.find("mains") != std::string::npos, hertz == 50.0);
  }
}

TEST(LogFaults, RippleOfAScrewIsNoLine) {
  RawLog log = strokes(7, true);
  for (std::size_t k = 0; k < log.f.y.size(); ++k)
    log.f.y[k] += 8.0 * std::sin(2.0 * std::numbers::pi * log.x.y[k] / 2.5e-3);
  const Conditioned c = condition(log);
  EXPECT_TRUE(c.findings.empty()) << texts(c);
}

/// Rows that the logger lost.
RawLog without_rows(RawLog log, std::size_t first, std::size_t count) {
  for (std::vector<double>* c : {&log.x.t, &log.x.y, &log.r.y, &log.f.y}) {
    const auto from = c->begin() + static_cast<std::ptrdiff_t>(first);
    c->erase(from, from + static_cast<std::ptrdiff_t>(count));
  }
  return log;
}

TEST(LogFaults, AClockIsStraightenedBeyondAGap) {
  const RawLog log = strokes(4, true);
  const double rows = static_cast<double>(log.f.y.size());
  const Conditioned c = condition(without_rows(with_force_moved(log, 0.0, -30.0 / rows), 3000, 150));
  ASSERT_EQ(c.records.size(), 2U) << texts(c);
  EXPECT_THAT(kinds(c), ::testing::Contains("late")) << texts(c);
  // In the second piece too the force is that of its row: before, it was 15 rows late.
  const auto& second = c.records.back();
  const RawLog truth = strokes(4, true);
  double off = 0.0;
  for (std::size_t k = 200; k + 200 < second.f.size(); ++k) {
    const auto row = static_cast<std::size_t>(std::lround(second.t[k] / second.sample_time));
    off += std::abs(second.f[k] - truth.f.y[row]) / static_cast<double>(second.f.size());
  }
  EXPECT_LT(off, 2.0);
}

}  // namespace
}  // namespace stribeck::ident::log::faults_test
