#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <stribeck/ident/log/record.hpp>

namespace stribeck::ident::log::record_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Record good() {
  Record r;
  r.source = "log.csv";
  r.sample_time = 0.005;
  for (int k = 0; k < 200; ++k) {
    r.t.push_back(0.005 * k);
    r.x.push_back(1e-3 * k);
    r.f.push_back(10.0);
  }
  return r;
}

TEST(Record, AGoodOneHasNoProblem) {
  EXPECT_THAT(problems(good()), IsEmpty());
  Record full = good();
  full.r = full.x;
  full.v = full.f;
  EXPECT_THAT(problems(full), IsEmpty());
}

TEST(Record, NamesTheColumnThatIsTooShort) {
  Record r = good();
  r.f.pop_back();
  EXPECT_THAT(problems(r), ElementsAre("log.csv: column f has 199 rows, expected 200 as in column t"));
  r.v = {1.0};
  EXPECT_EQ(problems(r).size(), 2U) << "all that is wrong is listed, not the first problem alone";
}

TEST(Record, NamesTheRowThatIsNoNumber) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e31}) {
    Record r = good();
    r.x[17] = bad;
    EXPECT_THAT(problems(r), ElementsAre(HasSubstr("log.csv: column x, row 17"))) << bad;
  }
}

TEST(Record, NeedsAPositiveSampleTimeAndAHundredRows) {
  Record r = good();
  r.sample_time = 0.0;
  EXPECT_THAT(problems(r), ElementsAre(HasSubstr("sample time is 0 s")));
  r = good();
  for (auto* column : {&r.t, &r.x, &r.f}) column->resize(99);
  EXPECT_THAT(problems(r), ElementsAre(HasSubstr("99 rows, expected at least 100")));
}

// The header promises that stamps may jitter by 1 % of the period.
TEST(Record, StampsMayJitterByOnePercent) {
  Record r = good();
  r.t[50] += 0.009 * r.sample_time;
  EXPECT_THAT(problems(r), IsEmpty());
  r.t[50] += 0.002 * r.sample_time;
  EXPECT_THAT(problems(r), ElementsAre(AllOf(HasSubstr("column t, row 50"), HasSubstr("expected 0.005 s"))));
}

}  // namespace
}  // namespace stribeck::ident::log::record_test
