#pragma once
/// TOML files of any struct that declares its parameters with fields() (core/fields.hpp).
///
///   auto machine = read_toml<Machine>("machine.toml");         // throws InputError with every problem
///   write_atomically("axis.toml", write_toml(axis, "written by …"));
///
/// Quantities are text with a unit, pure numbers are bare (or text: "16 %"), structs are tables, a
/// std::variant is a table whose key `kind` names the alternative, lists of structs are lists of inline
/// tables, and std::vector<std::pair<std::string, T>> is a table of named tables in the order of the file. A
/// key is required unless its field says or_default() or its member is a std::optional. Unknown keys are
/// errors. A struct may have
///
///   template <class Report> void validate(Report&& report) const;    // report("key.below", "what is wrong")
///
/// which is called when everything inside the struct could be read. Items of lists count from 1 in messages.
/// What write_toml writes, read_toml reads back bit for bit.
/// Real time: no.
/// Errors: InputError.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace stribeck::io {

/// A parsed file as a light tree, so that the TOML library is compiled once.
struct Node {
  enum class Kind { kTable, kList, kText, kInteger, kNumber, kBool, kOther };

  Kind kind = Kind::kTable;
  std::string key;    ///< name inside its table; "" in a list
  std::string text;   ///< value of kText; of other scalars as written, for messages
  double number = 0;  ///< value of kInteger and kNumber
  std::int64_t integer = 0;
  bool flag = false;
  std::size_t line = 0;
  std::vector<Node> children;  ///< of a table or list, in the order of the file

  /// Child of a table, or null.
  [[nodiscard]] const Node* find(std::string_view name) const;
};

/// Parses TOML; `file` is for messages.
Node parse_toml(std::string_view text, const std::string& file);

/// Reads a T from a table. Where something is wrong the member keeps its initial value and `problems` grows.
template <HasFields T>
T read(const Node& node, Problems& problems);

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

/// TOML text with the keys in the order of their declaration; with Docs::kYes each line ends with its
/// sentence. A number that is not finite cannot stand in a file: InputError names the key.
template <HasFields T>
std::string write_toml(const T& value, const std::string& header_comment = {}, Docs docs = Docs::kNo);

/// One declared key, for reference pages, --help and forms.
struct KeyInfo {
  std::string key;    ///< dotted path; `[]` stands for the items of a list, `<name>` for a free name
  std::string kind;   ///< alternative of a variant to which the key belongs, else ""
  std::string unit;   ///< unit that people read, or the kind of value: text, true/false, count, number
  std::string range;  ///< permitted values, "" when all are
  std::string default_value;  ///< "" when required
  bool required = true;
  std::string doc;
};

template <HasFields T>
std::vector<KeyInfo> keys_of();

/// The keys as a Markdown table.
std::string markdown(const std::vector<KeyInfo>& keys);
template <HasFields T>
std::string describe() {
  return markdown(keys_of<T>());
}

// ---------------------------------------------------------------------------------------------------------------

namespace detail {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

template <class T>
struct IsVariant : std::false_type {};
template <class... T>
struct IsVariant<std::variant<T...>> : std::true_type {};

template <class T>
struct IsNamedTables : std::false_type {};
template <class T>
struct IsNamedTables<std::vector<std::pair<std::string, T>>> : std::true_type {};

template <class T>
struct ListTraits {
  static constexpr bool kIsList = false;
};
template <class T, std::size_t N>
struct ListTraits<FixedVector<T, N>> {
  static constexpr bool kIsList = true;
  static constexpr std::size_t kMin = 0;
  static constexpr std::size_t kMax = N;
};
template <class T>
struct ListTraits<std::vector<T>> {
  static constexpr bool kIsList = true;
  static constexpr std::size_t kMin = 0;
  static constexpr std::size_t kMax = std::numeric_limits<std::size_t>::max();
};
template <class T, std::size_t N>
struct ListTraits<std::array<T, N>> {
  static constexpr bool kIsList = true;
  static constexpr std::size_t kMin = N;
  static constexpr std::size_t kMax = N;
};

template <class T>
constexpr bool kIsOptional = IsOptional<T>::value;
template <class T>
constexpr bool kIsVariant = IsVariant<T>::value;
template <class T>
constexpr bool kIsNamedTables = IsNamedTables<T>::value;
template <class T>
constexpr bool kIsList = ListTraits<T>::kIsList && !kIsNamedTables<T>;
/// Written as a table of its own.
template <class T>
constexpr bool kIsTable = HasFields<T> || kIsVariant<T> || kIsNamedTables<T>;
template <class T>
constexpr bool kNeverSupported = false;

/// Calls f(std::type_identity<Alternative>) for each alternative of a variant.
template <class F, class... T>
void for_each_alternative(std::type_identity<std::variant<T...>>, F&& f) {
  (f(std::type_identity<T>{}), ...);
}

template <class V>
std::vector<std::string_view> kinds_of() {
  std::vector<std::string_view> kinds;
  for_each_alternative(std::type_identity<V>{},
                       [&]<class A>(std::type_identity<A>) { kinds.push_back(A::kKind); });
  return kinds;
}

template <NamedEnum E>
std::vector<std::string_view> names_of() {
  std::vector<std::string_view> names;
  for (const auto& [value, name] : EnumNames<E>::names) names.push_back(name);
  return names;
}

template <NamedEnum E>
std::string_view name_of(E value) {
  for (const auto& [v, name] : EnumNames<E>::names) {
    if (v == value) return name;
  }
  return {};
}

std::string joined(const std::vector<std::string_view>& words, std::string_view between);
std::string dotted(const std::string& path, std::string_view key);

/// What the node is, as messages name it.
std::string shown(const Node& node);

// Readers of one value; on a problem they report it and give nothing.
std::optional<double> read_number(const Node&, const Quantity&, const std::string& key, Problems&);
std::optional<std::int64_t> read_integer(const Node&, const Quantity&, std::int64_t min, std::int64_t max,
                                         const std::string& key, Problems&);
std::optional<bool> read_bool(const Node&, const std::string& key, Problems&);
std::optional<std::string> read_string(const Node&, const std::string& key, Problems&);
/// Index into names.
std::optional<std::size_t> read_choice(const Node&, const std::vector<std::string_view>& names,
                                       const std::string& key, Problems&);
bool is_table(const Node&, const std::string& key, Problems&);
bool is_list(const Node&, std::size_t min, std::size_t max, const std::string& key, Problems&);
void report_unknown_keys(const Node&, const std::vector<std::string_view>& known, const std::string& path,
                         Problems&);
void report_missing(const Node& table, std::string_view name, const Quantity&, std::string_view doc,
                    const std::string& path, Problems&);
/// Line of the key below a table, as deep as it is there.
std::size_t line_of(const Node& table, std::string_view dotted_key);

template <class T>
void read_value(const Node& node, T& out, const Quantity& q, const std::string& key, Problems& problems);

template <HasFields T>
void read_members(const Node& table, T& out, const std::string& path, bool has_kind, Problems& problems) {
  const std::size_t before = problems.size();
  std::vector<std::string_view> known;
  if (has_kind) known.push_back("kind");
  for_each_field<T>([&](const auto& f) { known.push_back(f.name); });
  report_unknown_keys(table, known, path, problems);
  for_each_field<T>([&](const auto& f) {
    using M = typename std::remove_cvref_t<decltype(f)>::member_type;
    if (const Node* child = table.find(f.name)) {
      read_value(*child, out.*f.member, f.quantity, dotted(path, f.name), problems);
    } else if (f.required && !kIsOptional<M>) {
      report_missing(table, f.name, f.quantity, f.doc, path, problems);
    }
  });
  if constexpr (requires { out.validate([](std::string_view, std::string) {}); }) {
    if (problems.size() != before) return;
    out.validate([&](std::string_view key, std::string message) {
      problems.add(line_of(table, key), dotted(path, key), std::move(message));
    });
  }
}

template <class T>
void read_list(const Node& node, T& out, const Quantity& q, const std::string& key, Problems& problems) {
  using Traits = ListTraits<T>;
  if (!is_list(node, Traits::kMin, Traits::kMax, key, problems)) return;
  if constexpr (Traits::kMin == 0) out = T{};
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    typename T::value_type item{};
    read_value(node.children[i], item, q, key + '[' + std::to_string(i + 1) + ']', problems);
    if constexpr (Traits::kMin == 0) {
      out.push_back(item);
    } else {
      out[i] = item;
    }
  }
}

template <class V>
void read_variant(const Node& node, V& out, const std::string& key, Problems& problems) {
  if (!is_table(node, key, problems)) return;
  const auto kinds = kinds_of<V>();
  const Node* kind = node.find("kind");
  if (kind == nullptr) {
    report_missing(node, "kind", {}, "one of " + joined(kinds, ", "), key, problems);
    return;
  }
  const auto chosen = read_choice(*kind, kinds, dotted(key, "kind"), problems);
  if (!chosen) return;
  for_each_alternative(std::type_identity<V>{}, [&]<class A>(std::type_identity<A>) {
    if (A::kKind != kinds[*chosen]) return;
    A value{};
    read_members(node, value, key, true, problems);
    out = std::move(value);
  });
}

template <class T>
void read_value(const Node& node, T& out, const Quantity& q, const std::string& key, Problems& problems) {
  if constexpr (kIsOptional<T>) {
    typename T::value_type value{};
    read_value(node, value, q, key, problems);
    out = std::move(value);
  } else if constexpr (std::same_as<T, bool>) {
    if (const auto x = read_bool(node, key, problems)) out = *x;
  } else if constexpr (std::floating_point<T>) {
    static_assert(std::same_as<T, double>, "files hold double");
    if (const auto x = read_number(node, q, key, problems)) out = *x;
  } else if constexpr (std::integral<T>) {
    using Limits = std::numeric_limits<T>;
    constexpr auto kMax = static_cast<std::int64_t>(std::min<std::uint64_t>(
        static_cast<std::uint64_t>(Limits::max()), std::numeric_limits<std::int64_t>::max()));
    const auto x = read_integer(node, q, static_cast<std::int64_t>(Limits::min()), kMax, key, problems);
    if (x) out = static_cast<T>(*x);
  } else if constexpr (std::same_as<T, std::string>) {
    if (auto x = read_string(node, key, problems)) out = std::move(*x);
  } else if constexpr (NamedEnum<T>) {
    if (const auto x = read_choice(node, names_of<T>(), key, problems)) out = EnumNames<T>::names[*x].first;
  } else if constexpr (HasFields<T>) {
    if (is_table(node, key, problems)) read_members(node, out, key, false, problems);
  } else if constexpr (kIsVariant<T>) {
    read_variant(node, out, key, problems);
  } else if constexpr (kIsNamedTables<T>) {
    if (!is_table(node, key, problems)) return;
    out.clear();
    for (const Node& child : node.children) {
      typename T::value_type::second_type value{};
      read_value(child, value, q, dotted(key, child.key), problems);
      out.emplace_back(child.key, std::move(value));
    }
  } else if constexpr (kIsList<T>) {
    read_list(node, out, q, key, problems);
  } else {
    static_assert(kNeverSupported<T>, "see core/fields.hpp for the types that a parameter may have");
  }
}

// Writers of one value.
std::string written_number(double x, const Quantity&, const std::string& key);
std::string written_text(std::string_view text);
std::string written_key(std::string_view key);

template <class T>
std::string inline_value(const T& value, const Quantity& q, const std::string& key);

/// `a = 1, b = "2 mm"`, for inline tables.
template <HasFields T>
void inline_members(const T& value, const std::string& path, std::string& out) {
  for_each_field<T>([&](const auto& f) {
    const auto& member = value.*f.member;
    if constexpr (kIsOptional<std::remove_cvref_t<decltype(member)>>) {
      if (!member) return;
    }
    if (!out.empty()) out += ", ";
    out += written_key(f.name) + " = " + inline_value(member, f.quantity, dotted(path, f.name));
  });
}

template <class T>
std::string inline_value(const T& value, const Quantity& q, const std::string& key) {
  std::string out;
  if constexpr (kIsOptional<T>) {
    return inline_value(*value, q, key);
  } else if constexpr (std::same_as<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::floating_point<T>) {
    return written_number(value, q, key);
  } else if constexpr (std::integral<T>) {
    return std::to_string(value);
  } else if constexpr (std::same_as<T, std::string>) {
    return written_text(value);
  } else if constexpr (NamedEnum<T>) {
    return written_text(name_of(value));
  } else if constexpr (HasFields<T>) {
    inline_members(value, key, out);
    return '{' + out + '}';
  } else if constexpr (kIsVariant<T>) {
    std::visit(
        [&](const auto& chosen) {
          out = "kind = " + written_text(chosen.kKind);
          inline_members(chosen, key, out);
        },
        value);
    return '{' + out + '}';
  } else if constexpr (kIsNamedTables<T>) {
    for (const auto& [name, item] : value) {
      out += (out.empty() ? "" : ", ") + written_key(name) + " = " + inline_value(item, q, dotted(key, name));
    }
    return '{' + out + '}';
  } else {
    static_assert(kIsList<T>, "see core/fields.hpp for the types that a parameter may have");
    constexpr bool kOnePerLine = kIsTable<typename T::value_type>;
    std::size_t i = 0;
    for (const auto& item : value) {
      const std::string text = inline_value(item, q, key + '[' + std::to_string(++i) + ']');
      out += kOnePerLine ? "\n  " + text + ',' : (out.empty() ? "" : ", ") + text;
    }
    return '[' + out + (kOnePerLine && i > 0 ? "\n]" : "]");
  }
}

template <HasFields T>
void write_members(const T& value, const std::string& path, std::string lines, Docs docs, std::string& out);

template <class T>
void write_table(const T& value, const std::string& path, Docs docs, std::string& out) {
  if constexpr (kIsOptional<T>) {
    if (value) write_table(*value, path, docs, out);
  } else if constexpr (kIsVariant<T>) {
    std::visit(
        [&](const auto& chosen) {
          write_members(chosen, path, "kind = " + written_text(chosen.kKind) + '\n', docs, out);
        },
        value);
  } else if constexpr (kIsNamedTables<T>) {
    if (value.empty()) out += "\n[" + path + "]\n";
    for (const auto& [name, item] : value) {
      const std::string below = dotted(path, written_key(name));
      if constexpr (kIsTable<std::remove_cvref_t<decltype(item)>>) {
        write_table(item, below, docs, out);
      } else {
        static_assert(kNeverSupported<T>, "named tables hold structs or variants");
      }
    }
  } else {
    write_members(value, path, {}, docs, out);
  }
}

template <class M>
struct IsTableMember : std::bool_constant<kIsTable<M>> {};
template <class M>
struct IsTableMember<std::optional<M>> : IsTableMember<M> {};

/// First the lines of this table (`lines` holds those already there), then the tables below it.
template <HasFields T>
void write_members(const T& value, const std::string& path, std::string lines, Docs docs, std::string& out) {
  bool has_tables = false;
  for_each_field<T>([&](const auto& f) {
    const auto& member = value.*f.member;
    using M = std::remove_cvref_t<decltype(member)>;
    if constexpr (kIsOptional<M>) {
      if (!member) return;
    }
    if constexpr (IsTableMember<M>::value) {
      has_tables = true;
    } else {
      std::string text = inline_value(member, f.quantity, dotted(path, f.name));
      if (docs == Docs::kYes) {
        const auto end_of_line = std::min(text.find('\n'), text.size());
        text.insert(end_of_line, "  # " + std::string(f.doc));
      }
      lines += written_key(f.name) + " = " + text + '\n';
    }
  });
  // A table that only holds tables needs no heading of its own.
  if (!path.empty() && (!lines.empty() || !has_tables)) out += "\n[" + path + "]\n";
  out += lines;
  for_each_field<T>([&](const auto& f) {
    const auto& member = value.*f.member;
    if constexpr (IsTableMember<std::remove_cvref_t<decltype(member)>>::value) {
      write_table(member, dotted(path, written_key(f.name)), docs, out);
    }
  });
}

std::string commented(const std::string& text);

template <class T>
std::string default_text(const T& value, const Quantity& q) {
  if constexpr (kIsOptional<T>) {
    return value ? default_text(*value, q) : "none";
  } else if constexpr (std::same_as<T, double>) {
    return std::isfinite(value) ? from_si(value, q) : "none";
  } else if constexpr (kIsList<T>) {
    std::string text;
    for (const auto& item : value) text += (text.empty() ? "" : ", ") + default_text(item, q);
    return text.empty() ? "none" : text;
  } else if constexpr (std::same_as<T, std::string>) {
    return value.empty() ? "none" : value;
  } else if constexpr (kIsTable<T>) {
    return "see below";
  } else if constexpr (NamedEnum<T>) {
    return std::string(name_of(value));
  } else {
    return inline_value(value, q, {});
  }
}

template <class M>
void add_keys(KeyInfo info, const M& initial, const Quantity& q, std::vector<KeyInfo>& out);

template <HasFields T>
void add_members(const T& initial, const std::string& path, const std::string& kind,
                 std::vector<KeyInfo>& out) {
  for_each_field<T>([&](const auto& f) {
    const auto& member = initial.*f.member;
    KeyInfo info;
    info.key = dotted(path, f.name);
    info.kind = kind;
    info.required = f.required && !kIsOptional<std::remove_cvref_t<decltype(member)>>;
    if (!info.required) info.default_value = default_text(member, f.quantity);
    info.doc = f.doc;
    add_keys(std::move(info), member, f.quantity, out);
  });
}

template <class M>
void add_keys(KeyInfo info, const M& initial, const Quantity& q, std::vector<KeyInfo>& out) {
  if constexpr (kIsOptional<M>) {
    add_keys(std::move(info), initial.value_or(typename M::value_type{}), q, out);
  } else if constexpr (HasFields<M>) {
    info.unit = "table";
    const auto [key, kind] = std::pair{info.key, info.kind};
    out.push_back(std::move(info));
    add_members(initial, key, kind, out);
  } else if constexpr (kIsVariant<M>) {
    const std::string key = info.key;
    info.unit = "table";
    info.range = "kind = " + joined(kinds_of<M>(), " | ");
    out.push_back(std::move(info));
    for_each_alternative(std::type_identity<M>{}, [&]<class A>(std::type_identity<A>) {
      add_members(A{}, key, std::string(A::kKind), out);
    });
  } else if constexpr (kIsNamedTables<M>) {
    info.key += ".<name>";
    add_keys(std::move(info), typename M::value_type::second_type{}, q, out);
  } else if constexpr (kIsList<M>) {
    info.key += "[]";
    add_keys(std::move(info), typename M::value_type{}, q, out);
  } else {
    if constexpr (std::same_as<M, double>) {
      info.unit = q.unit.empty() && q.shown.empty() ? "number" : q.shown.empty() ? q.unit : q.shown;
      info.range = range_text(q);
    } else if constexpr (std::same_as<M, bool>) {
      info.unit = "true/false";
    } else if constexpr (std::integral<M>) {
      info.unit = "count";
      info.range = range_text(q);
    } else if constexpr (NamedEnum<M>) {
      info.unit = "text";
      info.range = joined(names_of<M>(), " | ");
    } else {
      info.unit = "text";
    }
    out.push_back(std::move(info));
  }
}

}  // namespace detail

template <HasFields T>
T read(const Node& node, Problems& problems) {
  T value{};
  detail::read_value(node, value, {}, {}, problems);
  return value;
}

template <HasFields T>
std::string write_toml(const T& value, const std::string& header_comment, Docs docs) {
  std::string out = detail::commented(header_comment);
  detail::write_members(value, {}, {}, docs, out);
  return out;
}

template <HasFields T>
std::vector<KeyInfo> keys_of() {
  std::vector<KeyInfo> keys;
  detail::add_members(T{}, {}, {}, keys);
  return keys;
}

}  // namespace stribeck::io
