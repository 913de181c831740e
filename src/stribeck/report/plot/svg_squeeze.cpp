#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <map>
#include <optional>
#include <stribeck/report/plot/svg_numbers.hpp>
#include <stribeck/report/plot/svg_squeeze.hpp>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace stribeck::report {
namespace {

struct Attribute {
  std::string name, value;
  char quote = '"';
};

/// An element, or a text where the name is empty.
struct Element {
  std::string name, text;
  std::vector<Attribute> attributes;
  std::vector<Element> children;

  [[nodiscard]] const std::string* find(std::string_view attribute) const {
    for (const Attribute& a : attributes) {
      if (a.name == attribute) return &a.value;
    }
    return nullptr;
  }
  [[nodiscard]] bool has_any(std::initializer_list<std::string_view> names) const {
    return std::any_of(names.begin(), names.end(), [&](std::string_view n) { return find(n) != nullptr; });
  }
  void erase(std::string_view attribute) {
    std::erase_if(attributes, [&](const Attribute& a) { return a.name == attribute; });
  }
};

/// Reads the elements of a drawing without comments, declarations and attributes without a value.
class DrawingReader {
 public:
  explicit DrawingReader(std::string_view svg) : svg_(svg) {}

  std::optional<Element> read() {
    Element root;
    if (!element(root) || at_ != svg_.size()) return std::nullopt;
    return root;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
  void skip_blanks() {
    while (at_ < svg_.size() && is_blank(svg_[at_])) ++at_;
  }
  [[nodiscard]] bool ends() const { return at_ >= svg_.size(); }
  std::string_view word() {
    const std::size_t begin = at_;
    while (!ends() && !is_blank(svg_[at_]) && svg_[at_] != '=' && svg_[at_] != '>' && svg_[at_] != '/') ++at_;
    return svg_.substr(begin, at_ - begin);
  }

  bool attribute(Element& to) {
    Attribute a;
    a.name = word();
    if (a.name.empty() || ends() || svg_[at_] != '=') return false;
    if (++at_ >= svg_.size()) return false;
    a.quote = svg_[at_++];
    if (a.quote != '"' && a.quote != '\'') return false;
    const std::size_t end = svg_.find(a.quote, at_);
    if (end == std::string_view::npos) return false;
    a.value = svg_.substr(at_, end - at_);
    at_ = end + 1;
    to.attributes.push_back(std::move(a));
    return true;
  }

  bool element(Element& to) {
    if (ends() || svg_[at_] != '<') return false;
    ++at_;
    to.name = word();
    if (to.name.empty()) return false;
    for (skip_blanks(); !ends() && svg_[at_] != '>' && svg_[at_] != '/'; skip_blanks()) {
      if (!attribute(to)) return false;
    }
    if (ends()) return false;
    if (svg_[at_] == '/') {
      at_ += 2;
      return at_ <= svg_.size() && svg_[at_ - 1] == '>';
    }
    ++at_;
    return contents(to);
  }

  bool contents(Element& to) {
    while (!ends()) {
      if (svg_[at_] != '<') {
        const std::size_t end = std::min(svg_.find('<', at_), svg_.size());
        to.children.emplace_back().text = svg_.substr(at_, end - at_);
        at_ = end;
      } else if (at_ + 1 < svg_.size() && svg_[at_ + 1] == '/') {
        at_ += 2;
        if (word() != to.name || ends() || svg_[at_] != '>') return false;
        ++at_;
        return true;
      } else if (!element(to.children.emplace_back())) {
        return false;
      }
    }
    return false;
  }

  std::string_view svg_;
  std::size_t at_ = 0;
};

void write(const Element& e, std::string& out) {
  if (e.name.empty()) {
    out += e.text;
    return;
  }
  (out += '<') += e.name;
  for (const Attribute& a : e.attributes) {
    ((out += ' ') += a.name) += '=';
    ((out += a.quote) += a.value) += a.quote;
  }
  if (e.children.empty()) {
    out += "/>";
    return;
  }
  out += '>';
  for (const Element& child : e.children) write(child, out);
  ((out += "</") += e.name) += '>';
}

/// "0.70" becomes ".7", "12.00" "12"; another text stays.
std::string short_number(const std::string& text) {
  const std::size_t point = text.find('.');
  if (point == std::string::npos || text.find_first_not_of("0123456789.") != std::string::npos) return text;
  std::string out = text.substr(0, text.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
  if (out.starts_with("0.")) out.erase(0, 1);
  return out.empty() ? "0" : out;
}

/// In tenths of a pixel, from the beginning of a text, which loses it.
std::optional<long> take_tenths(std::string_view& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !(std::abs(value) < 1e6)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return std::lround(10.0 * value);
}

/// "83.55,232.00 101.47,232.00 …" as one closed stretch of a path.
std::optional<std::string> as_path(std::string_view points) {
  std::string out;
  std::array<long, 2> at{};
  bool first = true;
  while (!points.empty()) {
    const auto x = take_tenths(points);
    if (!x || points.empty() || points.front() != ',') return std::nullopt;
    points.remove_prefix(1);
    const auto y = take_tenths(points);
    if (!y) return std::nullopt;
    while (!points.empty() && points.front() == ' ') points.remove_prefix(1);
    if (first) {
      out = 'M' + of_tenths(*x);
      append_tenths(out, *y);
      out += 'l';
    } else {
      if (out.back() == 'l') {
        out += of_tenths(*x - at[0]);
      } else {
        append_tenths(out, *x - at[0]);
      }
      append_tenths(out, *y - at[1]);
    }
    first = false;
    at = {*x, *y};
  }
  if (out.empty() || out.back() == 'l') return std::nullopt;
  return out + 'z';
}

bool same_attributes(const Element& a, const Element& b, std::string_view but) {
  const auto others = [&](const Element& e) {
    std::map<std::string, std::string> out;
    for (const Attribute& x : e.attributes) {
      if (x.name != but) out[x.name] = x.value;
    }
    return out;
  };
  return others(a) == others(b);
}

std::string& value_of(Element& e, std::string_view attribute) {
  return std::find_if(e.attributes.begin(), e.attributes.end(),
                      [&](const Attribute& a) { return a.name == attribute; })
      ->value;
}

/// A polygon as a path; unchanged where its points cannot be read.
void make_path(Element& e) {
  const std::string* points = e.find("points");
  if (e.name != "polygon" || points == nullptr || !e.children.empty()) return;
  const auto d = as_path(*points);
  if (!d) return;
  e.name = "path";
  Attribute& a = *std::find_if(e.attributes.begin(), e.attributes.end(),
                               [](const Attribute& x) { return x.name == "points"; });
  a.name = "d";
  a.value = *d;
}

/// A text at a place that is not turned has x and y.
void place_text(Element& e) {
  constexpr std::string_view kTranslate = "translate(";
  const std::string* transform = e.find("transform");
  if (e.name != "text" || transform == nullptr || e.has_any({"x", "y"})) return;
  std::string_view place = *transform;
  if (!place.starts_with(kTranslate)) return;
  place.remove_prefix(kTranslate.size());
  const auto x = take_tenths(place);
  if (!x || place.empty() || place.front() != ',') return;
  place.remove_prefix(1);
  const auto y = take_tenths(place);
  if (!y || place != ")") return;
  e.erase("transform");
  e.attributes.insert(e.attributes.begin(), {{"x", of_tenths(*x)}, {"y", of_tenths(*y)}});
}

/// A group with one element in it gives its attributes to that element and goes.
void unwrap(Element& e) {
  while (e.name == "g" && e.children.size() == 1 && !e.children.front().name.empty() &&
         !e.has_any({"id", "class", "clip-path", "opacity"})) {
    Element child = std::move(e.children.front());
    if (child.has_any({"clip-path"}) ||
        (child.find("transform") != nullptr && e.find("transform") != nullptr)) {
      e.children.front() = std::move(child);
      return;
    }
    for (Attribute& a : e.attributes) {
      if (child.find(a.name) == nullptr) child.attributes.push_back(std::move(a));
    }
    e = std::move(child);
  }
}

/// Neighbours that look alike and were polygons: one path.
void join_polygons(std::vector<Element>& children, const std::vector<bool>& polygon) {
  std::vector<Element> out;
  bool last = false;
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (last && polygon[i] && same_attributes(out.back(), children[i], "d")) {
      value_of(out.back(), "d") += *children[i].find("d");
    } else {
      out.push_back(std::move(children[i]));
    }
    last = polygon[i];
  }
  children = std::move(out);
}

/// The grid and the tics of the axes, which stand before all curves, between their numbers: one path for each look.
void join_tics(std::vector<Element>& children) {
  std::vector<Element> out;
  std::vector<std::size_t> paths;
  for (Element& child : children) {
    const bool path =
        child.name == "path" && child.find("d") != nullptr && !child.has_any({"id", "transform"});
    if (!path && child.name != "text") paths.clear();
    if (path) {
      const auto like = std::find_if(paths.begin(), paths.end(),
                                     [&](std::size_t k) { return same_attributes(out[k], child, "d"); });
      if (like != paths.end()) {
        value_of(out[*like], "d") += *child.find("d");
        continue;
      }
      paths.push_back(out.size());
    }
    out.push_back(std::move(child));
  }
  children = std::move(out);
}

using Inherited = std::map<std::string, std::string, std::less<>>;

/// What every element has from its parents, where nobody says otherwise.
Inherited initial() { return {{"stroke-width", "1"}, {"text-anchor", "start"}, {"fill-opacity", "1"}}; }

constexpr std::array<std::string_view, 12> kFromParents{
    "stroke",          "stroke-width",    "fill",        "font-size", "text-anchor",  "stroke-linecap",
    "stroke-linejoin", "shape-rendering", "font-family", "color",     "fill-opacity", "stroke-dasharray"};

/// Leaves out attributes that the parents have already.
void drop_inherited(Element& e, Inherited from_parents) {
  std::erase_if(e.attributes, [&](const Attribute& a) {
    if (std::find(kFromParents.begin(), kFromParents.end(), a.name) == kFromParents.end()) return false;
    const auto known = from_parents.find(a.name);
    if (known != from_parents.end() && known->second == a.value) return true;
    from_parents[a.name] = a.value;
    return false;
  });
  if (e.name == "defs") return;  // what is drawn from here has other parents
  for (Element& child : e.children) drop_inherited(child, from_parents);
}

void squeeze(Element& e) {
  if (e.name == "defs") return;
  for (Attribute& a : e.attributes) {
    if (std::find(kFromParents.begin(), kFromParents.end(), a.name) != kFromParents.end())
      a.value = short_number(a.value);
  }
  std::vector<bool> polygon;
  for (Element& child : e.children) {
    squeeze(child);
    const bool was = child.name == "polygon";
    make_path(child);
    polygon.push_back(was && child.name == "path");
  }
  join_polygons(e.children, polygon);
  unwrap(e);
  place_text(e);
}

/// Groups that say nothing any more give their elements to their parent.
void splice(Element& e) {
  if (e.name == "defs") return;
  std::vector<Element> out;
  for (Element& child : e.children) {
    splice(child);
    if (child.name == "g" && child.attributes.empty()) {
      std::move(child.children.begin(), child.children.end(), std::back_inserter(out));
    } else {
      out.push_back(std::move(child));
    }
  }
  e.children = std::move(out);
}

/// What texts that follow each other have in common stands once, in a group around them.
void join_texts(std::vector<Element>& children) {
  const auto look_of = [](const Element& text) {
    Element out;
    out.name = "g";
    for (const Attribute& a : text.attributes) {
      if (a.name != "x" && a.name != "y" && a.name != "transform") out.attributes.push_back(a);
    }
    return out;
  };
  std::vector<Element> out;
  for (std::size_t i = 0; i < children.size();) {
    Element group = look_of(children[i]);
    std::size_t end = i;
    while (end < children.size() && children[end].name == "text" && children[end].find("id") == nullptr &&
           same_attributes(look_of(children[end]), group, {}))
      ++end;
    if (end < i + 2 || group.attributes.empty()) {
      out.push_back(std::move(children[i++]));
      continue;
    }
    for (; i < end; ++i) {
      for (const Attribute& a : group.attributes) children[i].erase(a.name);
      group.children.push_back(std::move(children[i]));
    }
    out.push_back(std::move(group));
  }
  children = std::move(out);
}

void join_in_canvas(Element& e) {
  const std::string* id = e.find("id");
  if (id != nullptr && id->ends_with("gnuplot_canvas")) {
    join_tics(e.children);
    join_texts(e.children);
  }
  for (Element& child : e.children) join_in_canvas(child);
}

}  // namespace

std::string squeezed_svg(std::string svg) {
  std::optional<Element> root = DrawingReader(svg).read();
  if (!root) return svg;
  squeeze(*root);
  drop_inherited(*root, initial());
  splice(*root);
  join_in_canvas(*root);
  std::string out;
  out.reserve(svg.size());
  write(*root, out);
  return out;
}

}  // namespace stribeck::report
