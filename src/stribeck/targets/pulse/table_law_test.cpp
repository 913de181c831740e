#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/targets/pulse/table_law.hpp>
#include <stribeck/targets/pulse/test_export.hpp>

namespace stribeck::test::table_law_test {
namespace {

using ::testing::HasSubstr;

/// Force that a table of ±100 N adds at samples of 1 ms while the axis turns at 0.1 s with 1 m/s².
std::vector<double> added_force(const targets::TableForce& table) {
  control::CascadeParams params;
  control::Setup<2> setup;
  setup.period = 1e-3;
  setup.force_limit = {1e9, 1e9};
  const auto cascade = sim::make_controller<2>(params, setup);
  targets::TableCascade with(cascade, {table, table});
  const auto plain = cascade->copy();
  std::vector<double> out;
  for (int k = 0; k < 200; ++k) {
    path::PathPoint<2> r;
    const double t = (k + 0.5) * 1e-3 - 0.1;
    r.position = {0.5 * t * t, 0.0};
    r.velocity = {t, 0.0};
    r.acceleration = {1.0, 0.0};
    out.push_back(with.step(r, r.position)[0] - plain->step(r, r.position)[0]);
  }
  return out;
}

double level(double v) { return v < 0.0 ? -100.0 : v > 0.0 ? 100.0 : 0.0; }

TEST(TableCascade, WithoutWeightsTheForceTurnsWithTheVelocity) {
  const std::vector<double> force = added_force({level});
  for (std::size_t k = 0; k < force.size(); ++k) EXPECT_NEAR(force[k], k < 100 ? -100.0 : 100.0, 1e-9) << k;
}

TEST(TableCascade, TheForceGoesInTimeAndComesInDistance) {
  const std::vector<double> force = added_force({level, 400e-6, 20e-3});
  for (std::size_t k = 0; k < force.size(); ++k) {
    const double t = (static_cast<double>(k) + 0.5) * 1e-3 - 0.1;
    // The first sample after the turn, 0.5 ms behind it, is where the distance begins.
    const double expected = t < 0.0 ? -100.0 * std::min(-t / 20e-3, 1.0)
                                    : 100.0 * std::min(0.5 * (t * t - 0.25e-6) / 400e-6, 1.0);
    EXPECT_NEAR(force[k], expected, 1e-9) << k;
  }
}

TEST(BuildUp, TheTableOfIsgTakesMostOfTheQuadrantErrorAway) {
  PulseExport x("isg", kBristles);
  x.request.names = {"x"};
  x.request.gain = "12 N/%";
  EXPECT_THAT(x.refusal(), HasSubstr("--period: applies only to --to sinumerik"));
  x.request.controller = "cascade";
  const targets::Exported written = x.write();
  const auto& circle = written.json["circle"];
  EXPECT_LT(circle["pulse"]["quadrant_um"].get<double>(),
            0.35 * circle["without"]["quadrant_um"].get<double>());
  const std::string text = text_of(x.request.output);
  const std::string mark = "frict_comp.position_delay   ";
  ASSERT_NE(text.find(mark), std::string::npos);
  EXPECT_NEAR(0.1 * std::stod(text.substr(text.find(mark) + mark.size())),
              written.json["axes"][0]["build_up_um"].get<double>(), 1e-9);
  EXPECT_THAT(text, HasSubstr("frict_comp.reversal_lookahead   "));
  EXPECT_THAT(written.text, HasSubstr("after a reversal"));
}

}  // namespace
}  // namespace stribeck::test::table_law_test
