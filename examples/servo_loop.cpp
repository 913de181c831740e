/// A servo loop as a controller links it: PD with friction feed-forward and disturbance observer on one axis.
/// The "machine" here is a mass with Coulomb friction in ten lines; nothing of the loop knows it.

#include <cmath>
#include <cstdio>
#include <stribeck/control/pd.hpp>

int main() {
  using namespace stribeck;
  constexpr double kPeriod = 1e-3;
  control::Pd::Params params;
  params.gains = control::Gains::critical(60.0);
  params.compensation.model.mass = 800.0;
  params.compensation.model.friction.steady = friction::Conventional<double>{15.0, 3e3, {}};
  params.compensation.feedforward = control::Feedforward::kSteady;
  params.compensation.observer = control::Observer::kDisturbance;
  params.force_limit = 250.0;
  if (const char* wrong = control::Pd::problem(params, kPeriod)) {
    std::puts(wrong);
    return 1;
  }
  const control::Pd controller(params, kPeriod);
  control::Pd::State state;

  double x = 0.0;
  double v = 0.0;
  double error = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double w = 2.0;  // rad/s
    const double t = k * kPeriod;
    const control::Pd::Input in{10e-3 * std::sin(w * t), 10e-3 * w * std::cos(w * t),
                                -10e-3 * w * w * std::sin(w * t), x};
    const double force = controller.step(state, in);
    error = x - in.position;
    const double friction = 14.0 * std::tanh(v / 1e-4) + 3.2e3 * v;  // not what the model says
    v += kPeriod * (force - friction) / 820.0;
    x += kPeriod * v;
  }
  std::printf("tracking error after 2 s: %.4f um\n", std::abs(error) * 1e6);
}
