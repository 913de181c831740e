// The forces of every law, observer, feed-forward and supervision on one motion, against forces that were stored: any change of a
// force is seen here, also one that no closed form tells. Where a change is meant, STRIBECK_PRINT_FORCES=1 prints the new table.
#include <gtest/gtest.h>

#include <stribeck/control/test_stored.hpp>

namespace stribeck::control::stored_forces_test {
namespace {

using namespace test_stored;

ContouringParams critical() { return ContouringParams::critical(40.0, 60.0); }

std::function<void(Setup<2>&)> with(Feedforward f, Observer o, bool adapts = false) {
  return [=](Setup<2>& s) { everywhere(s, f, o, adapts); };
}

/// Each law alone.
void add_laws(std::vector<Case>& all) {
  const auto add = [&](std::string name, LawParams law) {
    all.push_back({std::move(name), std::move(law), {}, {}});
  };
  add("contouring", critical());
  add("pid", PidParams{});
  add("cascade", CascadeParams{});
  add("zpetc", ZpetcParams{});
  ZpetcParams delayed;
  delayed.preview = Preview::kDelayed;
  add("zpetc-delayed", delayed);
  add("cross-coupled", CrossCoupledParams{});
  add("repetitive", RepetitiveParams{});
  add("learning", LearningParams{});
  add("predictive", PredictiveParams{});
  for (const auto& [name, switching, gain] :
       {std::tuple{"sliding-sign", Switching::kSign, SwitchingGain::kPrinted},
        std::tuple{"sliding-layer", Switching::kBoundaryLayer, SwitchingGain::kSufficient},
        std::tuple{"sliding-tanh", Switching::kTanh, SwitchingGain::kAdaptive},
        std::tuple{"sliding-twisting", Switching::kSuperTwisting, SwitchingGain::kPrinted}}) {
    SlidingModeParams p;
    p.switching = switching;
    p.gain = gain;
    p.mass_bound = {10.0};
    p.force_bound = {20.0};
    add(name, p);
  }
  ContouringParams late_rate = critical();
  late_rate.error_rate = ErrorRate::kLate;
  add("late-rate", late_rate);
}

void add_compensations(std::vector<Case>& all) {
  const auto add = [&](std::string name, LawParams law, std::function<void(Setup<2>&)> change) {
    all.push_back({std::move(name), std::move(law), std::move(change), {}});
  };
  add("steady", critical(), with(Feedforward::kSteady, Observer::kNone));
  add("disturbance", critical(), with(Feedforward::kSteady, Observer::kDisturbance));
  add("kalman", critical(), with(Feedforward::kDynamic, Observer::kKalman));
  add("adaptive", critical(), with(Feedforward::kReversal, Observer::kAdaptive));
  add("adaptation", critical(), with(Feedforward::kDynamic, Observer::kKalman, true));
  add("reversal-adapts", critical(), with(Feedforward::kReversal, Observer::kDisturbance, true));
  ContouringParams observed = critical();
  observed.error_rate = ErrorRate::kObserved;
  add("observed-rate", observed, [](Setup<2>& s) {
    everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
    for (CompensationParams& c : s.compensation) c.disturbance_density = 4e4;
  });
  for (const double periods : {0.4, 1.0, 2.3}) {
    add("delay-" + std::to_string(static_cast<int>(10.0 * periods)), critical(), [=](Setup<2>& s) {
      everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
      late(s, periods);
    });
  }
  add("build-up", critical(), [](Setup<2>& s) {
    everywhere(s, Feedforward::kReversal, Observer::kDisturbance, true);
    s.compensation[0].reversal.build_up = {BuildUpPoint{0.0, 0.1}, BuildUpPoint{2e-6, 0.6},
                                           BuildUpPoint{9e-6, 1.1}, BuildUpPoint{30e-6, 1.0}};
    s.compensation[0].reversal.lead = 1.5e-3;
    s.compensation[1].reversal.distance = 6e-6;
    s.compensation[1].reversal.rate_limit = 2e3;
    s.compensation[1].reversal.short_move = 8e-3;
  });
  add("no-bristles", critical(), [](Setup<2>& s) {
    everywhere(s, Feedforward::kReversal, Observer::kKalman, true);
    for (CompensationParams& c : s.compensation) c.model.friction.dynamics = friction::Static{};
  });
  for (const auto mode : {friction::DriveMode::kVelocity, friction::DriveMode::kPosition}) {
    for (const bool offset : {false, true}) {
      add(std::string(mode == friction::DriveMode::kVelocity ? "velocity" : "position") +
              (offset ? "-offset" : "-loop"),
          critical(), [=](Setup<2>& s) {
            everywhere(s, Feedforward::kDynamic, Observer::kDisturbance, true);
            loops(s, mode, offset);
          });
    }
  }
  add("oscillation", ContouringParams::critical(250.0, 250.0), [](Setup<2>& s) {
    everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
    for (CompensationParams& c : s.compensation) c.observer_pole = 400.0;
  });
}

void add_supervised(std::vector<Case>& all) {
  const auto add = [&](std::string name, Trouble trouble) {
    all.push_back({std::move(name), critical(), with(Feedforward::kDynamic, Observer::kKalman, true),
                   std::move(trouble)});
  };
  add("sound", [](int, Given) {});
  add("wild-samples", [](int k, Given g) {
    if (k % 701 == 700) g.measured[0] += 3e-3;
    if (k % 503 == 502) g.measured[1] = kNan;
    if (k % 311 == 310) g.measured[0] += 1e-6;
    if (k > 4000 && k < 4006) g.measured[0] = -1.0;
    if (k % 907 == 906) g.r.acceleration[1] = kNan;
    if (k == 2200 || k == 2201) g.r.position[0] = kNan;
    if (k % 401 == 400) g.elapsed = 2.2 * kPeriod;
  });
  add("lost-and-reset", [](int k, Given g) {
    if (k >= 1800 && k < 2000) g.measured[1] = kNan;
    if (k >= 5200 && k < 5300) g.measured[0] = kNan;
    g.reset = k == 2400 || k == 5500;
  });
  add("frozen", [frozen = 0.0](int k, Given g) mutable {
    if (k == 1500) frozen = g.measured[0];
    if (k >= 1500) g.measured[0] = frozen;
  });
  add("wrong-sign", [](int, Given g) { g.measured[1] = 4e-3 - g.measured[1]; });
  add("command-lost", [](int k, Given g) {
    if (k > 3900) g.r.velocity[1] = kNan;
  });
  add("too-late", [](int k, Given g) {
    if (k > 4200) g.elapsed = 1.7 * kPeriod;
  });
  add("command-jumps", [](int k, Given g) {
    if (k > 2000) g.r.position[0] += 3e-3;
  });
}

const Stored kStored[] = {
    {"contouring", {2295.0926, -2581.90564, -132.90439}},
    {"pid", {2369.35172, -2582.04932, -132.90439}},
    {"cascade", {2390.22211, -2490.84157, -132.90439}},
    {"zpetc", {2402.445, -2063.43752, -132.90439}},
    {"zpetc-delayed", {2434.20648, -2035.06236, -132.90439}},
    {"cross-coupled", {2295.76949, -2570.95797, -132.90439}},
    {"repetitive", {2374.76939, -2258.28353, -132.90439}},
    {"learning", {2365.16694, -2043.39773, -132.90439}},
    {"predictive", {2427.36015, -2055.25564, -132.90439}},
    {"sliding-sign", {1694.42868, -1620.58179, -132.90439}},
    {"sliding-layer", {2039.10691, -2731.74663, -132.90439}},
    {"sliding-tanh", {1933.45863, -1537.85885, -132.90439}},
    {"sliding-twisting", {2465.18698, -2865.89018, -132.90439}},
    {"late-rate", {2331.71773, -2573.61299, -132.90439}},
    {"steady", {2660.3467, -2540.16883, 671.570037}},
    {"disturbance", {2572.2399, -2495.86671, 671.570037}},
    {"kalman", {2842.02817, -2404.72216, -332.965226}},
    {"adaptive", {2867.36636, -2447.14916, -353.566187}},
    {"adaptation", {2581.07881, -1962.16473, -81.2456336}},
    {"reversal-adapts", {2577.43683, -1970.15547, -89.311137}},
    {"observed-rate", {2530.97041, -1207.40913, -81.0172807}},
    {"delay-4", {2606.32698, -1940.71716, -82.4358496}},
    {"delay-10", {2568.75945, -1941.31179, -81.6674003}},
    {"delay-23", {2616.46047, -1970.59068, -72.6288981}},
    {"build-up", {2744.10631, -1813.75044, -293.787624}},
    {"no-bristles", {2682.95761, -1949.73967, -258.92778}},
    {"velocity-loop", {-718.780701, -2778.62321, 8098.24898}},
    {"velocity-offset", {-718.780701, -2778.62321, 7364.661}},
    {"position-loop", {-718.780701, -2778.62321, 1539.05855}},
    {"position-offset", {-718.780701, -2778.62321, 1517.17164}},
    {"oscillation", {2235.23399, -1938.74672, -80.9232816}},
    {"sound", {2581.07881, -1962.16473, -81.2456336}},
    {"wild-samples", {2530.89565, -1910.89612, -67.1040929}},
    {"lost-and-reset", {248.242852, -534.429933, 203.824703}},
    {"frozen", {630.289456, 196.559805, 8.59445197}},
    {"wrong-sign", {2.77996765, -157.743616, -56.4255923}},
    {"command-lost", {1210.9168, -2057.2328, 96.7221435}},
    {"too-late", {936.126689, -2058.84483, 92.1456128}},
    {"command-jumps", {181.671233, -616.884923, 178.122088}},
};

std::vector<Case> cases() {
  std::vector<Case> all;
  add_laws(all);
  add_compensations(all);
  add_supervised(all);
  return all;
}

class StoredForces : public ::testing::TestWithParam<std::size_t> {};

TEST_P(StoredForces, AreThoseOfTheTable) { expect_stored(cases().at(GetParam()), kStored[GetParam()]); }

INSTANTIATE_TEST_SUITE_P(Runs, StoredForces, ::testing::Range(std::size_t{0}, std::size(kStored)),
                         [](const auto& one) { return name_of(kStored[one.param]); });

TEST(StoredForcesTable, HasEveryRun) {
  if (printing()) return print(cases());
  EXPECT_EQ(cases().size(), std::size(kStored));
}

}  // namespace
}  // namespace stribeck::control::stored_forces_test
