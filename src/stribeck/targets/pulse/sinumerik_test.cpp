#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/targets/pulse/circle.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/pulse/sinumerik.hpp>
#include <stribeck/targets/pulse/test_export.hpp>
#include <stribeck/targets/target.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <string>
#include <variant>

namespace stribeck::test::sinumerik_test {
namespace {

using targets::Qec;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kMmPerMin = 1e-3 / 60.0;

TEST(Sinumerik, TheCharacteristicHasTheFourRangesOfTheManual) {
  const Qec q{20 * kMmPerMin, 5 * kMmPerMin, 0.1, 0.01, 0.1, 0.4};
  EXPECT_DOUBLE_EQ(q.amplitude(0.0025), 5 * kMmPerMin);  // a quarter of a1
  EXPECT_DOUBLE_EQ(q.amplitude(0.01), 20 * kMmPerMin);
  EXPECT_DOUBLE_EQ(q.amplitude(0.1), 20 * kMmPerMin);
  EXPECT_NEAR(q.amplitude(0.2), 15 * kMmPerMin, 1e-15);  // a third of the way down from 20 to 5
  EXPECT_DOUBLE_EQ(q.amplitude(0.4), 5 * kMmPerMin);
  EXPECT_DOUBLE_EQ(q.amplitude(9.0), 5 * kMmPerMin);
  EXPECT_EQ(q.amplitude(0.0), 0.0);
}

TEST(Sinumerik, TheArchiveIsReadBackToItsRounding) {
  const Qec q{20.12349 * kMmPerMin, 5.9996 * kMmPerMin, 0.123449, 0.01, 0.10000049, 0.4};
  const std::string text = targets::archive_text(q, "AX1") + targets::archive_text(Qec{}, "AX11");
  EXPECT_THAT(text, HasSubstr("N32490 $MA_FRICT_COMP_MODE[AX1]=1\n"));
  EXPECT_THAT(text, HasSubstr("N32520 $MA_FRICT_COMP_CONST_MAX[AX1]=20.123\n"));
  EXPECT_THAT(text, HasSubstr("N32540 $MA_FRICT_COMP_TIME[AX1]=0.1234\n"));
  const Qec back = targets::read_archive(text, "AX1");
  EXPECT_DOUBLE_EQ(back.largest, 20.123 * kMmPerMin);
  EXPECT_DOUBLE_EQ(back.smallest, 6.0 * kMmPerMin);
  EXPECT_DOUBLE_EQ(back.a2, 0.1);
  EXPECT_EQ(targets::archive_text(back, "AX1"), text.substr(0, text.find("N32490", 1)));
  EXPECT_THROW(static_cast<void>(targets::read_archive(text, "AX2")), io::InputError);
}

TEST(Sinumerik, TheFitFindsACharacteristicThatHasTheForm) {
  const Qec truth{10 * kMmPerMin, 30 * kMmPerMin, 0.1, 0.002, 0.01, 0.05};
  std::vector<targets::PulsePoint> points;
  for (double a = 0.0005; a < 0.2; a *= 1.3) points.push_back({a, truth.amplitude(a), 1.0});
  const Qec found = targets::nearest_qec(points, 0.1);
  EXPECT_LT(found.a1, found.a2);
  EXPECT_LT(found.a2, found.a3);
  // Breaks come from a list in steps of 29 %; half a step moves the steepest part by that much of 20 mm/min, at most.
  for (const auto& p : points)
    EXPECT_NEAR(found.amplitude(p.acceleration), p.amplitude, 2.0 * kMmPerMin) << p.acceleration;
  // Beyond what was tried nothing grows.
  EXPECT_DOUBLE_EQ(found.amplitude(1.0), found.amplitude(points.back().acceleration));
}

TEST(Sinumerik, OneAccelerationIsALevelPulse) {
  const Qec found = targets::nearest_qec({{0.05, 12 * kMmPerMin, 1.0}}, 0.1);
  EXPECT_NEAR(found.largest, 12 * kMmPerMin, 1e-12);
  EXPECT_NEAR(found.smallest, 12 * kMmPerMin, 1e-12);
}

// A controller file lists gains by the axes of the machine: y alone had those of x.
TEST(Sinumerik, EachAxisHasItsOwnGains) {
  targets::PulseTask t;
  control::CascadeParams law;
  law.position_gain = {20.0, 60.0};
  law.velocity_gain = {100.0};
  t.loop.law = law;
  const auto gain = [&](std::size_t axis) {
    return std::get<control::CascadeParams>(targets::with_gains_of(t, axis).loop.law).position_gain[0];
  };
  t.numbers = {1};
  EXPECT_EQ(gain(0), 60.0);
  t.numbers = {1, 0};
  EXPECT_EQ(gain(0), 60.0);
  EXPECT_EQ(gain(1), 20.0);
  t.numbers = {1, 2};  // y and z of a machine that has no x
  EXPECT_EQ(gain(0), 20.0);
  EXPECT_EQ(gain(1), 60.0);
}

// With τ = T_n a pulse is a step of force m·K_p·A: the integral takes over what the pulse gives away.
TEST(PulsedCascade, APulseOfTheIntegralTimeIsAStepOfForce) {
  constexpr double kPeriod = 1e-4;
  constexpr double kMass = 500.0;
  constexpr double kAmplitude = 2e-3;
  control::CascadeParams params;  // K_p = 80 1/s, T_n = 100 ms
  control::Setup<2> setup;
  setup.period = kPeriod;
  setup.force_limit = {1e9, 1e9};
  for (auto& c : setup.compensation) c.model.mass = kMass;
  const auto cascade = sim::make_controller<2>(params, setup);
  const targets::Pulse pulse{[](double) { return kAmplitude; }, params.integral_time[0]};
  targets::PulsedCascade pulsed(cascade, params, kPeriod, {pulse, pulse});
  const auto plain = cascade->copy();
  for (int k = 0; k < 4000; ++k) {
    // The first axis turns at 0.1 s; measured exactly what is wanted.
    path::PathPoint<2> r;
    const double t = k * kPeriod - 0.1;
    r.position = {0.5 * t * t, 0.0};
    r.velocity = {t, 0.0};
    r.acceleration = {1.0, 0.0};
    const double added = pulsed.step(r, r.position)[0] - plain->step(r, r.position)[0];
    // One sample of the integral, T/T_n, on either side of the step.
    const double step = t > 0.5 * kPeriod ? kMass * 80.0 * kAmplitude : 0.0;
    if (std::abs(t) <= 1.5 * kPeriod) continue;
    ASSERT_NEAR(added, step, 2e-3 * kMass * 80.0 * kAmplitude) << t;
  }
}

/// What a pulse adds to the force of a loop without integral, as a speed [m/s], after the axis turned at 0.1 s.
std::vector<double> added_speed(const targets::Pulse& pulse, double period, int periods) {
  control::CascadeParams params;
  params.integral_time = {1e9};
  control::Setup<2> setup;
  setup.period = period;
  setup.force_limit = {1e9, 1e9};
  for (auto& c : setup.compensation) c.model.mass = 1.0;
  const auto cascade = sim::make_controller<2>(params, setup);
  targets::PulsedCascade pulsed(cascade, params, period, {pulse, pulse});
  const auto plain = cascade->copy();
  std::vector<double> out;
  for (int k = 0; k < periods; ++k) {
    path::PathPoint<2> r;
    const double t = (k + 0.5) * period - 0.1;
    r.position = {0.5 * t * t, 0.0};
    r.velocity = {t, 0.0};
    r.acceleration = {1.0, 0.0};
    out.push_back((pulsed.step(r, r.position)[0] - plain->step(r, r.position)[0]) / params.velocity_gain[0]);
  }
  return out;
}

TEST(PulsedCascade, AConstantPulseEndsAfterItsTimeOrItsDistance) {
  targets::Pulse timed;
  timed.block = 2e-3;
  timed.block_time = 3.5e-3;
  const std::vector<double> speed = added_speed(timed, 1e-3, 120);
  for (std::size_t k = 0; k < speed.size(); ++k) {
    const double expected = k < 100 ? 0.0 : k < 103 ? 2e-3 : k == 103 ? 1e-3 : 0.0;
    EXPECT_NEAR(speed[k], expected, 1e-9) << k;
  }
  targets::Pulse travelled;
  travelled.block = 2e-3;
  travelled.block_travel = {5e-6, 20e-6};
  const std::vector<double> far = added_speed(travelled, 1e-3, 120);
  for (std::size_t k = 0; k < far.size(); ++k) {
    // From the sample after the turn, half a period behind it.
    const double t = 1e-3 * (static_cast<double>(k) - 99.5);
    const double travel = 0.5 * (t * t - 0.25e-6);
    const bool inside = k >= 100 && travel >= 5e-6 && travel < 20e-6;
    EXPECT_NEAR(far[k], inside ? 2e-3 : 0.0, 1e-9) << k;
  }
}

TEST(Sinumerik, WritesWhatTakesMostOfTheQuadrantErrorAway) {
  PulseExport x("sinumerik", kBristles);
  const targets::Exported written = x.write();
  const auto& circle = written.json["circle"];
  const double without = circle["without"]["quadrant_um"];
  EXPECT_GT(without, 3.0);
  EXPECT_LT(circle["pulse"]["quadrant_um"].get<double>(), 0.35 * without);
  EXPECT_LT(circle["model"]["quadrant_um"], circle["pulse"]["quadrant_um"]);
  // The prediction is that of the numbers in the file.
  const Qec q = targets::read_archive(text_of(x.request.output), "AX1");
  EXPECT_NEAR(q.largest / kMmPerMin, written.json["axes"][0]["const_max_mm_per_min"].get<double>(), 1e-9);
  for (const auto& row : written.json["axes"][0]["grid"])
    EXPECT_LT(row["quadrant_written_um"], row["quadrant_without_um"]);
  // The same bytes again.
  const std::string first = text_of(x.request.output);
  static_cast<void>(x.write());
  EXPECT_EQ(text_of(x.request.output), first);
}

// By position a file of z was laid on the axis y of the machine.
TEST(Sinumerik, TheMachineHasTheAxesThatTheFilesName) {
  PulseExport x("sinumerik", kBristles);
  const std::string model = text_of(x.request.files.front());
  const auto file_of = [&](const std::string& axis) {
    return x.folder.write(axis + ".toml", "axis = \"" + axis + "\"\n" + model);
  };
  x.request.machine = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  x.request.period.clear();
  x.request.files = {file_of("x"), file_of("z")};
  EXPECT_THAT(x.refusal(), HasSubstr("axis: is \"z\", and"));
  EXPECT_THAT(x.refusal(), HasSubstr("has x and y"));
  x.request.files = {file_of("x"), file_of("x")};
  EXPECT_THAT(x.refusal(), HasSubstr("two files are of axis x"));
}

TEST(Sinumerik, RefusesWhatItCannotPredict) {
  EXPECT_THAT(PulseExport("sinumerik", "").refusal(),
              HasSubstr("friction.dynamics: is missing: the pulse depends on pre-sliding"));
  PulseExport x("sinumerik", kBristles);
  x.request.controller = "pid";
  EXPECT_THAT(x.refusal(), HasSubstr("--controller: expected a file whose law has the kind cascade"));
  x.request.controller.clear();
  x.request.period = "90 ms";
  EXPECT_THAT(x.refusal(), HasSubstr("the loop is unstable at a period of 90 ms"));
  x.request.period = "5 ms";
  x.request.gain = "1 N/%";
  EXPECT_EQ(x.refusal(), "--gain: does not apply to --to sinumerik");
  x.request.gain.clear();
  x.request.names = {"X]=1"};
  EXPECT_THAT(x.refusal(), HasSubstr("expected a machine axis, e.g. AX1"));
  x.request.names.clear();
  x.request.speed = "2 m/s";
  EXPECT_THAT([&] { static_cast<void>(x.write()); },
              ThrowsMessage<std::runtime_error>(HasSubstr(
                  "circle of 10 mm at 2000 mm/s with the loop cascade: give the loop of the machine with "
                  "--controller")));
}

}  // namespace
}  // namespace stribeck::test::sinumerik_test
