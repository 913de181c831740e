#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/core/numbers.hpp>
#include <stribeck/report/board/board_report.hpp>

namespace stribeck::report::board_page_test {
namespace {

using testing::HasSubstr;
using testing::Not;

IdentificationRow identified(const char* id, double median, double low, double high) {
  IdentificationRow row;
  row.entrant = {id, "", "", false};
  row.curve_error.median = {median, low, high};
  return row;
}

std::string page_of(const BoardResult& result) { return board_report({result, "again", "1"}); }

TEST(BoardPageAnswer, NamesTheFirstAndWhetherTheNextIsDistinct) {
  BoardResult r;
  r.machines = {"one", "two"};
  r.identification = {identified("auto", 2.0, 1.8, 2.2), identified("jog", 3.0, 2.7, 3.3)};
  EXPECT_THAT(
      page_of(r),
      HasSubstr("Median error of the friction curve: auto has the smallest, 2.00 % (1.80–2.20); next of 2: "
                "jog with 3.00 %."));
  r.identification[1] = identified("jog", 2.1, 1.9, 2.3);
  EXPECT_THAT(page_of(r), HasSubstr("jog with 2.10 %, which these machines do not tell apart from it."));
}

TEST(BoardPageAnswer, SaysWhatIsLostAndNothingOfWhatNobodyReached) {
  BoardResult r;
  ControlRow first;
  first.entrant = {"h", "", "", false};
  first.motion = "circle";
  first.max_error.median = {1.5, 1.2, 1.9};
  ControlRow lost = first;
  lost.entrant.id = "c";
  lost.max_error.median = {kInfinity, kInfinity, kInfinity};
  r.control = {first, lost};
  EXPECT_THAT(
      page_of(r),
      HasSubstr(
          "Median of the largest contour error, circle: h has the smallest, 1.50 µm (1.20–1.90); next of 2: "
          "c, lost in half of the cases or more."));
  r.control = {first};  // alone: nothing to be smaller than
  EXPECT_THAT(page_of(r), HasSubstr("circle: h has 1.50 µm (1.20–1.90)."));
  r.control = {lost};
  EXPECT_THAT(page_of(r), Not(HasSubstr("has the smallest")));
}

}  // namespace
}  // namespace stribeck::report::board_page_test
