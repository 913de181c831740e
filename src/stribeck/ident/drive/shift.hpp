#pragma once
/// The shift between force and motion: searched, refined, and judged.
///
///   search   the shift with the smallest residual over ±30 ms, at most 40 rows; friction of every bin and the mass are free
///   refine   Gauss–Newton on the column ḟ of the linear terms
///   judge    a shift is accepted when it differs by more than its interval from the shift of a held force, and the residual is
///            smaller with it. A commanded force acts exactly under its hold, so its shift is known and is not estimated
///
/// A loop that works against a force periodic in position looks like a shift: where such terms are found, the shift is
/// refined and judged anew beside them.
///
/// Inside ident only. Real time: no.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/rows.hpp>

namespace stribeck::ident::drive {

/// Force that the reference asks for at a row of a record, by the fit [N]. The reference must predict the velocity there.
double asked_force(const AlignedLog& log, const Terms& terms, const LinearFit& fit, std::size_t record,
                   std::size_t row);

/// Absent where the best shift lies at the border of the search, or where neither speed nor acceleration changes within bins.
std::optional<double> find_shift(const AlignedLog& log, const Rows& rows,
                                 const std::optional<double>& known_mass);

/// Fills rows.asked_change: the difference between rows of m·a + F(v) of the predicted motion, and of the periodic terms along
/// the way; `fit` belongs to `terms`.
void ask_reference(const AlignedLog& log, Rows& rows, const Terms& terms, const LinearFit& fit);

/// Needs terms.shift; aligns the log again.
LinearFit refine_shift(AlignedLog& log, Rows& rows, const Terms& terms, LinearFit fit);

/// Mean square of the force that is left around reversals [N²]. NaN: there are no reversals.
struct Reversed {
  double shift = kHeldForce;  ///< that leaves least [rows]
  double least = std::numeric_limits<double>::quiet_NaN();
  double of_found = std::numeric_limits<double>::quiet_NaN();  ///< at the shift of the rows that slide
  double of_held = std::numeric_limits<double>::quiet_NaN();   ///< at that of a held force
};

inline constexpr double kMuchMoreLeft = 2.0;  ///< ratio of these squares that decides
inline constexpr double kMostLeft =
    9.0;  ///< of the square in the rows that slide: with more, friction reverses in another way
inline constexpr double kNearShift =
    2.0;  ///< [rows] within which the rows that slide know better: how friction reverses is a model
inline constexpr double kOfFriction =
    0.01;  ///< of its square: what may be left where a model of friction is right

/// What the rows around reversals say of the shift. On a single sine a shift looks like a mass in the rows that slide; where friction
/// changes its direction it does not: there it comes with the motion, in a distance that is not known, or in many.
struct Told {
  double found = kHeldForce;                                     ///< in the rows that slide [rows]
  double of_sliding = std::numeric_limits<double>::quiet_NaN();  ///< mean square that is left there [N²]
  double friction = std::numeric_limits<double>::quiet_NaN();    ///< where the axis hardly moves [N]
  Reversed simple;                                               ///< with one distance
  Reversed mixed;  ///< with shares of many: they follow any friction, and know the shift less well

  /// Whether the shift found leaves much more than another one, however friction comes.
  [[nodiscard]] bool refutes_found() const noexcept {
    const double needed = is_explained() ? kMuchMoreLeft : 10.0;
    return is_rigid() && simple.of_found > needed * simple.least && mixed.of_found > needed * mixed.least &&
           std::abs(found - simple.shift) > kNearShift && std::abs(found - mixed.shift) > kNearShift;
  }
  /// Whether a force that is held for its row is not what the reversals show, so that the shift of `simple` is taken.
  [[nodiscard]] bool refutes_held() const noexcept {
    constexpr double kAgree = 4.0, kFar = 1.0;  // [rows]
    return is_explained() && simple.of_held > kMuchMoreLeft * simple.least &&
           mixed.of_held > kMuchMoreLeft * mixed.least && std::abs(simple.shift - mixed.shift) < kAgree &&
           std::abs(kHeldForce - simple.shift) > kFar;
  }

 private:
  /// Of a drive that gives way, or with a play, the model knows neither the rows that slide nor the reversals.
  [[nodiscard]] bool is_rigid() const noexcept { return of_sliding < kOfFriction * friction * friction; }
  [[nodiscard]] bool is_explained() const noexcept {
    return is_rigid() && simple.least < std::min(kMostLeft * of_sliding, kOfFriction * friction * friction);
  }
};

/// `found`: the shift of least residual in the rows that slide; `fit` of any shift. Aligns the log as it was before.
Told ask_reversals(AlignedLog& log, const Rows& rows, Terms terms, const LinearFit& fit, double found);

/// Sets terms.shift and aligns the log; the fit that belongs to both.
LinearFit judge_shift(AlignedLog& log, Rows& rows, Terms& terms, LinearFit fit);

/// 95 % half width of the shift [rows], estimated together with the other terms.
double shift_half_width(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit);

/// Delay of the drive [s] by the shift of the force [rows]. A command that is held for `hold` [s] belongs to the motion half of that later
/// without any delay (motion.hpp). No delay is below 0: where the interval of the shift, ± `half` [rows], holds one of 0, it is the estimate
/// or 0. A force that stands later than that in the log was measured: it acts at once, and shows no delay of its command. Absent then.
std::optional<double> delay_of(double shift, double half, double sample_time, double hold);

}  // namespace stribeck::ident::drive
