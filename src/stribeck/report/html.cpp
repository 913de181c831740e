#include <fmt/format.h>

#include <algorithm>
#include <stribeck/report/html.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr std::string_view kStyle = R"(
:root{--ink:#202124;--soft:#5f6368;--line:#dadce0;--paper:#fff;--card:#f8f9fa;--mark:#0072b2;--warn:#fff4e0;--warn-line:#e69f00}
@media (prefers-color-scheme:dark){:root{--ink:#e8eaed;--soft:#a8adb3;--line:#45494d;--paper:#1b1c1e;--card:#26282b;
--mark:#6bb8e8;--warn:#3a2f1a;--warn-line:#e69f00}}
*{box-sizing:border-box}
body{margin:0 auto;padding:1.5rem 1.25rem 4rem;max-width:1160px;background:var(--paper);color:var(--ink);
font:16px/1.5 system-ui,"Segoe UI","Liberation Sans",Arial,sans-serif}
h1{font-size:1.7rem;line-height:1.2;margin:.5rem 0 .2rem}
h2{font-size:1.25rem;margin:2.4rem 0 .6rem;padding-top:.5rem;border-top:1px solid var(--line)}
h3{font-size:1.02rem;margin:1.4rem 0 .4rem}
p{margin:.5rem 0;max-width:78ch}
.subtitle,.remark,figcaption,caption{color:var(--soft);font-size:.88rem}
.remark{max-width:90ch}
.lead{font-size:1.06rem;padding:.8rem 1rem;background:var(--card);border-left:4px solid var(--mark);border-radius:4px;max-width:none}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-size:.86rem;font-variant-numeric:tabular-nums;margin:.6rem 0}
caption{text-align:left;padding:.2rem 0 .4rem;font-weight:600;color:var(--ink)}
th,td{padding:.26rem .5rem;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}
td.n,th.n .unit,td small,td:not(:first-child):not(:last-child){white-space:nowrap}
td.n .note{white-space:normal;margin-left:auto;max-width:11em}
th{font-weight:600;vertical-align:bottom;border-bottom:2px solid var(--line)}
th small,td small{color:var(--soft);font-weight:400;font-size:.8rem}
td span.note,th span.unit{display:block;color:var(--soft);font-weight:400;font-size:.78rem}
th.n,td.n{text-align:right}
tbody tr:hover{background:var(--card)}
.swatch{display:inline-block;width:.7em;height:.7em;border-radius:2px;margin-right:.45em;box-shadow:0 0 0 1px var(--soft)}
figure{margin:1rem 0 1.4rem;break-inside:avoid}
figcaption{margin-top:.35rem;max-width:100ch}
.plots{display:grid;gap:8px}
.plots>div{background:#fff;border:1px solid var(--line);border-radius:6px;padding:4px}
.across-2{grid-template-columns:repeat(2,1fr)}
.across-3{grid-template-columns:repeat(3,1fr)}
.across-4{grid-template-columns:repeat(4,1fr)}
svg{display:block;width:100%;height:auto}
@media (max-width:900px){.across-2{grid-template-columns:1fr}.across-3,.across-4{grid-template-columns:repeat(2,1fr)}
td small{display:block}td.n .note{max-width:6.6em}th,td{padding:.26rem .35rem}}
.list{background:var(--card);border-left:4px solid var(--line);border-radius:4px;padding:.5rem 1rem;margin:1rem 0}
.list ul{margin:.3rem 0;padding-left:1.2rem}
.warnings{background:var(--warn);border-left:4px solid var(--warn-line);border-radius:4px;padding:.5rem 1rem;margin:1rem 0}
.warnings ul{margin:.3rem 0;padding-left:1.2rem}
details{margin:.8rem 0;border:1px solid var(--line);border-radius:6px;padding:.4rem .9rem}
summary{cursor:pointer;font-weight:600}
pre{background:var(--card);padding:.7rem .9rem;border-radius:4px;overflow-x:auto;font-size:.85rem;white-space:pre-wrap}
@media print{body{max-width:none;padding:0;font-size:11pt}h2{break-after:avoid}.scroll{overflow:visible}
table{font-size:8.5pt}th,td{padding:.15rem .35rem}}
)";

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

bool is_color(std::string_view c) {
  return c.size() == 7 && c[0] == '#' &&
         c.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string_view::npos;
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
  std::string out = number ? "<td class=\"n\">" : "<td>";
  if (is_color(cell.color))
    out += fmt::format("<span class=\"swatch\" style=\"background:{}\"></span>", cell.color);
  out += cell.best ? "<b>" + escape_html(cell.text) + "</b>" : escape_html(cell.text);
  if (!cell.spread.empty()) out += " <small>" + escape_html(cell.spread) + "</small>";
  if (!cell.note.empty()) out += "<span class=\"note\">" + escape_html(cell.note) + "</span>";
  return out + "</td>";
}

}  // namespace

std::string escape_html(std::string_view text) { return escape(text, false); }

Page::Page(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void Page::section(std::string_view heading) { add(element("h2", heading)); }
void Page::subsection(std::string_view heading) { add(element("h3", heading)); }
void Page::paragraph(std::string_view text) { add(element("p", text)); }
void Page::lead(std::string_view text) { add(element("p class=\"lead\"", text)); }
void Page::remark(std::string_view text) { add(element("p class=\"remark\"", text)); }
void Page::code(std::string_view text) { add("<pre><code>" + escape(text, true) + "</code></pre>\n"); }

void Page::table(const Table& table) {
  add("<div class=\"scroll\"><table>\n");
  if (!table.caption.empty()) add(element("caption", table.caption));
  if (std::any_of(table.columns.begin(), table.columns.end(),
                  [](const Column& c) { return !c.head.empty(); })) {
    add("<thead><tr>");
    for (const Column& c : table.columns) {
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

void Page::figures(const std::vector<Plot>& plots, int across, std::string_view caption) {
  if (plots.empty()) return;
  add(fmt::format("<figure><div class=\"plots across-{}\">", across));
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

std::string Page::html() const {
  const std::vector<std::string> drawings = render(plots_);
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      // Even if a text were not escaped, nothing would run or be fetched.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n";
  out += element("title", title_);
  out += "<style>";
  out += kStyle;
  out += "</style>\n</head>\n<body>\n";
  out += element("h1", title_);
  if (!subtitle_.empty()) out += element("p class=\"subtitle\"", subtitle_);
  for (std::size_t i = 0; i < body_.size(); ++i) {
    out += body_[i];
    if (i < drawings.size()) out += drawings[i];
  }
  out += "</body>\n</html>\n";
  return out;
}

}  // namespace stribeck::report
