#include <algorithm>
#include <cmath>
#include <sstream>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io {
namespace {

using detail::dotted;
using detail::inline_value;

std::string written_number(double x, const Quantity& q, const std::string& key) {
  if (!std::isfinite(x)) {
    throw InputError(Problem{"", 0, key, "got " + number_text(x) + ", expected a finite number to write"});
  }
  std::string text = from_si(x, q);
  return q.unit.empty() && q.shown.empty() ? text : '"' + text + '"';
}

std::string written_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (code < 0x20 || code == 0x7f) {
      constexpr std::string_view kHex = "0123456789ABCDEF";
      out += "\\u00";
      out += kHex[code >> 4];
      out += kHex[code & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string written_key(std::string_view key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  return bare ? std::string(key) : written_text(key);
}

std::string commented(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);)
    out += line.empty() ? "#\n" : "# " + printable(line) + '\n';
  return out;
}

/// A value that stands for "left out" and that no reader accepts: a default outside the range of its number, an empty list.
bool stands_for_nothing(const Value& group, const Member& m) {
  if (m.required()) return false;
  if (m.value.kind() == Kind::kList) return m.value.size() < m.value.type().least_items;
  if (m.value.kind() != Kind::kNumber) return false;
  const double x = m.value.number();
  const Quantity& q = m.info.quantity;
  const bool inside = x <= q.max && (q.min_excluded ? x > q.min : x >= q.min);
  return !inside && is_initial(group, m);
}

/// Nothing that is left out, and no setting that a reader would refuse because it has no effect.
template <class F>
void for_each_written(const Value& group, F&& f) {
  for_each_member(group, [&](const Member& m) {
    if (m.value.kind() == Kind::kOptional && m.value.size() == 0) return;
    if (!m.has_effect() && !is_initial(group, m)) return;
    if (stands_for_nothing(group, m)) return;
    f(m);
  });
}

/// Whether a member is written as a separate table.
bool is_table(const Value& v) {
  if (v.kind() == Kind::kOptional) return is_table(v[0]);
  return (v.kind() == Kind::kGroup && !is_short(v)) || v.kind() == Kind::kVariant || v.kind() == Kind::kNamed;
}

/// `a = 1, b = "2 mm"`, the form of inline tables.
std::string inline_members(const Value& group, const std::string& path, std::string out) {
  for_each_written(group, [&](const Member& m) {
    if (!out.empty()) out += ", ";
    out +=
        written_key(m.info.name) + " = " + inline_value(m.value, m.info.quantity, dotted(path, m.info.name));
  });
  return out;
}

std::string inline_list(const Value& list, const Quantity& q, const std::string& key) {
  if (list.type().least_items == 0 && list.type().most_items == 2 &&
      list.type().inner->kind == Kind::kNumber && list.size() == 1)
    return inline_value(list[0], q, key);
  const Kind item = list.type().inner->kind;
  const bool one_per_line = item == Kind::kGroup || item == Kind::kVariant || item == Kind::kNamed;
  std::string out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string text = inline_value(list[i], q, key + '[' + std::to_string(i + 1) + ']');
    out += one_per_line ? "\n  " + text + ',' : (out.empty() ? "" : ", ") + text;
  }
  return '[' + out + (one_per_line && list.size() > 0 ? "\n]" : "]");
}

void write_members(const Value& group, const std::string& path, std::string lines, Docs docs,
                   std::string& out);

void write_table(const Value& value, const std::string& path, Docs docs, std::string& out) {
  if (value.kind() == Kind::kOptional) return write_table(value[0], path, docs, out);
  if (value.kind() == Kind::kVariant)
    return write_members(value.chosen(), path, "kind = " + written_text(value.word()) + '\n', docs, out);
  if (value.kind() == Kind::kGroup) return write_members(value, path, {}, docs, out);
  if (value.size() == 0) out += "\n[" + path + "]\n";
  for (std::size_t i = 0; i < value.size(); ++i)
    write_table(value[i], dotted(path, written_key(value.name_at(i))), docs, out);
}

/// First the lines of this table (`lines` holds those written already), then the tables below it.
void write_members(const Value& group, const std::string& path, std::string lines, Docs docs,
                   std::string& out) {
  bool has_tables = false;
  for_each_member(group, [&](const Member& m) {
    if (m.value.kind() != Kind::kOptional) has_tables = has_tables || is_table(m.value);
  });
  for_each_written(group, [&](const Member& m) {
    if (is_table(m.value)) {
      has_tables = true;
      return;
    }
    std::string text = inline_value(m.value, m.info.quantity, dotted(path, m.info.name));
    if (docs == Docs::kYes) {
      const auto end_of_line = std::min(text.find('\n'), text.size());
      text.insert(end_of_line, "  # " + std::string(m.info.doc));
    }
    lines += written_key(m.info.name) + " = " + text + '\n';
  });
  // A table that contains only tables needs no heading.
  if (!path.empty() && (!lines.empty() || !has_tables)) out += "\n[" + path + "]\n";
  out += lines;
  for_each_written(group, [&](const Member& m) {
    if (is_table(m.value)) write_table(m.value, dotted(path, written_key(m.info.name)), docs, out);
  });
}

}  // namespace

namespace detail {

std::string inline_value(const Value& value, const Quantity& q, const std::string& key) {
  switch (value.kind()) {
    case Kind::kSwitch:
      return value.number() != 0.0 ? "true" : "false";
    case Kind::kCount:
      return std::to_string(static_cast<std::int64_t>(value.number()));
    case Kind::kNumber:
      return written_number(value.number(), q, key);
    case Kind::kText:
      return written_text(value.text());
    case Kind::kChoice:
      return written_text(value.word());
    case Kind::kOptional:
      return inline_value(value[0], q, key);
    case Kind::kGroup:
      if (is_short(value)) return written_text(short_form(value));
      return '{' + inline_members(value, key, {}) + '}';
    case Kind::kVariant:
      return '{' + inline_members(value.chosen(), key, "kind = " + written_text(value.word())) + '}';
    case Kind::kList:
      return inline_list(value, q, key);
    case Kind::kNamed:
      break;
  }
  std::string out;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::string name(value.name_at(i));
    out +=
        (out.empty() ? "" : ", ") + written_key(name) + " = " + inline_value(value[i], q, dotted(key, name));
  }
  return '{' + out + '}';
}

}  // namespace detail

std::string write_toml(const Value& group, const std::string& header_comment, Docs docs) {
  std::string out = commented(header_comment);
  write_members(group, {}, {}, docs, out);
  return out;
}

}  // namespace stribeck::io
