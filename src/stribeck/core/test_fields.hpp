#pragma once
/// What parameters say of themselves, for tests of their rules.
///
/// For tests only.

#include <set>
#include <stribeck/core/fields.hpp>
#include <string>

namespace stribeck::test {

/// The keys that validate() complains of.
template <class Params>
std::set<std::string> complaints(const Params& p) {
  std::set<std::string> keys;
  p.validate([&](std::string_view key, std::string_view) { keys.emplace(key); });
  return keys;
}

/// The keys that have no effect beside the values of the others.
template <class Params>
std::set<std::string> without_effect(const Params& p) {
  std::set<std::string> keys;
  for_each_field<Params>([&](const auto& field) {
    if (field.has_effect != nullptr && !field.has_effect(p)) keys.emplace(field.name);
  });
  return keys;
}

}  // namespace stribeck::test
