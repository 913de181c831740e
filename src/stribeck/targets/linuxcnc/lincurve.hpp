#pragma once
/// Friction in the form of LinuxCNC's own component lincurve: a table of at most 16 points over the velocity.
/// Real time: no.

#include <stribeck/friction/axis_model.hpp>
#include <stribeck/targets/steady/nearest_polyline.hpp>
#include <string>
#include <string_view>

namespace stribeck::targets::linuxcnc {

/// The friction of an axis as lincurve can hold it: at most 16 points, joined by straight lines.
struct Lincurve {
  Polyline table;          ///< velocity [machine units/s], force [N]
  double max_error = 0.0;  ///< largest over the range [N]
  double rms_error = 0.0;  ///< over the range, every velocity weighted equally [N]
};

/// The table nearest to the steady-state curve from −`fastest` to `fastest`, in the sense of the largest error (to some per cent, as
/// it is sampled), with as many points on each side as that takes; fewer than 16 where they are enough. At zero the curve jumps: two points 2·10⁻⁶ machine units/s apart, and at rest the mean of both sides.
/// Without load and without terms periodic in position, which a table of velocity cannot hold. `fastest` [m/s], `unit` [m].
Lincurve best_lincurve(const friction::AxisModel& model, double fastest, double unit);

/// The error of the table, as a comment and as text; `unit` is that of its velocities.
std::string lincurve_words(const Lincurve& table, const friction::AxisModel& model, std::string_view unit);

/// setp lines for one instance.
std::string lincurve_lines(const std::string& name, const Lincurve& table);

}  // namespace stribeck::targets::linuxcnc
