#pragma once
/// The steps from the records to rows, shift and linear terms: what the map, periodic terms and places are chosen beside.
///
///   fit_first        rows far from reversals and fast, with the shift of a held force
///   take_out_shift   the shift of least residual (shift.hpp)
///   settle           the distance in which friction settles, all rows beyond it, the lag that remains, and whether the shift is believed
///
/// Each step changes the stage that it is given. Inside ident only. Real time: no.

#include <limits>
#include <span>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/relaxation.hpp>
#include <stribeck/ident/drive/rows.hpp>
#include <stribeck/ident/map/static_fit.hpp>

namespace stribeck::ident::drive {

/// The values that each step hands to the next; the steps are functions of them.
struct Stage {
  AlignedLog log;
  Extent extent;
  Rows rows;
  Terms terms;
  LinearFit fit;
  double first_shift = kHeldForce;  ///< before it was judged [rows]
  Relaxation relaxation;            ///< of friction after a reversal; its length is 0 where none was found
};

/// Friction of a fit without its load.
Level level_of(const LinearFit& fit);

/// A shift in rows means one time in all of them.
bool one_sample_time(std::span<const log::Record> records);

/// Warns once that the instrument could not be used.
void note_weak_instrument(const LinearFit& before, const LinearFit& now, Notes& notes);

/// Friction near reversals is not known yet, so a generous distance is left out.
void fit_first(Stage& stage, const DriveFitOptions& options, Notes& notes);

void take_out_shift(Stage& stage, Notes& notes);

/// Subtracts the lag anew, of friction without the viscous part of the map: what grows with speed as a line does not lag, and the line
/// through the bins is not the viscous friction where the map has a bump or a fall.
void renew_lag(Stage& stage, const map::StaticFit& chosen);

/// Selects rows in which friction has settled, subtracts the remaining lag and judges the shift.
void settle(Stage& stage, const DriveFitOptions& options, Notes& notes);

}  // namespace stribeck::ident::drive
