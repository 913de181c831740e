#pragma once
/// The circle by which commissioning shows what it gained: programs for LinuxCNC, and the laps that count.
///
///   radius   at most 10 mm and 0.3 of the free travel
///   speed    at most 10 mm/s, 0.8 of the speed limit and √(a·R/2)
///
/// Three laps in each direction. The first one does not count, because it begins from rest, where friction depends on what was before.
/// Real time: no. Errors: Stopped where there is no room.

#include <string>
#include <utility>

#include <stribeck/workflow/commissioning/records.hpp>

namespace stribeck::workflow::commissioning {

struct CirclePlan {
  const RunningAxis* u = nullptr;  ///< X of an XY plane, and so on
  const RunningAxis* v = nullptr;
  std::string plane;  ///< G17, G18, G19
  char i = 'I';
  char j = 'J';
  double middle_u = 0.0;  ///< [m]
  double middle_v = 0.0;
  double radius = 0.0;  ///< [m]
  double speed = 0.0;   ///< [m/s]

  /// From the place where the machine is to the start of the circle.
  [[nodiscard]] std::string approach() const;
  [[nodiscard]] std::string laps(bool counter_clockwise) const;
  [[nodiscard]] double lap_time() const;  ///< [s]
  [[nodiscard]] std::string words() const;
};

/// Of the first two axes among X, Y and Z; u is null where there are not two.
CirclePlan plan_circle(const RunningAxes& all);

/// Rows after the first lap and before the end of the last one, by the angle of the command.
std::pair<AxisRows, AxisRows> counted_laps(const CirclePlan& plan, const AxisRows& u, const AxisRows& v);

}  // namespace stribeck::workflow::commissioning
