#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <tests/recordings/recording.hpp>
#include <vector>

namespace stribeck::test::bristle_test {
namespace {

friction::AxisModel axis_model(double mass, double load, double coulomb, double viscous) {
  friction::AxisModel a;
  a.mass = mass;
  a.load = load;
  friction::Conventional<double> c;
  c.alpha0 = coulomb;
  c.alpha2 = viscous;
  a.friction.steady = c;
  return a;
}

ident::log::Record record(double sample_time, const std::vector<double>& x, const std::vector<double>& f,
                          double x_scale, double f_scale) {
  ident::log::Record r;
  r.source = "recording";
  r.sample_time = sample_time;
  for (std::size_t k = 0; k < x.size(); ++k) {
    r.t.push_back(sample_time * static_cast<double>(k));
    r.x.push_back(x_scale * x[k]);
    r.f.push_back(f_scale * f[k]);
  }
  return r;
}

TEST(BristleRecordings, EmpsTurnsSlowlyEnoughForItsEncoder) {
  STRIBECK_RECORDING(path, "emps/emps.csv");
  const io::Log log = io::read_csv(path);
  ident::log::Record r = record(1e-3, log.columns[2].values, log.columns[3].values, 1.0, 35.15065188248547);
  r.r = log.columns[1].values;
  const auto fit = ident::bristle::fit_bristle({r}, axis_model(95.1089, -3.1648, 20.3935, 203.5034));
  ASSERT_TRUE(fit.determinable) << fit.reason;
  EXPECT_EQ(fit.reversals, 7U);
  // 50 nm encoder, eight samples within three break-away distances.
  EXPECT_GT(fit.break_away, 5.5e-6);
  EXPECT_LT(fit.break_away, 9e-6);
  ASSERT_TRUE(fit.lugre.has_value());
  EXPECT_GT(fit.lugre->sigma0, 1.6e6);
  EXPECT_LT(fit.lugre->sigma0, 2.6e6);
  EXPECT_LT(fit.models[1].held_out_rms, 0.25 * fit.models[0].held_out_rms);
  // No Stribeck peak: the level at rest lies below the Coulomb force of the straight line.
  EXPECT_LT(fit.level_factor[0], 0.85);
  EXPECT_LT(fit.level_factor[1], 0.85);
}

TEST(BristleRecordings, ArmRepeatsItsStiffness) {
  STRIBECK_RECORDING(path, "dd_arm/presliding.csv");
  const io::Log log = io::read_csv(path, {.leave_out_text_columns = true});
  const auto& t = log.at("t_s").values;
  const auto& q = log.at("q_deg").values;
  const auto& torque = log.at("tau_Nm").values;
  const auto& joint = log.at("joint").values;
  // Runs follow one another; the torque of the first three of joint 1 swings from −6 to 6 Nm.
  std::vector<double> stiffness;
  for (std::size_t from = 0; from < t.size();) {
    std::size_t to = from + 1;
    while (to < t.size() && t[to] > t[to - 1]) ++to;
    std::vector<double> x(q.begin() + static_cast<std::ptrdiff_t>(from),
                          q.begin() + static_cast<std::ptrdiff_t>(to));
    std::vector<double> f(torque.begin() + static_cast<std::ptrdiff_t>(from),
                          torque.begin() + static_cast<std::ptrdiff_t>(to));
    bool both_ways = false;
    for (const double value : f) both_ways = both_ways || value < -5.0;
    if (joint[from] == 1.0 && both_ways) {
      ident::log::Record r = record(0.015, x, f, std::acos(-1.0) / 180.0, 1.0);
      r.position_unit = "rad";
      r.force_unit = "N m";
      r.loop = ident::log::Loop::kOpen;
      ident::bristle::BristleOptions options;
      options.mass_tolerance = 0.02;
      const auto fit = ident::bristle::fit_bristle({r}, axis_model(2.519, 0.0, 11.4, 2.0), options);
      EXPECT_TRUE(fit.determinable) << fit.reason;
      ASSERT_TRUE(fit.gms.has_value());
      stiffness.push_back(fit.gms->stiffness());
    }
    from = to;
  }
  ASSERT_EQ(stiffness.size(), 3U);
  for (const double k : stiffness) {
    EXPECT_GT(k, 1.7e5);
    EXPECT_LT(k, 2.4e5);
  }
}

TEST(BristleRecordings, MillIsSaidToBeTooCoarse) {
  STRIBECK_RECORDING(path, "umich_cnc_mill/experiment_01.csv");
  const io::Log log = io::read_csv(path, {.leave_out_text_columns = true});
  ident::log::Record r =
      record(0.1, log.at("X1_ActualPosition").values, log.at("X1_CurrentFeedback").values, 1e-3, 1.0);
  r.force_unit = "A";
  const auto fit = ident::bristle::fit_bristle({r}, axis_model(20.0, 0.0, 3.0, 100.0));
  EXPECT_FALSE(fit.determinable);
  EXPECT_NE(fit.reason.find("not determinable from this log"), std::string::npos);
  EXPECT_NE(fit.reason.find("encoder"), std::string::npos) << fit.reason;
}

}  // namespace
}  // namespace stribeck::test::bristle_test
