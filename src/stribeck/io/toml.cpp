#include <algorithm>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>

namespace {
struct BrokenToml {};
[[noreturn]] void give_up() { throw BrokenToml{}; }
}  // namespace

// toml++ 3.3 asserts on some bad files, e.g. "[=a]", instead of reporting them; without assertions it assumes that
// they do not occur. Here its assertions are always on and throw.
#undef NDEBUG
#define TOML_ASSERT(condition) ((condition) ? static_cast<void>(0) : give_up())
#include <toml++/toml.h>

namespace stribeck::io {

namespace {

Node converted(const toml::node& in, std::size_t fallback_line);

/// Children in the order of the file; toml++ itself sorts them by name.
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

}  // namespace

const Node* Node::find(std::string_view name) const {
  const auto hit =
      std::find_if(children.begin(), children.end(), [&](const Node& n) { return n.key == name; });
  return hit == children.end() ? nullptr : &*hit;
}

namespace {

/// Line at which toml++ fails on a text without reporting a place.
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

/// End of a text in quotes that begins at `at`; where it is missing, the end of the line or, with three quotes, of the file.
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

/// Line of a key with more parts than any file needs, or 0. Walking tables of that depth would overflow the stack;
/// toml++ itself limits only lists and inline tables.
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

void take_angles_too(Node& node) {
  node.either = true;
  for (Node& child : node.children) take_angles_too(child);
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
    if (const Node* turns = root.find("rotary"); turns != nullptr && turns->flag) take_angles_too(root);
    return root;
  } catch (const toml::parse_error& e) {
    throw NotToml(
        Problem{file, e.source().begin.line, "", "not valid TOML: " + std::string(e.description())});
  } catch (const BrokenToml&) {
    throw NotToml(Problem{file, broken_line(text), "",
                          "not valid TOML, expected key = value or [table] (see toml.io)"});
  }
}

Node load_toml(const std::string& path) { return parse_toml(FileBytes(path).view(), path); }

}  // namespace stribeck::io
