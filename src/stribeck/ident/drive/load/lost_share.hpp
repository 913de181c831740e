#pragma once
/// Friction that grows with the force that the drive transmits, as in the nut of a screw, a worm or a gear of limited efficiency.
///
///   f = m·a + F(v) + c + w·|f|·sgn v        w share of the force that is lost
///
/// Driving, the motor has to make 1/(1 − w) of what moves the axis, braking 1/(1 + w). A log in which the axis accelerates and brakes
/// tells w: mass and friction alone want the same force for both. At constant speed w is a part of friction and cannot be told.
///
/// w is looked for by least squares beside mass, load and a free curve of friction, on means over 20 ms. Believed only where a column
/// |a|·sgn v, which knows nothing of the force, explains much of what is left as well (any force that is not in the model is in |f|), or
/// where |f|·sgn v explains nearly all of it and the axis brakes in a twentieth of the rows.
/// Source: law of efficiency of machine elements. Not modelled: w that depends on speed or direction; losses by a load alone, without
/// acceleration; losses beside a spring or an unbalance, which hide them. Real time: no. Errors: none.

#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::drive {

struct LostShare {
  double share = 0.0;  ///< w
  double half_width = 0.0;
};

/// Absent where the logs show none, or do not tell it.
std::optional<LostShare> lost_share(const std::vector<log::Record>& records);

/// The force that the axis would need if it lost the same share while it brakes as while it drives: then mass and load come out as
/// 1/(1 − w) of theirs, and friction as at constant speed.
void as_driving(double share, log::Record& record);

}  // namespace stribeck::ident::drive
