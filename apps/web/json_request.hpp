#pragma once
/// The body of a request: JSON, read and checked through fields() as a file is, with the same messages.
/// Real time: no.
/// Errors: InputError whose keys are those of the request.

#include <stribeck/io/toml.hpp>
#include <string_view>

namespace stribeck::web {

/// A JSON document as the tree that readers of files take. Refuses what is no object, is deeper than 16 levels or holds null.
io::Node parse_json(std::string_view text);

template <HasFields T>
T read_request(std::string_view text) {
  io::Problems problems("request");
  T value = io::read<T>(parse_json(text), problems);
  problems.throw_if_any();
  return value;
}

}  // namespace stribeck::web
