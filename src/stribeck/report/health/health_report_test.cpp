#include <gmock/gmock.h>

#include <cmath>

#include <stribeck/report/health/health_report.hpp>

namespace stribeck::report::health_report_test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Three tests of two numbers; the fit of each is a constant.
HealthReportInput input() {
  namespace health = ident::health;
  HealthReportInput in;
  in.machine = "table";
  in.command = "stribeck health m.toml";
  in.version = "1";
  HealthAxis axis{"x", {}, std::vector<health::HealthTest>(1), {}};
  for (const health::Number number : {health::Number::kCoulomb, health::Number::kViscous}) {
    health::Channel c;
    c.number = number;
    c.scale = 40.0;
    c.trend.reference = c.trend.now = 40.0;
    c.trend.drift_limit = in.limits.drift;
    for (const double day : {0.0, 1.0, 2.0}) {
      c.readings.push_back({day, 40.0, 1.0, std::nan("")});
      c.trend.curve.push_back({day, 40.0, 1.0});
    }
    axis.health.channels.push_back(c);
  }
  in.axes = {axis};
  return in;
}

// Twice the limit was drawn, and 25 % said.
TEST(HealthReport, SaysTheLimitThatIsDrawn) {
  HealthReportInput in = input();
  EXPECT_THAT(text_table(in), Not(HasSubstr("without temperatures")));
  in.axes[0].health.channels[1].trend.drift_limit = 0.5;
  EXPECT_THAT(text_table(in),
              HasSubstr("a slow change of 25 % (of viscous friction without temperatures 50 %)."));
  const std::string page = health_report(in);
  EXPECT_THAT(page, HasSubstr("a slow change from 25 % on (of viscous friction without temperatures 50 %)"));
  EXPECT_THAT(page, HasSubstr("(dashed, 25 % (of viscous friction without temperatures 50 %))"));
}

// Percent of a circle are not those of forces.
TEST(HealthReport, SaysWhatTheChangesOfACircleAreSharesOf) {
  namespace health = ident::health;
  HealthReportInput in = input();
  EXPECT_THAT(text_table(in), HasSubstr("shares of the friction level of the first test"));
  EXPECT_THAT(text_table(in), Not(HasSubstr("circle")));
  in.axes[0].health.channels.resize(1);
  in.axes[0].health.channels[0].number = health::Number::kCircularDeviation;
  const std::string words =
      "Changes of a circle are shares of twice the value of the first test, at least of 2 um.";
  EXPECT_THAT(text_table(in), HasSubstr(words));
  EXPECT_THAT(text_table(in), Not(HasSubstr("forces")));
  EXPECT_THAT(health_report(in), HasSubstr(words));
}

TEST(HealthReport, NamesTheFilesThatItWasMadeFrom) {
  HealthReportInput in = input();
  in.inputs = {{"m.toml", "0123abcd"}};
  EXPECT_THAT(health_report(in), HasSubstr("0123abcd"));
}

}  // namespace
}  // namespace stribeck::report::health_report_test
