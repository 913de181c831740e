#pragma once
/// Terms periodic in position beside the map: searched in the residual (map/periodic.hpp), kept if held-out motion
/// is better for them by more than the standard error of the difference.
///
/// Mass and friction of a fit that does not know the terms take a part of them. The search is therefore repeated
/// on what is left beside the terms found, until their periods stand still.
///
/// Inside ident only. Real time: no.

#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/map_choice.hpp>
#include <stribeck/ident/map/periodic.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::drive {

/// What is left of the force when everything but the periodic terms is taken off.
map::PeriodicRows rows_for_periodic(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                    const LinearFit& fit);

/// The columns of a term.
PeriodicColumns columns_of(const AlignedLog& log, const map::PeriodicTerm& term);

/// The map with the linear terms that it was chosen beside.
struct PeriodicChoice {
  MapChoice map;
  Terms terms;
  LinearFit fit;
  std::vector<SpectrumLine> spectrum;
};
/// `map`: the choice without periodic terms, made with `terms` and `fit`.
PeriodicChoice choose_periodic(const AlignedLog& log, const Rows& rows, const Terms& terms,
                               const LinearFit& fit, MapChoice map, const DriveFitOptions& options,
                               Notes& notes);

}  // namespace stribeck::ident::drive
