#include <algorithm>
#include <sstream>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>

namespace {
struct BrokenToml {};
[[noreturn]] void give_up() { throw BrokenToml{}; }
}  // namespace

// toml++ 3.3 asserts on some bad files, e.g. "[=a]", instead of reporting them, and without assertions
// assumes that they do not happen. Here its assertions are always on and throw.
#undef NDEBUG
#define TOML_ASSERT(condition) ((condition) ? static_cast<void>(0) : give_up())
#include <toml++/toml.h>

namespace stribeck::io {

namespace {

Node converted(const toml::node& in, std::size_t fallback_line);

/// Children in the order of the file; toml++ keeps them sorted by name.
void add_children(const toml::table& in, Node& out) {
  struct Child {
    toml::source_position at;
    Node node;
  };
  std::vector<Child> children;
  for (const auto& [key, value] : in) {
    const auto at = key.source().begin;
    Child child{at, converted(value, at.line > 0 ? at.line : out.line)};
    child.node.key = std::string(key.str());
    children.push_back(std::move(child));
  }
  std::stable_sort(children.begin(), children.end(),
                   [](const Child& a, const Child& b) { return a.at < b.at; });
  for (auto& child : children) out.children.push_back(std::move(child.node));
}

Node converted(const toml::node& in, std::size_t fallback_line) {
  using Kind = Node::Kind;
  Node out;
  out.line = in.source().begin.line > 0 ? in.source().begin.line : fallback_line;
  if (const auto* table = in.as_table()) {
    out.kind = Kind::kTable;
    add_children(*table, out);
  } else if (const auto* array = in.as_array()) {
    out.kind = Kind::kList;
    for (const auto& item : *array) out.children.push_back(converted(item, out.line));
  } else if (const auto* text = in.as_string()) {
    out.kind = Kind::kText;
    out.text = text->get();
  } else if (const auto* integer = in.as_integer()) {
    out.kind = Kind::kInteger;
    out.integer = integer->get();
    out.number = static_cast<double>(out.integer);
    out.text = std::to_string(out.integer);
  } else if (const auto* number = in.as_floating_point()) {
    out.kind = Kind::kNumber;
    out.number = number->get();
    out.text = number_text(out.number);
  } else if (const auto* flag = in.as_boolean()) {
    out.kind = Kind::kBool;
    out.flag = flag->get();
    out.text = out.flag ? "true" : "false";
  } else {
    out.kind = Kind::kOther;
    out.text = "a date or time";
  }
  return out;
}

std::string unit_example(const Quantity& q) {
  const auto unit = q.shown.empty() ? q.unit : q.shown;
  return unit.empty() ? std::string("5") : "\"5 " + std::string(unit) + '"';
}

}  // namespace

const Node* Node::find(std::string_view name) const {
  const auto hit =
      std::find_if(children.begin(), children.end(), [&](const Node& n) { return n.key == name; });
  return hit == children.end() ? nullptr : &*hit;
}

namespace {

/// Line at which toml++ gives up on a text without saying where.
std::size_t broken_line(std::string_view text) {
  std::size_t line = 0;
  for (std::size_t end = 0; end < text.size();) {
    end = std::min(text.find('\n', end), text.size() - 1) + 1;
    ++line;
    try {
      (void)toml::parse(text.substr(0, end));
    } catch (const BrokenToml&) {
      break;
    } catch (const toml::parse_error&) {
      continue;  // cut inside a value
    }
  }
  return line;
}

}  // namespace

namespace {

/// Where a text in quotes that begins at `at` ends; of one that has no end, the end of the line or, with three quotes, of all.
std::size_t end_of_quotes(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string three(3, quote);
  const bool long_text = text.substr(at, 3) == three;
  for (std::size_t i = at + (long_text ? 3 : 1); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (long_text ? text.substr(i, 3) == three : text[i] == quote) {
      return i + (long_text ? 3 : 1);
    } else if (!long_text && text[i] == '\n') {
      return i;
    }
  }
  return text.size();
}

/// Line of a key of more parts than any file needs, or 0. Tables as deep as such a key would overflow the stack when they are
/// walked; toml++ itself limits lists and inline tables alone.
std::size_t line_of_deep_key(std::string_view text) {
  constexpr int kDeepest = 64;
  std::size_t line = 1;
  int dots = 0;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::size_t end = end_of_quotes(text, i);
      line += static_cast<std::size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                                  text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
      i = end;
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (c == '.') {
      if (++dots >= kDeepest) return line;
    } else if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) {
      dots = 0;
      if (c == '\n') ++line;
    }
    ++i;
  }
  return 0;
}

}  // namespace

Node parse_toml(std::string_view text, const std::string& file) {
  if (const std::size_t line = line_of_deep_key(text); line > 0)
    throw InputError(
        Problem{file, line, "", "a key of 64 parts or more, expected at most ten, e.g. axes.x.plant.mass"});
  try {
    const toml::table table = toml::parse(text);
    Node root = converted(table, 1);
    root.line = 1;
    return root;
  } catch (const toml::parse_error& e) {
    throw InputError(
        Problem{file, e.source().begin.line, "", "not valid TOML: " + std::string(e.description())});
  } catch (const BrokenToml&) {
    throw InputError(Problem{file, broken_line(text), "",
                             "not valid TOML, expected key = value or [table] (see toml.io)"});
  }
}

Node load_toml(const std::string& path) { return parse_toml(FileBytes(path).view(), path); }

std::string markdown(const std::vector<KeyInfo>& keys) {
  const auto cell = [](std::string text) {
    for (auto at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
      text.insert(at, "\\");
    return text;
  };
  std::string out = "| Key | Unit | Range | Default | Meaning |\n|---|---|---|---|---|\n";
  for (const auto& k : keys) {
    const std::string when = k.kind.empty() ? std::string() : "kind " + k.kind + ": ";
    const std::string initial = k.required ? std::string("required") : k.default_value;
    out += "| `" + cell(k.key) + "` | " + cell(k.unit) + " | " + cell(k.range) + " | " + cell(initial) +
           " | " + cell(when + k.doc) + " |\n";
  }
  return out;
}

namespace detail {

std::string joined(const std::vector<std::string_view>& words, std::string_view between) {
  std::string out;
  for (const auto word : words) {
    if (!out.empty()) out += between;
    out += word;
  }
  return out;
}

std::string dotted(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + '.' + std::string(key);
}

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

std::optional<double> read_number(const Node& node, const Quantity& q, const std::string& key,
                                  Problems& problems) {
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
  if (node.kind == Node::Kind::kText) return node.text;
  problems.add(node.line, key, "got " + shown(node) + ", expected text in quotes");
  return std::nullopt;
}

std::optional<std::size_t> read_choice(const Node& node, const std::vector<std::string_view>& names,
                                       const std::string& key, Problems& problems) {
  if (node.kind == Node::Kind::kText) {
    const auto hit = std::find(names.begin(), names.end(), node.text);
    if (hit != names.end()) return static_cast<std::size_t>(hit - names.begin());
  }
  std::string message = "got " + shown(node) + ", expected one of " + joined(names, ", ");
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
               "got a list of " + std::to_string(n) + ", expected " + (min == max ? "exactly " : "at most ") +
                   std::to_string(max) + " items");
  return false;
}

void report_unknown_keys(const Node& table, const std::vector<std::string_view>& known,
                         const std::string& path, Problems& problems) {
  for (const Node& child : table.children) {
    if (std::find(known.begin(), known.end(), child.key) != known.end()) continue;
    const auto near = nearest(child.key, known);
    problems.add(child.line, dotted(path, child.key),
                 "unknown key" + (!near.empty()   ? " (meant " + in_quotes(near) + "?)"
                                  : known.empty() ? std::string(" (nothing is set here)")
                                                  : " (known here: " + joined(known, ", ") + ")"));
  }
}

void report_missing(const Node& table, std::string_view name, const Quantity& q, std::string_view doc,
                    const std::string& path, Problems& problems) {
  std::string message = "missing key, expected " + std::string(doc);
  if (!q.unit.empty())
    message += " (write " + std::string(name) + " = " + unit_example(q) + ", with your value)";
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
  for (std::string line; std::getline(lines, line);) out += line.empty() ? "#\n" : "# " + line + '\n';
  return out;
}

}  // namespace detail

}  // namespace stribeck::io
