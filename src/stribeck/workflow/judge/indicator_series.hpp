#pragma once
/// Readings of a dial indicator from a table that was typed by hand, one row for each reading, in the order in which they were taken:
///
///   direction,reading [um],position [mm],load [N]
///   +,0,100,0
///   -,26,100,0
///
///   direction  of the approach: + or - (1 or -1, plus or minus, forward or back, vor or zurück);  reading  of the indicator at the table;  position  commanded, left out: always the
///   same;  load  on the table against the positive direction, left out: none
///
/// Separators, decimal commas and units as in any log; German names are known (Richtung, Anzeige, Position, Last). A table without
/// names gets them in its side file.
///
/// Real time: no. Errors: InputError with file, column and what was expected.

#include <stribeck/ident/lost_motion/indicator.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

std::vector<ident::lost_motion::Reading> read_indicator_series(const std::string& file);

}  // namespace stribeck::workflow
