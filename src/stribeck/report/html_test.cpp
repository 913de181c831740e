#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/report/html.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report {
namespace {

using ::testing::HasSubstr;
using testing::kHostile;
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
  const std::string html = page.html();
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
  const std::string html = page.html();
  for (const char* foreign : {"http:", "https:", "<script", "<link", "src=", "@import", "url("}) {
    EXPECT_THAT(html, Not(HasSubstr(foreign)));
  }
  EXPECT_THAT(html, Not(HasSubstr("role=\"note\"")));
  EXPECT_THAT(html, Not(HasSubstr("nothing")));
  const auto first = html.find("<title>first</title>");
  const auto second = html.find("<title>second</title>");
  const auto after = html.find("<p>after</p>");
  EXPECT_LT(first, second);
  EXPECT_LT(second, after);
  EXPECT_NE(after, std::string::npos);
}

}  // namespace
}  // namespace stribeck::report
