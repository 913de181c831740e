#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/workflow/inspect.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <string>
#include <tests/recordings/recording.hpp>
#include <vector>

namespace stribeck::test::condition_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

ident::log::Conditioned cleaned(const std::string& path, const workflow::LogOptions& options = {}) {
  return workflow::condition_log(workflow::read_log(path, options), options);
}

std::vector<std::string> kinds(const ident::log::Conditioned& c) {
  std::vector<std::string> out;
  for (const ident::log::Finding& f : c.findings) out.push_back(f.kind);
  return out;
}

const ident::log::Finding& first(const ident::log::Conditioned& c, const std::string& kind) {
  for (const ident::log::Finding& f : c.findings) {
    if (f.kind == kind) return f;
  }
  static const ident::log::Finding none;
  ADD_FAILURE() << "no " << kind;
  return none;
}

// Numbers: README of each recording.

TEST(Conditioning, EmpsNeedsNone) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const ident::log::Conditioned c = cleaned(log, {.gain = "35.15065188248547 N/V"});
  EXPECT_TRUE(c.findings.empty());
  ASSERT_EQ(c.records.size(), 1U);
  EXPECT_EQ(c.records[0].x.size(), 24841U);
  EXPECT_EQ(c.records[0].force_unit, "N");
  EXPECT_NEAR(c.sampling.x_quantum, 5e-8, 1e-12);
  EXPECT_NEAR(c.rough.mass, 95.1, 0.5);  // 95.1089 kg
  EXPECT_EQ(c.coverage.reversals, 7U);   // four cycles
}

TEST(Conditioning, TumCurrentIsAMagnitudeAndTheDriveGoesOff) {
  STRIBECK_RECORDING(log, "tum_feed_axis/FeedStep150_N0_H55.sco");
  const ident::log::Conditioned c = cleaned(log);
  EXPECT_THAT(kinds(c), ElementsAre("drive-off", "unsigned"));
  EXPECT_NEAR(c.findings[0].time, 14.38, 0.03);         // off at 14.4 s, the current falls within 60 ms
  EXPECT_NEAR(c.findings[0].values.at(1), 3.81, 0.05);  // holding current
  EXPECT_NEAR(c.findings[0].values.at(2), 0.07, 0.02);
  ASSERT_EQ(c.records.size(), 1U);
  const ident::log::Record& r = c.records[0];
  EXPECT_EQ(r.force_unit, "A");
  // Below −0.1 A in 54 samples by the model of the README; the rows themselves carry noise.
  const auto below = std::count_if(r.f.begin(), r.f.end(), [](double f) { return f < -0.1; });
  EXPECT_GT(below, 40);
  EXPECT_LT(below, 80);
  // I = 2.63 a + 4.93 v + 0.646 sgn v + 3.23 at 0.168 A behind another filter.
  EXPECT_NEAR(c.rough.mass, 2.63, 0.2);
  EXPECT_NEAR(c.rough.coulomb, 0.646, 0.03);
  EXPECT_NEAR(c.rough.offset, 3.23, 0.1);
  EXPECT_LT(c.rough.rms, 0.168);
  EXPECT_GT(c.rough.rms, 0.03);
  EXPECT_GE(c.rough.delay, 2);  // late by 5 to 6 ms, and half a row by the pairing
  EXPECT_LE(c.rough.delay, 3);
  // Left as a magnitude the same fit is no better than the README's naive one.
  EXPECT_GT(cleaned(log, {.keep = {"unsigned"}}).rough.rms, 0.15);
}

TEST(Conditioning, UbcLoggerFrozeThreeTimes) {
  STRIBECK_RECORDING(log, "ubc_feed_axis/ubc_trial3_x.csv");
  const ident::log::Conditioned c = cleaned(log);
  EXPECT_THAT(kinds(c), ElementsAre("frozen", "frozen", "frozen", "held"));
  // The README names the longest; the two shorter ones show the same way: 22 ms at 4.208 s, 13 ms at 7.142 s.
  EXPECT_NEAR(c.findings[1].values.at(0), 4.6976, 1e-6);
  EXPECT_NEAR(c.findings[1].values.at(1), 4.7936, 1e-6);
  EXPECT_NEAR(c.findings[1].values.at(2), 3.56e-3, 0.12e-3);  // jump of 3.67 mm, over the ends of both slots
  EXPECT_NEAR(c.findings[0].values.at(0), 4.208, 1e-3);
  EXPECT_NEAR(c.findings[2].values.at(0), 7.1424, 1e-3);
  EXPECT_EQ(c.sampling.x_hold, 15.0);
  EXPECT_EQ(c.sampling.v_hold, 15.0);
  EXPECT_EQ(c.sampling.f_hold, 1.0);
  ASSERT_EQ(c.records.size(), 4U);
  for (const ident::log::Record& r : c.records) EXPECT_NEAR(r.sample_time, 3e-3, 1e-9);
  // I = 3.97 a + 8.37 v + 1.108 sgn v + 0.066, rms 0.0437 A behind a 40 Hz filter.
  EXPECT_NEAR(c.rough.mass, 3.97, 0.15);
  EXPECT_NEAR(c.rough.viscous, 8.37, 0.4);
  EXPECT_NEAR(c.rough.coulomb, 1.108, 0.06);
  EXPECT_GE(c.rough.delay, 1);
  EXPECT_LE(c.rough.delay, 2);
}

TEST(Conditioning, SiemensSignAndGap) {
  STRIBECK_RECORDING(log, "siemens_edge_capture/capture_840Dsl.json");
  for (const auto& [axis, mass, friction, r2] :
       {std::tuple{"x", 8.26, 1.74, 0.999}, std::tuple{"y", 8.89, 2.49, 0.996}}) {
    const ident::log::Conditioned c = cleaned(log, {.axis = axis});
    EXPECT_THAT(kinds(c), ElementsAre("gap", "inverted")) << axis;
    EXPECT_EQ(c.findings[0].row, 1495U);  // the first row behind the gap, counted from 1
    EXPECT_NEAR(c.findings[0].values.at(0), 7.72, 1e-6);
    EXPECT_NEAR(c.rough.mass, mass, 0.06 * mass) << axis;
    EXPECT_NEAR(c.rough.coulomb, friction, 0.1 * friction) << axis;
    EXPECT_GE(c.rough.r_squared, r2 - 0.001) << axis;
    EXPECT_EQ(c.rough.delay, 1) << axis;
    ASSERT_EQ(c.records.size(), 2U);
    EXPECT_EQ(c.records[0].x.size() + c.records[1].x.size(), 3818U);
  }
  // The flat copy gives the same rows.
  STRIBECK_RECORDING(flat, "siemens_edge_capture/hf_xyz.csv");
  EXPECT_EQ(cleaned(flat, {.axis = "2"}).records[1].x.size(),
            cleaned(log, {.axis = "Y1"}).records[1].x.size());
  // Six axes: one must be named.
  EXPECT_THAT(workflow::inspect(workflow::read_log(log, {}), {}).text, HasSubstr("--axis"));
}

TEST(Conditioning, UmichIsTooCoarseForPreSliding) {
  STRIBECK_RECORDING(log, "umich_cnc_mill/experiment_01.csv");
  for (const std::string axis : {"X1", "Y1"}) {
    workflow::LogOptions options;
    options.axis = axis;
    options.sample_time = "100 ms";
    options.maps = {"x=" + axis + "_ActualPosition mm", "v=" + axis + "_ActualVelocity mm/s",
                    "current=" + axis + "_CurrentFeedback A"};
    const ident::log::Conditioned c = cleaned(log, options);
    EXPECT_NEAR(c.sampling.x_quantum_large, 1e-3, 1e-6);  // three digits: 1 mm from 100 mm on
    EXPECT_THAT(c.cannot_tell, Contains(AllOf(HasSubstr("pre-sliding"), HasSubstr("too coarse"),
                                              HasSubstr("1 mm"), HasSubstr("0.1 s between rows"))));
    EXPECT_EQ(c.rough.r_squared > 0.69, true);  // X 0.69, Y 0.62 in the README, without delay
  }
}

TEST(Conditioning, ArmHasTwoDays) {
  STRIBECK_RECORDING(log, "dd_arm/const_velocity.csv");
  for (const std::string joint : {"1", "2"}) {
    workflow::LogOptions options;
    options.axis = joint;
    options.runs = {"run"};
    const ident::log::Conditioned c = cleaned(log, options);
    EXPECT_EQ(c.records.size(), 54U);
    EXPECT_THAT(kinds(c), Contains("mixed-runs")) << joint;
    const ident::log::Finding& f = first(c, "mixed-runs");
    EXPECT_FALSE(f.repaired);
    EXPECT_THAT(f.text, AllOf(HasSubstr("different days"), HasSubstr("04_a")));
    // Between 0.4 and 0.5 deg/s (1 deg/s where the run at 0.5 is too short); 15.2 to 11.7 N m in the README.
    EXPECT_NEAR(f.values.at(1) * 57.3, 0.39, 0.02);
    EXPECT_LT(f.values.at(3), 0.0);
    EXPECT_EQ(c.records[0].position_unit, "rad");
    EXPECT_EQ(c.records[0].force_unit, "N m");
  }
  // One day alone is not warned of: the runs from 5 deg/s on.
  workflow::LogOptions options;
  options.axis = "1";
  options.runs = {"run"};
  options.keep = {"mixed-runs"};
  EXPECT_THAT(kinds(cleaned(log, options)), Not(Contains("mixed-runs")));
}

TEST(Conditioning, ScrewDrivesAreRunsWithoutPosition) {
  STRIBECK_RECORDING(log, "screw_drives/screw_drives.csv");
  for (const auto& [drive, runs] : {std::pair{"1", 16U}, {"2", 16U}, {"3", 24U}}) {
    workflow::LogOptions options;
    options.where = {std::string("drive=") + drive, "test=steady"};
    options.runs = {"set_rpm"};
    const ident::log::Conditioned c = cleaned(log, options);
    EXPECT_THAT(kinds(c), ElementsAre("no-position")) << drive;
    EXPECT_EQ(c.records.size(), runs) << drive;
    for (const ident::log::Record& r : c.records) EXPECT_EQ(r.x.size(), 500U);
    EXPECT_EQ(c.records[0].force_unit, "%");
    EXPECT_EQ(c.records[0].position_unit, "rad");
  }
  // Without a choice three drives would be one: said, with the columns that tell them apart.
  const workflow::LoggedAxis all = workflow::logged_axis(workflow::read_log(log, {}), {});
  EXPECT_THAT(all.notes, Contains(AllOf(HasSubstr("drive"), HasSubstr("set_rpm"), HasSubstr("--where"))));
}

TEST(Conditioning, DrivesOfOtherFormats) {
  STRIBECK_RECORDING(epos, "log_formats/maxon_epos_studio_recorder.csv");
  const ident::log::Conditioned a = cleaned(epos);
  EXPECT_THAT(kinds(a), ElementsAre("no-position"));
  EXPECT_EQ(a.records[0].force_unit, "%");
  STRIBECK_RECORDING(mr, "log_formats/mitsubishi_mr_configurator2.csv");
  workflow::LogOptions options;
  options.lead = "20 mm";  // README of the recording
  const ident::log::Conditioned b = cleaned(mr, options);
  EXPECT_EQ(b.records[0].position_unit, "m");
  EXPECT_NEAR(b.coverage.v_min, -207.3 * 0.02 / 6.2832, 0.01);
  STRIBECK_RECORDING(bldc, "bldc_cogging/hold_up.csv");
  const ident::log::Conditioned c = cleaned(bldc);
  EXPECT_THAT(kinds(c), Contains("irregular"));
  EXPECT_EQ(c.records[0].x.size(), 15714U);
  EXPECT_NEAR(c.sampling.x_quantum, 6.2832 / 20000.0, 1e-6);
}

}  // namespace
}  // namespace stribeck::test::condition_test
