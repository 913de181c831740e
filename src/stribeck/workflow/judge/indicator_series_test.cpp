#include <stribeck/workflow/judge/indicator_series.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>

namespace stribeck::workflow {
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

TEST_F(IndicatorSeries, OtherTablesAreRefused) {
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
}  // namespace stribeck::workflow
