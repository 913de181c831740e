#pragma once
/// What is behind a controller's handle: parameters, and behind them the law at work and its state, all in one piece of memory
/// of the caller. How much memory there is decides which laws it may have.
/// Real time: step.cpp; the rest configures.

#include <stribeck/stribeck.h>

#include <cstdint>
#include <limits>
#include <new>
#include <stribeck/control/supervision/supervisor.hpp>
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

/// A law at work.
template <class Law>
struct Running {
  Law law;
  typename Law::State state;
};
/// One that looks ahead, with the points that it is given: too many for a stack.
template <std::size_t N>
struct Running<control::Predictive<N>> {
  using Law = control::Predictive<N>;
  Law law;
  typename Law::State state;
  std::array<path::PathPoint<N>, Law::kPreview + 1> ahead{};
};

template <std::size_t N>
struct Controller : stribeck_controller {
  std::array<AxisSettings, N> settings;
  double period = 1e-3;
  double phase = kAbsent;    ///< place in the lap
  double elapsed = kAbsent;  ///< since the last step, as the host measured it [s]
  control::Setup<N> setup;
  control::Supervisor<N> supervisor;
  typename control::Supervisor<N>::State watch;
  Frame<N> frame;
  std::size_t law = kLaws;  ///< which one is at work; kLaws: none
  std::size_t room = 0;     ///< for it, behind this [bytes]
};

/// Where the law at work lies.
template <class Law, std::size_t N>
void* place_of(Controller<N>& c) noexcept {
  static_assert(alignof(Running<Law>) <= alignof(Controller<N>) &&
                sizeof(Controller<N>) % alignof(Running<Law>) == 0);
  return reinterpret_cast<unsigned char*>(&c) + sizeof c;
}

inline bool good(const stribeck_controller* c) noexcept {
  return c != nullptr && c->mark == stribeck_controller::kMark && c->axes >= 1 &&
         c->axes <= STRIBECK_MAX_AXES;
}

/// Calls f with a number of axes as a type.
template <class F>
auto with_axes(std::uint32_t axes, F&& f) noexcept {
  if (axes == 1) return f(std::integral_constant<std::size_t, 1>{});
  if (axes == 2) return f(std::integral_constant<std::size_t, 2>{});
  return f(std::integral_constant<std::size_t, 3>{});
}

/// Calls f with the controller as what it is.
template <class C, class F>
auto with(C* c, F&& f) noexcept {
  return with_axes(c->axes, [&](auto n) -> decltype(auto) {
    using Whole = std::conditional_t<std::is_const_v<C>, const Controller<n>, Controller<n>>;
    return f(static_cast<Whole&>(*c));
  });
}

/// Calls f with the law at work; false when there is none.
template <std::size_t N, class F>
bool with_law(Controller<N>& c, F&& f) noexcept {
  const auto one = [&](auto index) {
    using Law = LawAt<N, index>;
    if (c.law != index) return false;
    f(*std::launder(static_cast<Running<Law>*>(place_of<Law>(c))));
    return true;
  };
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return (one(std::integral_constant<std::size_t, I>{}) || ...);
  }
  (std::make_index_sequence<kLaws>());
}
template <std::size_t N, class F>
bool with_law(const Controller<N>& c, F&& f) noexcept {
  return with_law(const_cast<Controller<N>&>(c), [&](const auto& running) { f(running); });
}

}  // namespace stribeck::capi
