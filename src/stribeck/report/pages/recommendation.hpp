#pragma once
/// What a comparison recommends, for the first screen of its page.
///
/// The controller with the smallest largest error, as the geometric mean over speeds. The default is recommended in its place where
/// the two cannot be distinguished: where at every speed their difference is within twice its standard error over the trials.
///
/// Inside report only. Real time: no. Errors: none.

#include <stribeck/report/html.hpp>
#include <stribeck/report/pages/compare_blocks.hpp>
#include <stribeck/sim/compare.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct Recommendation {
  std::vector<const sim::CompareRow*>
      rows;           ///< of the recommended controller, one for each block; empty: none is finite
  std::string words;  ///< one or two sentences
  std::vector<KeyNumber> numbers;  ///< at most three
};

Recommendation recommendation(const std::vector<TravelBlock>& blocks, const sim::CompareResult& result);

}  // namespace stribeck::report
