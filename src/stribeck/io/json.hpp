#pragma once
/// JSON for programs: keys keep their order, unknown values are null, the same value gives the same bytes.
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace stribeck::io {

using Json = nlohmann::ordered_json;

/// NaN and infinity become null, because an absent value is not zero.
Json number_or_null(double value);
Json number_or_null(const std::optional<double>& value);

/// One entry per value.
Json numbers(const std::vector<double>& values);

/// Two blanks per level and a newline at the end. Text that is not UTF-8 is replaced by U+FFFD.
std::string dump(const Json& json);

}  // namespace stribeck::io
