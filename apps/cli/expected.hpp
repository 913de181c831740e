#pragma once
/// Checks of the values of options; problems are reported as everywhere: got VALUE, expected WHAT.
///
///   number_from(1, 90)   a finite number within both bounds, these included
///   whole_from(1, 100)   a whole number in digits; the library alone would read "-1" for an unsigned option as 4294967295
///   one_of({"a", "b"})   a word; the message suggests the nearest one
///
/// Real time: no.

#include <CLI/CLI.hpp>

#include <cstdint>
#include <stribeck/core/fields.hpp>
#include <string>
#include <vector>

namespace stribeck::cli {

CLI::Validator number_from(double low, double high);
CLI::Validator whole_from(std::uint64_t low, std::uint64_t high);
CLI::Validator one_of(std::vector<std::string> words);

/// The words of an enumeration, for one_of().
template <NamedEnum E>
std::vector<std::string> words_of() {
  return {kEnumWords<E>.begin(), kEnumWords<E>.end()};
}

}  // namespace stribeck::cli
