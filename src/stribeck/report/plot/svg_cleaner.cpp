#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <stribeck/report/html.hpp>
#include <stribeck/report/plot/frame.hpp>
#include <stribeck/report/plot/svg_cleaner.hpp>
#include <stribeck/report/plot/svg_numbers.hpp>
#include <stribeck/report/text.hpp>
#include <system_error>
#include <utility>
#include <vector>

namespace stribeck::report {
namespace {

/// Converts absolute coordinates to relative ones with a tenth of a pixel, which takes half the length: "M1.00,2.00
/// L3.00,2.50" becomes "M1 2l2 .5". A path with other commands than M, L and Z is returned unchanged.
std::string compact_path(std::string_view d) {
  std::string out;
  std::array<long, 2> at{};
  char last = 0;
  const auto number = [&](long tenths, bool first) {
    if (first) {
      out += of_tenths(tenths);
    } else {
      append_tenths(out, tenths);
    }
  };
  for (std::size_t i = 0; i < d.size();) {
    const char c = d[i];
    if (c == ' ' || c == '\n' || c == '\t' || c == '\r') {
      ++i;
    } else if (c == 'Z') {
      out += last = 'z';
      ++i;
    } else if (c == 'M' || c == 'L') {
      std::array<long, 2> next{};
      ++i;
      for (std::size_t k = 0; k < 2; ++k) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(d.data() + i, d.data() + d.size(), value);
        if (error != std::errc()) return std::string(d);
        next[k] = std::lround(10.0 * value);
        i = static_cast<std::size_t>(end - d.data());
        if (k == 0 && (i >= d.size() || d[i++] != ',')) return std::string(d);
      }
      // After z the current point is the start of the stretch; in gnuplot's output every z is followed by M or
      // nothing.
      if (c == 'L' && last == 'z') return std::string(d);
      const bool move = c == 'M';
      if (move || last != 'l') out += move ? 'M' : 'l';
      number(move ? next[0] : next[0] - at[0], move || last != 'l');
      number(move ? next[1] : next[1] - at[1], false);
      last = move ? 'M' : 'l';
      at = next;
    } else {
      return std::string(d);
    }
  }
  return out;
}

/// A text for an attribute in single quotes: the many double quotes of JSON stay as they are.
std::string quoted_once(std::string_view text) {
  std::string out = escape_html(text);
  constexpr std::string_view kQuote = "&quot;";
  for (std::size_t at = out.find(kQuote); at != std::string::npos; at = out.find(kQuote, at))
    out.replace(at, kQuote.size(), "\"");
  return out;
}

/// Attributes that the outermost element holds for all.
constexpr std::array<std::string_view, 6> kInherited{" fill=\"none\"",
                                                     " color=\"black\"",
                                                     " stroke=\"currentColor\"",
                                                     " stroke-linecap=\"round\"",
                                                     " stroke-linejoin=\"round\"",
                                                     " font-family=\"sans-serif\""};

/// The tag with colours as #rrggbb, and a group without what it inherits.
std::string plain_tag(std::string_view tag) {
  std::string out;
  constexpr std::string_view kRgb = "rgb(";
  for (std::size_t i = 0; i < tag.size();) {
    if (tag.substr(i, kRgb.size()) != kRgb) {
      out += tag[i++];
      continue;
    }
    const std::size_t end = tag.find(')', i);
    if (end == std::string_view::npos) return std::string(tag);
    std::array<int, 3> parts{};
    const char* at = tag.data() + i + kRgb.size();
    for (int& part : parts) {
      while (at < tag.data() + end && (*at == ' ' || *at == ',')) ++at;
      at = std::from_chars(at, tag.data() + end, part).ptr;
    }
    out += fmt::format("#{:02x}{:02x}{:02x}", parts[0], parts[1], parts[2]);
    i = end + 1;
  }
  if (tag.substr(0, 3) != "<g ") return out;
  for (const std::string_view inherited : kInherited) {
    if (const std::size_t at = out.find(inherited); at != std::string::npos) out.erase(at, inherited.size());
  }
  return out;
}

class SvgCleaner {
 public:
  SvgCleaner(std::string_view raw, std::string prefix) : raw_(raw), prefix_(std::move(prefix)) {}

  std::string clean(const Plot& plot) {
    find_used();
    const std::string text = escape_html(clean_text(described(plot)));
    out_ = fmt::format(
        "<svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" fill=\"none\" color=\"#000000\" stroke=\"currentColor\" "
        "stroke-linecap=\"round\" stroke-linejoin=\"round\" font-family=\"sans-serif\" font-size=\"12\" data-plot='{3}' role=\"img\" "
        "aria-label=\"{2}\"><title>{2}</title>",
        plot.width, plot.height, text, quoted_once(plot_facts(plot)));
    std::size_t at = raw_.find("<svg");
    at = at == std::string_view::npos ? raw_.size() : raw_.find('>', at) + 1;
    while (at < raw_.size()) {
      if (raw_[at] != '<') {
        const std::size_t end = std::min(raw_.find('<', at), raw_.size());
        const std::string_view content = raw_.substr(at, end - at);
        if (content.find_first_not_of(" \t\r\n") != std::string_view::npos) emit(content);
        at = end;
        continue;
      }
      const std::size_t end = raw_.find('>', at) + 1;
      if (end == 0) break;
      at = tag(raw_.substr(at, end - at), end);
    }
    return std::move(out_);
  }

 private:
  static bool is_named(std::string_view tag, std::string_view name) {
    return tag.substr(1, name.size()) == name && tag.find_first_of(" />", 1) == name.size() + 1;
  }

  static std::string_view attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
      const std::size_t value = at + name.size();
      if (!is_blank(tag[at - 1]) || value + 1 >= tag.size() || tag[value] != '=') continue;
      const std::size_t end = tag.find(tag[value + 1], value + 2);
      if (end != std::string_view::npos) return tag.substr(value + 2, end - value - 2);
    }
    return {};
  }

  /// Which symbols are drawn. A symbol may use another one before it, so the list is read
  /// backwards.
  void find_used() {
    std::vector<std::string_view> tags;
    for (std::size_t at = raw_.find('<'); at != std::string_view::npos; at = raw_.find('<', at + 1)) {
      const std::size_t end = raw_.find('>', at);
      if (end == std::string_view::npos) break;
      tags.push_back(raw_.substr(at, end - at + 1));
    }
    for (auto tag = tags.rbegin(); tag != tags.rend(); ++tag) {
      const std::string_view href = attribute(*tag, "xlink:href");
      const std::string_view id = attribute(*tag, "id");
      if (is_named(*tag, "use") && id.empty() && href == "#gpPt6") continue;  // see add_dot
      if (!href.empty() && (id.empty() || used_.contains(id))) used_.insert(href.substr(1));
    }
  }

  /// Handles the tag that ends at `end`; returns the place to continue.
  std::size_t tag(std::string_view t, std::size_t end) {
    const auto after = [&](std::string_view closing) {
      const std::size_t found = raw_.find(closing, end);
      return found == std::string_view::npos ? raw_.size() : found + closing.size();
    };
    if (is_named(t, "title")) return after("</title>");
    if (is_named(t, "desc")) return after("</desc>");
    if (is_named(t, "filter")) return after("</filter>");
    const bool symbol = attribute(t, "id").substr(0, 2) == "gp";
    if (symbol && !used_.contains(attribute(t, "id"))) return end;
    if (t.substr(0, 2) == "</") end_dots();
    if (t == "</g>" || t == "</defs>") {
      if (!open_.empty() && open_.back().at + open_.back().length == out_.size()) {
        out_.resize(open_.back().at);  // the element is empty
        open_.pop_back();
        return end;
      }
      if (!open_.empty()) open_.pop_back();
      out_ += t;
      return end;
    }
    if (t.substr(0, 2) == "</") {
      out_ += t;
      return end;
    }
    const std::size_t start = out_.size();
    if (add_dot(t)) return end;
    end_dots();
    const std::string_view d = attribute(t, "d");
    if (is_named(t, "path") && !symbol && !d.empty()) {
      const auto at = static_cast<std::size_t>(d.data() - t.data());
      rewrite(plain_tag(t.substr(0, at)) + compact_path(d) + plain_tag(t.substr(at + d.size())));
    } else {
      rewrite(plain_tag(t));
      // Outside a group nothing had a border.
      if (is_named(t, "rect") && open_.size() < 2 && attribute(t, "stroke").empty())
        out_.insert(start + 5, " stroke=\"none\"");
    }
    if (is_named(t, "g") || is_named(t, "defs")) open_.push_back({start, out_.size() - start});
    return end;
  }

  void emit(std::string_view content) { out_ += content; }

  /// Merges filled circles of one colour and size into one path of round dots: a map has thousands of them.
  bool add_dot(std::string_view t) {
    constexpr std::string_view kTranslate = "translate(";
    constexpr std::string_view kScale = "scale(";
    if (!is_named(t, "use") || attribute(t, "xlink:href") != "#gpPt6") return false;
    const std::string_view transform = attribute(t, "transform");
    const std::size_t place = transform.find(kTranslate);
    const std::size_t size = transform.find(kScale);
    if (place != 0 || size == std::string_view::npos) return false;
    const std::string_view at = transform.substr(kTranslate.size(), transform.find(')') - kTranslate.size());
    const std::string_view scale =
        transform.substr(size + kScale.size(), transform.find(')', size) - size - kScale.size());
    const std::string look_of_dot = plain_tag(attribute(t, "color"));
    double radius = 0.0;
    std::from_chars(scale.data(), scale.data() + scale.size(), radius);
    const std::string look = fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\"", look_of_dot, 2.0 * radius);
    if (look != dots_look_) end_dots();
    dots_look_ = look;
    dots_ += fmt::format("M{}h0", at);
    return true;
  }
  void end_dots() {
    if (!dots_.empty())
      out_ += fmt::format("<path {} stroke-linecap=\"round\" d=\"{}\"/>", dots_look_, dots_);
    dots_.clear();
  }

  /// A tag with the prefix before every id, and each run of white space replaced by one blank.
  void rewrite(std::string_view t) {
    bool blank = false;
    char quote = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const char c = t[i];
      if (is_blank(c)) {
        blank = true;
        continue;
      }
      const bool useless = quote == 0 ? c == '>' || c == '/' || c == '=' : c == quote;
      const bool after_equals = quote == 0 && !out_.empty() && out_.back() == '=';
      if (blank && !useless && !after_equals) out_ += ' ';
      blank = false;
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (t.substr(i, 11) == "xlink:href=") {
        out_ += "href=";
        i += 10;
        continue;
      }
      out_ += c;
      const std::string_view before(out_);
      if (before.ends_with(" id=\"") || before.ends_with(" id='") || before.ends_with("href='#") ||
          before.ends_with("href=\"#") || before.ends_with("url(#")) {
        out_ += prefix_;
      }
    }
  }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  struct Open {
    std::size_t at;
    std::size_t length;
  };

  std::string_view raw_;
  std::string prefix_;
  std::string out_;
  std::string dots_;
  std::string dots_look_;
  std::vector<Open> open_;
  std::set<std::string_view> used_;
};
}  // namespace

std::string cleaned_svg(std::string_view raw, const Plot& plot, std::string prefix) {
  return SvgCleaner(raw, std::move(prefix)).clean(plot);
}

}  // namespace stribeck::report
