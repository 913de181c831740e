#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io {
namespace {

using detail::dotted;

constexpr std::string_view kOn = "on";
constexpr std::string_view kOff = "off";

std::string joined(const std::vector<std::string_view>& words) {
  return detail::joined(words.data(), words.size(), ", ");
}

std::string unit_example(const Quantity& q) {
  const auto unit = q.shown.empty() ? q.unit : q.shown;
  return unit.empty() ? std::string("5") : "\"5 " + std::string(unit) + '"';
}

/// The node as messages name it.
std::string shown(const Node& node) {
  switch (node.kind) {
    case Node::Kind::kTable:
      return "a table";
    case Node::Kind::kList:
      return "a list";
    case Node::Kind::kText:
      return in_quotes(node.text);
    default:
      return node.text;
  }
}

std::optional<double> read_number(const Node& node, const Quantity& declared, const std::string& key,
                                  Problems& problems) {
  std::optional<Quantity> rotary;
  if (node.rotary || node.either) rotary = rotary_quantity(declared, node.text);
  if (node.either && rotary && !is_convertible(node.text, *rotary)) rotary.reset();
  const Quantity& q = rotary ? *rotary : declared;
  const bool is_number = node.kind == Node::Kind::kInteger || node.kind == Node::Kind::kNumber;
  try {
    if (node.kind == Node::Kind::kText) return to_si(node.text, q);
    if (is_number && q.unit.empty()) {
      if (!std::isfinite(node.number)) {
        problems.add(node.line, key, "got " + shown(node) + ", expected a finite number");
        return std::nullopt;
      }
      check_range(node.number, q, node.text);
      return node.number;
    }
  } catch (const InputError& e) {
    problems.add(node.line, key, e.problems().front().message);
    return std::nullopt;
  }
  if (is_number) {
    const auto unit = std::string(q.shown.empty() ? q.unit : q.shown);
    problems.add(node.line, key,
                 "got the bare number " + node.text + ", expected text with a unit (missing unit: write \"" +
                     node.text + ' ' + unit + "\")");
  } else {
    problems.add(node.line, key,
                 "got " + shown(node) + ", expected " +
                     (q.unit.empty() ? "a number" : "a number with its unit in quotes") + " (write it like " +
                     unit_example(q) + ")");
  }
  return std::nullopt;
}

std::optional<std::int64_t> read_integer(const Node& node, const Quantity& q, std::int64_t min,
                                         std::int64_t max, const std::string& key, Problems& problems) {
  if (node.kind != Node::Kind::kInteger) {
    problems.add(node.line, key, "got " + shown(node) + ", expected a whole number without quotes");
    return std::nullopt;
  }
  if (!q.permits(node.number)) {
    problems.add(node.line, key, "got " + node.text + ", expected " + range_text(q));
    return std::nullopt;
  }
  if (node.integer < min || node.integer > max) {
    problems.add(node.line, key,
                 "got " + node.text + ", expected " + std::to_string(min) + " to " + std::to_string(max));
    return std::nullopt;
  }
  return node.integer;
}

std::optional<bool> read_bool(const Node& node, const std::string& key, Problems& problems) {
  if (node.kind == Node::Kind::kBool) return node.flag;
  problems.add(node.line, key, "got " + shown(node) + ", expected true or false (without quotes)");
  return std::nullopt;
}

std::optional<std::string> read_string(const Node& node, const std::string& key, Problems& problems) {
  if (node.kind != Node::Kind::kText) {
    problems.add(node.line, key, "got " + shown(node) + ", expected text in quotes");
    return std::nullopt;
  }
  // Names reach files that other programs obey line by line.
  if (printable(node.text) != node.text) {
    problems.add(node.line, key,
                 "got " + shown(node) +
                     " with line breaks or control characters in it, expected plain text on one line");
    return std::nullopt;
  }
  return node.text;
}

std::optional<std::size_t> read_choice(const Node& node, const std::vector<std::string_view>& names,
                                       const std::string& key, Problems& problems) {
  if (node.kind == Node::Kind::kText) {
    const auto hit = std::find(names.begin(), names.end(), node.text);
    if (hit != names.end()) return static_cast<std::size_t>(hit - names.begin());
  }
  std::string message = "got " + shown(node) + ", expected one of " + joined(names);
  if (node.kind == Node::Kind::kText) {
    if (const auto near = nearest(node.text, names); !near.empty())
      message += " (meant " + in_quotes(near) + "?)";
  }
  problems.add(node.line, key, std::move(message));
  return std::nullopt;
}

bool is_table(const Node& node, const std::string& key, Problems& problems) {
  if (node.kind == Node::Kind::kTable) return true;
  problems.add(node.line, key,
               "got " + shown(node) + ", expected a table (write [" + key + "] and its keys below)");
  return false;
}

bool is_list(const Node& node, std::size_t min, std::size_t max, const std::string& key, Problems& problems) {
  const std::size_t n = node.children.size();
  if (node.kind != Node::Kind::kList) {
    problems.add(node.line, key, "got " + shown(node) + ", expected a list (write " + key + " = [...])");
    return false;
  }
  if (n >= min && n <= max) return true;
  problems.add(node.line, key,
               "got a list of " + std::to_string(n) + ", expected " +
                   (min == max ? "exactly "
                    : min > 0  ? std::to_string(min) + " to "
                               : "at most ") +
                   std::to_string(max) + " items" + (n == 0 ? " (leave the key out for its default)" : ""));
  return false;
}

void report_unknown_keys(const Node& table, const std::vector<std::string_view>& known,
                         const std::string& path, Problems& problems) {
  for (const Node& child : table.children) {
    if (std::find(known.begin(), known.end(), child.key) != known.end()) continue;
    const auto near = nearest(child.key, known);
    problems.add(child.line, dotted(path, child.key),
                 "unknown key" + (!near.empty()   ? " (meant " + in_quotes(near) + "?)"
                                  : known.empty() ? std::string(" (this table has no keys)")
                                                  : " (known here: " + joined(known) + ")"));
  }
}

void report_missing(const Node& table, std::string_view name, const Quantity& q, std::string_view doc,
                    const std::string& path, Problems& problems) {
  std::string message = "missing key, expected " + std::string(doc);
  const std::optional<Quantity> rotary = table.rotary ? rotary_quantity(q, "") : std::nullopt;
  if (!q.unit.empty())
    message +=
        " (write " + std::string(name) + " = " + unit_example(rotary.value_or(q)) + ", with your value)";
  problems.add(table.line, dotted(path, name), std::move(message));
}

std::size_t line_of(const Node& table, std::string_view dotted_key) {
  const Node* at = &table;
  while (!dotted_key.empty()) {
    const auto dot = std::min(dotted_key.find('.'), dotted_key.size());
    const Node* child = at->find(dotted_key.substr(0, dot));
    if (child == nullptr) break;
    at = child;
    dotted_key.remove_prefix(std::min(dot + 1, dotted_key.size()));
  }
  return at->line;
}

void read_value(const Node& node, Target out, const Quantity& q, const std::string& key, Problems& problems);

/// Refuses a setting that does not have its initial value but has no effect beside the others.
void refuse_without_effect(const Node& table, const Target& out, const std::string& path,
                           Problems& problems) {
  for_each_member(Value(out), [&](const Member& m) {
    const Node* child = table.find(m.info.name);
    if (child == nullptr || m.has_effect() || is_initial(out, m)) return;
    problems.add(child->line, dotted(path, m.info.name),
                 std::string(m.info.condition) + " only: set that, or leave this out");
  });
}

void read_members(const Node& table, Target out, const std::string& path, bool has_kind, Problems& problems) {
  const std::size_t before = problems.size();
  std::vector<std::string_view> known;
  if (has_kind) known.push_back("kind");
  for_each_member(out, [&](const TargetMember& m) { known.push_back(m.info.name); });
  report_unknown_keys(table, known, path, problems);
  for_each_member(out, [&](const TargetMember& m) {
    if (const Node* child = table.find(m.info.name)) {
      read_value(*child, m.value, m.info.quantity, dotted(path, m.info.name), problems);
    } else if (m.required()) {
      report_missing(table, m.info.name, m.info.quantity, m.info.doc, path, problems);
    }
  });
  if (problems.size() != before) return;
  refuse_without_effect(table, out, path, problems);
  validate(out, [&](std::string_view key, std::string_view message) {
    problems.add(line_of(table, key), dotted(path, key), std::string(message));
  });
}

void read_group(const Node& node, Target out, const std::string& key, Problems& problems) {
  const std::string_view short_form = out.type().short_form;
  if (!short_form.empty() && node.kind != Node::Kind::kTable) {
    const bool on = node.kind == Node::Kind::kText && node.text == kOn;
    if (on || (node.kind == Node::Kind::kText && node.text == kOff)) {
      find_member(out, short_form)->set(on ? 1.0 : 0.0);
    } else {
      problems.add(node.line, key,
                   "got " + shown(node) + ", expected \"off\", \"on\" or a table [" + key + "]");
    }
    return;
  }
  if (is_table(node, key, problems)) read_members(node, out, key, false, problems);
}

void read_list(const Node& node, Target out, const Quantity& q, const std::string& key, Problems& problems) {
  const Type& type = out.type();
  // A value that may be a range of two is written as one where it is one.
  if (type.least_items <= 1 && type.most_items == 2 && type.inner->kind == Kind::kNumber &&
      node.kind != Node::Kind::kList) {
    out.resize(0);
    out.resize(1);
    return read_value(node, out[0], q, key, problems);
  }
  if (!is_list(node, type.least_items, type.most_items, key, problems)) return;
  if (type.resize != nullptr) {
    out.resize(0);
    out.resize(node.children.size());
  }
  for (std::size_t i = 0; i < node.children.size(); ++i)
    read_value(node.children[i], out[i], q, key + '[' + std::to_string(i + 1) + ']', problems);
}

void read_variant(const Node& node, Target out, const std::string& key, Problems& problems) {
  if (!is_table(node, key, problems)) return;
  const std::vector<std::string_view> kinds(out.type().words, out.type().words + out.type().word_count);
  const Node* kind = node.find("kind");
  if (kind == nullptr) {
    report_missing(node, "kind", {}, "one of " + joined(kinds), key, problems);
    return;
  }
  const auto chosen = read_choice(*kind, kinds, dotted(key, "kind"), problems);
  if (!chosen) return;
  out.set(static_cast<double>(*chosen));
  read_members(node, out.chosen(), key, true, problems);
}

void read_value(const Node& node, Target out, const Quantity& q, const std::string& key, Problems& problems) {
  const Type& type = out.type();
  switch (type.kind) {
    case Kind::kSwitch:
      if (const auto x = read_bool(node, key, problems)) out.set(*x ? 1.0 : 0.0);
      return;
    case Kind::kCount:
      if (const auto x = read_integer(node, q, type.least, type.most, key, problems))
        out.set(static_cast<double>(*x));
      return;
    case Kind::kNumber:
      if (const auto x = read_number(node, q, key, problems)) out.set(*x);
      return;
    case Kind::kText:
      if (const auto x = read_string(node, key, problems)) out.set(*x);
      return;
    case Kind::kChoice:
      if (const auto x = read_choice(node, {type.words, type.words + type.word_count}, key, problems))
        out.set(static_cast<double>(*x));
      return;
    case Kind::kGroup:
      return read_group(node, out, key, problems);
    case Kind::kOptional:
      out.resize(1);
      return read_value(node, out[0], q, key, problems);
    case Kind::kList:
      return read_list(node, out, q, key, problems);
    case Kind::kVariant:
      return read_variant(node, out, key, problems);
    case Kind::kNamed:
      if (!is_table(node, key, problems)) return;
      out.resize(0);
      for (const Node& child : node.children) {
        out.add(child.key);
        read_value(child, out[out.size() - 1], q, dotted(key, child.key), problems);
      }
      return;
  }
}

}  // namespace

namespace detail {

std::string joined(const std::string_view* words, std::size_t count, std::string_view between) {
  return fmt::format("{}", fmt::join(words, words + count, between));
}

std::string dotted(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + '.' + std::string(key);
}

}  // namespace detail

void read(const Node& node, Target out, Problems& problems) { read_value(node, out, {}, {}, problems); }

}  // namespace stribeck::io
