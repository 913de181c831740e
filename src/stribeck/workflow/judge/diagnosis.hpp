#pragma once
/// What the result of an identification leaves of the force, looked at after any method (ident/residual): quality in words,
/// causes with their cure. A force that grows with position, that follows an angle, or that an elastic drive carries, is taken
/// off the logs where they determine it, and the method runs once more.
///
/// Inside workflow only. Real time: no. Errors: those of the method.

#include <functional>
#include <stribeck/workflow/identify.hpp>

namespace stribeck::workflow {

/// How much of an identification is needed: pre-sliding costs most of the time, and the diagnosis does not use it.
enum class Depth { kSteady, kWhole };

using Identify = std::function<Identification(const AxisRecords&, Depth)>;

/// The result of `method` on these logs, diagnosed.
Identification diagnosed(const AxisRecords& axis, const Identify& method);

}  // namespace stribeck::workflow
