#pragma once
/// The result of a comparison in a few sentences, for one travel. Every number in them is a mean over the trials and stands in the
/// JSON of compare.
///
/// Where there are controllers beyond the thesis (they feed forward friction with memory), the default one, or the one with the
/// smallest maximum where none adapts, is compared with the last of the thesis's own, which stands before them. Elsewhere the
/// best is compared with no compensation and with the conventional model.
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

/// Whom the summary compares; nothing where there is no controller beyond the thesis, or none before it.
std::optional<Rivals> rivals_of(const Rows& rows);

/// Rows of one travel, none of them null; `pace` as "9.5 mm/s".
std::string verdict(const Rows& rows, const std::string& pace, const sim::CompareResult& result);

}  // namespace stribeck::report
