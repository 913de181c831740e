#pragma once
/// The result of a fit in numbers and words: parameters with intervals, curve, points for plots.
///
/// Inside ident only. Real time: no.

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/intervals.hpp>
#include <stribeck/ident/drive/periodic_choice.hpp>
#include <stribeck/ident/drive/places/places.hpp>
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

/// The result without its notes, and without what add_bristle() and warn_of_drift() add.
Result describe(const Found& found, const DriveFitOptions& options, Notes& notes);

/// Adds friction along the travel.
void add_places(Result& result, const PlaceShares& along, Notes& notes);

/// Adds pre-sliding from the reversals. Uses the closed-loop records where there are any: their slow reversals tell more than
/// the ringing after a pulse.
/// A shift that is known in its interval only widens theirs. Stiffness at places where the model has such.
void add_bristle(Result& result, const Found& found, Notes& notes);

/// Warns of friction or an offset that changes with time, judged on the longest record.
void warn_of_drift(const Found& found, const std::string& force_unit, Notes& notes);

}  // namespace stribeck::ident::drive
