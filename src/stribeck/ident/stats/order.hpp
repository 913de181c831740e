#pragma once
/// Order statistics: median and quantiles of a list of numbers.
///
/// Each function returns one of the numbers, never a value between two of them. The list is taken by value because the search
/// reorders it. The result for an empty list is NaN.
///
/// Real time: no.

#include <cstddef>
#include <vector>

namespace stribeck::ident::stats {

/// The element at index k (from 0) in ascending order.
double nth_smallest(std::vector<double> values, std::size_t k);

/// The middle element; with an even number of elements, the upper one of the two.
double median(std::vector<double> values);

/// The element below which a share (0 … 1) of the elements lies.
double quantile(std::vector<double> values, double share);

/// The same, from at most about 100 000 elements at equal distances: the whole of a long log would cost time and gain nothing.
double thinned_quantile(std::vector<double> values, double share);

std::vector<double> magnitudes(std::vector<double> values);

}  // namespace stribeck::ident::stats
