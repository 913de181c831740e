// What runs in the servo thread, apart from what configures: built with a limit on stack frames (CMakeLists.txt).
#include "controller.hpp"

#include <memory>
#include <type_traits>

using namespace stribeck;
using capi::Controller;
using capi::good;
using capi::with;

namespace {

/// Makes a state anew where it lies: assigning a new one would put a copy on the stack, beyond the limit of a servo thread.
template <class State>
void renew(State& s) {
  static_assert(std::is_trivially_destructible_v<State>);
  std::construct_at(&s);
}

template <std::size_t N>
void forget(Controller<N>& c) {
  renew(c.state);
  if constexpr (N > 1) renew(c.frame.state);
}

template <std::size_t N>
stribeck_result step(Controller<N>& c, const stribeck_axis_input* in, double* force) {
  if (!c.law) return STRIBECK_NOT_CONFIGURED;
  path::PathPoint<N> r;
  Vec<double, N> measured;
  double sum = 0.0;
  for (std::size_t i = 0; i < N; ++i) {
    r.position[i] = in[i].position;
    r.velocity[i] = in[i].velocity;
    r.acceleration[i] = in[i].acceleration;
    measured[i] = in[i].measured;
    sum += in[i].position + in[i].velocity + in[i].acceleration + in[i].measured;
  }
  const bool finite = isfinite(sum);
  if constexpr (N > 1) {
    if (finite) c.frame.of_motion.step(c.frame.state, r);
  }
  const Vec<double, N> f = c.law->step(c.state, r, measured);
  for (std::size_t i = 0; i < N; ++i) force[i] = f[i];
  return finite ? STRIBECK_OK : STRIBECK_NOT_FINITE;
}

template <std::size_t N>
void signals(const Controller<N>& c, std::size_t i, stribeck_axis_signals& out) {
  const auto& s = c.state.compensation[i];
  out.force = c.state.force[i];
  out.friction = s.friction;
  out.disturbance = s.guard.trust * s.estimate;
  out.error = c.state.error[i].e;
  out.error_rate = c.state.error[i].rate;
  out.level = c.settings[i].compensation.adaptation.enabled
                  ? control::DriftMonitor::report(s.drift, s.adaptation, c.period).level
                  : capi::kAbsent;
  out.limited = s.limited ? 1 : 0;
  out.backed_off = s.guard.trust < 1.0 ? 1 : 0;
}

}  // namespace

extern "C" {

stribeck_result stribeck_controller_step(stribeck_controller* c, const stribeck_axis_input* in,
                                         double* force) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (in == nullptr || force == nullptr) return STRIBECK_BAD_ARGUMENT;
  return with(c, [&](auto& whole) { return step(whole, in, force); });
}

stribeck_result stribeck_controller_reset(stribeck_controller* c) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  with(c, [](auto& whole) { forget(whole); });
  return STRIBECK_OK;
}

stribeck_result stribeck_controller_signals(const stribeck_controller* c, std::uint32_t axis,
                                            stribeck_axis_signals* out, std::size_t size) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (axis >= c->axes || out == nullptr) return STRIBECK_BAD_ARGUMENT;
  stribeck_axis_signals now{};
  with(c, [&](const auto& whole) { signals(whole, axis, now); });
  std::memcpy(out, &now, std::min(size, sizeof now));
  return STRIBECK_OK;
}

}  // extern "C"
