#pragma once
/// The friction of an axis as source code holds it: a table for each direction, and terms periodic in position.
/// Real time: no.

#include <stribeck/targets/steady/approximation.hpp>
#include <string>

namespace stribeck::targets {

/// Points of each direction.
inline constexpr std::size_t kSourcePoints = 24;

/// Tables of both directions with the digits that the source code has.
struct SourceTables {
  std::vector<Corner> positive;  ///< speed [m/s], friction against the motion [N]
  std::vector<Corner> negative;

  explicit SourceTables(const Axis& axis);

  /// Without periodic terms [N].
  [[nodiscard]] double at(double v) const noexcept;
};

/// A sentence, begun with a space: what the code does where its tables end.
std::string words_of_end(const Axis& axis, const SourceTables& tables);

/// "0.001, 0.002, …": speeds or forces of a table.
std::string speeds_of(const std::vector<Corner>& points);
std::string forces_of(const std::vector<Corner>& points);

/// The elastic stops of bristles as two such lists: shares of the friction, and stiffness 2·α/ρ [N/m] (pulse/pre_sliding.hpp).
struct StopLists {
  std::string weights;
  std::string stiffness;
};
StopLists lists_of(const friction::BuildUp& bristles);

}  // namespace stribeck::targets
