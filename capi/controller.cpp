#include "controller.hpp"

#include <cmath>
#include <new>

using namespace stribeck;
using capi::Controller;
using capi::good;
using capi::with;

namespace {

/// Below this speed the frame of the path holds [m/s].
constexpr double kSlowest = 1e-5;
/// A frame turns at most at this share of the loop's lowest natural frequency.
constexpr double kTurning = 0.25;

constexpr std::string_view kAxis[] = {"axis 0: ", "axis 1: ", "axis 2: "};

template <std::size_t N>
stribeck_result configure(Controller<N>& c, double period) {
  static const capi::AxisSettings kInitial;
  for (std::size_t i = 0; i < N; ++i) {
    capi::Name name;
    const bool sound =
        capi::check(name, c.settings[i], kInitial, {}, [&](std::string_view key, std::string_view what) {
          c.problem.set({kAxis[i], key, ": ", what});
        });
    if (!sound) return STRIBECK_REFUSED;
    if (c.settings[i].compensation.model.delay > period * static_cast<double>(control::kMostDelay)) {
      c.problem.set({kAxis[i], "delay: longer than eight periods"});
      return STRIBECK_REFUSED;
    }
    const auto observed = c.settings[0].error_rate == control::ErrorRate::kObserved;
    if (observed && c.settings[i].compensation.observer != control::Observer::kKalman) {
      c.problem.set({kAxis[i], "error_rate: \"observed\" needs observer \"kalman\""});
      return STRIBECK_REFUSED;
    }
  }
  c.period = period;
  c.setup.period = period;
  c.kp.clear();
  c.kv.clear();
  double slowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < N; ++i) {
    const capi::AxisSettings& s = c.settings[i];
    const double kp = s.kp.value_or(s.omega * s.omega);
    slowest = std::min(slowest, std::sqrt(kp));
    c.kp.push_back(kp);
    c.kv.push_back(s.kv.value_or(2.0 * s.omega));
    c.setup.compensation[i] = s.compensation;
    c.setup.compensation[i].delay = s.compensation.model.delay;
    c.setup.force_limit[i] = s.force_limit.value_or(std::numeric_limits<double>::infinity());
  }
  control::ContouringParams params;
  params.kp = c.kp;
  params.kv = c.kv;
  params.error_rate = c.settings[0].error_rate;
  c.law.emplace(params, c.setup);
  if constexpr (N > 1) c.frame.of_motion = path::MotionFrame<N>(period, kSlowest, kTurning * slowest);
  stribeck_controller_reset(&c);
  return STRIBECK_OK;
}

}  // namespace

extern "C" {

std::uint32_t stribeck_abi(void) noexcept { return STRIBECK_ABI; }

std::uint32_t stribeck_capabilities(void) noexcept {
  return STRIBECK_HAS_CONTOURING | STRIBECK_HAS_DYNAMIC_FEEDFORWARD | STRIBECK_HAS_REVERSAL_FEEDFORWARD |
         STRIBECK_HAS_DISTURBANCE_OBSERVER | STRIBECK_HAS_KALMAN_OBSERVER | STRIBECK_HAS_ADAPTIVE_FRICTION |
         STRIBECK_HAS_FRICTION_ADAPTATION;
}

const char* stribeck_version(void) noexcept { return STRIBECK_VERSION; }

const char* stribeck_describe(stribeck_result r) noexcept {
  switch (r) {
    case STRIBECK_OK:
      return "done";
    case STRIBECK_BAD_HANDLE:
      return "no handle: null, or memory that was not initialised";
    case STRIBECK_BAD_ARGUMENT:
      return "an index too high, a null pointer, or a period that is no time";
    case STRIBECK_UNKNOWN_NAME:
      return "no parameter has this name";
    case STRIBECK_OUT_OF_RANGE:
      return "the value is out of range";
    case STRIBECK_NOT_SELECTED:
      return "belongs to a kind that is not chosen; choose it first";
    case STRIBECK_REFUSED:
      return "the parameters mean nothing together";
    case STRIBECK_NOT_CONFIGURED:
      return "configure first";
    case STRIBECK_NOT_FINITE:
      return "an input was not a finite number";
    case STRIBECK_NO_MEMORY:
      return "out of memory";
    default:
      return "unknown result";
  }
}

std::size_t stribeck_alignment(void) noexcept { return alignof(Controller<3>); }

std::size_t stribeck_controller_size(std::uint32_t axes) noexcept {
  switch (axes) {
    case 1:
      return sizeof(Controller<1>);
    case 2:
      return sizeof(Controller<2>);
    case 3:
      return sizeof(Controller<3>);
    default:
      return 0;
  }
}

stribeck_controller* stribeck_controller_init(void* memory, std::size_t size, std::uint32_t axes) noexcept {
  const std::size_t needed = stribeck_controller_size(axes);
  if (memory == nullptr || needed == 0 || size < needed ||
      reinterpret_cast<std::uintptr_t>(memory) % stribeck_alignment() != 0)
    return nullptr;
  stribeck_controller* c = axes == 1   ? static_cast<stribeck_controller*>(::new (memory) Controller<1>())
                           : axes == 2 ? static_cast<stribeck_controller*>(::new (memory) Controller<2>())
                                       : static_cast<stribeck_controller*>(::new (memory) Controller<3>());
  c->axes = axes;
  return c;
}

stribeck_result stribeck_controller_parameter(std::uint32_t index, stribeck_parameter* out) noexcept {
  return capi::parameter_at(capi::AxisSettings{}, index, out);
}

const char* stribeck_controller_parameter_word(const char* name, std::uint32_t index) noexcept {
  return capi::word_at(capi::AxisSettings{}, name, index);
}

stribeck_result stribeck_controller_set(stribeck_controller* c, std::uint32_t axis, const char* name,
                                        double value) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (axis >= c->axes) return STRIBECK_BAD_ARGUMENT;
  return with(c, [&](auto& whole) {
    return capi::set_parameter(whole.settings[axis], name, value, kAxis[axis], whole.problem);
  });
}

stribeck_result stribeck_controller_choose(stribeck_controller* c, std::uint32_t axis, const char* name,
                                           const char* word) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (axis >= c->axes) return STRIBECK_BAD_ARGUMENT;
  return with(c, [&](auto& whole) {
    return capi::choose_parameter(whole.settings[axis], capi::AxisSettings{}, name, word, kAxis[axis],
                                  whole.problem);
  });
}

stribeck_result stribeck_controller_configure(stribeck_controller* c, double period) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (!(period > 0.0 && period < 1.0)) {
    c->problem.set({"period: expected a time above 0 and below 1 s"});
    return STRIBECK_BAD_ARGUMENT;
  }
  return with(c, [&](auto& whole) { return configure(whole, period); });
}

const char* stribeck_controller_problem(const stribeck_controller* c) noexcept {
  return good(c) ? c->problem.text() : stribeck_describe(STRIBECK_BAD_HANDLE);
}

}  // extern "C"
