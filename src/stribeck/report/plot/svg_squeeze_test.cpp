#include <gtest/gtest.h>

#include <stribeck/report/plot/svg_squeeze.hpp>

namespace stribeck::report::svg_squeeze_test {
namespace {

std::string squeezed(const std::string& inside) {
  return squeezed_svg("<svg viewBox=\"0 0 9 9\" font-size=\"12\">" + inside + "</svg>");
}
std::string expected(const std::string& inside) {
  return "<svg viewBox=\"0 0 9 9\" font-size=\"12\">" + inside + "</svg>";
}

TEST(SvgSqueeze, ATextHasItsPlaceAndOnlyWhatItsParentsLack) {
  EXPECT_EQ(squeezed("<g transform=\"translate(52.02,235.90)\" stroke=\"none\" font-size=\"12.00\" "
                     "text-anchor=\"end\"><text>0 &lt; 1</text></g>"),
            expected("<text x=\"52\" y=\"235.9\" stroke=\"none\" text-anchor=\"end\">0 &lt; 1</text>"));
  EXPECT_EQ(
      squeezed(
          "<g transform=\"translate(1.00,2.00) rotate(-90)\" font-size=\"14.00\" text-anchor=\"start\"><text>y</text></g>"),
      expected("<text transform=\"translate(1.00,2.00) rotate(-90)\" font-size=\"14\">y</text>"));
}

TEST(SvgSqueeze, AGroupOfOneGivesItsAttributesToIt) {
  EXPECT_EQ(squeezed("<g stroke-width=\"0.70\"><path stroke='#111111' d='M1 2l3 4'/></g>"),
            expected("<path stroke='#111111' d='M1 2l3 4' stroke-width=\".7\"/>"));
  // An id may be looked for, and two transformations are no single one.
  const std::string with_id = "<g id=\"plot_1\"><path d='M1 2l3 4'/></g>";
  EXPECT_EQ(squeezed(with_id), expected(with_id));
  const std::string twice = "<g transform=\"scale(2)\"><path transform=\"scale(3)\" d='M1 2'/></g>";
  EXPECT_EQ(squeezed(twice), expected(twice));
}

TEST(SvgSqueeze, WhatAParentSaysIsNotDroppedBelowOneThatSaysOtherwise) {
  const std::string nested =
      "<g id=\"a\" stroke-width=\"3\"><g id=\"b\" stroke-width=\"1\"><path d='M1 2'/><path d='M3 4'/></g></g>";
  EXPECT_EQ(squeezed(nested), expected(nested));
}

TEST(SvgSqueeze, BarsOfOneColourAreOnePath) {
  EXPECT_EQ(
      squeezed(
          "<polygon fill='#7a7a7a' fill-opacity='0.900000' points='83.55,232.00 101.47,232.00 101.47,81.75 83.55,81.75'/>"
          "<polygon fill='#7a7a7a' fill-opacity='0.900000' points='-0.5,0.00 1.00,2.04 0.00,-3.00'/>"
          "<polygon fill='#e69f00' fill-opacity='0.900000' points='1.00,1.00 2.00,2.00'/>"),
      expected("<path fill='#7a7a7a' fill-opacity='.9' "
               "d='M83.6 232l17.9 0 0-150.2-17.9 0zM-.5 0l1.5 2-1-5z'/>"
               "<path fill='#e69f00' fill-opacity='.9' d='M1 1l1 1z'/>"));
}

TEST(SvgSqueeze, TicsOfTheAxesAreOnePathForEachLookAndTheirNumbersOneGroup) {
  EXPECT_EQ(
      squeezed(
          "<g id=\"plot-1-gnuplot_canvas\">"
          "<path class=\"gridline\" d='M1 1l2 0'/><path stroke='#9aa0a6' d='M1 1l1 0'/><text x=\"1\" fill=\"red\">1</text>"
          "<path class=\"gridline\" d='M1 3l2 0'/><path stroke='#9aa0a6' d='M1 3l1 0'/><text x=\"2\" fill=\"red\">2</text>"
          "<g id=\"plot-1-gnuplot_plot_1\"><path d='M5 5l1 1'/><path d='M6 6l1 1'/></g><text fill=\"red\">3</text></g>"),
      expected(
          "<g id=\"plot-1-gnuplot_canvas\">"
          "<path class=\"gridline\" d='M1 1l2 0M1 3l2 0'/><path stroke='#9aa0a6' d='M1 1l1 0M1 3l1 0'/>"
          "<g fill=\"red\"><text x=\"1\">1</text><text x=\"2\">2</text></g>"
          "<g id=\"plot-1-gnuplot_plot_1\"><path d='M5 5l1 1'/><path d='M6 6l1 1'/></g><text fill=\"red\">3</text></g>"));
}

TEST(SvgSqueeze, AGroupThatSaysNothingGoes) {
  EXPECT_EQ(squeezed("<g stroke-width=\"1.00\"><path d='M1 2'/><g><text>1</text><text>2</text></g></g>"),
            expected("<path d='M1 2'/><text>1</text><text>2</text>"));
}

TEST(SvgSqueeze, WhatIsNoDrawingStays) {
  for (const std::string text : {"", "<", "<svg", "<svg>", "<svg></g>", "<svg a></svg>", "<svg a=\"></svg>",
                                 "<svg/", "<svg/><g/>", "x"})
    EXPECT_EQ(squeezed_svg(text), text);
  EXPECT_EQ(squeezed("<polygon points='1,2 x,3'/>"), expected("<polygon points='1,2 x,3'/>"));
  EXPECT_EQ(squeezed("<polygon points=''/>"), expected("<polygon points=''/>"));
}

// A symbol that is drawn from elsewhere has other parents than the place where it stands.
TEST(SvgSqueeze, SymbolsStay) {
  const std::string symbols = "<defs><path id=\"p-gpPt0\" stroke-width=\"1.000\" d=\"M-1,0 h2\"/></defs>";
  EXPECT_EQ(squeezed(symbols), expected(symbols));
}

}  // namespace
}  // namespace stribeck::report::svg_squeeze_test
