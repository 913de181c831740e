#pragma once
/// The shift between force and motion: searched, refined, and judged.
///
///   search   the shift of least residual with friction of every bin and the mass free, over ±30 ms, 40 rows at most
///   refine   Gauss–Newton on the column ḟ of the linear terms
///   judge    a shift is believed when it differs from that of a force under its hold by more than its interval
///            and the residual is smaller for it; a commanded force acts under its hold, exactly, and nothing is
///            gained by estimating what is known
///
/// Inside ident only. Real time: no.

#include <optional>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/rows.hpp>

namespace stribeck::ident::drive {

/// Absent where the search ends at its border, or where neither speed nor acceleration changes within the bins.
std::optional<double> find_shift(const AlignedLog& log, const Rows& rows,
                                 const std::optional<double>& known_mass);

/// Fills rows.asked_change: m·a + F(v) of the predicted motion, differenced.
void ask_reference(const AlignedLog& log, Rows& rows, const LinearFit& fit);

/// Needs terms.shift; aligns the log anew.
LinearFit refine_shift(AlignedLog& log, Rows& rows, const Terms& terms, LinearFit fit);

/// Sets terms.shift and aligns the log; the fit that belongs to both.
LinearFit judge_shift(AlignedLog& log, Rows& rows, Terms& terms, LinearFit fit, Notes& notes);

/// 95 % half width of the shift beside the other terms [rows].
double shift_half_width(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit);

}  // namespace stribeck::ident::drive
