#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <stribeck/ident/drive/describe.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::describe_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Steps one to six on a symmetric axis; `change` alters the force, t runs from 0 to 1.
struct Steps {
  explicit Steps(const std::function<double(double, double)>& change = {}) {
    std::mt19937_64 engine(5);
    std::normal_distribution<double> normal;
    double row = 0.0;
    log = test::synthetic_log([&](double, double v, double a) {
      row += 1.0;
      return 250.0 * a + (v > 0.0 ? 40.0 : -40.0) + 900.0 * v + normal(engine) +
             (change ? change(row / 40000.0, v) : 0.0);
    });
    rows = gather(log.log, extent_of(log.log), {1e-3, 0.04, 0.0}, 160);
    const LinearFit first = solve(log.log, rows, terms);
    fit = solve(log.log, rows, terms, &first);
    choice = choose_map(log.log, rows, terms, fit, {});
    found_intervals = intervals(log.log, rows, terms, fit, choice, true);
  }
  [[nodiscard]] Found found() const { return {log.log, rows, terms, fit, choice, found_intervals}; }

  test::SyntheticLog log;
  Rows rows;
  Terms terms;
  LinearFit fit;
  MapChoice choice;
  Intervals found_intervals;
};

TEST(Describe, SaysWhereFrictionIsLowestAndHighest) {
  PlaceShares along;
  along.places = {friction::Place{0.1, 1.02}, friction::Place{0.25, 0.94}, friction::Place{0.4, 1.12}};
  along.half = {0.01, 0.01, 0.01};
  Result r;
  Notes notes;
  add_places(r, along, Shown(r), notes);
  EXPECT_EQ(r.friction.places.size(), 3u);
  ASSERT_EQ(notes.warnings.size(), 1u);
  EXPECT_THAT(notes.warnings[0], HasSubstr("from -6 % at 250 mm to +12 % at 400 mm"));
}

TEST(Describe, GivesParametersCurveAndPoints) {
  const Steps steps;
  Notes notes;
  const Result r = describe(steps.found(), {}, notes);
  EXPECT_EQ(r.model, "conventional");
  EXPECT_EQ(r.method, Method::kAuto);
  std::vector<std::string> names;
  for (const Parameter& p : r.parameters) {
    if (!p.name.starts_with("friction_at_")) names.push_back(p.name);
  }
  EXPECT_THAT(names, ::testing::ElementsAre("mass", "coulomb_positive", "static_positive", "viscous_positive",
                                            "coulomb_negative", "static_negative", "viscous_negative", "load",
                                            "alpha0", "alpha2"));
  EXPECT_EQ(r.parameters.size(), names.size() + 2u * 9u);
  EXPECT_NEAR(r.find("coulomb_positive")->value, 40.0, 0.5);
  EXPECT_NEAR(r.find("coulomb_negative")->value, -40.0, 0.5);
  EXPECT_NEAR(r.find("viscous_negative")->value, 900.0, 20.0);
  EXPECT_NEAR(r.parameters[0].value, 250.0, 1.0);
  EXPECT_EQ(r.parameters[0].unit, "kg");
  EXPECT_LT(r.parameters[0].ci_low, 250.0);
  EXPECT_GT(r.parameters[0].ci_high, 250.0);
  EXPECT_FALSE(r.find("load")->identifiable);  // no load: its interval holds zero
  EXPECT_EQ(r.rows, steps.rows.size());
  ASSERT_EQ(r.curve.size(), 2u * 120u);
  for (std::size_t i = 1; i < r.curve.size(); ++i) ASSERT_GT(r.curve[i].velocity, r.curve[i - 1].velocity);
  for (const CurvePoint& p : r.curve) {
    ASSERT_LE(p.ci_low, p.friction);
    ASSERT_GE(p.ci_high, p.friction);
    ASSERT_NEAR(p.friction, (p.velocity > 0 ? 40.0 : -40.0) + 900.0 * p.velocity, 1.0);
  }
  EXPECT_GT(r.r_squared, 0.99);
  EXPECT_THAT(notes.warnings, IsEmpty());
}

// A force in volts: every N of a unit stands for V, and the mass with it.
TEST(Describe, WritesTheUnitOfTheLog) {
  Steps steps;
  (*steps.log.records)[0].force_unit = "V";
  Notes notes;
  const Result r = describe(steps.found(), {}, notes);
  EXPECT_EQ(r.parameters[0].unit, "V s2/m");
  EXPECT_EQ(r.parameters[2].unit, "V");
  EXPECT_EQ(r.parameters[3].shown, "V s/mm");
}

TEST(Describe, AShiftIsAParameterAndAWarning) {
  Steps steps;
  steps.terms.shift = true;
  steps.fit = solve(steps.log.log, steps.rows, steps.terms, &steps.fit);
  steps.log.log.shift = 3.0;
  steps.found_intervals = intervals(steps.log.log, steps.rows, steps.terms, steps.fit, steps.choice, true);
  Notes notes;
  const Result r = describe(steps.found(), {}, notes);
  ASSERT_NE(r.find("force_shift"), nullptr);
  EXPECT_DOUBLE_EQ(r.find("force_shift")->value, 3e-3);
  EXPECT_FALSE(r.delay);  // late in the log: it acts at once, and a delay of its command does not show
  EXPECT_THAT(notes.warnings, ::testing::ElementsAre(HasSubstr("3 rows (3 ms) later")));
}

// The force that the drive makes acts at once: whatever its time in the log, it shows no delay of its command.
TEST(Describe, AMeasuredForceShowsNoDelay) {
  Steps steps;
  Notes notes;
  const Result commanded = describe(steps.found(), {}, notes);
  ASSERT_TRUE(commanded.delay);
  EXPECT_EQ(*commanded.delay, 0.0);
  steps.terms.shift = true;
  steps.fit = solve(steps.log.log, steps.rows, steps.terms, &steps.fit);
  steps.log.log.shift = -4.5;
  steps.found_intervals = intervals(steps.log.log, steps.rows, steps.terms, steps.fit, steps.choice, true);
  const Result late = describe(steps.found(), {}, notes);
  ASSERT_TRUE(late.delay);
  EXPECT_DOUBLE_EQ(*late.delay, 4e-3);
  // The same log of every fourth command of a control of 0.25 ms: each is held for a quarter of a row.
  DriveFitOptions fast;
  fast.control_period = 0.25e-3;
  EXPECT_DOUBLE_EQ(*describe(steps.found(), fast, notes).delay, 4.5e-3 - 0.125e-3);
  // Held for half a row, a command without delay stands at −0.25 rows.
  const auto delay_at = [&](double shift, double error) {
    steps.log.log.shift = shift;
    steps.found_intervals.shift_error = error;
    DriveFitOptions fourth;
    fourth.control_period = 0.5e-3;
    return describe(steps.found(), fourth, notes).delay;
  };
  ASSERT_TRUE(delay_at(-0.22, 0.02));
  EXPECT_EQ(*delay_at(-0.22, 0.02), 0.0);
  EXPECT_NEAR(*delay_at(-0.28, 0.02), 0.03e-3, 1e-9);
  EXPECT_FALSE(delay_at(-0.22, 0.005));
  EXPECT_FALSE(delay_at(0.55, 0.02));
  EXPECT_FALSE(delay_at(-0.22, 5.0));  // nothing tells the shift
  (*steps.log.records)[0].measured = true;
  EXPECT_FALSE(describe(steps.found(), {}, notes).delay);
}

// Below the slowest rows nothing was measured: static friction is not determined, and that is said once for both directions.
TEST(Describe, StaticFrictionIsToldBySlowRowsAlone) {
  Steps steps;
  ASSERT_GT(steps.rows.grid[0].low, 2e-3);
  Notes notes;
  const Result r = describe(steps.found(), {}, notes);
  EXPECT_FALSE(r.find("static_positive")->identifiable);
  EXPECT_TRUE(r.find("coulomb_positive")->identifiable);
  EXPECT_THAT(notes.cannot_tell,
              ::testing::ElementsAre(HasSubstr("static friction: nothing slower than 4.89 mm/s was used")));
  // Slower motion was asked for: more of it does not help.
  log::Record& record = steps.log.records->front();
  for (std::size_t k = 0; k < record.t.size(); ++k) record.r.push_back(1e-3 * record.t[k]);
  Notes stuck;
  describe(steps.found(), {}, stuck);
  EXPECT_THAT(stuck.cannot_tell, ::testing::ElementsAre(HasSubstr("the axis sticks and slips there")));
  for (map::Grid& grid : steps.rows.grid) grid.low = 1e-3;
  Notes slow;
  EXPECT_TRUE(describe(steps.found(), {}, slow).find("static_positive")->identifiable);
  EXPECT_THAT(slow.cannot_tell, IsEmpty());
}

TEST(Describe, FrictionThatFallsWithTimeIsSaid) {
  const DriftWords none = words_of_drift(Steps().found(), {});
  EXPECT_THAT(none.offset, IsEmpty());
  EXPECT_THAT(none.friction, IsEmpty());
  const DriftWords friction =
      words_of_drift(Steps([](double t, double v) { return (v > 0.0 ? -8.0 : 8.0) * t; }).found(), {});
  EXPECT_THAT(friction.offset, IsEmpty());
  EXPECT_THAT(friction.friction, HasSubstr("friction fell by"));
  const DriftWords offset = words_of_drift(Steps([](double t, double) { return 8.0 * t; }).found(), {});
  EXPECT_THAT(offset.offset, HasSubstr("the offset of the force rose by"));
  EXPECT_THAT(offset.friction, IsEmpty());
}

// Friction that falls by a quarter at every speed: 2/7 of its mean over the record, far less than of that near zero.
TEST(Describe, ADriftIsAShareOfTheFrictionAtItsSpeeds) {
  const Steps steps([](double t, double v) { return -0.25 * t * ((v > 0.0 ? 40.0 : -40.0) + 900.0 * v); });
  const std::string words = words_of_drift(steps.found(), {}).friction;
  const auto at = words.find('(');
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(words.substr(at + 1)), 100.0 * 2.0 / 7.0, 3.0) << words;
}

TEST(Describe, NoBristleWithoutAMassOrMetres) {
  Steps steps;
  Notes notes;
  Result r = describe(steps.found(), {}, notes);
  r.position_unit = "rad";
  const std::size_t before = r.parameters.size();
  Notes bristle;
  add_bristle(r, steps.found(), bristle);
  EXPECT_EQ(r.parameters.size(), before);
  EXPECT_THAT(bristle.cannot_tell, IsEmpty());
}

}  // namespace
}  // namespace stribeck::ident::drive::describe_test
