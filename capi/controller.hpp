#pragma once
/// What is behind a controller's handle: parameters, law and state in one piece of memory of the caller.
/// Real time: step.cpp; the rest configures.

#include <stribeck/stribeck.h>

#include <cstdint>
#include <stribeck/control/contouring.hpp>
#include <stribeck/path/motion_frame.hpp>

#include "axis_settings.hpp"

/// The part that does not depend on how many axes there are.
struct stribeck_controller {
  static constexpr std::uint32_t kMark = 0x53747242;

  std::uint32_t mark = kMark;
  std::uint32_t axes = 0;
  stribeck::capi::Problem problem;
};

namespace stribeck::capi {

template <std::size_t N>
struct Frame {
  path::MotionFrame<N> of_motion;
  typename path::MotionFrame<N>::State state;
};
template <>
struct Frame<1> {};

template <std::size_t N>
struct Controller : stribeck_controller {
  std::array<AxisSettings, N> settings;
  double period = 1e-3;
  control::Setup<N> setup;
  control::PerAxis kp;
  control::PerAxis kv;
  std::optional<control::Contouring<N>> law;
  typename control::Contouring<N>::State state;
  Frame<N> frame;
};

inline bool good(const stribeck_controller* c) noexcept {
  return c != nullptr && c->mark == stribeck_controller::kMark && c->axes >= 1 &&
         c->axes <= STRIBECK_MAX_AXES;
}

/// Calls f with the controller as what it is.
template <class C, class F>
auto with(C* c, F&& f) noexcept {
  const auto as = [&](auto n) -> decltype(auto) {
    using Whole = std::conditional_t<std::is_const_v<C>, const Controller<n>, Controller<n>>;
    return f(static_cast<Whole&>(*c));
  };
  if (c->axes == 1) return as(std::integral_constant<std::size_t, 1>{});
  if (c->axes == 2) return as(std::integral_constant<std::size_t, 2>{});
  return as(std::integral_constant<std::size_t, 3>{});
}

}  // namespace stribeck::capi
