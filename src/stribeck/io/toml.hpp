#pragma once
/// TOML files of any struct that declares its parameters with fields() (core/fields.hpp).
///
///   auto machine = read_toml<Machine>("machine.toml");         // throws InputError with every problem
///   write_atomically("axis.toml", write_toml(axis, "written by …"));
///
/// Quantities are text with a unit, pure numbers are bare (or text: "16 %"), structs are tables, a
/// std::variant is a table whose key `kind` names the alternative, lists of structs are lists of inline
/// tables, and std::vector<std::pair<std::string, T>> is a table of named tables in the order of the file. A
/// key is required unless its field says or_default() or its member is a std::optional. Unknown keys are errors, and so is a setting
/// that has no effect beside the others (Field::when) and does not have its initial value. A struct with a
/// kShortForm may be written as `key = "on"` or "off", which sets that switch alone. A struct may have
///
///   template <class Report> void validate(Report&& report) const;    // report("key.below", "what is wrong")
///
/// which is called when everything inside the struct could be read. Items of lists count from 1 in messages.
/// What write_toml writes, read_toml reads back bit for bit.
/// Real time: no.
/// Errors: InputError.

#include <cstdint>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/io/error.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io {

/// A parsed file as a simple tree, so that the TOML library is compiled only once.
struct Node {
  enum class Kind { kTable, kList, kText, kInteger, kNumber, kBool, kOther };

  Kind kind = Kind::kTable;
  std::string key;    ///< name inside its table; "" in a list
  std::string text;   ///< value of kText; of other scalars as written, for messages
  double number = 0;  ///< value of kInteger and kNumber
  std::int64_t integer = 0;
  bool flag = false;
  bool rotary = false;  ///< of an axis that turns: lengths are angles (units.hpp, rotary_quantity)
  bool either = false;  ///< below rotary = true: units of angles count beside those of lengths
  std::size_t line = 0;
  std::vector<Node> children;  ///< of a table or list, in the order of the file

  /// Child of a table, or null.
  [[nodiscard]] const Node* find(std::string_view name) const;
};

/// One problem: the text is no TOML at all, so the file may be one of another kind.
class NotToml : public InputError {
 public:
  using InputError::InputError;
};

/// Parses TOML; `file` is for messages. Throws NotToml.
Node parse_toml(std::string_view text, const std::string& file);

/// Reads a group from a table. On a problem the member keeps its initial value and `problems` grows.
void read(const Node& node, Target out, Problems& problems);
template <HasFields T>
T read(const Node& node, Problems& problems) {
  T value{};
  read(node, target_of(value), problems);
  return value;
}

/// Parses a text and reads it as T. Throws InputError with all problems.
template <HasFields T>
T read_toml_text(std::string_view text, const std::string& file) {
  Problems problems(file);
  T value = read<T>(parse_toml(text, file), problems);
  problems.throw_if_any();
  return value;
}

/// The same from a file.
Node load_toml(const std::string& path);
template <HasFields T>
T read_toml(const std::string& path) {
  Problems problems(path);
  T value = read<T>(load_toml(path), problems);
  problems.throw_if_any();
  return value;
}

enum class Docs { kNo, kYes };

/// TOML text with the keys in the order of declaration; with Docs::kYes each line ends with its
/// sentence. A number that is not finite cannot be written to a file: InputError names the key.
std::string write_toml(const Value& group, const std::string& header_comment, Docs docs);
template <HasFields T>
std::string write_toml(const T& value, const std::string& header_comment = {}, Docs docs = Docs::kNo) {
  return write_toml(value_of(value), header_comment, docs);
}

namespace detail {

std::string joined(const std::string_view* words, std::size_t count, std::string_view between);
std::string dotted(const std::string& path, std::string_view key);
/// A value in one line, as in files.
std::string inline_value(const Value& value, const Quantity& q, const std::string& key);

}  // namespace detail

}  // namespace stribeck::io
