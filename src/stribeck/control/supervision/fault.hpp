#pragma once
/// Why supervision stops a machine, and how. The list for builders, with what to do: docs/guides/faults.md.
///
/// A fault is latched: the first one stays until the state is reset. Its number is part of the C interface; new ones are added at
/// the end.
/// Real time: safe.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace stribeck::control {

enum class Fault : std::uint8_t {
  kNone,
  kEncoderLost,         ///< samples are NaN or infinite
  kEncoderImplausible,  ///< samples lie where the axis cannot be
  kEncoderFrozen,       ///< samples stand still while force or command say motion
  kEncoderUnreliable,   ///< more than a fifth of the samples had to be bridged
  kWrongSign,           ///< the axis gains speed against the force
  kOverspeed,           ///< faster than the axis may be
  kFollowingError,      ///< too far from the reference
  kSaturated,           ///< at the force limit for too long
  kOscillation,         ///< the loop oscillates at a large share of the force limit
  kLate,                ///< the step is called too late
  kCommandLost,         ///< the reference is NaN or infinite
  kCount
};

inline constexpr std::size_t kFaults = static_cast<std::size_t>(Fault::kCount);

/// What supervision does with the force after a fault.
enum class Reaction : std::uint8_t {
  kNone,
  kBrake,  ///< brakes against the last known motion, then holds the gravity load
  kCut     ///< force 0 at once: the sign of the force cannot be trusted
};

constexpr Reaction reaction(Fault f) noexcept {
  if (f == Fault::kNone) return Reaction::kNone;
  return f == Fault::kWrongSign ? Reaction::kCut : Reaction::kBrake;
}

constexpr std::string_view name_of(Fault f) noexcept {
  constexpr std::array<std::string_view, kFaults> kNames{
      "none",       "encoder-lost", "encoder-implausible", "encoder-frozen", "encoder-unreliable",
      "wrong-sign", "overspeed",    "following-error",     "saturated",      "oscillation",
      "late",       "command-lost"};
  return f < Fault::kCount ? kNames[static_cast<std::size_t>(f)] : "unknown";
}

constexpr std::string_view describe(Fault f) noexcept {
  switch (f) {
    case Fault::kNone:
      return "no fault";
    case Fault::kEncoderLost:
      return "encoder lost: its samples are not finite numbers";
    case Fault::kEncoderImplausible:
      return "encoder implausible: its samples lie where the axis cannot be";
    case Fault::kEncoderFrozen:
      return "encoder frozen, or axis blocked: the samples stand still while force or command say motion";
    case Fault::kEncoderUnreliable:
      return "encoder unreliable: more than a fifth of its samples are wild, repeated or missing";
    case Fault::kWrongSign:
      return "wrong sign of force or encoder: the axis gains speed against the force";
    case Fault::kOverspeed:
      return "overspeed: the axis is faster than its speed limit permits";
    case Fault::kFollowingError:
      return "following error: the axis is too far from the reference";
    case Fault::kSaturated:
      return "saturated: the force stayed at its limit for too long";
    case Fault::kOscillation:
      return "oscillation: the force swings regularly by a large share of its limit";
    case Fault::kLate:
      return "late: the step was called too late for several periods";
    case Fault::kCommandLost:
      return "command lost: the reference is not a finite number";
    case Fault::kCount:
      break;
  }
  return "unknown fault";
}

}  // namespace stribeck::control
