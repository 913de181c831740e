#include <gtest/gtest.h>

#include <stribeck/core/status.hpp>

namespace stribeck::status_test {
namespace {

TEST(Status, CountsAndRemembersTheFirst) {
  StatusCounter counter;
  counter.raise(Status::kOk);
  counter.raise(Status::kOutputLimited);
  counter.raise(Status::kNotFinite);
  counter.raise(Status::kOutputLimited);
  EXPECT_EQ(counter.first, Status::kOutputLimited);
  EXPECT_EQ(counter.count(Status::kOutputLimited), 2U);
  EXPECT_EQ(counter.count(Status::kOk), 0U);
  for (int i = 0; i < static_cast<int>(Status::kCount); ++i)
    EXPECT_NE(describe(static_cast<Status>(i)), "unknown status");
}

}  // namespace
}  // namespace stribeck::status_test
