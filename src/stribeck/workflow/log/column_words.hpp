#pragma once
/// What the words in the name of a column say, for names that no notation in known_columns.cpp has: "Motor Current",
/// "Lageistwert", "TorqueFeedback", "MC_Axis.ActPos", "xist".
///
/// A name is read as words of one list, written together or apart, in any order: one of a quantity, at most one that tells
/// actual from commanded, an axis, and words that say nothing. A name with any other word ("PosError") has no meaning here.
/// SINAMICS parameters (r0063) are in the same list by their numbers.
///
/// Real time: no.

#include <optional>
#include <stribeck/workflow/log/columns.hpp>
#include <string>

namespace stribeck::workflow {

struct NameMeaning {
  LogQuantity what;
  std::size_t rank = 0;  ///< the lower is the better one of two columns of one quantity
  std::string axis;      ///< lower case; "" where the name has none
};

std::string lower_case(std::string text);

std::optional<NameMeaning> meaning_of(const std::string& name);

}  // namespace stribeck::workflow
