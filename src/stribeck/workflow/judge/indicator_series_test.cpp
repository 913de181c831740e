#include <stribeck/workflow/judge/indicator_series.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>

namespace stribeck::workflow::indicator_series_test {
namespace {

using ::testing::HasSubstr;

class IndicatorSeries : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file_with(const std::string& text) const {
    return folder_.write("series.csv", text);
  }
  [[nodiscard]] std::string refused(const std::string& text) const {
    try {
      static_cast<void>(read_indicator_series(file_with(text)));
    } catch (const io::InputError& e) {
      return e.what();
    }
    return "not refused";
  }

  test::Folder folder_;
};

TEST_F(IndicatorSeries, SignsAndNumbersAreDirections) {
  const auto signs = read_indicator_series(
      file_with("direction,reading [um],position [mm],load [N]\n+,1,10,0\n-,26,10,500\n"));
  ASSERT_EQ(signs.size(), 2U);
  EXPECT_EQ(signs[0].direction, 1);
  EXPECT_EQ(signs[1].direction, -1);
  EXPECT_DOUBLE_EQ(signs[1].value, 26e-6);
  EXPECT_DOUBLE_EQ(signs[1].position, 10e-3);
  EXPECT_DOUBLE_EQ(signs[1].load, 500.0);
  const auto numbers = read_indicator_series(file_with("reading [mm],direction\n0.001,1\n0.026,-1\n"));
  ASSERT_EQ(numbers.size(), 2U);
  EXPECT_EQ(numbers[1].direction, -1);
  EXPECT_DOUBLE_EQ(numbers[1].value, 26e-6);
  EXPECT_EQ(numbers[1].load, 0.0);
}

// As typed into a German spreadsheet, with tabs, with words for the direction, without names.
TEST_F(IndicatorSeries, ReadsWhatPeopleType) {
  const auto wanted =
      read_indicator_series(file_with("direction,reading [um],load [N]\n+,0.5,0\n-,26.5,500\n"));
  for (const std::string text :
       {"Richtung;Anzeige (\u00B5m);Last (N)\n+;0,5;0\n\u2212;26,5;500\n",
        "Direction\tDial indicator [mm]\tLoad [N]\nforward\t0.0005\t0\nBack\t0.0265\t500\n",
        "sep=;\nRICHTUNG;ABLESUNG_um;LAST_N\nvor;0,5;0\nzur\u00FCck;26,5;500\n"}) {
    const auto got = read_indicator_series(file_with(text));
    ASSERT_EQ(got.size(), 2U) << text;
    for (const std::size_t i : {0, 1}) {
      EXPECT_EQ(got[i].direction, wanted[i].direction) << text;
      EXPECT_NEAR(got[i].value, wanted[i].value, 1e-12) << text;
      EXPECT_EQ(got[i].load, wanted[i].load) << text;
    }
  }
  static_cast<void>(folder_.write("bare.csv.toml", "columns = [\"direction\", \"reading um\"]\n"));
  const auto bare = read_indicator_series(folder_.write("bare.csv", "1 0.5\n-1 26.5\n"));
  ASSERT_EQ(bare.size(), 2U);
  EXPECT_NEAR(bare[1].value, 26.5e-6, 1e-12);
}

TEST_F(IndicatorSeries, OtherTablesAreRefused) {
  EXPECT_THAT(refused("direction,reading [um],Anzeige [um]\n+,1,1\n-,2,2\n"),
              HasSubstr("are both the reading"));
  EXPECT_THAT(refused("direction,load position [mm],reading [um]\n+,1,1\n-,2,2\n"),
              HasSubstr("is no column of a series of readings"));
  EXPECT_THAT(refused("direction,reading [um]\n+,1\nup,2\n"),
              HasSubstr("row 2: got \"up\", expected + or -"));
  EXPECT_THAT(refused("direction,reading [um]\n1,1\n0,2\n"), HasSubstr("row 2: got 0, expected + or -"));
  EXPECT_THAT(refused("reading [um],load [N]\n1,1\n0,2\n"),
              HasSubstr("no column \"direction\", expected columns"));
  EXPECT_THAT(refused("direction,reading [um],force [N]\n1,1,0\n-1,2,0\n"),
              HasSubstr("is no column of a series of readings"));
  EXPECT_THAT(refused("direction,reading\n1,1\n-1,2\n"), HasSubstr("unit"));
}

}  // namespace
}  // namespace stribeck::workflow::indicator_series_test
