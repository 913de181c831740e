/// The controller of docs/guides/write-a-controller.md, tried on two axes with an encoder of 1 um: how much the drive rattles
/// on a slow circle, with the zone and without.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stribeck/path/curve.hpp>

#include "dead_zone.hpp"

using namespace stribeck;

struct Result {
  double rattle = 0.0;  ///< mean change of the force from tick to tick [N]
  double worst = 0.0;   ///< greatest distance from the circle [um]
};

Result run(double zone) {
  constexpr double kPeriod = 1e-3;
  control::Setup<2> setup;
  setup.period = kPeriod;
  for (auto& axis : setup.compensation) {
    axis.model.mass = 800.0;
    axis.model.friction.steady = friction::Conventional<double>{0.0, 2e3, {}};
    axis.feedforward = control::Feedforward::kSteady;
  }
  const control::DeadZone<2> law({40.0, zone}, setup);
  control::DeadZone<2>::State state;

  const path::Curve circle{path::Shape::kCircle, 10e-3};
  path::Reference<path::Curve> reference(circle, {5e-3, 0.5, 50e-3});
  Vec2 x = reference.point().position;
  Vec2 v;
  Vec2 last;
  Result result;
  int ticks = 0;
  for (; !reference.finished(); reference.advance(kPeriod), ++ticks) {
    Vec2 encoder;
    for (int i = 0; i < 2; ++i) encoder[i] = std::round(x[i] * 1e6) * 1e-6;
    const Vec2 force = law.step(state, reference.point(), encoder);
    for (int i = 0; i < 2; ++i) {
      result.rattle += 0.5 * std::abs(force[i] - last[i]);
      v[i] += kPeriod * (force[i] - 2.05e3 * v[i]) / 820.0;  // not quite the model
      x[i] += kPeriod * v[i];
    }
    last = force;
    result.worst = std::max(result.worst, 1e6 * std::abs(norm(x) - 10e-3));
  }
  result.rattle /= ticks;
  return result;
}

int main() {
  const Result plain = run(0.0);
  const Result zone = run(2e-6);
  std::printf("PD             rattle %5.1f N   contour error %.1f um\n", plain.rattle, plain.worst);
  std::printf("dead zone 2 um rattle %5.1f N   contour error %.1f um\n", zone.rattle, zone.worst);
}
