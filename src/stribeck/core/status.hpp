#pragma once
/// Reports of a step of the real-time tier. A status is latched and counted, never thrown.
/// Real time: safe.

#include <array>
#include <cstdint>
#include <string_view>

namespace stribeck {

enum class Status : std::uint8_t {
  kOk,
  kNotFinite,  ///< an input was NaN or infinite, or numbers overflowed; the step held its last safe output
  kOutputLimited,         ///< the output reached the limit of the drive
  kOutsideVelocityRange,  ///< a friction model was evaluated outside the velocities that it was identified on
  kOscillation,           ///< the loop oscillated; trust in observer and adaptation was reduced
  kCount
};

constexpr std::string_view describe(Status s) noexcept {
  switch (s) {
    case Status::kOk:
      return "ok";
    case Status::kNotFinite:
      return "an input was not a finite number, or numbers overflowed";
    case Status::kOutputLimited:
      return "the output reached the limit of the drive";
    case Status::kOutsideVelocityRange:
      return "friction was evaluated at velocities outside the range of the identified model";
    case Status::kOscillation:
      return "the loop oscillated, and the observer and the adaptation were backed off";
    case Status::kCount:
      break;
  }
  return "unknown status";
}

/// Counts how often each status was raised; remembers the first that was not kOk.
struct StatusCounter {
  std::array<std::uint32_t, static_cast<std::size_t>(Status::kCount)> counts{};
  Status first = Status::kOk;

  constexpr void raise(Status s) noexcept {
    if (s == Status::kOk) return;
    if (first == Status::kOk) first = s;
    auto& n = counts[static_cast<std::size_t>(s)];
    if (n != UINT32_MAX) ++n;
  }
  [[nodiscard]] constexpr std::uint32_t count(Status s) const noexcept {
    return counts[static_cast<std::size_t>(s)];
  }
};

}  // namespace stribeck
