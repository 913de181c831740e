// Lost motion compensated on virtual machines that are commissioned from their logs: a circle with and without, at the table.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/commission.hpp>

namespace stribeck::lost_motion_move_test {
namespace {

/// What the test changes of machines/lost-motion.toml, on both axes; the y axis has three quarters of the friction and backlash.
struct Changed {
  double mass, friction, sigma0;  ///< [kg], [N], [N/m]
  double backlash, stiffness;     ///< [m], [N/m]
  double table_share, table_friction;
  double noise;   ///< [N]
  double period;  ///< [s]
  double jerk;    ///< that the axis may have [m/s³]
};

sim::Machine machine_of(const Changed& c) {
  sim::Machine m = workflow::built_in_machine("lost-motion");
  m.sample_time = c.period;
  double share = 1.0;
  for (auto& [name, axis] : m.axes) {
    plant::AxisParams& p = axis.plant;
    p.mass = c.mass;
    p.lost_motion =
        plant::LostMotion{share * c.backlash, 0.0, c.stiffness, 0.15, c.table_share, c.table_friction};
    const double F = share * c.friction;
    p.friction.steady =
        friction::Conventional<double>{F, 0.015 * F / 1e-3, friction::Stribeck<double>{1.2 * F, 1.5e-3}};
    p.friction.dynamics = friction::LuGre<double>{c.sigma0, 2.0 * std::sqrt(c.sigma0 * c.mass) * 0.1, 1e-4};
    p.noise->rms = c.noise;
    p.drive = plant::CurrentDrive{c.friction, {}};
    axis.limits.jerk = c.jerk;
    axis.commissioning.mass = 0.95 * c.mass;
    axis.commissioning.friction = 1.1 * F;
    share = 0.75;
  }
  return m;
}

struct Seen {
  sim::Metrics before, after;
  double reference = 0.0;  ///< largest acceleration of the path [m/s²]
  double table[2] = {};    ///< of the table, mean over 20 ms, before and after [m/s²]
  double time[2] = {};     ///< [s]
};

double largest_acceleration(const std::vector<sim::ContourSample>& trace, double period) {
  const auto n = static_cast<std::size_t>(20e-3 / period);
  double most = 0.0;
  for (std::size_t k = 2 * n; k < trace.size(); ++k) {
    if (!trace[k].scored) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      const double d = trace[k].position[i] - 2.0 * trace[k - n].position[i] + trace[k - 2 * n].position[i];
      most = std::max(most, std::abs(d) / (static_cast<double>(n * n) * period * period));
    }
  }
  return most;
}

/// A circle under controller (h), the default, with a double pole at omega [rad/s].
Seen circle(const sim::Machine& m, double omega, double radius, double speed) {
  sim::CompareSpec spec;
  spec.travels = {sim::along(path::Shape::kCircle, radius, speed, 1.0)};
  spec.trials = 2;
  spec.accuracy = 20e-9;
  const auto thesis = sim::biaxial_controllers(control::ContouringParams::critical(omega, omega));
  for (const sim::ControllerSpec& c : sim::beyond_controllers(thesis.back())) {
    if (c.id == "h") spec.controllers = {c};
  }
  std::vector<sim::AxisKnowledge> known;
  for (std::size_t i = 0; i < 2; ++i)
    known.push_back(workflow::commission_axis(m, i, workflow::Needs::of(spec.controllers), 1).knowledge);
  EXPECT_TRUE(known[0].lost_motion && known[1].lost_motion);
  sim::CompareSpec without = spec;
  without.controllers.front().lost_motion = false;
  const sim::CompareResult a = sim::compare(m, known, without);
  const sim::CompareResult b = sim::compare(m, known, spec);
  Seen s{a.rows[0].mean, b.rows[0].mean};
  for (const auto& point : a.rows[0].trace)
    s.reference = std::max(s.reference, std::hypot(point.acceleration[0], point.acceleration[1]));
  s.table[0] = largest_acceleration(a.rows[0].trace, m.sample_time);
  s.table[1] = largest_acceleration(b.rows[0].trace, m.sample_time);
  s.time[0] = a.rows[0].trace.back().time;
  s.time[1] = b.rows[0].trace.back().time;
  std::printf(
      "max %.2f -> %.2f um (%.1f %%), RMS %.2f -> %.2f um (%.1f %%), time %.3f -> %.3f s, acceleration of the path %.4f, of "
      "the table %.4f -> %.4f m/s2\n",
      1e6 * s.before.max_contour_error, 1e6 * s.after.max_contour_error,
      100.0 * s.after.max_contour_error / s.before.max_contour_error, 1e6 * s.before.rms, 1e6 * s.after.rms,
      100.0 * s.after.rms / s.before.rms, s.time[0], s.time[1], s.reference, s.table[0], s.table[1]);
  return s;
}

void expect_gone(const Seen& s, double most) {
  EXPECT_LT(s.after.max_contour_error, most * s.before.max_contour_error);
  EXPECT_LT(s.after.rms, most * s.before.rms);
  EXPECT_EQ(s.time[0], s.time[1]);
  EXPECT_LE(s.table[1], s.table[0]);
}

TEST(LostMotionMove, CircleOnTheWornTable) {
  expect_gone(circle(workflow::built_in_machine("lost-motion"), 80.0, 20e-3, 9.5e-3), 0.10);
}

TEST(LostMotionMove, CircleOnALightRouter) {
  const Changed router{120.0, 60.0, 2e7, 40e-6, 20e6, 0.4, 0.5, 0.5, 0.5e-3, 40.0};
  expect_gone(circle(machine_of(router), 100.0, 10e-3, 6e-3), 0.10);
}

// Without any lost motion this table has 1.2 um under the same loop, by noise and the friction of the reversal: more than a tenth of
// what is there before.
TEST(LostMotionMove, CircleOnAHeavyTableThatWindsUp) {
  const Changed heavy{4000.0, 900.0, 3e8, 2e-6, 50e6, 0.4, 0.6, 8.0, 2e-3, 10.0};
  expect_gone(circle(machine_of(heavy), 60.0, 50e-3, 12e-3), 0.12);
}

}  // namespace
}  // namespace stribeck::lost_motion_move_test
