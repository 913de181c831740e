#pragma once
/// What a fit chooses, in this order: shift, rows, map, periodic terms, lag of friction, friction along the travel.
///
/// Each step judges on held-out motion and hands on a value; where a later one changes what an earlier one was chosen beside, that one is
/// chosen again. What the reversals tell of pre-sliding is not chosen here (drive_fit.cpp).
///
/// Inside ident only. Real time: no.
/// Errors: Refused where the rows are too few for a fit.

#include <optional>
#include <span>
#include <stribeck/ident/drive/describe.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/places/places.hpp>
#include <stribeck/ident/drive/stage.hpp>
#include <vector>

namespace stribeck::ident::drive {

/// Map and periodic terms.
struct Steady {
  MapChoice map;
  std::vector<SpectrumLine> spectrum;
};

/// A map, the linear terms that belong to it, and their intervals.
struct Judged {
  MapChoice map;
  LinearFit fit;
  Intervals found;
};

/// Everything that is chosen beside places.
struct Placed {
  Stage stage;
  std::vector<double> lag;  ///< of the rows, without places
  PlaceShares along;
  std::optional<Judged> judged;
  Steady steady;
  Notes notes;
};

/// All steps from the rows to what is judged.
Placed choose_all(std::span<const log::Record> records, const DriveFitOptions& options);

}  // namespace stribeck::ident::drive
