#pragma once
/// A machine that travels circles with known causes of error, for tests. Positions come from the mechanics of each cause (a play
/// that is dragged along, a lag that is integrated, a tilted axis), not from the columns of the fit.

#include <cmath>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/laps.hpp>
#include <vector>

namespace stribeck::ident::circle {

struct VirtualMachine {
  double radius = 0.1;             // [m]
  double spike[2] = {0.0, 0.0};    // height [m]
  double spike_time = 0.06;        // to the top [s]
  double spike_at_negative = 1.0;  // share of it at the negative end
  double before =
      0.0;  // a spike of the other sign that comes first, in a quarter of the time: share of the height
  double backlash[2] = {0.0, 0.0};    // [m]
  double lateral[2] = {0.0, 0.0};     // [m]
  double cyclic[2] = {0.0, 0.0};      // amplitude [m]
  double pitch[2] = {0.01, 0.01};     // [m]
  double lag[2] = {0.0, 0.0};         // [s]
  double scale[2] = {0.0, 0.0};       // [1]
  double tilt = 0.0;                  // of y towards x [rad]
  double bow[2] = {0.0, 0.0};         // of x along y, of y along x, at the border of the circle [m]
  double larger = 0.0;                // [m]
  double vibration = 0.0;             // [m]
  double vibration_frequency = 37.0;  // [Hz]
  int vibration_axis = -1;            // 0 x, 1 y; −1: in the radius
  double offset[2] = {0.0, 0.0};      // of the instrument [m]
  double drift[2] = {0.0, 0.0};       // of it [m/s]
  double noise = 0.1e-6;              // of each sample [m]
  double rate = 250.0;                // [Hz]
};

/// Follows with a play: moves only when pushed by a border.
struct Play {
  double width;
  double at;
  double follow(double drive) {
    at = std::fmin(std::fmax(at, drive - 0.5 * width), drive + 0.5 * width);
    return at;
  }
};

struct VirtualRecord {
  std::vector<double> t, x, y, cx, cy;
  [[nodiscard]] CircleMotion motion(double radius) const { return circle_motion({x, y, cx, cy}, t, radius); }
};

/// `turns` in each direction, with a quarter of a turn before them that is left out.
inline VirtualRecord travel(const VirtualMachine& m, double feed, double turns, std::mt19937_64& random) {
  VirtualRecord out;
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 2.0 * kPi);
  const double omega = feed / m.radius;
  const double dt = 1.0 / m.rate;
  double t = 0.0;
  for (const double way : {1.0, -1.0}) {
    const double start = way > 0.0 ? -0.4 : 0.3;
    const double hum = uniform(random);
    double followed[2] = {m.radius * std::cos(start), m.radius * std::sin(start)};
    Play play[2] = {{m.backlash[0], followed[0]}, {m.backlash[1], followed[1]}};
    double before[2] = {followed[0], followed[1]};
    double side[2] = {0.0, 0.0};
    double reversed[2] = {-1e9, -1e9};
    double moving[2] = {0.0, 0.0};
    const auto count = static_cast<std::size_t>((turns + 0.25) * 2.0 * kPi / omega / dt);
    for (std::size_t i = 0; i < count; ++i, t += dt) {
      const double angle = start + way * omega * dt * static_cast<double>(i);
      const double command[2] = {m.radius * std::cos(angle), m.radius * std::sin(angle)};
      double p[2];
      for (int k = 0; k < 2; ++k) {
        // The lag of first order, exact for a command that is straight between two samples.
        if (m.lag[k] > 0.0) {
          const double slope = (command[k] - before[k]) / dt;
          const double e = std::exp(-dt / m.lag[k]);
          const double settled = command[k] - slope * m.lag[k];
          followed[k] = i == 0 ? settled : settled + (followed[k] - (before[k] - slope * m.lag[k])) * e;
        } else {
          followed[k] = command[k];
        }
        const double direction = command[k] > before[k] ? 1.0 : (command[k] < before[k] ? -1.0 : moving[k]);
        if (moving[k] != 0.0 && direction != moving[k]) reversed[k] = t;
        moving[k] = direction;
        before[k] = command[k];
        p[k] = (m.backlash[k] >= 0.0 ? play[k].follow(followed[k])
                                     : followed[k] - 0.5 * m.backlash[k] * direction);
        side[k] = -0.5 * m.lateral[k] * direction;
        const double since = (t - reversed[k]) / m.spike_time;
        // Rises fast and dies away: since²·e^(2(1 − since)), its top is one.
        const auto shape = [](double x) { return x < 30.0 ? x * x * std::exp(2.0 * (1.0 - x)) : 0.0; };
        p[k] -= m.spike[k] * direction * (shape(since) - m.before * shape(4.0 * since)) *
                (command[k] < 0.0 ? m.spike_at_negative : 1.0);
        p[k] += m.cyclic[k] * std::cos(2.0 * kPi * command[k] / m.pitch[k] - 0.7);
        p[k] *= 1.0 + m.scale[k];
      }
      p[0] += side[1];
      p[1] += side[0];
      const double x = p[0] + m.tilt * p[1] + m.bow[0] * std::pow(p[1] / m.radius, 2);
      const double y = p[1] + m.bow[1] * std::pow(p[0] / m.radius, 2);
      const double vibration = m.vibration * std::sin(2.0 * kPi * m.vibration_frequency * t + hum);
      const double more = m.larger + m.noise * normal(random) + (m.vibration_axis < 0 ? vibration : 0.0);
      out.t.push_back(t);
      out.x.push_back(x + m.offset[0] + m.drift[0] * t + more * std::cos(angle) +
                      (m.vibration_axis == 0 ? vibration : 0.0));
      out.y.push_back(y + m.offset[1] + m.drift[1] * t + more * std::sin(angle) +
                      (m.vibration_axis == 1 ? vibration : 0.0));
      out.cx.push_back(command[0]);
      out.cy.push_back(command[1]);
    }
    t += 1.0;
  }
  return out;
}

}  // namespace stribeck::ident::circle
