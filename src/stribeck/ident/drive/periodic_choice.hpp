#pragma once
/// Terms periodic in position beside the map. They are searched in the residual (map/periodic.hpp) and kept if they improve the
/// prediction of held-out motion by more than the standard error of the difference.
///
/// A fit without these terms puts a part of them into mass and friction. The search is therefore repeated on the residual
/// beside the terms found, until their periods no longer change.
///
/// Where every speed occurs at two positions only, as on a sine, the bins of speed take a part of a term, and what they leave does
/// not stand out. The search then begins beside the maps of few parameters, and a line that does not stand out there is tried too.
/// Such terms count when they stand out of the residual of a map that was fitted together with them.
///
/// Inside ident only. Real time: no.

#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/map/map_choice.hpp>
#include <stribeck/ident/map/periodic.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::drive {

/// The force less everything but the periodic terms: less the linear terms and the friction of the bins, or of a map with the
/// linear terms that belong to it.
map::PeriodicRows rows_for_periodic(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                    const LinearFit& fit, const JointFit* joint = nullptr);

/// The columns of a term: its mean over the triangle of two rows that a second difference of the position is (motion.hpp). At
/// a third of a period a row, the value at the row itself would be larger by 20 %, and the amplitude smaller.
PeriodicColumns columns_of(const AlignedLog& log, const map::PeriodicTerm& term);

/// Whether the losses of the blocks are less with the terms: by so many standard errors of the gain, or by half of all, with nearly every
/// block (sign test). A block that a map without the terms misses by far has a scatter as large as the gain.
bool predicts_better(const std::vector<double>& without, const std::vector<double>& with, double errors);

/// The map with the linear terms beside which it was chosen.
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
