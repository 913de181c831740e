#pragma once
/// Converts the values of a column to another unit in one step.
/// Real time: no.

#include <cstddef>
#include <optional>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/units.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// The conversion between two units; empty where there is none.
std::optional<io::Conversion> conversion_between(const std::string& unit, std::string_view si);

/// All values of a column, converted and then multiplied by a factor.
std::vector<double> converted(const io::Column& column, const io::Conversion& conversion, double factor);

/// The same for some rows, counted from 0.
std::vector<double> converted(const io::Column& column, const io::Conversion& conversion, double factor,
                              const std::vector<std::size_t>& rows);

}  // namespace stribeck::workflow
