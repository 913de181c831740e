#pragma once
/// Compares a table of the reproduction with the one in a document. Measured numbers may differ as much as rounding of another
/// processor explains; printed numbers, names and words must be identical.
/// Real time: no.

#include <string>

namespace stribeck::workflow {

/// The first line in which two tables differ: "LINE: expected …, got …"; empty: no difference.
std::string first_difference(const std::string& expected, const std::string& got);

}  // namespace stribeck::workflow
