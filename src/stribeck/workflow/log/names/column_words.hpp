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
#include <span>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

struct NameMeaning {
  LogQuantity what;
  std::size_t rank = 0;  ///< the lower is the better one of two columns of one quantity
  std::string axis;      ///< lower case; "" where the name has none
  bool by_unit = false;  ///< the name says only actual or commanded, the unit of what
};

using io::lower_case;

/// The words of a name in lower case, apart where other signs than letters and digits stand; letters beyond ASCII are kept.
std::vector<std::string> words_of_name(const std::string& name);
/// Whether one of them is known.
bool any_word(const std::vector<std::string>& words, std::span<const std::string_view> known);

/// Unit of a force that CiA 402 defines: torques and currents are per mille of the rated ones, "0.1 %". "" for other names.
std::string unit_of_object(const std::string& header);

/// `unit` is that of the column; it tells the quantity where the name says only actual or commanded ("Z act [mm]").
std::optional<NameMeaning> meaning_of(const std::string& name, const std::string& unit = {});

}  // namespace stribeck::workflow
