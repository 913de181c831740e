#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::log::condition_drive_test {
namespace {

using ::testing::HasSubstr;

/// An axis of 100 kg and 20 N of friction that goes to and fro by 20 mm and stands between its motions.
struct Strokes {
  double period = 1e-3;   ///< [s]
  double moving = 0.5;    ///< [s]
  double standing = 0.3;  ///< [s]
  RawLog log{};
  double at = 0.0;  ///< [m]
  std::mt19937_64 engine{3};
  std::normal_distribution<double> normal{};

  Strokes() { log.source = "log.csv"; }

  void row(double x, double f) {
    log.x.t.push_back(period * static_cast<double>(log.x.t.size()));
    log.x.y.push_back(1e-7 * std::round(1e7 * x));
    log.f.y.push_back(f);
  }
  /// A motion of least jerk; `pushed`: by hand, with the drive off.
  void move(double way, double time, bool pushed = false) {
    const int rows = static_cast<int>(std::lround(time / period));
    for (int k = 0; k < rows; ++k) {
      const double s = (k + 0.5) / rows;
      const double v = 30.0 * s * s * (1.0 - s) * (1.0 - s) * way / time;
      const double a = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * way / (time * time);
      const double f = 100.0 * a + 200.0 * v + 20.0 * std::tanh(v / 1e-3) + 0.3 * normal(engine);
      row(at + way * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), pushed ? 0.0 : f);
    }
    at += way;
  }
  /// Friction holds the axis: the force keeps the value that it had.
  void stand() {
    const double f = log.f.y.empty() ? 12.0 : log.f.y.back();
    for (int k = 0; k < static_cast<int>(std::lround(standing / period)); ++k) row(at, f);
  }
  void run(int strokes) {
    for (int n = 0; n < strokes; ++n) {
      move(n % 2 == 0 ? 0.02 : -0.02, moving);
      stand();
    }
  }
};

const Finding* found(const Conditioned& c, const std::string& kind) {
  const auto at =
      std::find_if(c.findings.begin(), c.findings.end(), [&](const Finding& f) { return f.kind == kind; });
  return at == c.findings.end() ? nullptr : &*at;
}

TEST(ConditionDrive, RowsInWhichTheAxisIsPushedAreCutOut) {
  Strokes s;
  s.run(6);
  const double from = s.period * static_cast<double>(s.log.x.t.size());
  s.move(0.005, 0.4, true);
  s.stand();  // still off
  const double to = s.period * static_cast<double>(s.log.x.t.size());
  s.run(6);
  const Conditioned c = condition(s.log);
  const Finding* off = found(c, "drive-off");
  ASSERT_NE(off, nullptr);
  EXPECT_THAT(off->text, HasSubstr("the force is exactly 0 while the axis sets out and moves by 5 mm"));
  ASSERT_EQ(c.records.size(), 2u);
  EXPECT_NEAR(c.records[0].t.back(), from, 2.0 * s.period);
  EXPECT_NEAR(c.records[1].t.front(), to, 2.0 * s.period);
  // Left alone, they stay.
  EXPECT_EQ(found(condition(s.log, {.keep = {"drive-off"}}), "drive-off"), nullptr);
}

// A drive that reports its force in counts: at constant speed it keeps one value for long. It was cut out as a stuck channel.
TEST(ConditionDrive, AForceInCountsMayStayAtConstantSpeed) {
  const auto strokes = [](bool stuck) {
    Strokes s;
    for (int n = 0; n < 40; ++n) s.move(n % 2 == 0 ? 0.02 : -0.02, 0.5);
    for (const double side : {1.0, -1.0}) {
      double v = 0.0;
      for (int k = 0; k < 900; ++k) {
        const int into = k < 300 ? k : std::max(0, k - 600);
        const double wave = k >= 300 && k < 600 ? 0.0 : std::pow(std::sin(kPi * into / 300.0), 2.0);
        const double a = (k < 300 ? 0.5 : -0.5) * wave;
        v += a * s.period;
        s.at += side * v * s.period;
        const bool held = stuck && k >= 250 && k < 600;
        s.row(s.at,
              held ? s.log.f.y.back() : side * (100.0 * a + 200.0 * v + 20.0) + 0.01 * s.normal(s.engine));
      }
    }
    for (double& f : s.log.f.y) f = 0.2 * std::round(f / 0.2);
    return condition(s.log);
  };
  EXPECT_EQ(found(strokes(false), "stuck"), nullptr);
  EXPECT_NE(found(strokes(true), "stuck"), nullptr);
}

// All pieces between the pushes are too short: the rows stayed, though the note said that they were cut off.
TEST(ConditionDrive, NothingIsLeftBetweenPushes) {
  Strokes s;
  s.period = 5e-3, s.moving = 0.3, s.standing = 0.15;
  for (int n = 0; n < 3; ++n) {
    s.run(1);  // 90 rows
    s.move(0.002, 0.11, true);
  }
  try {
    static_cast<void>(condition(s.log));
    ADD_FAILURE() << "accepted";
  } catch (const Refused& e) {
    EXPECT_THAT(e.what(), HasSubstr("log.csv: the rows in which the force is exactly 0"));
    EXPECT_THAT(e.what(), HasSubstr("--keep drive-off"));
  }
}

// At rest the force keeps its value for longer than at its limit, which hid that it is cut off.
TEST(ConditionDrive, AForceThatIsCutOffIsFoundBetweenRests) {
  Strokes s;
  s.run(12);
  EXPECT_EQ(found(condition(s.log), "saturated"), nullptr);
  std::size_t cut = 0;
  for (double& f : s.log.f.y) {
    if (f > 50.0) f = 50.0, ++cut;
  }
  ASSERT_GT(cut, 100u);
  const Conditioned c = condition(s.log);
  const Finding* limit = found(c, "saturated");
  ASSERT_NE(limit, nullptr);
  EXPECT_EQ(limit->values.at(0), 50.0);
  EXPECT_EQ(static_cast<std::size_t>(limit->values.at(1)), cut);
}

}  // namespace
}  // namespace stribeck::ident::log::condition_drive_test
