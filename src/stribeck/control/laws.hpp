#pragma once
/// The list of control laws. A new one is a header and one line here; files, options and reports find it by its
/// kKind. docs/guides/write-a-controller.md shows how.
///
/// Which law runs is decided once, outside the loop:
///
///   std::visit([&](const auto& params) {
///     using Controller = typename std::decay_t<decltype(params)>::template Controller<3>;
///     const Controller controller(params, setup);
///     typename Controller::State state;
///     …
///   }, law);
///
/// Real time: safe.

#include <stribeck/control/laws/cascade.hpp>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/cross_coupled.hpp>
#include <stribeck/control/laws/learning.hpp>
#include <stribeck/control/laws/pid.hpp>
#include <stribeck/control/laws/predictive.hpp>
#include <stribeck/control/laws/repetitive.hpp>
#include <stribeck/control/laws/sliding_mode.hpp>
#include <stribeck/control/laws/zpetc.hpp>
#include <variant>

namespace stribeck::control {

using LawParams = std::variant<ContouringParams, SlidingModeParams, PidParams, CascadeParams, ZpetcParams,
                               CrossCoupledParams, RepetitiveParams, LearningParams, PredictiveParams>;

}  // namespace stribeck::control
