// As stored_forces_test.cpp, with two axes that differ in every setting, so that a number of the wrong axis is seen. Where a change is
// meant, STRIBECK_PRINT_FORCES=1 prints the new table.
#include <gtest/gtest.h>

#include <stribeck/control/test_stored.hpp>

namespace stribeck::control::stored_axes_test {
namespace {

using namespace test_stored;

/// Mass, friction, encoder, poles and spreads of both axes; the second has periodic friction and a coarse encoder too.
void apart(Setup<2>& s) {
  CompensationParams& x = s.compensation[0];
  CompensationParams& y = s.compensation[1];
  s.force_limit = {{180.0, 150.0}};
  y.model.mass = 90.0;
  y.model.friction.eccentric = {
      friction::Eccentric<double>{2.2, 3e-3, 1.1},
      friction::Eccentric<double>{0.8, 1.1e-3, 0.3, friction::EccentricForm::kProportional}};
  y.encoder_resolution = 1.3e-6;
  x.observer_pole = 70.0;
  y.observer_pole = 35.0;
  x.adaptive_gain = 24.0;
  y.adaptive_gain = 41.0;
  x.adaptation.memory = 4.0;
  y.adaptation.memory = 9.0;
  x.adaptation.level_spread = 0.3;
  y.adaptation.level_spread = 0.2;
  x.adaptation.viscous_spread = 0.35;
  y.adaptation.viscous_spread = 0.15;
  x.adaptation.stiffness_spread = 0.5;
  y.adaptation.stiffness_spread = 0.3;
  x.adaptation.mass_spread = 0.2;
  y.adaptation.mass_spread = 0.1;
  x.adaptation.delay_spread = 0.7;
  y.adaptation.delay_spread = 0.3;
  x.adaptation.noise_share = 0.08;
  y.adaptation.noise_share = 0.02;
  x.adaptation.correlation = 0.03;
  y.adaptation.correlation = 0.11;
  y.guarded = false;
}

std::function<void(Setup<2>&)> apart_with(Feedforward f, Observer o, bool adapts = false) {
  return [=](Setup<2>& s) {
    everywhere(s, f, o, adapts);
    apart(s);
  };
}

ContouringParams along() { return ContouringParams::critical(45.0, 30.0); }

void add_laws(std::vector<Case>& all) {
  const auto add = [&](std::string name, LawParams law, int periods = kPeriods) {
    all.push_back({std::move(name),
                   std::move(law),
                   apart_with(Feedforward::kSteady, Observer::kNone),
                   {},
                   {},
                   {},
                   periods});
  };
  PidParams pid;
  pid.kp = {2700.0, 1500.0};
  pid.ki = {27000.0, 9000.0};
  pid.kv = {90.0, 65.0};
  add("pid", pid);
  CascadeParams cascade;
  cascade.position_gain = {22.0, 13.0};
  cascade.velocity_gain = {80.0, 55.0};
  cascade.integral_time = {0.08, 0.17};
  cascade.velocity_feedforward = 0.9;
  cascade.acceleration_feedforward = 0.7;
  add("cascade", cascade);
  ZpetcParams zpetc;
  zpetc.kp = {1600.0, 900.0};
  zpetc.kv = {80.0, 50.0};
  add("zpetc", zpetc);
  CrossCoupledParams coupled;
  coupled.kp = {1600.0, 700.0};
  coupled.kv = {80.0, 45.0};
  coupled.contour_kp = 1100.0;
  coupled.contour_ki = 9000.0;
  coupled.contour_kv = 25.0;
  add("cross-coupled", coupled);
  RepetitiveParams repetitive;
  repetitive.kp = {1600.0, 1000.0};
  repetitive.kv = {80.0, 60.0};
  repetitive.learning = 0.5;
  repetitive.cutoff = 70.0;
  repetitive.lead = 3;
  add("repetitive", repetitive, 16000);
  LearningParams learning;
  learning.kp = {1500.0, 900.0};
  learning.kv = {75.0, 55.0};
  learning.learning = 0.8;
  learning.least_learning = 0.3;
  learning.cutoff = 150.0;
  add("learning", learning, 16000);
  PredictiveParams predictive;
  predictive.omega = 35.0;
  predictive.horizon = 0.04;
  predictive.iterations = 9;
  predictive.speed_limit = {24e-3, 9e-3};
  predictive.catch_up = 0.2;
  predictive.reserve = 0.15;
  add("predictive", predictive);
  SlidingModeParams sliding;
  sliding.lambda = {25.0, 17.0};
  sliding.a = {12.0, 7.0};
  sliding.gamma = {8e-3, 15e-3};
  sliding.mass_bound = {10.0, 4.0};
  sliding.force_bound = {20.0, 9.0};
  sliding.gamma_least = {0.5e-3, 2e-3};
  sliding.gamma_most = {40e-3, 15e-3};
  sliding.boundary = 2e-3;
  sliding.growth = 1500.0;
  sliding.layer = 3.0;
  for (const auto& [name, switching] :
       {std::pair{"sign", Switching::kSign}, std::pair{"layer", Switching::kBoundaryLayer},
        std::pair{"tanh", Switching::kTanh}, std::pair{"twisting", Switching::kSuperTwisting}}) {
    for (const auto& [kind, gain] :
         {std::pair{"printed", SwitchingGain::kPrinted}, std::pair{"sufficient", SwitchingGain::kSufficient},
          std::pair{"adaptive", SwitchingGain::kAdaptive}}) {
      if (switching == Switching::kSuperTwisting && gain == SwitchingGain::kAdaptive) continue;
      sliding.switching = switching;
      sliding.gain = gain;
      add(std::string("sliding-") + name + "-" + kind, sliding);
    }
  }
}

/// Laws whose samples are late, and which use the rate of an observer.
void add_late_laws(std::vector<Case>& all) {
  const auto add = [&](std::string name, LawParams law) {
    all.push_back({std::move(name),
                   std::move(law),
                   [](Setup<2>& s) {
                     everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
                     apart(s);
                     s.compensation[0].model.delay = 0.6 * kPeriod;
                     s.compensation[1].model.delay = 2.3 * kPeriod;
                   },
                   {}});
  };
  ZpetcParams zpetc;
  zpetc.preview = Preview::kDelayed;
  add("late-zpetc", zpetc);
  PredictiveParams predictive;
  predictive.slows = false;
  predictive.rate_at_sample = true;
  add("late-predictive", predictive);
  add("late-learning", LearningParams{});
  add("late-repetitive", RepetitiveParams{});
  CascadeParams cascade;
  cascade.error_rate = ErrorRate::kLate;
  add("late-cascade", cascade);
}

void add_compensations(std::vector<Case>& all) {
  const auto add = [&](std::string name, std::function<void(Setup<2>&)> change, int periods = kPeriods) {
    all.push_back({std::move(name), along(), std::move(change), {}, {}, {}, periods});
  };
  add("disturbance", apart_with(Feedforward::kDynamic, Observer::kDisturbance, true), 12000);
  add("kalman", apart_with(Feedforward::kDynamic, Observer::kKalman, true), 12000);
  add("adaptive", apart_with(Feedforward::kReversal, Observer::kAdaptive, true), 12000);
  add("reversal", [](Setup<2>& s) {
    everywhere(s, Feedforward::kReversal, Observer::kDisturbance, true);
    apart(s);
    s.compensation[0].reversal.lead = 2.2e-3;
    s.compensation[0].reversal.short_move = 3e-3;
    s.compensation[0].reversal.rate_limit = 900.0;
    s.compensation[1].reversal.distance = 9e-6;
    s.compensation[1].reversal.lead = 0.6e-3;
  });
  add("densities", [](Setup<2>& s) {
    everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
    apart(s);
    s.compensation[0].disturbance_density = 2e4;
    s.compensation[1].disturbance_density = 9e4;
  });
  for (const auto mode : {friction::DriveMode::kVelocity, friction::DriveMode::kPosition}) {
    for (const bool offset : {false, true}) {
      add(std::string(mode == friction::DriveMode::kVelocity ? "velocity" : "position") +
              (offset ? "-offset" : "-loop"),
          [=](Setup<2>& s) {
            everywhere(s, Feedforward::kDynamic, Observer::kDisturbance, true);
            apart(s);
            loops(s, mode, offset);
            friction::DriveLoop& y = *s.compensation[1].model.drive_loop;
            y.gain = 6e3;
            y.integral_time = {};
            y.position_gain = 35.0;
            y.velocity_feedforward = 0.55;
            s.compensation[0].model.delay = 1.2 * kPeriod;
          });
    }
  }
}

/// Bounds of both axes that differ, checks of the first axis as given.
std::function<void(Supervision<2>&)> bounds(Checks first) {
  return [=](Supervision<2>& all) {
    SupervisionParams& x = all[0];
    SupervisionParams& y = all[1];
    x.checks = first;
    x.speed_limit = 60e-3;
    y.speed_limit = 35e-3;
    x.acceleration_limit = 0.5;
    y.acceleration_limit = 0.3;
    x.omega = 45.0;
    y.omega = 30.0;
    x.following_time = 0.15;
    y.following_time = 0.06;
    x.bridge_time = 8e-3;
    y.bridge_time = 13e-3;
    x.stop_time = 30e-3;
    y.stop_time = 70e-3;
    x.saturation_time = 0.3;
    y.saturation_time = 0.7;
    x.start_share = 0.4;
    y.start_share = 0.7;
    y.jump = 40e-6;
    y.push = 90.0;
    y.following_error = 0.8e-3;
  };
}

void add_supervised(std::vector<Case>& all) {
  const auto add = [&](std::string name, Trouble trouble, Checks first = Checks::kAll) {
    all.push_back({std::move(name), along(),
                   [](Setup<2>& s) {
                     everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
                     apart(s);
                     s.compensation[0].adaptation.enabled = false;
                   },
                   std::move(trouble), bounds(first)});
  };
  add("sound", [](int, Given) {});
  add(
      "sound-lost", [](int, Given) {}, Checks::kLost);
  add(
      "sound-none", [](int, Given) {}, Checks::kNone);
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    const std::string tail = axis == 0 ? "-first" : "-second";
    add("wild" + tail, [=](int k, Given g) {
      if (k % 701 == 700) g.measured[axis] += 2e-3;
      if (k % 503 == 502) g.measured[axis] = kNan;
      if (k % 311 == 310) g.measured[axis] += 3e-6;
      if (k > 4000 && k < 4007) g.measured[axis] = -1.0;
      if (k == 2200) g.r.position[axis] = kNan;
      if (k == 2300) g.r.velocity[axis] = kNan;
      if (k == 2400) g.r.acceleration[axis] = kNan;
      if (k == 2500) g.r.frame[axis][1 - axis] = kNan;
      if (k == 2600) g.r.frame_rate[axis][1 - axis] = kNan;
      if (k == 2700) g.r.frame_acceleration[axis][axis] = kNan;
      if (k % 401 == 400) g.elapsed = (1.4 + 0.3 * static_cast<double>(axis)) * kPeriod;
    });
    add("lost" + tail, [=](int k, Given g) {
      if (k >= 1800 && k < 2000) g.measured[axis] = kNan;
      g.reset = k == 2400;
    });
    add("frozen" + tail, [=, frozen = 0.0](int k, Given g) mutable {
      if (k == 1500) frozen = g.measured[axis];
      if (k >= 1500) g.measured[axis] = frozen;
    });
    add("wrong-sign" + tail,
        [=](int, Given g) { g.measured[axis] = (axis == 0 ? 20e-3 : 4e-3) - g.measured[axis]; });
    add("command" + tail, [=](int k, Given g) {
      if (k > 3900) g.r.acceleration[axis] = kNan;
    });
    add("command-jumps" + tail, [=](int k, Given g) {
      if (k > 2000) g.r.position[axis] -= 2e-3;
    });
    add("drifts" + tail, [=](int k, Given g) {
      if (k > 2000) g.measured[axis] += 2e-6 * (k - 2000);
    });
  }
  add("late", [](int k, Given g) {
    if (k > 2500) g.elapsed = 1.6 * kPeriod;
  });
  add("long-late", [](int k, Given g) {
    if (k == 2500) g.elapsed = 9.4 * kPeriod;
    if (k == 3500) g.elapsed = 60.0 * kPeriod;
  });
  add(
      "late-lost",
      [](int k, Given g) {
        if (k > 2500) g.elapsed = 1.6 * kPeriod;
        if (k > 4000) g.measured[0] = kNan;
      },
      Checks::kLost);
}

/// What sits between motor and table, in other sizes and with moves of other shapes.
void add_lost_motion(std::vector<Case>& all) {
  const auto add = [&](std::string name, std::function<void(LostMotionParams&)> lose) {
    all.push_back({std::move(name),
                   along(),
                   apart_with(Feedforward::kSteady, Observer::kNone),
                   {},
                   {},
                   std::move(lose)});
  };
  add("play-alone", [](LostMotionParams& p) {
    p.stiffness = {};
    p.table_friction = 0.0;
    p.backlash = 25e-6;
  });
  add("wind-up-alone", [](LostMotionParams& p) {
    p.backlash = p.backlash_slope = 0.0;
    p.table_mass = 0.0;
    p.build_up = 8e-6;
  });
  add("slow-moves", [](LostMotionParams& p) {
    p.backlash = 40e-6;
    p.backlash_slope = -9e-4;
    p.move.speed = 2e-3;
    p.move.acceleration = 0.15;
    p.move.jerk = 12.0;
  });
  add("over-a-distance", [](LostMotionParams& p) {
    p.backlash = 18e-6;
    p.move.distance = 60e-6;
  });
  add("over-cycles", [](LostMotionParams& p) {
    p.backlash = 18e-6;
    p.move.cycles = 14;
  });
}

const Stored kStored[] = {
    {"pid", {-4574.3404, 2115.79476, -560.784183}},
    {"cascade", {-4599.80925, 1850.60714, -560.784183}},
    {"zpetc", {-4560.98861, 1520.54235, -560.784183}},
    {"cross-coupled", {-4553.08358, 1972.85415, -560.784183}},
    {"repetitive", {-5408.84836, 2018.63407, -858.627221}},
    {"learning", {-5555.05484, 1930.81276, -858.627221}},
    {"predictive", {-4181.05061, -189.534395, -560.729991}},
    {"sliding-sign-printed", {-4694.5177, 174.348337, -560.784183}},
    {"sliding-sign-sufficient", {-4718.27906, 1124.72047, -560.784183}},
    {"sliding-sign-adaptive", {-4675.64068, 1375.50794, -560.784183}},
    {"sliding-layer-printed", {-4505.57055, 1857.86917, -560.784183}},
    {"sliding-layer-sufficient", {-4448.41913, 1554.2834, -560.784183}},
    {"sliding-layer-adaptive", {-4626.35257, 1234.43002, -560.784183}},
    {"sliding-tanh-printed", {-4522.91285, 1647.66045, -560.784183}},
    {"sliding-tanh-sufficient", {-4447.45103, 1825.72498, -560.784183}},
    {"sliding-tanh-adaptive", {-4688.83497, 1285.60124, -560.784183}},
    {"sliding-twisting-printed", {-4376.95409, 1816.76307, -560.784183}},
    {"sliding-twisting-sufficient", {-4371.98329, 1296.99327, -560.784183}},
    {"late-zpetc", {-2032.01606, -1199.94608, 462.792874}},
    {"late-predictive", {-2026.012, -1171.24536, 463.027926}},
    {"late-learning", {-2025.78994, -1183.41906, 463.569835}},
    {"late-repetitive", {-2015.44365, -1080.82559, 463.576239}},
    {"late-cascade", {-1973.98707, -920.551967, 463.08975}},
    {"disturbance", {-4692.63356, -1907.27581, 309.205772}},
    {"kalman", {-4641.88558, -1593.4603, 309.370042}},
    {"adaptive", {-4770.78039, -1273.43126, 319.575702}},
    {"reversal", {-1739.64499, -826.08305, 1771.96164}},
    {"densities", {-1924.01224, -1465.71329, 490.312672}},
    {"velocity-loop", {897.838988, 1468.87001, 11274.9479}},
    {"velocity-offset", {897.838988, 1468.87001, 3816.49592}},
    {"position-loop", {897.838988, 1468.87001, 7026.67016}},
    {"position-offset", {897.838988, 1468.87001, 4508.61389}},
    {"sound", {-2422.25021, 934.796393, -640.236024}},
    {"sound-lost", {-2422.25021, 934.796393, -640.236024}},
    {"sound-none", {-2422.25021, 934.796393, -640.236024}},
    {"wild-first", {-2329.53505, 643.301081, -626.51022}},
    {"lost-first", {-798.494186, -766.662165, -245.449213}},
    {"frozen-first", {-1242.03651, -730.332746, -264.318245}},
    {"wrong-sign-first", {40.5631067, -24.239548, -650.853047}},
    {"command-first", {-2016.76314, 562.44915, -524.499155}},
    {"command-jumps-first", {-2170.68575, 1141.24894, -787.734797}},
    {"drifts-first", {-3441.70731, 915.81827, -640.691039}},
    {"wild-second", {-2389.64675, 863.767772, -642.605669}},
    {"lost-second", {-773.762253, -713.832162, -255.717753}},
    {"frozen-second", {-1061.1295, -395.477369, -341.187163}},
    {"wrong-sign-second", {11.721338, -512.448751, -626.962026}},
    {"command-second", {-2016.76314, 562.44915, -677.274221}},
    {"command-jumps-second", {-1015.00643, -612.972753, -495.230117}},
    {"drifts-second", {-2485.01895, -115.534634, -647.37372}},
    {"late", {-1699.45443, -128.595135, -395.295297}},
    {"long-late", {-1767.28955, -165.703905, -407.0887}},
    {"late-lost", {-1699.45443, -128.595135, -394.433299}},
    {"play-alone", {-4594.14676, 1483.11262, -750.479049}},
    {"wind-up-alone", {-4594.14676, 1483.11262, -178.057377}},
    {"slow-moves", {-4594.14676, 1483.11262, -1026.1272}},
    {"over-a-distance", {-4594.14676, 1483.11262, -1281.67174}},
    {"over-cycles", {-4594.14676, 1483.11262, -1119.5739}},
};

std::vector<Case> cases() {
  std::vector<Case> all;
  add_laws(all);
  add_late_laws(all);
  add_compensations(all);
  add_supervised(all);
  add_lost_motion(all);
  for (Case& one : all) one.second = true;
  return all;
}

class StoredAxes : public ::testing::TestWithParam<std::size_t> {};

TEST_P(StoredAxes, AreThoseOfTheTable) { expect_stored(cases().at(GetParam()), kStored[GetParam()]); }

INSTANTIATE_TEST_SUITE_P(Runs, StoredAxes, ::testing::Range(std::size_t{0}, std::size(kStored)),
                         [](const auto& one) { return name_of(kStored[one.param]); });

TEST(StoredAxesTable, HasEveryRun) {
  if (printing()) return print(cases());
  EXPECT_EQ(cases().size(), std::size(kStored));
}

}  // namespace
}  // namespace stribeck::control::stored_axes_test
