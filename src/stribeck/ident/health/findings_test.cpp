#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/ident/health/findings.hpp>

namespace stribeck::ident::health::findings_test {
namespace {

/// Factors and additions from a day on.
struct Event {
  double coulomb = 1.0, viscous = 1.0, mass = 1.0, load = 0.0, place = 0.0, wave = 0.0;
};

/// Coulomb 100 N, viscous 60 N at the top speed, mass 500 kg, with a scatter of 1 %.
std::vector<HealthTest> tests_with(const Event& event, int days = 80, int from = 60) {
  std::mt19937 generator(11);
  std::normal_distribution<double> normal;
  std::vector<HealthTest> out;
  for (int d = 0; d < days; ++d) {
    const Event now = d >= from ? event : Event{};
    const auto force = [&](double value) { return Force{value + 1.2 * normal(generator), 0.5}; };
    const double c = 100.0 * now.coulomb, v = 60.0 * now.viscous;
    Measured m;
    m.motion = {{0.0, 0.08}, 0.02, 0.1, 60.0};
    m.forward = force(c + 0.5 * v + now.load + 0.25 * now.place);
    m.backward = force(c + 0.5 * v - now.load + 0.25 * now.place);
    m.offset = force(now.load);
    m.coulomb = force(c + 0.25 * now.place);
    m.viscous = Viscous{(v + normal(generator)) / 0.02, 10.0};
    m.mass = Mass{500.0 * now.mass + 2.0 * normal(generator), 1.0};
    for (int j = 0; j < 4; ++j)
      m.places.push_back({0.02 * j, 0.02 * (j + 1), force(j == 2 ? 0.75 * now.place : -0.25 * now.place)});
    m.periodic.push_back({0.01, force(2.0 + now.wave)});
    HealthTest t;
    t.day = d;
    t.axis = m;
    out.push_back(t);
  }
  return out;
}

/// The first cause of the only change that matters.
std::string cause_of(const Event& event) {
  const Health health = health_of(tests_with(event));
  for (const Change& c : health.changes) {
    if (!c.matters()) continue;
    EXPECT_NEAR(c.day, 60.0, 1.0);
    return c.causes.front().what;
  }
  return "no change";
}

Event event_of(double Event::*member, double value) {
  Event e;
  e.*member = value;
  return e;
}

TEST(HealthFindings, NothingIsFoundWhereNothingHappened) {
  const Health health = health_of(tests_with({}));
  EXPECT_FALSE(health.changed());
  EXPECT_TRUE(health.changes.empty());
  EXPECT_EQ(health.channels.size(), 11U);
}

TEST(HealthFindings, NamesTheLikelyCause) {
  EXPECT_EQ(cause_of(event_of(&Event::coulomb, 0.75)), "preload lost");
  EXPECT_EQ(cause_of(event_of(&Event::coulomb, 1.3)),
            "tighter than before: preload, misalignment, wipers or chips");
  EXPECT_EQ(cause_of(event_of(&Event::load, 25.0)), "load or counterbalance");
  EXPECT_EQ(cause_of(event_of(&Event::viscous, 1.5)), "stiffer lubricant: cold, too much, or another grease");
  EXPECT_EQ(cause_of(event_of(&Event::mass, 1.2)), "more mass: workpiece, fixture or tool");
  EXPECT_EQ(cause_of(event_of(&Event::place, 40.0)), "wear or dirt between 40 and 60 mm");
  EXPECT_EQ(cause_of(event_of(&Event::wave, 20.0)), "screw, bearing or coupling out of true (period 10 mm)");
  Event dry;
  dry.coulomb = 1.3;
  dry.viscous = 0.6;
  EXPECT_EQ(cause_of(dry), "lubricant missing or old");
  Event greased;
  greased.coulomb = 0.8;
  greased.viscous = 1.4;
  EXPECT_EQ(cause_of(greased), "freshly lubricated");
  Event gain;
  gain.coulomb = gain.viscous = gain.mass = 1.2;
  EXPECT_EQ(cause_of(gain), "scale of the force: gain, current sensor or motor constant");
}

// Preload lost by a sixth beside twice as much viscous friction is 7 % of the whole.
TEST(HealthFindings, CoulombFrictionIsAShareOfItself) {
  std::vector<HealthTest> tests = tests_with(event_of(&Event::coulomb, 0.83));
  for (HealthTest& t : tests) {
    Measured& m = *t.axis;
    for (Force* f : {&m.forward, &m.backward}) f->value += 100.0;
    m.viscous->value += 200.0 / 0.02;
  }
  const Health health = health_of(tests);
  ASSERT_TRUE(health.changed());
  EXPECT_EQ(health.changes.front().causes.front().what, "preload lost");
}

TEST(HealthFindings, StepsOfOneDayAreOneChange) {
  Event dry;
  dry.coulomb = 1.3;
  dry.viscous = 0.6;
  const Health health = health_of(tests_with(dry));
  ASSERT_EQ(health.changes.size(), 1U);
  EXPECT_EQ(health.changes[0].shifts.size(), health.channels.size());
  EXPECT_GT(health.changes[0].probability, 0.98);
}

// Six days apart: they were one change of one day, with the cause of the second alone.
TEST(HealthFindings, TwoChangesInOneWeekAreTwo) {
  Event first, both;
  first.coulomb = both.coulomb = 1.25;
  both.load = 20.0;
  std::vector<HealthTest> tests = tests_with(first);
  const std::vector<HealthTest> later = tests_with(both);
  for (std::size_t d = 66; d < tests.size(); ++d) tests[d] = later[d];
  const Health health = health_of(tests);
  std::vector<const Change*> matter;
  for (const Change& c : health.changes) {
    if (c.matters()) matter.push_back(&c);
  }
  ASSERT_EQ(matter.size(), 2U);
  EXPECT_NEAR(matter[0]->day, 60.0, 1.0);
  EXPECT_EQ(matter[0]->causes.front().what, "tighter than before: preload, misalignment, wipers or chips");
  EXPECT_NEAR(matter[1]->day, 66.0, 1.0);
  EXPECT_EQ(matter[1]->causes.front().what.substr(0, 4), "load");
}

/// Weekly tests for a year with a season of Coulomb and viscous friction, and an event from day 290 on.
std::vector<HealthTest> weekly(const Event& event) {
  std::vector<HealthTest> tests = tests_with({}, 53, 1000);
  const std::vector<HealthTest> later = tests_with(event, 53, 0);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const double day = 7.0 * static_cast<double>(i);
    if (day >= 290.0) tests[i] = later[i];
    tests[i].day = day;
    const double season = std::cos(2.0 * 3.14159265 * (day - 20.0) / 365.25);
    Measured& m = *tests[i].axis;
    m.coulomb->value += 6.0 * season;
    m.viscous->value += 12.0 * season / 0.02;
    for (Force* f : {&m.forward, &m.backward}) f->value += 12.0 * season;
  }
  return tests;
}

/// What counts at the only change that matters.
std::string counted(const Health& health) {
  std::string out;
  for (const Change& c : health.changes) {
    if (!c.matters()) continue;
    for (const Shift& s : c.shifts) {
      if (s.counts) out += std::string(enum_name(health.channels[s.channel].number)) + ' ';
    }
  }
  return out;
}

// Ten weekly tests before and after lie months apart: a workpiece of 10 % was told as the scale of the force, by the season of friction.
TEST(HealthFindings, ASeasonIsNoPartOfAStep) {
  const Health health = health_of(weekly(event_of(&Event::mass, 1.105)));
  EXPECT_EQ(counted(health), "mass ");
  ASSERT_TRUE(health.changed());
  EXPECT_EQ(health.changes.front().causes.front().what, "more mass: workpiece, fixture or tool");
}

TEST(HealthFindings, AStepBesideASeasonStaysFound) {
  Event gain;
  gain.coulomb = gain.viscous = gain.mass = 1.2;
  const Health health = health_of(weekly(gain));
  EXPECT_EQ(counted(health), "forward backward coulomb viscous mass ");
  ASSERT_TRUE(health.changed());
  EXPECT_EQ(health.changes.front().causes.front().what,
            "scale of the force: gain, current sensor or motor constant");
}

/// Adds to the friction above the mean at one place, from a test up to another.
void add_at(std::vector<HealthTest>& tests, std::size_t place, std::size_t from, std::size_t to,
            double newton) {
  for (std::size_t d = from; d < to; ++d) tests[d].axis->places[place].more.value += newton;
}

// A step of half a percent in a number that hardly scatters made a change with what other numbers did meanwhile.
TEST(HealthFindings, AStepThatDoesNotCountMakesNoChange) {
  std::vector<HealthTest> tests = tests_with({}, 120, 1000);
  for (std::size_t d = 0; d < tests.size(); ++d)
    tests[d].axis->places[1].more.value = 0.01 * static_cast<double>(d % 2);
  add_at(tests, 1, 60, 120, 2.4);
  const Health health = health_of(tests);
  ASSERT_EQ(health.channels[7].trend.steps.size(), 1U) << "of 1.8 %, and sure";
  EXPECT_TRUE(health.changes.empty());
  Limits fine;
  fine.step = 0.015;
  EXPECT_TRUE(health_of(tests, fine).changed()) << "beyond a limit of 1.5 %";
}

// Mass is back to what it was, Coulomb friction is not.
TEST(HealthFindings, AChangeTakesBackOnlyWhatGoesBack) {
  std::vector<HealthTest> tests = tests_with(event_of(&Event::mass, 1.3), 120, 40);
  Event after;
  after.coulomb = 1.07;
  const std::vector<HealthTest> later = tests_with(after, 120, 80);
  for (std::size_t d = 80; d < tests.size(); ++d) tests[d] = later[d];
  const Health health = health_of(tests);
  ASSERT_EQ(health.changes.size(), 2U);
  EXPECT_FALSE(health.changes[1].restores);
  EXPECT_TRUE(health.changes[1].restores_part);
  ASSERT_FALSE(health.changes[1].causes.empty());
  EXPECT_EQ(health.changes[1].causes.front().what.substr(0, 7), "tighter");
  EXPECT_FALSE(health.changed()) << "7 % of friction are within the limit";
}

TEST(HealthFindings, AMassThatIsTakenOffAgainIsTakenBack) {
  std::vector<HealthTest> tests = tests_with(event_of(&Event::mass, 1.3), 120, 40);
  const std::vector<HealthTest> later = tests_with({}, 120, 1000);
  for (std::size_t d = 80; d < tests.size(); ++d) tests[d] = later[d];
  const Health health = health_of(tests);
  ASSERT_EQ(health.changes.size(), 2U);
  EXPECT_TRUE(health.changes[1].restores);
  EXPECT_TRUE(health.changes[1].causes.empty());
}

TEST(HealthFindings, SlowWearIsASlowChange) {
  std::vector<HealthTest> tests = tests_with({}, 200, 1000);
  for (std::size_t d = 50; d < tests.size(); ++d) {
    const double more = 0.4 * static_cast<double>(d - 50);
    tests[d].axis->forward.value += more;
    tests[d].axis->backward.value += more;
    tests[d].axis->coulomb->value += more;
  }
  const Health health = health_of(tests);
  ASSERT_FALSE(health.changes.empty());
  EXPECT_TRUE(health.changes.back().slow);
  EXPECT_TRUE(health.changed());
}

// Half a year in which viscous friction alone rises slowly.
std::vector<HealthTest> warmer(double rise, bool thermometer) {
  std::vector<HealthTest> tests = tests_with({}, 180, 1000);
  for (std::size_t d = 0; d < tests.size(); ++d) {
    const double share = static_cast<double>(d) / 180.0;
    tests[d].axis->viscous->value *= 1.0 + rise * share;
    // A thermometer whose readings have nothing to do with it.
    if (thermometer) tests[d].temperature = 20.0 + 3.0 * std::sin(2.0 * static_cast<double>(d));
  }
  return tests;
}

TEST(HealthFindings, WithoutATemperatureViscousFrictionMayFollowTheSeason) {
  // 60 N of viscous friction at the top speed, where 100 % are 130 N.
  EXPECT_FALSE(health_of(warmer(0.8, false)).changed()) << "37 % of the level";
  EXPECT_TRUE(health_of(warmer(0.8, true)).changed());
  EXPECT_TRUE(health_of(warmer(1.4, false)).changed()) << "65 %";
}

TEST(HealthFindings, ACircleThatBecomesLessRoundIsFound) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  std::vector<HealthTest> tests;
  for (int d = 0; d < 60; ++d) {
    HealthTest t;
    t.day = d;
    t.circle = CircleMeasured{0.05, (d < 40 ? 8e-6 : 14e-6) + 0.2e-6 * normal(generator), 6e-6, {}};
    tests.push_back(t);
  }
  const Health health = health_of(tests);
  ASSERT_EQ(health.changes.size(), 1U);
  EXPECT_EQ(health.changes[0].day, 40.0);
  EXPECT_EQ(health.changes[0].causes.front().what, "lost motion, friction or servo gains of the two axes");
}

}  // namespace
}  // namespace stribeck::ident::health::findings_test
