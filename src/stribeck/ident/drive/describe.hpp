#pragma once
/// The result of a fit in numbers and words: parameters with intervals, curve, points for plots.
///
/// Inside ident only. Real time: no.

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/intervals.hpp>
#include <stribeck/ident/drive/periodic_choice.hpp>
#include <stribeck/ident/result.hpp>

namespace stribeck::ident::drive {

/// Everything that the steps before have found.
struct Found {
  const AlignedLog& log;
  const Rows& rows;
  const Terms& terms;
  const LinearFit& fit;
  const MapChoice& choice;
  const Intervals& intervals;
};

/// Without notes and what add_bristle() and warn_of_drift() add.
Result describe(const Found& found, const DriveFitOptions& options, Notes& notes);

/// Pre-sliding from the reversals. Records of a closed loop where there are any: their slow reversals tell more than
/// the ringing after a pulse.
void add_bristle(Result& result, const AlignedLog& log, Notes& notes);

/// Friction or offset that moves with time, on the longest record.
void warn_of_drift(const Found& found, const std::string& force_unit, Notes& notes);

}  // namespace stribeck::ident::drive
