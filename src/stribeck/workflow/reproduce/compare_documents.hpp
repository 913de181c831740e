#pragma once
/// Whether a table of the reproduction is still what a document says. Measured numbers may differ as another
/// processor's rounding explains; what was printed, names and words must be the same to the letter.
/// Real time: no.

#include <string>

namespace stribeck::workflow {

/// The first line in which two tables differ: "LINE: expected …, got …"; empty: none.
std::string first_difference(const std::string& expected, const std::string& got);

}  // namespace stribeck::workflow
