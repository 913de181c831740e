#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/io/sha256.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/page/page_files.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::html_test {
namespace {

using test::kHostile;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Html, Escapes) {
  EXPECT_EQ(escape_html("<a href=\"x\">'&'</a>\n"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt; ");
  EXPECT_EQ(escape_html("\xff\x01µ"), "\uFFFD µ");
}

TEST(Html, EveryWayInIsEscaped) {
  Page page(kHostile, kHostile);
  page.section(kHostile);
  page.subsection(kHostile);
  page.paragraph(kHostile);
  page.lead(kHostile);
  page.remark(kHostile);
  page.code(kHostile);
  page.warnings({kHostile});
  page.list(kHostile, {kHostile});
  page.table({kHostile, {{kHostile, kHostile}}, {{{kHostile, kHostile, kHostile, true, kHostile}}}});
  page.details(kHostile, [&] { page.paragraph(kHostile); });
  Plot plot;
  plot.title = kHostile;
  page.figure(plot, kHostile);
  page.numbers({{kHostile, kHostile, kHostile}});
  const std::string html = test::without_script(page.html());
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("&amp;&amp;")));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt;"));
  EXPECT_THAT(html, HasSubstr("&amp;amp;"));
}

TEST(Html, TablesAlignNumbersAndMarkTheBest) {
  Page page("t");
  page.table({"",
              {{"name", "", false}, {"max", "µm"}},
              {{{"(a)"}, {"1.00", "± 0.10", "print 2.00 · ×0.50", true}}}});
  const std::string html = page.html();
  EXPECT_THAT(
      html,
      HasSubstr(
          "<th scope=\"col\">name</th><th scope=\"col\" class=\"n\">max<span class=\"unit\">µm</span></th>"));
  EXPECT_THAT(html, HasSubstr("<td>(a)</td><td class=\"n\"><b>1.00</b> <small>± 0.10</small><span "
                              "class=\"note\">print 2.00 · ×0.50</span></td>"));
}

TEST(Html, TheKeyboardAndAScreenReaderReachEverything) {
  Page page("t");
  page.table({"", {{"", "", false}, {"max", "µm"}}, {{{"(a)"}, {"1.00"}}}});
  page.table({"Two <x>", {{"max", "µm"}}, {{{"1.00"}}}});
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr("<div class=\"scroll\" role=\"group\" tabindex=\"0\" aria-label=\"Table 1\">"));
  EXPECT_THAT(html, HasSubstr("tabindex=\"0\" aria-label=\"Two &lt;x&gt;\""));
  EXPECT_THAT(html, HasSubstr("<tr><td></td><th scope=\"col\" class=\"n\">max"));
  EXPECT_LT(html.find("<main>"), html.find("<h1>"));
  EXPECT_LT(html.find("1.00"), html.find("</main>"));
}

TEST(Html, HeadsAreNotBrokenInsideAnAbsoluteValue) {
  Page page("t");
  page.table({"", {{"mean |e| x", "µm"}}, {{{"1.00"}}}});
  EXPECT_THAT(page.html(), HasSubstr("mean |\u2060e|\u2060 x"));
}

TEST(Html, StandsAlone) {
  Page page("t");
  page.warnings({});
  page.list("nothing", {});
  page.figures({}, 2, "none");
  page.figures({Plot{.title = "first"}, Plot{.title = "second"}}, 2, "two");
  page.paragraph("after");
  const std::string whole = page.html();
  const std::string html = test::without_script(whole);
  EXPECT_LT(html.size(), whole.size());
  for (const char* foreign : {"http:", "https:", "<script", "<link", "src=", "@import", "url("}) {
    EXPECT_THAT(html, Not(HasSubstr(foreign)));
  }
  for (const char* foreign : {"fetch(", "XMLHttpRequest", "import(", "WebSocket", "eval(", "</"})
    EXPECT_THAT(std::string(page_script()), Not(HasSubstr(foreign)));
  EXPECT_THAT(html, Not(HasSubstr("role=\"note\"")));
  EXPECT_THAT(html, Not(HasSubstr("nothing")));
  const auto first = html.find("<title>first</title>");
  const auto second = html.find("<title>second</title>");
  const auto after = html.find("<p>after</p>");
  EXPECT_LT(first, second);
  EXPECT_LT(second, after);
  EXPECT_NE(after, std::string::npos);
}

TEST(Html, OnlyItsOwnScriptMayRun) {
  Page drawn("t");
  drawn.figure(Plot{.title = "one"}, "");
  const std::string html = drawn.html();
  EXPECT_THAT(html, HasSubstr("script-src 'sha256-" + io::base64(io::sha256(page_script())) + "'"));
  Page plain("t");
  plain.paragraph("no figure");
  EXPECT_THAT(plain.html(), Not(HasSubstr("script-src")));
  EXPECT_THAT(plain.html(), Not(HasSubstr("<script")));
}

TEST(Html, ContentsLinkToSections) {
  Page page("t");
  page.lead("result");
  for (const char* heading : {"One & two", "Three"}) page.section(heading);
  EXPECT_THAT(page.html(), Not(HasSubstr("<nav")));
  page.section("Four");
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr("<li><a href=\"#section-1\">One &amp; two</a></li>"));
  EXPECT_THAT(html, HasSubstr("<h2 id=\"section-3\">Four</h2>"));
  EXPECT_LT(html.find("result</p>"), html.find("<nav"));
  EXPECT_LT(html.find("</nav>"), html.find("<h2"));
}

/// Relative luminance after WCAG 2.
double luminance(const std::string& color) {
  const auto part = [&](std::size_t k) {
    const double v = std::stoi(color.substr(1 + 2 * k, 2), nullptr, 16) / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * part(0) + 0.7152 * part(1) + 0.0722 * part(2);
}

TEST(Html, CurvesAndSwatchesCanBeSeenInTheDark) {
  Page page("t");
  Plot plot;
  Table table{"", {{"", "", false}}, {}};
  for (std::size_t i = 0; i < 16; ++i) {
    const std::string color = controller_color("", i);
    plot.series.push_back({.label = "c", .x = {0, 1}, .y = {0, 1}, .color = color});
    table.rows.push_back({Cell{.text = "c", .color = color}});
  }
  page.figure(plot, "");
  page.table(table);
  const std::string html = page.html();
  const double paper = luminance("#202124");
  for (std::size_t i = 0; i < 16; ++i) {
    const std::string key = "[stroke=\"" + controller_color("", i) + "\"]{stroke:";
    const auto at = html.find(key);
    ASSERT_NE(at, std::string::npos) << key;
    const std::string dark = html.substr(at + key.size(), 7);
    // WCAG 2 asks 3 of graphics; the 16 curves keep that.
    EXPECT_GT((luminance(dark) + 0.05) / (paper + 0.05), 3.0) << dark;
    EXPECT_THAT(html, HasSubstr("[data-color=\"" + controller_color("", i) + "\"]{background:" + dark));
  }
}

}  // namespace
}  // namespace stribeck::report::html_test
