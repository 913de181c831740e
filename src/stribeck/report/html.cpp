#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stribeck/io/sha256.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/page/page_files.hpp>
#include <stribeck/report/plot/frame.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

/// Markup of a text, with newlines as they are.
std::string escape(std::string_view text, bool keep_newlines) {
  std::string out;
  out.reserve(text.size());
  for (const char c : clean_text(text, keep_newlines)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string element(std::string_view tag, std::string_view text) {
  return fmt::format("<{0}>{1}</{2}>\n", tag, escape_html(text), tag.substr(0, tag.find(' ')));
}

/// A head may be broken between words, but not after the bar of an absolute value: "mean |ε|".
std::string head_markup(std::string_view head) {
  std::string out;
  for (const char c : escape_html(head)) {
    out += c;
    if (c == '|') out += "\u2060";
  }
  return out;
}

std::string cell_markup(const Cell& cell, bool number) {
  constexpr std::size_t kLong = 60;  // letters; a sentence needs its own width on a small screen
  std::string out = number ? "<td class=\"n\">" : cell.text.size() > kLong ? "<td class=\"long\">" : "<td>";
  if (is_color(cell.color))
    out +=
        fmt::format("<span class=\"swatch\" data-color=\"{0}\" style=\"background:{0}\"></span>", cell.color);
  out += cell.best ? "<b>" + escape_html(cell.text) + "</b>" : escape_html(cell.text);
  if (!cell.spread.empty()) out += " <small>" + escape_html(cell.spread) + "</small>";
  if (!cell.note.empty()) out += "<span class=\"note\">" + escape_html(cell.note) + "</span>";
  return out + "</td>";
}

/// The colour that stands for this one on a dark page: greys are turned round, and others are lightened until they can be seen.
std::string dark_color(std::string_view color) {
  std::array<double, 3> rgb{};
  for (std::size_t k = 0; k < rgb.size(); ++k)
    rgb[k] = std::stoi(std::string(color.substr(1 + 2 * k, 2)), nullptr, 16) / 255.0;
  const auto luminance = [&] {
    const auto linear = [](double v) {
      return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    };
    return 0.2126 * linear(rgb[0]) + 0.7152 * linear(rgb[1]) + 0.0722 * linear(rgb[2]);
  };
  const auto [low, high] = std::minmax_element(rgb.begin(), rgb.end());
  constexpr double kPaper = 0.125;  // white becomes the paper of a dark page
  if (*high - *low < 0.08) {
    for (double& v : rgb) v = kPaper + (0.93 - kPaper) * (1.0 - v);
  } else {
    constexpr double kVisible = 0.22;  // a contrast of 4.5 to the paper
    while (luminance() < kVisible) {
      for (double& v : rgb) v += 0.08 * (1.0 - v);
    }
  }
  const auto byte = [](double v) { return static_cast<int>(std::lround(255.0 * v)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(rgb[0]), byte(rgb[1]), byte(rgb[2]));
}

/// Rules that replace the colours of drawings and swatches for readers of dark pages. Drawings keep their colours, so that they can
/// be taken out of the page.
std::string dark_colors(std::string_view body) {
  std::set<std::string> colors;
  for (const std::string_view key : {"stroke=", "fill=", "color="}) {
    for (std::size_t at = body.find(key); at != std::string_view::npos; at = body.find(key, at + 1)) {
      const std::string_view value = body.substr(std::min(at + key.size() + 1, body.size()), 7);
      if (is_color(value)) colors.emplace(value);
    }
  }
  if (colors.empty()) return {};
  std::string out = "@media screen and (prefers-color-scheme:dark){svg{color:#e8eaed}\n";
  for (const std::string& c : colors) {
    out += fmt::format(
        "[stroke=\"{0}\"]{{stroke:{1}}}[fill=\"{0}\"]{{fill:{1}}}[data-color=\"{0}\"]{{background:{1}!important}}\n",
        c, dark_color(c));
  }
  return out + "}\n";
}

}  // namespace

std::string escape_html(std::string_view text) { return escape(text, false); }

Page::Page(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void Page::section(std::string_view heading) {
  sections_.emplace_back(heading);
  if (sections_.size() == 1) {
    first_section_ = body_.size() - 1;
    first_section_at_ = body_.back().size();
  }
  add(fmt::format("<h2 id=\"section-{}\">{}</h2>\n", sections_.size(), escape_html(heading)));
}
void Page::subsection(std::string_view heading) { add(element("h3", heading)); }
void Page::paragraph(std::string_view text) { add(element("p", text)); }
void Page::lead(std::string_view text) { add(element("p class=\"lead\"", text)); }
void Page::link(std::string_view file, std::string_view words) {
  add("<p><a href=\"" + escape(file, true) + "\">" + escape(words, true) + "</a></p>\n");
}
void Page::remark(std::string_view text) { add(element("p class=\"remark\"", text)); }
void Page::code(std::string_view text) { add("<pre><code>" + escape(text, true) + "</code></pre>\n"); }

void Page::made(const Made& made) {
  if (made.command.empty()) return;
  section("How to make this page again");
  code(made.command);
  std::vector<std::string> files;
  for (const InputFile& f : made.inputs) files.push_back(f.file + ": " + f.sha256);
  list("SHA-256 of the files that were read:", files);
  if (!made.version.empty()) remark("Program: stribeck " + made.version + ".");
}

void Page::table(const Table& table) {
  tables_.push_back(table);
  // On a narrow screen a wide table moves sideways; the keyboard can do that only where the focus can go.
  add(fmt::format(
      "<div class=\"scroll\" role=\"group\" tabindex=\"0\" aria-label=\"{}\"><table>\n",
      table.caption.empty() ? fmt::format("Table {}", tables_.size()) : escape_html(table.caption)));
  if (!table.caption.empty()) add(element("caption", table.caption));
  if (std::any_of(table.columns.begin(), table.columns.end(),
                  [](const Column& c) { return !c.head.empty(); })) {
    add("<thead><tr>");
    for (const Column& c : table.columns) {
      if (c.head.empty() && c.unit.empty()) {
        add("<td></td>");  // a head without a word is none
        continue;
      }
      add(c.number ? "<th scope=\"col\" class=\"n\">" : "<th scope=\"col\">");
      add(head_markup(c.head));
      if (!c.unit.empty()) add("<span class=\"unit\">" + escape_html(printed_unit(c.unit)) + "</span>");
      add("</th>");
    }
    add("</tr></thead>\n");
  }
  add("<tbody>\n");
  for (const auto& row : table.rows) {
    add("<tr>");
    for (std::size_t i = 0; i < row.size(); ++i)
      add(cell_markup(row[i], i < table.columns.size() && table.columns[i].number));
    add("</tr>\n");
  }
  add("</tbody></table></div>\n");
}

void Page::figure(const Plot& plot, std::string_view caption) { figures({plot}, 1, caption); }

void Page::numbers(const std::vector<KeyNumber>& numbers) {
  if (numbers.empty()) return;
  add("<dl class=\"numbers\">\n");
  for (const KeyNumber& n : numbers) {
    add(fmt::format("<div><dt>{}</dt><dd>{}", escape_html(n.name), escape_html(n.value)));
    if (!n.unit.empty()) add(" <small>" + escape_html(printed_unit(n.unit)) + "</small>");
    add("</dd></div>\n");
  }
  add("</dl>\n");
}

void Page::figures(const std::vector<Plot>& plots, int across, std::string_view caption) {
  if (plots.empty()) return;
  constexpr int kNarrow = 700;  // a drawing of this width would be blown up to the width of the page [px]
  const bool narrow = plots.size() == 1 && plots.front().width < kNarrow;
  if (narrow) across = 1;  // or it would stand in a part of its own width
  add(fmt::format("<figure><div class=\"plots across-{}{}{}\">", across, narrow ? " narrow" : "",
                  plots.size() == 1 ? " alone" : ""));
  for (const Plot& p : plots) {
    add("<div>");
    plots_.push_back(p);
    body_.emplace_back("</div>");
  }
  add("</div>");
  if (!caption.empty()) add("\n" + element("figcaption", caption));
  add("</figure>\n");
}

void Page::list(std::string_view heading, const std::vector<std::string>& items) {
  if (items.empty()) return;
  add("<div class=\"list\"><b>" + escape_html(heading) + "</b><ul>\n");
  for (const std::string& item : items) add(element("li", item));
  add("</ul></div>\n");
}

void Page::warnings(const std::vector<std::string>& list) {
  if (list.empty()) return;
  add("<div class=\"warnings\" role=\"note\"><b>Read this before you use these numbers</b><ul>\n");
  for (const std::string& w : list) add(element("li", w));
  add("</ul></div>\n");
}

void Page::details(std::string_view summary, const std::function<void()>& fill) {
  add("<details>" + element("summary", summary));
  fill();
  add("</details>\n");
}

std::string Page::contents() const {
  constexpr std::size_t kWorthContents = 3;
  if (sections_.size() < kWorthContents) return {};
  std::string out = "<nav class=\"contents\" aria-label=\"Contents\"><b>Contents</b><ol>\n";
  for (std::size_t i = 0; i < sections_.size(); ++i)
    out += fmt::format("<li><a href=\"#section-{}\">{}</a></li>\n", i + 1, escape_html(sections_[i]));
  out += "</ol></nav>\n";
  if (!plots_.empty()) {
    out +=
        "<p class=\"remark with-script\" hidden>Figures answer: a drag zooms, a double click shows all again; the pointer reads "
        "values; a click on an entry of a legend hides its curve. Keys: arrows, +, −, 0.</p>\n";
  }
  return out;
}

std::string Page::html() const {
  const std::vector<std::string> drawings = render(plots_);
  std::string body;
  for (std::size_t i = 0; i < body_.size(); ++i) {
    if (i == first_section_ && !sections_.empty()) {
      body += body_[i].substr(0, first_section_at_) + contents() + body_[i].substr(first_section_at_);
    } else {
      body += body_[i];
    }
    if (i < drawings.size()) body += drawings[i];
  }
  const std::string_view script = plots_.empty() ? std::string_view() : page_script();
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      // Even if a text were not escaped, nothing would be fetched, and no script would run but the page's own.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'";
  if (!script.empty()) out += fmt::format("; script-src 'sha256-{}'", io::base64(io::sha256(script)));
  out += "\">\n";
  out += element("title", title_);
  out += "<style>\n";
  out += page_style();
  out += dark_colors(body);
  out += "</style>\n</head>\n<body>\n<main>\n";
  out += element("h1", title_);
  if (!subtitle_.empty()) out += element("p class=\"subtitle\"", subtitle_);
  out += body;
  out += "</main>\n";
  if (!script.empty()) out += fmt::format("<script>{}</script>\n", script);
  out += "</body>\n</html>\n";
  return out;
}

}  // namespace stribeck::report
