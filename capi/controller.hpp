#pragma once
/// The memory behind a controller's handle: parameters, followed by the active law and its state, in one piece of memory of the
/// caller. The size of this memory decides which laws the controller may have.
/// Real time: step.cpp; the rest configures.

#include <stribeck/stribeck.h>

#include <cstdint>
#include <limits>
#include <new>
#include <stribeck/control/drive_interface.hpp>
#include <stribeck/control/supervision/supervisor.hpp>
#include <stribeck/path/motion_frame.hpp>
#include <string_view>

#include "axis_settings.hpp"

/// The part that does not depend on the number of axes.
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

/// An active law.
template <class Law>
struct Running {
  Law law;
  typename Law::State state;
};
/// A law that looks ahead, with the points that it is given: they are too large for a stack.
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
  control::DriveInterface<N> drives;
  typename control::DriveInterface<N>::State commands{};
  Vec<double, N> measured_force;  ///< of the past period, as the drives report it [N]; NaN: none
  Frame<N> frame;
  std::size_t law = kLaws;  ///< index of the active law; kLaws: none
  std::size_t room = 0;     ///< memory for it behind this object [bytes]
};

/// Address of the active law.
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

/// The answer to a call with an argument that it cannot take; `what` says which, and what was expected.
inline stribeck_result bad_argument(stribeck_controller* c, std::string_view what) noexcept {
  c->problem.set({what});
  return STRIBECK_BAD_ARGUMENT;
}

/// Calls f with a number of axes as a type.
template <class F>
auto with_axes(std::uint32_t axes, F&& f) noexcept {
  if (axes == 1) return f(std::integral_constant<std::size_t, 1>{});
  if (axes == 2) return f(std::integral_constant<std::size_t, 2>{});
  return f(std::integral_constant<std::size_t, 3>{});
}

/// Calls f with the controller in its real type.
template <class C, class F>
auto with(C* c, F&& f) noexcept {
  return with_axes(c->axes, [&](auto n) -> decltype(auto) {
    using Whole = std::conditional_t<std::is_const_v<C>, const Controller<n>, Controller<n>>;
    return f(static_cast<Whole&>(*c));
  });
}

/// Calls f with the active law; returns false when there is none.
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
