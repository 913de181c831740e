#pragma once
/// Takes a filter of first order off a force that the drive passed through it before it was logged (filter_search.hpp finds its time).
///
///   f = f_logged + τ·ḟ_logged        τ: time of the filter
///
/// ḟ_logged is the slope of a line through the rows within 0.2 τ to either side, at least one: noise of the force grows
/// 5.4 times at most. The first and last rows of a record have half of a line.
///
/// Not modelled: other filters. A mean over W rows has the first two moments of a filter of τ = W/√12 and a delay.
/// Real time: no.

#include <span>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::drive {

/// `time` in rows.
std::vector<double> before_filter(std::span<const double> logged, double time);

/// Takes it off the force of a record, which then knows of it. Rows whose line holds a row to skip, or passes an end, are skipped too.
void take_off(const ForceFilter& filter, log::Record& record);

}  // namespace stribeck::ident::drive
