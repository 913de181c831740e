#pragma once
/// The result of a fit in numbers and words: parameters with intervals, curve, points for plots.
///
/// Inside ident only. Real time: no.

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/intervals/intervals.hpp>
#include <stribeck/ident/drive/map/level_drift.hpp>
#include <stribeck/ident/drive/periodic_choice.hpp>
#include <stribeck/ident/drive/places/places.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/ident/shown.hpp>
#include <string>

namespace stribeck::ident::drive {

/// A load that something else than the two directions tells (load/load_of_reversals.hpp).
struct ToldLoad {
  double value = 0.0;  ///< [N]
  double error = 0.0;  ///< standard error [N]
};

/// Everything that the steps before have found.
struct Found {
  const AlignedLog& log;
  const Rows& rows;
  const Terms& terms;
  const LinearFit& fit;
  const MapChoice& choice;
  const Intervals& intervals;
  std::optional<ToldLoad> load =
      {};  ///< absent: the load of the map is half the sum of the directions, or none
  const LevelDrift* taken_out = nullptr;  ///< drift of friction that the records had
  bool may_drift = true;  ///< false: what looks like a drift of friction is an error of the curve
};

/// The result without its notes, and without what add_bristle() and add_places() add.
Result describe(const Found& found, const DriveFitOptions& options, Notes& notes);

/// Adds the filter of the drive that was taken off the record, if one was.
void describe_filter(const log::Record& record, Result& result, Notes& notes);

/// Adds the terms periodic in position. The weight of a rotary axis, which repeats every turn, has a name of its own and stands behind the
/// others, so that their numbers are those of the parameters.
void add_periodic(Result& result, const Found& found, Notes& notes);

/// Adds friction along the travel.
void add_places(Result& result, const PlaceShares& along, const Shown& shown, Notes& notes);

/// The records whose reversals tell pre-sliding: the closed-loop ones where there are any, because their slow reversals tell more than
/// the ringing after a pulse; else all.
std::vector<log::Record> records_of_reversals(const AlignedLog& log);

/// Whether friction at rest is too small beside the noise for its build-up after a reversal to be seen.
bool below_the_noise(const Result& result);

/// Adds pre-sliding from the reversals.
/// A shift that is known in its interval only widens theirs. Stiffness at places where the model has such.
void add_bristle(Result& result, const Found& found, Notes& notes);

/// A sentence for each that changes with time; empty: it does not.
struct DriftWords {
  std::string offset;
  std::string friction;
};

/// Judged on the longest log.
DriftWords words_of_drift(const Found& found, const LevelDrift& drift);

}  // namespace stribeck::ident::drive
