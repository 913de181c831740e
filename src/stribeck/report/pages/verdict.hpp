#pragma once
/// The result of a comparison in a few sentences, for one travel. Every number in them is a mean over the trials that the JSON of
/// compare also has.
///
/// Where there are controllers beyond the thesis (they feed forward friction with memory), the default one is compared with the
/// last of the thesis's own controllers before them; where none adapts, the one with the smallest maximum is. Elsewhere the best
/// controller is compared with no compensation and with the conventional model.
/// Real time: no.

#include <optional>
#include <stribeck/report/plot/contour_plots.hpp>
#include <stribeck/sim/compare.hpp>
#include <string>

namespace stribeck::report {

struct Rivals {
  const sim::CompareRow* ours = nullptr;
  const sim::CompareRow* against = nullptr;  ///< the last of the thesis's own
  bool is_default = false;                   ///< ours adapts, as the default of the product does
};

/// The two controllers that the summary compares; empty where no controller is beyond the thesis, or none is before it.
std::optional<Rivals> rivals_of(const Rows& rows);

/// Rows of one travel, none of them null; `pace` as "9.5 mm/s".
std::string verdict(const Rows& rows, const std::string& pace, const sim::CompareResult& result);

}  // namespace stribeck::report
