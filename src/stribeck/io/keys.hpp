#pragma once
/// Every key that a file of a struct with fields() may have, for reference pages and forms.
/// Real time: no.

#include <stribeck/core/walk_fields.hpp>
#include <string>
#include <vector>

namespace stribeck::io {

/// One declared key.
struct KeyInfo {
  std::string key;            ///< dotted path; `[]` stands for the items of a list, `<name>` for a free name
  std::string kind;           ///< alternative of a variant to which the key belongs, else ""
  std::string unit;           ///< unit for people, or the kind of value: text, true/false, count, number
  std::string range;          ///< permitted values; "": all
  std::string default_value;  ///< "" when required
  bool required = true;
  std::string doc;
  std::string condition;  ///< condition under which it has an effect, in words; "": always
};

/// Keys of a group, with the values of `initial` as defaults.
std::vector<KeyInfo> keys_of(const Value& initial);
template <HasFields T>
std::vector<KeyInfo> keys_of() {
  return keys_of(initial_of(type_of<T>));
}

/// The keys as Markdown: one table for each table of the file, with headings of this level.
std::string markdown_by_table(const std::vector<KeyInfo>& keys, int level);

/// The keys as one Markdown table.
std::string markdown(const std::vector<KeyInfo>& keys);
template <HasFields T>
std::string describe() {
  return markdown(keys_of<T>());
}

}  // namespace stribeck::io
