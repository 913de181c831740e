#pragma once
/// An enumeration and its words (core/fields.hpp).
/// Real time: no.

#include <optional>
#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// Name of a value; "" for a value that has none.
template <NamedEnum E>
constexpr std::string_view enum_name(E wanted) noexcept {
  for (const auto& [value, name] : EnumNames<E>::names) {
    if (value == wanted) return name;
  }
  return {};
}

/// Value of a name; nothing for a name that is none.
template <NamedEnum E>
constexpr std::optional<E> enum_value(std::string_view wanted) noexcept {
  for (const auto& [value, name] : EnumNames<E>::names) {
    if (name == wanted) return value;
  }
  return std::nullopt;
}

}  // namespace stribeck::workflow
