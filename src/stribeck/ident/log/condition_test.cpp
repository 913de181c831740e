#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/test_runs.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::log::condition_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

constexpr double kTau = 2.0 * std::numbers::pi;

/// A log whose law is known: x from two sines, f = m·a + c·v + F·sgn v + f0 with white noise, 1 ms.
struct Axis {
  double mass = 100.0;
  double viscous = 200.0;
  double coulomb = 20.0;
  double load = 0.0;
  double noise = 0.5;
  double sample_time = 1e-3;
  std::size_t rows = 8000;

  [[nodiscard]] double x(double t) const {
    return 0.04 * std::sin(kTau * 0.5 * t) + 0.006 * std::sin(kTau * 1.7 * t + 0.4);
  }
  [[nodiscard]] double v(double t) const {
    return 0.04 * kTau * 0.5 * std::cos(kTau * 0.5 * t) + 0.006 * kTau * 1.7 * std::cos(kTau * 1.7 * t + 0.4);
  }
  [[nodiscard]] double a(double t) const {
    return -0.04 * std::pow(kTau * 0.5, 2) * std::sin(kTau * 0.5 * t) -
           0.006 * std::pow(kTau * 1.7, 2) * std::sin(kTau * 1.7 * t + 0.4);
  }
  [[nodiscard]] double force(double t) const {
    const double vt = v(t);
    return mass * a(t) + viscous * vt + coulomb * std::tanh(vt / 1e-3) + load;
  }
};

RawLog logged(const Axis& axis = {}, std::uint64_t seed = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  RawLog log;
  log.source = "log.csv";
  for (std::size_t k = 0; k < axis.rows; ++k) {
    const double t = axis.sample_time * static_cast<double>(k);
    log.x.t.push_back(t);
    log.x.y.push_back(1e-7 * std::round(axis.x(t) * 1e7));
    log.v.y.push_back(axis.v(t) + 1e-5 * normal(engine));
    log.f.y.push_back(axis.force(t) + axis.noise * normal(engine));
  }
  return log;
}

void erase(RawLog& log, std::size_t first, std::size_t last) {
  for (std::vector<double>* c : {&log.x.t, &log.x.y, &log.r.y, &log.v.y, &log.f.y}) {
    if (!c->empty())
      c->erase(c->begin() + static_cast<std::ptrdiff_t>(first),
               c->begin() + static_cast<std::ptrdiff_t>(last));
  }
}

std::vector<std::string> kinds(const Conditioned& c) {
  std::vector<std::string> out;
  for (const Finding& f : c.findings) out.push_back(f.kind);
  return out;
}

std::string texts(const Conditioned& c) {
  std::string out;
  for (const Finding& f : c.findings) out += f.kind + ": " + f.text + "\n";
  return out;
}

/// The only finding, of this kind.
const Finding& only(const Conditioned& c, const std::string& kind) {
  EXPECT_EQ(kinds(c), std::vector<std::string>{kind}) << texts(c);
  static const Finding none;
  return c.findings.empty() ? none : c.findings.front();
}

std::string refusal(const RawLog& log) {
  try {
    static_cast<void>(condition(log));
  } catch (const Refused& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

RawLog raw(const Record& record) {
  RawLog log;
  log.source = record.source;
  log.x = {record.t, record.x};
  log.r.y = record.r;
  log.f.y = record.f;
  log.loop = record.loop;
  return log;
}

// ---- no false alarm ----

TEST(Condition, CleanLogHasNoFinding) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const double load : {0.0, -60.0, 300.0}) {
      Axis axis;
      axis.load = load;
      const Conditioned c = condition(logged(axis, seed));
      EXPECT_TRUE(c.findings.empty()) << "seed " << seed << " load " << load << "\n" << texts(c);
      ASSERT_EQ(c.records.size(), 1U);
      EXPECT_EQ(c.records[0].x.size(), 8000U);
      EXPECT_TRUE(c.records[0].skip.empty());
      EXPECT_TRUE(problems(c.records[0]).empty());
    }
  }
}

TEST(Condition, CleanLogsOfTheVirtualDriveHaveNoFinding) {
  test::Drive drive;
  drive.friction = test::table_2_3('x');
  // Sine in closed loop.
  const Record sine = test::run_closed(drive, 57e3, test::sine_reference(0.005, 0.02, 0.475, 2), 3);
  // Jogs with rests between, as they are commanded.
  std::vector<double> jog;
  double at = 0.0;
  for (const double speed : {0.1e-3, -0.1e-3, 1e-3, -1e-3, 5e-3, -5e-3}) {
    for (int k = 0; k < 300; ++k)
      jog.push_back(at +=
                    0.005 * speed * std::clamp(k / 20.0, 0.0, 1.0) * (k < 280 ? 1.0 : (300 - k) / 20.0));
    for (int k = 0; k < 100; ++k) jog.push_back(at);
  }
  const Record jogs = test::run_closed(drive, 57e3, jog, 4);
  // Pulses in open loop, exact zeros between them.
  const Record pulses = test::run(drive, 20.0, 5, [](std::size_t k, double, double) {
    const std::size_t phase = k % 800;
    const double sign = phase < 400 ? 1.0 : -1.0;
    const std::size_t p = phase % 400;
    return sign * 2500.0 *
           (p < 20    ? static_cast<double>(p) / 20.0
            : p < 100 ? 1.0
            : p < 120 ? static_cast<double>(120 - p) / 20.0
                      : 0.0);
  });
  for (const Record* r : {&sine, &jogs, &pulses}) {
    const Conditioned c = condition(raw(*r));
    EXPECT_TRUE(c.findings.empty()) << texts(c);
    EXPECT_EQ(c.records.size(), 1U);
    EXPECT_EQ(c.records[0].f, r->f);
    EXPECT_EQ(c.records[0].x, r->x);
  }
}

// ---- time ----

TEST(Condition, GapIsCutThere) {
  RawLog log = logged();
  erase(log, 3000, 3500);
  const Conditioned c = condition(log);
  const Finding& f = only(c, "gap");
  EXPECT_EQ(f.row, 3001U);
  EXPECT_NEAR(f.time, 3.5, 1e-9);
  EXPECT_TRUE(f.repaired);
  ASSERT_EQ(c.records.size(), 2U);
  EXPECT_EQ(c.records[0].x.size(), 3000U);
  EXPECT_EQ(c.records[1].x.size(), 4500U);
  EXPECT_EQ(c.rows[1].front(), 3001U);
  EXPECT_EQ(c.sampling.gaps, 1U);
}

TEST(Condition, ShortPieceIsLeftOut) {
  RawLog log = logged();
  erase(log, 3000, 3500);
  erase(log, 3050, 3500);
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), UnorderedElementsAre("gap", "short")) << texts(c);
  EXPECT_EQ(c.records.size(), 2U);
}

TEST(Condition, ManySingleGapsAreBridged) {
  RawLog log = logged();
  for (std::size_t k = 7900; k > 50; k -= 60) erase(log, k, k + 1);
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "gap").text, HasSubstr("the first of 131 short ones with 131 rows in all"));
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_NEAR(c.records[0].sample_time, 1e-3, 1e-9);
  EXPECT_EQ(c.records[0].x.size(), 8000U);
  EXPECT_EQ(std::count(c.records[0].skip.begin(), c.records[0].skip.end(), 1), 131);
  const Axis axis;
  for (std::size_t k = 0; k < c.records[0].x.size(); k += 97)
    EXPECT_NEAR(c.records[0].x[k], axis.x(c.records[0].t[k]), 2e-6) << k;  // a·T²/8 = 0.2 um, and resolution
}

TEST(Condition, ShortGapsAreBridgedAndNotFitted) {
  RawLog log = logged();
  for (const auto& [at, rows] : {std::pair{7000, 1}, {5200, 3}, {2400, 5}, {900, 2}})
    erase(log, static_cast<std::size_t>(at), static_cast<std::size_t>(at + rows));
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "gap").text, HasSubstr("the first of 4 short ones with 11 rows in all"));
  ASSERT_EQ(c.records.size(), 1U);
  ASSERT_EQ(c.records[0].x.size(), 8000U);
  ASSERT_EQ(c.records[0].skip.size(), 8000U);
  EXPECT_EQ(std::count(c.records[0].skip.begin(), c.records[0].skip.end(), 1), 11);
  const Axis axis;
  for (const std::size_t k : {900U, 901U, 2400U, 2402U, 2404U, 5201U, 7000U}) {
    EXPECT_EQ(c.records[0].skip[k], 1) << k;
    EXPECT_NEAR(c.records[0].t[k], static_cast<double>(k) * 1e-3, 1e-9);
    EXPECT_NEAR(c.records[0].x[k], axis.x(c.records[0].t[k]), 1e-6) << k;
  }
  // A longer gap is cut beside them.
  erase(log, 4000, 4006);
  EXPECT_EQ(condition(log).records.size(), 2U);
}

// A counter of the control as the time: the stamps are exact, and every seventh row is missing at random.
TEST(Condition, ManyMissingRowsAreBridgedWhereStampsCountThem) {
  RawLog log = logged();
  std::size_t missing = 0;
  std::uint32_t random = 1;
  for (std::size_t at = 7990; at > 10; --at) {
    random = random * 1664525u + 1013904223u;
    if (random >> 16 > 65536u / 7u) continue;
    erase(log, at, at + 1);
    ++missing;
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "gap").text, HasSubstr("are put in between their neighbours"));
  ASSERT_EQ(c.records.size(), 1U);
  ASSERT_EQ(c.records[0].x.size(), 8000U);
  EXPECT_EQ(static_cast<std::size_t>(std::count(c.records[0].skip.begin(), c.records[0].skip.end(), 1)),
            missing);
  const Axis axis;
  for (std::size_t k = 0; k < c.records[0].x.size(); k += 13)
    EXPECT_NEAR(c.records[0].x[k], axis.x(c.records[0].t[k]), 1.5e-6) << k;
}

// The time jumps, the motion does not: rows put in would be a standstill that never was.
TEST(Condition, AClockThatJumpsIsNotBridged) {
  RawLog log = logged();
  for (std::size_t k = 4000; k < log.x.t.size(); ++k) {
    for (Signal* s : {&log.x, &log.v, &log.f}) {
      if (!s->t.empty()) s->t[k] += 3e-3;
    }
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "gap").text, HasSubstr("cut there"));
  EXPECT_EQ(c.records.size(), 2U);
}

// Without a position nothing tells lost rows from a pause of the clock.
TEST(Condition, GapsOfALogOfVelocityAreCut) {
  RawLog log = logged();
  log.v.t = log.x.t;
  log.x = {};
  for (std::vector<double>* c : {&log.v.t, &log.v.y, &log.f.y})
    c->erase(c->begin() + 4000, c->begin() + 4003);
  const Conditioned c = condition(log);
  EXPECT_THAT(texts(c), HasSubstr("cut there"));
  EXPECT_EQ(c.records.size(), 2U);
}

TEST(Condition, TimeBackIsANewRecordOrRefused) {
  RawLog log = logged();
  const RawLog again = logged({}, 2);
  for (std::size_t k = 0; k < 4000; ++k) {
    log.x.t.push_back(again.x.t[k]);
    log.x.y.push_back(again.x.y[k]);
    log.v.y.push_back(again.v.y[k]);
    log.f.y.push_back(again.f.y[k]);
  }
  const Conditioned c = condition(log);
  EXPECT_EQ(only(c, "time-back").row, 8001U);
  EXPECT_EQ(c.records.size(), 2U);

  RawLog swapped = logged();
  std::swap(swapped.x.t[4000], swapped.x.t[4001]);
  EXPECT_THAT(refusal(swapped), AllOf(HasSubstr("row 4002"), HasSubstr("time goes back")));
}

TEST(Condition, DoubleStampsAreMended) {
  RawLog log = logged();
  log.x.t[2000] = log.x.t[1999];  // one stamp written twice, the next is right
  const Conditioned c = condition(log);
  EXPECT_EQ(only(c, "double-time").row, 2001U);
  EXPECT_EQ(c.records[0].x.size(), 8000U);
  EXPECT_NEAR(c.records[0].t[2000], 2.0, 1e-9);

  RawLog padded = logged();
  for (int i = 0; i < 700; ++i) {
    for (std::vector<double>* column : {&padded.x.t, &padded.x.y, &padded.v.y, &padded.f.y})
      column->push_back(column->back());
  }
  const Conditioned d = condition(padded);
  EXPECT_EQ(only(d, "double-time").row, 8001U);
  EXPECT_EQ(d.records[0].x.size(), 8000U);
}

TEST(Condition, RoundedStampsAreMadeEven) {
  Axis axis;
  axis.sample_time = 2.0 / 3.0 * 1e-3;
  RawLog log = logged(axis);
  for (double& t : log.x.t) t = 1e-4 * std::round(t * 1e4);
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "rounded-time").text, HasSubstr("rounded to 0.0001"));
  EXPECT_NEAR(c.records[0].sample_time, axis.sample_time, 1e-8);
  // Coarser than the rows: several in one stamp.
  for (double& t : log.x.t) t = 1e-3 * std::floor(t * 1e3 + 1e-9);
  const Conditioned d = condition(log);
  EXPECT_THAT(only(d, "rounded-time").text, HasSubstr("coarser"));
  EXPECT_NEAR(d.records[0].sample_time, axis.sample_time, 1e-6);
}

TEST(Condition, RowsAreCountedBetweenChangesOfACoarseStamp) {
  // Whole seconds: the first holds 50 rows, the last 50, every other one 1000.
  RawLog log = logged();
  for (std::vector<double>* column : {&log.x.t, &log.x.y, &log.v.y, &log.f.y}) column->resize(7100);
  RawLog short_log = log;
  for (double& t : log.x.t) t = std::floor(t + 0.95 + 1e-9);
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "rounded-time").text, HasSubstr("--sample-time"));
  // Between the changes stands a whole number of milliseconds.
  EXPECT_NEAR(c.records[0].sample_time, 1e-3, 1e-12);
  // At standstill rows of one stamp are equal: they count too.
  RawLog still = log;
  for (std::size_t k = 3000; k < 3600; ++k) {
    for (std::vector<double>* column : {&still.x.y, &still.v.y, &still.f.y}) (*column)[k] = (*column)[3000];
  }
  EXPECT_NEAR(condition(still).records[0].sample_time, 1e-3, 1e-12);
  // No whole second: the rate is not known.
  for (std::vector<double>* column : {&short_log.x.t, &short_log.x.y, &short_log.v.y, &short_log.f.y})
    column->resize(900);
  for (double& t : short_log.x.t) t = std::floor(t + 0.5 + 1e-9);
  EXPECT_THAT([&] { condition(short_log); },
              ::testing::ThrowsMessage<Refused>(HasSubstr("holds no whole one")));
}

TEST(Condition, JitterIsResampled) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> shake(-2e-4, 2e-4);
  const Axis axis;
  RawLog log = logged();
  for (std::size_t k = 0; k < log.x.t.size(); ++k) {
    log.x.t[k] += shake(engine);
    log.x.y[k] = axis.x(log.x.t[k]);
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "jitter").text, HasSubstr("resampled"));
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_TRUE(problems(c.records[0]).empty());
  for (std::size_t k = 0; k < c.records[0].x.size(); k += 53)
    EXPECT_NEAR(c.records[0].x[k], axis.x(c.records[0].t[k]), 5e-7) << k;  // a·T²/8 = 0.3 um
}

// Of a long log eight parts are looked at closely; its speeds are those of all rows, also of short strokes on a coarse encoder.
TEST(Condition, SpeedsAreThoseOfAllRows) {
  for (const auto& [amplitude, rate, count] :
       {std::tuple{0.5e-3, 1.0, 1e-6}, {2e-3, 1.0, 1e-5}, {20e-3, 0.5, 1e-7}}) {
    RawLog log;
    log.source = "log.csv";
    const double w = 2.0 * kPi * rate;
    for (std::size_t k = 0; k < 50000; ++k) {
      const double t = 1e-3 * static_cast<double>(k);
      log.x.t.push_back(t);
      log.x.y.push_back(count * std::round(amplitude * std::sin(w * t) / count));
      log.f.y.push_back(std::copysign(20.0, std::cos(w * t)) - 50.0 * amplitude * w * w * std::sin(w * t));
    }
    const Conditioned c = condition(log);
    EXPECT_NEAR(c.coverage.v_max, amplitude * w, 0.05 * amplitude * w) << amplitude;
    EXPECT_NEAR(c.coverage.v_min, -amplitude * w, 0.05 * amplitude * w) << amplitude;
    EXPECT_NEAR(c.coverage.forward, 0.5, 0.05) << amplitude;
  }
}

// Among stamps that jitter by a third of a step one comes before the last now and then; the log was refused for it.
TEST(Condition, JitterMayPutAStampBeforeTheLast) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> shake(0.0, 2.5e-4);
  const Axis axis;
  RawLog log = logged();
  std::size_t back = 0;
  for (std::size_t k = 0; k < log.x.t.size(); ++k) {
    log.x.t[k] += std::clamp(shake(engine), -7e-4, 7e-4);
    log.x.y[k] = axis.x(log.x.t[k]);
    if (k > 0 && log.x.t[k] < log.x.t[k - 1] && log.x.t[k - 1] - log.x.t[k] < 5e-4) ++back;
  }
  ASSERT_GT(back, 0U);
  const Conditioned c = condition(log);
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_EQ(c.records[0].x.size(), log.x.t.size());
}

// A warning for each of the pieces between gaps is read by nobody.
TEST(Condition, JitterOfManyPiecesIsOneFinding) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> shake(-1.5e-4, 1.5e-4);
  const Axis axis;
  RawLog log = logged();
  for (std::size_t k = 0; k < log.x.t.size(); ++k) {
    const double often = k > 2000 && k < 3000 ? 2.0 : 1.0;  // the second piece is the worst
    log.x.t[k] += often * shake(engine) + 0.5 * static_cast<double>(k / 1500);
    log.x.y[k] = axis.x(log.x.t[k]);
  }
  const Conditioned c = condition(log);
  std::vector<Finding> found;
  for (const Finding& f : c.findings) {
    if (f.kind == "jitter" && f.text.find("not equally spaced") != std::string::npos) found.push_back(f);
  }
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found.front().text, HasSubstr("the worst of "));
  EXPECT_GT(found.front().row, 1500U);
  EXPECT_LE(found.front().row, 3001U);
}

// A computer stamps the rows of a control when they arrive: the stamps shake, the rows do not. Put where the stamps are, a speed of
// 200 mm/s shakes the position by 40 um, which is no noise that a force could have made.
TEST(Condition, StampsMayJitterWhereTheRowsDoNot) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> shake(-2e-4, 2e-4);
  RawLog log = logged();
  for (std::size_t k = 1; k + 2 < log.x.t.size(); ++k) log.x.t[k] += shake(engine);
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "jitter").text, HasSubstr("the motion is that of equally spaced rows"));
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_NEAR(c.records[0].sample_time, 1e-3, 1e-12);
  EXPECT_EQ(c.records[0].x, log.x.y);
  EXPECT_EQ(c.records[0].f, log.f.y);
}

// Two stamps that jitter may be 1.7 steps apart. A row that is missing moves all stamps behind it.
TEST(Condition, ALateStampAmongOthersIsNoMissingRow) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> shake(-3.5e-4, 3.5e-4);
  RawLog log = logged();
  for (std::size_t k = 1; k + 2 < log.x.t.size(); ++k) log.x.t[k] += shake(engine);
  std::size_t late = 0;
  for (std::size_t k = 1; k < log.x.t.size(); ++k) late += log.x.t[k] - log.x.t[k - 1] > 1.5e-3 ? 1 : 0;
  ASSERT_GT(late, 50U);
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "jitter").text, HasSubstr("the motion is that of equally spaced rows"));
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_EQ(c.records[0].x, log.x.y);
  // Rows that are really missing are found among them, and put in again.
  const std::size_t rows = log.x.y.size();
  const std::vector<double> whole = log.x.y;
  for (auto* column : {&log.x.t, &log.x.y, &log.v.y, &log.f.y}) {
    for (const std::ptrdiff_t k : {7000, 5500, 5499, 4000, 2500}) column->erase(column->begin() + k);
  }
  const Conditioned lost = condition(log);
  EXPECT_THAT(texts(lost), HasSubstr("equally spaced rows, of which 5 are missing"));
  ASSERT_EQ(lost.records.size(), 1U) << texts(lost);
  ASSERT_EQ(lost.records[0].x.size(), rows);
  for (std::size_t k = 0; k < rows; ++k) ASSERT_NEAR(lost.records[0].x[k], whole[k], 2e-6) << k;
}

// Rows that were taken at their stamps, some of them late: moved, each would be a jump of the position (mass -0.01 of 300 kg).
TEST(Condition, RowsTakenAtLateStampsKeepThem) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> shake(-5e-5, 5e-5);
  const Axis axis;
  RawLog log = logged();
  for (std::size_t k = 0; k < log.x.t.size(); ++k) {
    log.x.t[k] += shake(engine) + (k % 50 == 25 ? 7e-4 : 0.0);
    log.x.y[k] = axis.x(log.x.t[k]);
  }
  for (const Record& r : condition(log).records) {
    for (std::size_t k = 0; k < r.x.size(); ++k) ASSERT_NEAR(r.x[k], axis.x(r.t[k]), 2e-6) << k;
  }
}

// At rest a coarse position changes by single steps. Resampled, it has values between them, which are no motion.
TEST(Condition, RestInAResampledLogIsNoFrozenLogger) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> shake(-2e-4, 2e-4);
  const Axis axis;
  RawLog log = logged();
  log.v.y.clear();
  for (std::size_t k = 0; k < log.x.t.size(); ++k) {
    log.x.t[k] += shake(engine);
    log.x.y[k] = 1e-7 * std::round(axis.x(log.x.t[k]) * 1e7);
    if (k >= 3000 && k < 4000) {  // at rest, one step to and fro every 40 rows, the force as constant
      log.x.y[k] = log.x.y[2999] + (k / 40 % 2 == 0 ? 0.0 : 1e-7);
      log.f.y[k] = log.f.y[2999];
    }
  }
  EXPECT_THAT(kinds(condition(log)), Not(Contains("frozen"))) << texts(condition(log));
}

TEST(Condition, RowAfterTheStopIsLeftOut) {
  RawLog log = logged();
  log.x.t.push_back(log.x.t.back() + 3e-4);
  for (std::vector<double>* column : {&log.x.y, &log.v.y, &log.f.y}) column->push_back(column->back());
  const Conditioned c = condition(log);
  EXPECT_EQ(only(c, "jitter").row, 8001U);
  EXPECT_EQ(c.records[0].x.size(), 8000U);
}

TEST(Condition, TimeFromTheSampleTime) {
  RawLog log = logged();
  log.x.t.clear();
  EXPECT_THAT(refusal(log), HasSubstr("--sample-time"));
  log.sample_time = 1e-3;
  const Conditioned c = condition(log);
  EXPECT_TRUE(c.findings.empty()) << texts(c);
  EXPECT_NEAR(c.records[0].sample_time, 1e-3, 1e-12);
}

TEST(Condition, IrregularTimesKeepTheRows) {
  RawLog log = logged();
  double t = 0.0;
  for (std::size_t k = 0; k < log.x.t.size(); ++k) {
    t += k % 5 == 0 ? 0.02 : k % 3 == 0 ? 0.004 : 0.001;
    log.x.t[k] = t;
  }
  log.v.y.clear();
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), Contains("irregular"));
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_EQ(c.records[0].x, log.x.y);
  EXPECT_THAT(c.cannot_tell, Contains(HasSubstr("irregular")));
}

// ---- time bases and held values ----

TEST(Condition, ForceOfAFasterClockIsAveraged) {
  const Axis axis;
  RawLog log = logged();
  log.f = {};
  for (int k = -7; k < 32010; ++k) {  // four times as fast, begins earlier, half a step off
    const double t = 0.25e-3 * (k + 0.5);
    log.f.t.push_back(t);
    log.f.y.push_back(axis.force(t));
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "time-bases").text, HasSubstr("mean over each interval"));
  ASSERT_EQ(c.records.size(), 1U);
  // Exact for a held signal: shares of the held values within the interval.
  for (std::size_t k = 10; k < 7990; k += 411) {
    const auto held = [&](double t) { return axis.force(0.25e-3 * (std::floor(t / 0.25e-3 - 0.5) + 0.5)); };
    const double t = c.records[0].t[k];
    double sum = 0.0;
    for (int i = 0; i < 8; ++i) sum += held(t + 0.125e-3 * i + 1e-9) / 8.0;
    EXPECT_NEAR(c.records[0].f[k], sum, 1e-6) << k;
  }
}

TEST(Condition, SlowForceMakesTheGrid) {
  const Axis axis;
  RawLog log = logged();
  log.f = {};
  for (int k = 0; k < 2000; ++k) {
    log.f.t.push_back(4e-3 * k);
    log.f.y.push_back(axis.force(4e-3 * k));
  }
  const Conditioned c = condition(log);
  only(c, "time-bases");
  EXPECT_NEAR(c.records[0].sample_time, 4e-3, 1e-9);
  EXPECT_NEAR(c.records[0].x[1000], axis.x(4.0), 1e-7);
}

/// Position and velocity new every `hold` rows, force in every row.
RawLog held(std::size_t hold, std::size_t phase, const Axis& axis) {
  RawLog log = logged(axis);
  for (std::size_t k = 0; k < log.x.y.size(); ++k) {
    const std::size_t from = k < phase ? 0 : k - (k - phase) % hold;
    const double t = axis.sample_time * static_cast<double>(from);
    log.x.y[k] = 1e-8 * std::round(axis.x(t) * 1e8);
    log.v.y[k] = axis.v(t);
  }
  return log;
}

TEST(Condition, HeldValuesGoToTheirOwnGrid) {
  Axis axis;
  axis.sample_time = 0.2e-3;
  axis.rows = 30000;
  const RawLog log = held(15, 4, axis);
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "held").text, HasSubstr("position every 15 rows"));
  EXPECT_EQ(c.sampling.x_hold, 15.0);
  EXPECT_EQ(c.sampling.f_hold, 1.0);
  ASSERT_EQ(c.records.size(), 1U);
  const Record& r = c.records[0];
  EXPECT_NEAR(r.sample_time, 3e-3, 1e-12);
  EXPECT_EQ(c.rows[0][0], 5U);  // the first new value
  for (std::size_t k = 0; k < r.x.size(); k += 37) {
    EXPECT_NEAR(r.x[k], axis.x(r.t[k]), 1e-7) << k;
    double mean = 0.0;
    for (std::size_t i = 0; i < 15; ++i) mean += log.f.y[c.rows[0][k] - 1 + i] / 15.0;
    EXPECT_NEAR(r.f[k], mean, 1e-9) << k;
  }
}

TEST(Condition, HoldThatIsNoWholeNumber) {
  Axis axis;
  axis.sample_time = 0.4e-3;
  axis.rows = 20000;
  RawLog log = logged(axis);
  for (std::size_t k = 0; k < log.x.y.size(); ++k) {
    const double t = 3e-3 * std::floor(axis.sample_time * static_cast<double>(k) / 3e-3 + 1e-9);
    log.x.y[k] = axis.x(t);
    log.v.y[k] = axis.v(t);
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), ElementsAre("held")) << texts(c);
  EXPECT_NEAR(c.records[0].sample_time, 3e-3, 1e-5);
}

TEST(Condition, CoarsePositionIsNoHold) {
  Axis axis;
  RawLog log = logged(axis);
  for (double& x : log.x.y) x = 1e-4 * std::round(x * 1e4);  // stands for rows where it is slow
  const Conditioned c = condition(log);
  EXPECT_EQ(c.sampling.x_hold, 1.0);
  EXPECT_TRUE(c.findings.empty()) << texts(c);
  EXPECT_NEAR(c.sampling.x_quantum, 1e-4, 1e-9);
  EXPECT_THAT(c.cannot_tell, Contains(AllOf(HasSubstr("pre-sliding"), HasSubstr("too coarse"))));
}

// ---- logger ----

TEST(Condition, FrozenLoggerIsCutOut) {
  for (const std::size_t first : {2100U, 5333U}) {
    RawLog log = logged();
    for (std::size_t k = first + 1; k < first + 97; ++k) {
      for (Signal* s : {&log.x, &log.v, &log.f}) s->y[k] = s->y[first];
    }
    const Conditioned c = condition(log);
    const Finding& f = only(c, "frozen");
    EXPECT_EQ(f.row, first + 1);
    EXPECT_NEAR(f.values.at(0), 1e-3 * static_cast<double>(first), 1e-9);
    EXPECT_NEAR(f.values.at(1), 1e-3 * static_cast<double>(first + 96), 1e-9);
    ASSERT_EQ(c.records.size(), 2U);
    EXPECT_EQ(c.records[0].x.size(), first + 1);
    EXPECT_EQ(c.rows[1].front(), first + 98);
  }
}

TEST(Condition, FrozenMultiRateLogger) {
  Axis axis;
  axis.sample_time = 0.2e-3;
  axis.rows = 30000;
  RawLog log = held(15, 0, axis);
  const std::size_t first = 12004;
  for (std::size_t k = first + 1; k < first + 480; ++k) {
    for (Signal* s : {&log.x, &log.v, &log.f}) s->y[k] = s->y[first];
  }
  // The current comes back before the next slot of the position.
  for (std::size_t k = first + 480; k < first + 491; ++k) {
    for (Signal* s : {&log.x, &log.v}) s->y[k] = s->y[first];
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), ElementsAre("frozen", "held")) << texts(c);
  EXPECT_EQ(c.findings[0].row, first + 1);
  ASSERT_EQ(c.records.size(), 2U);
  for (const Record& r : c.records) {
    for (std::size_t k = 0; k < r.x.size(); k += 11) EXPECT_NEAR(r.x[k], axis.x(r.t[k]), 1e-7) << k;
  }
}

TEST(Condition, StandstillIsNotFrozen) {
  // It slows down over a second, then stands to the last bit with a force that the converter holds.
  RawLog log = logged();
  const Axis axis;
  double at = axis.x(2.0);
  for (std::size_t k = 2000; k < log.x.y.size(); ++k) {
    const double t = 1e-3 * static_cast<double>(k) - 2.0;
    if (t < 1.0) at += 1e-3 * axis.v(2.0) * (1.0 - t);
    log.x.y[k] = 1e-7 * std::round(1e7 * at);
    if (t >= 1.0) log.f.y[k] = 7.0;
  }
  log.v.y.clear();
  EXPECT_THAT(kinds(condition(log)), Not(Contains("frozen")));
}

TEST(Condition, LoggerThatStopsBeforeTheAxis) {
  RawLog log = logged();
  erase(log, 7600, 8000);  // moving at 9 % of the top speed or more
  for (int i = 0; i < 300; ++i) {
    log.x.t.push_back(log.x.t.back() + 1e-3);
    for (std::vector<double>* column : {&log.x.y, &log.v.y, &log.f.y}) column->push_back(column->back());
  }
  const Conditioned c = condition(log);
  EXPECT_EQ(only(c, "frozen").row, 7600U);
  EXPECT_EQ(c.records[0].x.size(), 7600U);
}

TEST(Condition, JumpWithoutGapIsCut) {
  RawLog log = logged();
  erase(log, 2000, 2060);
  for (std::size_t k = 0; k < log.x.t.size(); ++k) log.x.t[k] = 1e-3 * static_cast<double>(k);
  log.v.y.clear();
  const Conditioned c = condition(log);
  EXPECT_EQ(only(c, "jump").row, 2001U);
  EXPECT_EQ(c.records.size(), 2U);
}

// ---- channels ----

TEST(Condition, StuckChannels) {
  RawLog log = logged();
  std::fill(log.f.y.begin(), log.f.y.end(), 3.5);
  EXPECT_THAT(refusal(log), AllOf(HasSubstr("force"), HasSubstr("3.5"), HasSubstr("every row")));
  log = logged();
  std::fill(log.x.y.begin(), log.x.y.end(), 0.1);
  EXPECT_THAT(refusal(log), AllOf(HasSubstr("position"), HasSubstr("0.1")));
  log = logged();
  std::fill(log.v.y.begin(), log.v.y.end(), 0.0);
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "stuck").text, HasSubstr("velocity"));
  EXPECT_TRUE(c.records[0].v.empty());
  log = logged();
  std::fill(log.f.y.begin() + 3000, log.f.y.begin() + 3400, log.f.y[3000]);
  const Conditioned d = condition(log);
  EXPECT_EQ(only(d, "stuck").row, 3001U);
  EXPECT_EQ(d.records.size(), 2U);
  EXPECT_THAT(only(d, "stuck").text, HasSubstr("the channel was stuck"));
  log = logged();
  std::fill(log.f.y.begin() + 3000, log.f.y.begin() + 3400, 0.0);
  EXPECT_THAT(only(condition(log), "stuck").text, HasSubstr("the drive was off"));
}

// Whole rpm and tenths of a percent repeat some rows at constant speed.
TEST(Condition, CoarseSpeedAndForceAreNotFrozen) {
  RawLog log = logged();
  log.v.t = log.x.t;
  log.x = {};
  std::mt19937_64 engine(3);
  for (std::size_t k = 0; k < log.v.y.size(); ++k) {
    // Forward seven rows of eight are equal, back some more than every third.
    std::bernoulli_distribution up(k / 2000 % 2 == 0 ? 0.03 : 0.25);
    log.v.y[k] = (k / 2000 % 2 == 0 ? 0.05 : -0.05) + (up(engine) ? 0.001 : 0.0);
    log.f.y[k] = log.v.y[k] > 0.0 ? 20.0 : -20.0;
    if (up(engine)) log.f.y[k] += 0.5;
  }
  EXPECT_THAT(kinds(condition(log)), Not(Contains("frozen")));
  // A long run is one.
  for (std::size_t k = 1000; k < 1300; ++k) {
    log.v.y[k] = log.v.y[1000];
    log.f.y[k] = log.f.y[1000];
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), Contains("frozen"));
  EXPECT_THAT(c.findings.front().text, HasSubstr("to the last digit"));
}

// The position of an axis at rest changes by some counts, and the drive may hold it with one and the same force.
TEST(Condition, ConstantForceAtRestStays) {
  for (const int counts : {1, 20}) {
    RawLog log = logged();
    log.v.y.clear();
    std::mt19937_64 engine(11);
    std::uniform_int_distribution<int> any(-counts, counts);
    const double rest = log.x.y[4000];
    for (std::size_t k = 4000; k < 4600; ++k) {
      log.x.y[k] = rest + 1e-7 * any(engine);
      log.f.y[k] = log.f.y[4000];
    }
    EXPECT_THAT(kinds(condition(log)), Not(Contains("stuck"))) << counts;
  }
}

// Between its ramps a programmed force is zero while the axis springs back; that is no stuck channel.
TEST(Condition, RestBetweenProgrammedRampsStays) {
  RawLog log = logged({.noise = 0.0});
  double x = 0.0;
  for (std::size_t k = 0; k < log.f.y.size(); ++k) {
    const std::size_t i = k % 2000;
    const double side = k / 2000 % 2 == 0 ? 1.0 : -1.0;
    log.f.y[k] = side * (i < 1500   ? 0.01 * static_cast<double>(i)
                         : i < 1700 ? 0.075 * static_cast<double>(1700 - i)
                                    : 0.0);
    x += side * (i > 1400 && i < 1600 ? 1e-5 : i > 1700 ? -1e-8 : 0.0);
    log.x.y[k] = x;
  }
  log.v.y.clear();
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), Not(Contains("stuck")));
  EXPECT_EQ(c.records.size(), 1U);
}

// Squares of such numbers are none.
TEST(Condition, NumbersOfNoMachineAreRefused) {
  for (const bool all : {true, false}) {
    RawLog log = logged();
    if (all) {
      for (double& f : log.f.y) f *= 1e300;
    } else {
      log.x.y[76] = -1e300;
    }
    EXPECT_THAT(refusal(log),
                AllOf(HasSubstr(all ? "row 1: the force" : "row 77: the position"), HasSubstr("unit")));
  }
  for (const double scale : {1e-200, 1e-20, 1e20}) {
    RawLog log = logged();
    for (double& t : log.x.t) t *= scale;
    EXPECT_THAT(refusal(log), AllOf(HasSubstr("time between rows"), HasSubstr("unit"))) << scale;
    log = logged();
    for (double& x : log.x.y) x *= scale;
    EXPECT_THAT(refusal(log), AllOf(HasSubstr("position ranges over"), HasSubstr("unit"))) << scale;
    log = logged();
    for (double& f : log.f.y) f *= scale;
    EXPECT_THAT(refusal(log), AllOf(HasSubstr("force ranges over"), HasSubstr("unit"))) << scale;
  }
}

TEST(Condition, VelocityInAnotherUnitIsRefused) {
  for (const auto& [factor, hint] : {std::pair{60.0, "per minute"},
                                     {1000.0, "mm for m"},
                                     {1.0 / 60.0, "perhaps the two units are exchanged"},
                                     {25.4, "inch"},
                                     {3.3, "3.3 times"}}) {
    RawLog log = logged();
    for (double& v : log.v.y) v *= factor;
    EXPECT_THAT(refusal(log),
                AllOf(HasSubstr("times the rate of the position"), HasSubstr(hint), HasSubstr("--map v=")));
    EXPECT_NO_THROW(static_cast<void>(condition(log, {{"velocity"}})));
  }
}

TEST(Condition, VelocityTurnedOrForeign) {
  RawLog log = logged();
  for (double& v : log.v.y) v = -v;
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "velocity").text, HasSubstr("opposite sign"));
  EXPECT_NEAR(c.records[0].v[10], Axis{}.v(0.01), 1e-4);
  for (std::size_t k = 0; k < log.v.y.size(); ++k) log.v.y[k] = std::sin(0.1 * static_cast<double>(k));
  const Conditioned d = condition(log);
  EXPECT_THAT(only(d, "velocity").text, HasSubstr("not the rate"));
  EXPECT_TRUE(d.records[0].v.empty());
}

TEST(Condition, ReferenceThatDoesNotBelong) {
  RawLog log = logged();
  log.r.y.assign(log.x.y.size(), 0.3);
  EXPECT_THAT(only(condition(log), "reference").text, HasSubstr("never changes"));
  for (std::size_t k = 0; k < log.r.y.size(); ++k) log.r.y[k] = 1000.0 * log.x.y[k];
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "reference").text, HasSubstr("1000 times"));
  EXPECT_TRUE(c.records[0].r.empty());
  // A following error as large as a third of the stroke is still a reference.
  const Axis axis;
  for (std::size_t k = 0; k < log.r.y.size(); ++k) log.r.y[k] = axis.x(1e-3 * static_cast<double>(k) + 0.2);
  EXPECT_TRUE(condition(log).findings.empty());
}

TEST(Condition, WildSamplesAreReplacedAndMarked) {
  RawLog log = logged();
  log.f.y[0] = -1200.0;  // the edited first torque of a recording
  log.x.y[4321] += 0.02;
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), ElementsAre("spike", "spike")) << texts(c);
  EXPECT_EQ(c.findings[0].row, 4322U);
  EXPECT_EQ(c.findings[1].row, 1U);
  EXPECT_THAT(c.findings[1].text, HasSubstr("-1200"));
  EXPECT_NEAR(c.records[0].x[4321], Axis{}.x(4.321), 1e-6);
  ASSERT_FALSE(c.records[0].skip.empty());
  EXPECT_EQ(c.records[0].skip[0], 1);
  EXPECT_EQ(c.records[0].skip[4321], 1);
  EXPECT_EQ(c.records[0].skip[100], 0);
}

TEST(Condition, NoPositionNoForceNotFinite) {
  RawLog log = logged();
  log.v.t = log.x.t;
  log.x = {};
  const Conditioned c = condition(log);
  EXPECT_THAT(only(c, "no-position").text, HasSubstr("integrated"));
  const Axis axis;
  EXPECT_NEAR(c.records[0].x[5000] - c.records[0].x[0], axis.x(5.0) - axis.x(0.0), 1e-5);
  EXPECT_THAT(c.cannot_tell, Contains(HasSubstr("no position")));
  RawLog no_force = logged();
  no_force.f = {};
  EXPECT_THAT(refusal(no_force), HasSubstr("no force"));
  RawLog bad = logged();
  bad.x.y[77] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(bad), AllOf(HasSubstr("column x"), HasSubstr("row 78")));
  RawLog uneven = logged();
  uneven.f.y.pop_back();
  EXPECT_THAT(refusal(uneven), AllOf(HasSubstr("7999"), HasSubstr("8000")));
  RawLog few = logged();
  erase(few, 50, 8000);
  EXPECT_THAT(refusal(few), HasSubstr("100 rows"));
}

// ---- force ----

TEST(Condition, MagnitudeGetsItsSignBack) {
  for (const double load : {0.0, 15.0, 60.0, -60.0}) {
    Axis axis;
    axis.load = load;
    const RawLog clean = logged(axis);
    RawLog log = clean;
    for (double& f : log.f.y) f = std::abs(f);
    const Conditioned c = condition(log);
    const Finding& f = only(c, "unsigned");
    EXPECT_TRUE(f.repaired);
    std::size_t wrong = 0;
    const Record& r = c.records[0];
    for (std::size_t k = 0; k < r.f.size(); ++k) {
      const bool unsure = !r.skip.empty() && r.skip[k] != 0;
      if (!unsure && r.f[k] * clean.f.y[k] < 0.0) ++wrong;
    }
    EXPECT_LE(wrong, 8U) << "load " << load << "\n" << f.text;
    EXPECT_GT(c.rough.mass, 90.0);
    EXPECT_LT(c.rough.mass, 110.0);
    EXPECT_NEAR(c.rough.offset, load, 2.0);
    // Left alone when told so.
    EXPECT_EQ(condition(log, {{"unsigned", "inverted", "contradiction"}}).records[0].f, log.f.y);
  }
}

TEST(Condition, MagnitudeOfJogs) {
  // Friction and inertia are equally strong here: neither sign alone is a good start.
  test::Drive drive;
  drive.friction = test::table_2_3('y');
  std::vector<double> jog;
  double at = 0.0;
  for (const double speed : {2e-3, -2e-3, 8e-3, -8e-3}) {
    for (int k = 0; k < 240; ++k)
      jog.push_back(at += 0.005 * speed * std::clamp(std::min(k, 240 - k) / 8.0, 0.0, 1.0));
    for (int k = 0; k < 60; ++k) jog.push_back(at);
  }
  const RawLog clean = raw(test::run_closed(drive, 57e3, jog, 6));
  RawLog log = clean;
  for (double& f : log.f.y) f = std::abs(f);
  const Conditioned c = condition(log);
  only(c, "unsigned");
  const Record& r = c.records[0];
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < r.f.size(); ++k)
    wrong += r.skip[k] == 0 && r.f[k] * clean.f.y[k] < 0.0 && std::abs(r.f[k]) > 300.0 ? 1 : 0;
  EXPECT_LE(wrong, r.f.size() / 100);
  EXPECT_NEAR(c.rough.mass, 57.65e3, 8e3);
}

TEST(Condition, LateMagnitude) {
  Axis axis;
  axis.load = 50.0;
  RawLog log = logged(axis);
  for (std::size_t k = log.f.y.size(); k-- > 4;) log.f.y[k] = std::abs(log.f.y[k - 4]);
  for (std::size_t k = 0; k < 4; ++k) log.f.y[k] = std::abs(log.f.y[k]);
  const Conditioned c = condition(log);
  only(c, "unsigned");
  EXPECT_NEAR(c.rough.delay, 4.5, 0.6);  // the force of a row belongs to its middle
  EXPECT_NEAR(c.rough.mass, 100.0, 5.0);
}

TEST(Condition, ForceAgainstThePosition) {
  for (const double load : {0.0, 150.0}) {
    Axis axis;
    axis.load = load;
    const RawLog clean = logged(axis);
    RawLog log = clean;
    for (double& f : log.f.y) f = -f;
    const Conditioned c = condition(log);
    EXPECT_TRUE(only(c, "inverted").repaired);
    EXPECT_EQ(c.records[0].f, clean.f.y);
    EXPECT_EQ(condition(log, {{"inverted"}}).records[0].f, log.f.y);
  }
}

TEST(Condition, MirroredAndScaledLogsGiveTheSame) {
  RawLog log = logged();
  for (Signal* s : {&log.x, &log.v, &log.f}) {
    for (double& y : s->y) y = -y;
  }
  const Conditioned mirrored = condition(log);
  EXPECT_TRUE(mirrored.findings.empty()) << texts(mirrored);
  EXPECT_NEAR(mirrored.rough.mass, condition(logged()).rough.mass, 1e-6);
  for (double& f : log.f.y) f *= -1e-3;  // another unit, and against the position
  const Conditioned scaled = condition(log);
  only(scaled, "inverted");
  EXPECT_NEAR(scaled.rough.mass, 1e-3 * mirrored.rough.mass, 1e-9);
}

TEST(Condition, SpringOfPreSlidingIsNotInverted) {
  // f = k·x + hysteresis: the acceleration of a sine is −ω²·x, so that the fit may see a negative mass.
  RawLog log = logged();
  for (std::size_t k = 0; k < log.x.y.size(); ++k) {
    const double t = 1e-3 * static_cast<double>(k);
    log.x.y[k] = 20e-6 * std::sin(kTau * 0.5 * t);
    const double v = std::cos(kTau * 0.5 * t);
    log.f.y[k] = 2e6 * log.x.y[k] + 8.0 * v + 0.01 * std::sin(1234.5 * t * t);
  }
  log.v.y.clear();
  const Conditioned c = condition(log);
  EXPECT_TRUE(c.findings.empty()) << texts(c);
}

TEST(Condition, DriveOffAtTheEndIsCut) {
  Axis axis;
  axis.load = 60.0;
  RawLog log = logged(axis);
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  const double rest = log.x.y.back();
  for (int k = 0; k < 3000; ++k) {
    log.x.t.push_back(log.x.t.back() + 1e-3);
    log.x.y.push_back(rest);
    log.v.y.push_back(1e-5 * normal(engine));
    const double level = k < 1000 ? 60.0 : k < 1060 ? 60.0 - static_cast<double>(k - 1000) : 0.2;
    log.f.y.push_back(level + 0.5 * normal(engine));
  }
  const Conditioned c = condition(log);
  const Finding& f = only(c, "drive-off");
  EXPECT_NEAR(f.time, 9.0, 0.02);
  EXPECT_NEAR(c.records[0].t.back(), 9.0, 0.02);
  // Standing still with the drive on is kept, and marked.
  EXPECT_EQ(c.marks[0].back() & kAtRest, kAtRest);
  EXPECT_EQ(c.marks[0][4000] & kAtRest, 0);
}

TEST(Condition, LimitOfTheForceIsMarked) {
  RawLog log = logged();
  std::size_t cut = 0;
  for (double& f : log.f.y) {
    if (f > 60.0) {
      f = 60.0;
      ++cut;
    }
  }
  ASSERT_GT(cut, 100U);
  const Conditioned c = condition(log);
  const Finding& f = only(c, "saturated");
  EXPECT_FALSE(f.repaired);
  EXPECT_EQ(f.values.at(0), 60.0);
  EXPECT_EQ(static_cast<std::size_t>(std::count(c.records[0].skip.begin(), c.records[0].skip.end(), 1)), cut);
}

TEST(Condition, RunsShareOneSign) {
  // A run in one direction alone cannot tell its sign; together they can.
  std::vector<RawLog> runs;
  for (const Record& r : test::steady_runs([](double v) { return 40.0 + 40.0 * v; }, false)) {
    runs.push_back(raw(r));
    for (double& f : runs.back().f.y) f = -f;
  }
  const Conditioned c = condition(runs);
  EXPECT_THAT(kinds(c), Contains("inverted")) << texts(c);
  EXPECT_EQ(c.records.size(), runs.size());
  EXPECT_EQ(c.run[5], 5U);
  for (std::size_t i = 0; i < runs.size(); ++i) EXPECT_EQ(c.records[i].f[100], -runs[i].f.y[100]);
}

TEST(Condition, RowsOfTheLogAreKept) {
  RawLog log = logged();
  for (std::size_t k = 0; k < log.x.y.size(); ++k) log.row.push_back(1001 + k);
  erase(log, 3000, 3500);
  log.row.erase(log.row.begin() + 3000, log.row.begin() + 3500);
  EXPECT_EQ(only(condition(log), "gap").row, 4501U);
}

// In a motion of one frequency a spring k·x and a mass cannot be distinguished. identify has no spring and finds the mass.
TEST(Condition, MassOfASineShowsUnlessASpringActs) {
  Axis axis;
  RawLog log = logged(axis);
  for (std::size_t k = 0; k < axis.rows; ++k) {
    const double t = log.x.t[k];
    const double w = kTau * 0.5;
    log.x.y[k] = 0.04 * std::sin(w * t);
    log.v.y[k] = 0.04 * w * std::cos(w * t);
    log.f.y[k] +=
        axis.mass * (-0.04 * w * w * std::sin(w * t)) + 20.0 * std::tanh(log.v.y[k] / 1e-3) - axis.force(t);
  }
  const Conditioned c = condition(log);
  EXPECT_FALSE(c.rough.mass_shows);
  EXPECT_TRUE(c.rough.mass_shows_without_spring);
  EXPECT_THAT(c.determinable, Contains(HasSubstr("mass, if no spring acts on the axis")));
  EXPECT_THAT(c.cannot_tell, Not(Contains(HasSubstr("mass"))));
  // Two frequencies tell them apart.
  EXPECT_THAT(condition(logged()).determinable, Contains(HasSubstr("mass: acceleration up to")));
}

TEST(Condition, UnknownKindIsRefused) {
  try {
    static_cast<void>(condition(logged(), {{"gapp"}}));
    FAIL();
  } catch (const Refused& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("gapp"), HasSubstr("frozen")));
  }
}

TEST(Quantum, FoundWhereThereIsOne) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<double> continuous(5000);
  std::vector<double> coarse(5000);
  std::vector<double> even(5000);
  for (std::size_t k = 0; k < 5000; ++k) {
    continuous[k] = uniform(engine);
    coarse[k] = 0.0977 * std::round(continuous[k] / 0.0977 * 3.0);
    even[k] = 8.4e-3 * static_cast<double>(k);  // a constant speed has no resolution
  }
  EXPECT_EQ(quantum(continuous), 0.0);
  EXPECT_NEAR(quantum(coarse), 0.0977, 1e-9);
  EXPECT_EQ(quantum(even), 0.0);
  EXPECT_EQ(quantum({1.0, 1.0, 1.0}), 0.0);
  EXPECT_EQ(quantum({}), 0.0);
}

}  // namespace
}  // namespace stribeck::ident::log::condition_test
