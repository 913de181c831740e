#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <stribeck/report/run/loop_figures.hpp>

namespace stribeck::report::loop_figures_test {
namespace {

/// 1/(jω)² with a delay of 10 ms: the phase falls by 3.6 degrees per hertz from −180 on.
sim::LoopResponse double_integrator() {
  sim::LoopResponse r;
  for (int k = 0; k <= 400; ++k) {
    const double omega = 0.1 * std::pow(10.0, k / 100.0);
    r.omega.push_back(omega);
    r.loop.push_back(-1.0 / (omega * omega) * std::polar(1.0, -0.010 * omega));
  }
  return r;
}

TEST(LoopFigures, ThePhaseGoesOnWithoutJumps) {
  const sim::LoopResponse r = double_integrator();
  const std::vector<double> phase = loop_phase(r);
  ASSERT_EQ(phase.size(), r.omega.size());
  for (std::size_t k = 0; k < phase.size(); ++k)
    EXPECT_NEAR(phase[k], -180.0 - 0.010 * r.omega[k] * 180.0 / 3.14159265358979, 1e-9) << k;
}

TEST(LoopFigures, FourDrawingsOfEveryLoop) {
  const sim::LoopResponse r = double_integrator();
  const std::vector<Plot> plots =
      loop_plots({{"(f) own", &r, "#0072b2", true}, {"(f) tuned", &r, "#0072b2"}});
  ASSERT_EQ(plots.size(), 4u);
  // 0.1 rad/s has 40 dB; 1 rad/s none.
  EXPECT_NEAR(plots[0].series[0].y.front(), 40.0, 1e-9);
  EXPECT_NEAR(plots[0].series[0].x.front(), 0.1 / (2.0 * 3.14159265358979), 1e-9);
  EXPECT_NEAR(plots[0].series[1].y[100], 0.0, 1e-9);
  EXPECT_TRUE(plots[0].series[0].dashed);
  EXPECT_FALSE(plots[0].series[1].dashed);
  // Far from −1 the plane shows nothing; |1 + L| is 2 with L = 1 at half a turn of the delay.
  EXPECT_TRUE(std::isnan(plots[2].series[1].x.front()));
  EXPECT_FALSE(std::isnan(plots[2].series[1].x.back()));
  const nlohmann::ordered_json json = loop_json(r, "x");
  EXPECT_EQ(json["axis"], "x");
  EXPECT_NEAR(json["sensitivity_dB"].back().get<double>(), 0.0, 1e-4);
  EXPECT_NEAR(json["gain_dB"].front().get<double>(), 40.0, 1e-9);
}

}  // namespace
}  // namespace stribeck::report::loop_figures_test
