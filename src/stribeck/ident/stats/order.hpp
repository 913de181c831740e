#pragma once
/// Order statistics: median and quantiles of a list of numbers.
///
/// Each function returns one of the numbers, never a value between two of them. The list is taken by value,
/// because finding the element reorders it. Not a number where the list is empty.
///
/// Real time: no.

#include <cstddef>
#include <vector>

namespace stribeck::ident::stats {

/// The element that stands at place k (from 0) in ascending order.
double nth_smallest(std::vector<double> values, std::size_t k);

/// The middle element; the upper one of the two where their number is even.
double median(std::vector<double> values);

/// The element below which a share (0 … 1) of the others lies.
double quantile(std::vector<double> values, double share);

/// The same, of at most about 100 000 elements taken at equal distances: long logs would cost time and gain
/// nothing.
double thinned_quantile(std::vector<double> values, double share);

std::vector<double> magnitudes(std::vector<double> values);

}  // namespace stribeck::ident::stats
