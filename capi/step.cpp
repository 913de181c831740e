// The code that runs in the servo thread, separate from configuration: built with a limit on stack frames (CMakeLists.txt).
#include "controller.hpp"

#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>

using namespace stribeck;
using capi::Controller;
using capi::good;
using capi::with;

namespace {

/// Constructs a state in place: assigning a new one would put a copy on the stack, beyond the limit of a servo thread.
template <class State>
void renew(State& s) {
  static_assert(std::is_trivially_destructible_v<State>);
  std::construct_at(&s);
}

template <std::size_t N>
void forget(Controller<N>& c) {
  capi::with_law(c, [](auto& running) { renew(running.state); });
  capi::with_law(c, [&](auto& running) { c.supervisor.reset(c.watch, running.state); });
  c.phase = c.elapsed = capi::kAbsent;
  for (std::size_t i = 0; i < N; ++i) {
    // The drive goes on with its last set point until the next one comes.
    const double held = c.commands[i].started ? c.commands[i].command : capi::kAbsent;
    renew(c.commands[i]);
    c.commands[i].resumed = held;
    c.measured_force[i] = capi::kAbsent;
  }
  if constexpr (N > 1) renew(c.frame.state);
}

/// After finite inputs that made numbers overflow: what the law remembers may be no number any more. Its last forces stay.
template <class State>
[[gnu::noinline]] void begin_anew(State& s) {
  const auto force = s.force;
  const StatusCounter status = s.status;
  renew(s);
  s.force = force;
  s.status = status;
}

/// Reads one point of the reference; returns true when it is finite.
template <std::size_t N>
bool point_from(const stribeck_axis_input* in, path::PathPoint<N>& r) {
  double sum = 0.0;
  for (std::size_t i = 0; i < N; ++i) {
    r.position[i] = in[i].position;
    r.velocity[i] = in[i].velocity;
    r.acceleration[i] = in[i].acceleration;
    sum += in[i].position + in[i].velocity + in[i].acceleration;
  }
  return isfinite(sum);
}

// Separate functions, so that the stack frames of the laws do not add up.
template <class Law, std::size_t N>
[[gnu::noinline]] Vec<double, N> step_of(capi::Running<Law>& running, const path::PathPoint<N>& r,
                                         const Vec<double, N>& measured) {
  return running.law.step(running.state, r, measured);
}
template <std::size_t N>
[[gnu::noinline]] bool admit(Controller<N>& c, typename control::Common<N>::State& law, path::PathPoint<N>& r,
                             Vec<double, N>& measured) {
  return c.supervisor.admit(c.watch, law, r, measured, c.elapsed);
}
template <std::size_t N>
[[gnu::noinline]] Vec<double, N> judge(Controller<N>& c, typename control::Common<N>::State& law,
                                       const path::PathPoint<N>& r, const Vec<double, N>& force) {
  return c.supervisor.judge(c.watch, law, r, force);
}
template <std::size_t N>
[[gnu::noinline]] Vec<double, N> stopped(Controller<N>& c) {
  return c.supervisor.stopped(c.watch);
}
/// Commands of drives with a loop of their own, for the forces that are put out.
template <std::size_t N>
[[gnu::noinline]] void command(Controller<N>& c, const typename control::Common<N>::State& law,
                               const path::PathPoint<N>& r, const Vec<double, N>& measured,
                               const Vec<double, N>& force) {
  if (c.watch.fault == control::Fault::kNone) {
    c.drives.command(c.commands, law, r, measured, force);
  } else {
    std::array<int, N> periods;
    for (std::size_t i = 0; i < N; ++i) periods[i] = c.supervisor.limits(i).stop_periods;
    c.drives.stop(c.commands, r, measured, force, periods,
                  control::Supervisor<N>::reaction_to(c.watch) == control::Reaction::kCut);
  }
}

/// `points` rows of the reference begin at `in`; the active law uses as many of them as it needs.
template <std::size_t N>
stribeck_result step(Controller<N>& c, const stribeck_axis_input* in, std::uint32_t points, double* force) {
  path::PathPoint<N> r;
  Vec<double, N> measured;
  double sum = 0.0;
  for (std::size_t i = 0; i < N; ++i) {
    measured[i] = in[i].measured;
    sum += in[i].measured;
  }
  const bool led = point_from(in, r);
  bool finite = led && isfinite(sum);
  r.phi = c.phase;
  if constexpr (N > 1) {
    if (led) c.frame.of_motion.step(c.frame.state, r);
  }
  Vec<double, N> f;
  const bool runs = capi::with_law(c, [&](auto& running) {
    const std::uint32_t overflows = running.state.status.count(Status::kNotFinite);
    const auto forces = [&] {
      if (!admit<N>(c, running.state, r, measured)) return stopped(c);
      c.drives.admit(c.commands, running.state, c.measured_force);
      if constexpr (requires { running.ahead; }) {
        if (points > 1) {
          std::size_t n = std::min<std::size_t>(points, running.ahead.size());
          running.ahead[0] = r;
          // Rows from the first one on that is no number are left out; the answer tells it.
          for (std::size_t k = 1; k < n; ++k) {
            if (point_from(in + k * N, running.ahead[k])) continue;
            finite = false;
            n = k;
          }
          const auto wanted = running.law.step(running.state, std::span(running.ahead).first(n), measured);
          return judge<N>(c, running.state, r, wanted);
        }
      }
      return judge<N>(c, running.state, r, step_of(running, r, measured));
    };
    f = forces();
    if (finite && running.state.status.count(Status::kNotFinite) != overflows) {
      finite = false;
      begin_anew(running.state);
    }
  });
  if (!runs) {
    c.problem.set({"not configured: call stribeck_controller_configure() before the first step"});
    return STRIBECK_NOT_CONFIGURED;
  }
  capi::with_law(c, [&](const auto& running) { command<N>(c, running.state, r, measured, f); });
  c.elapsed = capi::kAbsent;
  for (std::size_t i = 0; i < N; ++i) {
    c.measured_force[i] = capi::kAbsent;
    force[i] = f[i];
  }
  if (c.watch.fault != control::Fault::kNone) return STRIBECK_FAULT;
  return finite ? STRIBECK_OK : STRIBECK_NOT_FINITE;
}

template <std::size_t N>
void signals(const Controller<N>& c, std::size_t i, stribeck_axis_signals& out) {
  capi::with_law(c, [&](const auto& running) {
    const typename control::Common<N>::State& common = running.state;
    const auto& s = common.compensation[i];
    out.force = c.watch.fault == control::Fault::kNone ? common.force[i] : c.watch.force[i];
    out.bridged = c.watch.axes[i].encoder.bridged;
    out.friction = s.friction;
    out.disturbance = s.guard.trust * s.estimate;
    out.error = common.error[i].e;
    out.error_rate = common.error[i].rate;
    if (c.setup.compensation[i].adaptation.enabled && control::knows_force(c.setup.compensation[i]))
      out.level = control::DriftMonitor::report(s.drift, s.adaptation, c.period).level;
    out.command = c.commands[i].command;
    out.offset = c.commands[i].offset;
    out.limited = s.limited && !c.watch.axes[i].cut ? 1 : 0;
    out.backed_off = s.guard.trust < 1.0 ? 1 : 0;
    if constexpr (requires { running.state.surface; }) {
      out.surface = running.state.surface[i];
      out.switching_gain = running.state.gain[i];
    }
    if constexpr (requires { running.state.lag; }) out.lag = running.state.lag;
    if constexpr (requires { running.state.learned; }) out.learned = running.state.learned[i];
  });
}

template <std::size_t N>
void supervision(const Controller<N>& c, stribeck_supervision& out) {
  using control::Supervisor;
  static_assert(STRIBECK_FAULTS == control::kFaults);
  static_assert(STRIBECK_FAULT_COMMAND_LOST == static_cast<int>(control::Fault::kCommandLost));
  out.fault = static_cast<std::int32_t>(c.watch.fault);
  out.axis = static_cast<std::uint32_t>(c.watch.axis);
  out.brake = Supervisor<N>::brake_requested(c.watch) ? 1 : 0;
  out.safe = Supervisor<N>::safe(c.watch) && c.drives.at_rest(c.commands) ? 1 : 0;
  out.late = c.watch.late;
  out.commands_lost = c.watch.commands_lost;
  for (std::size_t k = 0; k < control::kFaults; ++k) out.counts[k] = c.watch.counts[k];
}

}  // namespace

extern "C" {

stribeck_result stribeck_controller_step(stribeck_controller* c, const stribeck_axis_input* in,
                                         double* force) noexcept {
  return stribeck_controller_step_ahead(c, in, 1, force);
}

stribeck_result stribeck_controller_step_ahead(stribeck_controller* c, const stribeck_axis_input* in,
                                               std::uint32_t points, double* force) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (in == nullptr) return capi::bad_argument(c, "in: is null, expected one input for each axis");
  if (force == nullptr) return capi::bad_argument(c, "force: is null, expected room for one number per axis");
  if (points < 1) return capi::bad_argument(c, "points: is 0, expected at least 1");
  return with(c, [&](auto& whole) { return step(whole, in, points, force); });
}

std::uint32_t stribeck_controller_points(const stribeck_controller* c) noexcept {
  if (!good(c)) return 0;
  std::uint32_t points = 0;
  with(c, [&](const auto& whole) {
    capi::with_law(whole, [&](const auto& running) {
      points = 1;
      if constexpr (requires { running.ahead; }) points = static_cast<std::uint32_t>(running.ahead.size());
    });
  });
  return points;
}

stribeck_result stribeck_controller_set_phase(stribeck_controller* c, double phase) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  const bool infinite = std::isinf(phase);
  if (infinite) c->problem.set({"phase: is infinite, expected the place in the lap, or NaN for none"});
  with(c, [&](auto& whole) { whole.phase = infinite ? capi::kAbsent : phase; });
  return infinite ? STRIBECK_NOT_FINITE : STRIBECK_OK;
}

stribeck_result stribeck_controller_reset(stribeck_controller* c) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  with(c, [](auto& whole) { forget(whole); });
  return STRIBECK_OK;
}

stribeck_result stribeck_controller_set_elapsed(stribeck_controller* c, double elapsed) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (elapsed < 0.0) return capi::bad_argument(c, "elapsed: is below 0, expected seconds, or NaN for none");
  with(c, [&](auto& whole) { whole.elapsed = elapsed; });
  return STRIBECK_OK;
}

stribeck_result stribeck_controller_set_measured_force(stribeck_controller* c, const double* force) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (force == nullptr) return capi::bad_argument(c, "force: is null, expected one number per axis");
  with(c, [&](auto& whole) {
    for (std::size_t i = 0; i < whole.settings.size(); ++i) whole.measured_force[i] = force[i];
  });
  return STRIBECK_OK;
}

stribeck_result stribeck_controller_supervision(const stribeck_controller* c, stribeck_supervision* out,
                                                std::size_t size) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (out == nullptr) return STRIBECK_BAD_ARGUMENT;
  stribeck_supervision now{};
  with(c, [&](const auto& whole) { supervision(whole, now); });
  std::memcpy(out, &now, std::min(size, sizeof now));
  return STRIBECK_OK;
}

stribeck_result stribeck_controller_signals(const stribeck_controller* c, std::uint32_t axis,
                                            stribeck_axis_signals* out, std::size_t size) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (axis >= c->axes || out == nullptr) return STRIBECK_BAD_ARGUMENT;
  stribeck_axis_signals now{};
  for (double* absent : {&now.level, &now.surface, &now.switching_gain, &now.lag, &now.learned})
    *absent = capi::kAbsent;
  with(c, [&](const auto& whole) { signals(whole, axis, now); });
  std::memcpy(out, &now, std::min(size, sizeof now));
  return STRIBECK_OK;
}

}  // extern "C"
