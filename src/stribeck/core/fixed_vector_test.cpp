#include <gtest/gtest.h>

#include <stribeck/core/fixed_vector.hpp>

namespace stribeck::fixed_vector_test {
namespace {

TEST(FixedVector, RefusesMoreThanItHolds) {
  FixedVector<int, 2> v{1};
  EXPECT_TRUE(v.push_back(2));
  EXPECT_FALSE(v.push_back(3));
  EXPECT_EQ(v.size(), 2U);
  EXPECT_EQ(v, (FixedVector<int, 2>{1, 2}));
}

TEST(FixedVector, ItsElementsMayBeChangedInALoop) {
  FixedVector<int, 4> v{1, 2, 3};
  int visited = 0;
  for (int& x : v) {
    x *= 10;
    ++visited;
  }
  EXPECT_EQ(visited, 3);
  EXPECT_EQ(v, (FixedVector<int, 4>{10, 20, 30}));
}

TEST(FixedVector, GrowsByNewElementsAndNeverBeyondItsCapacity) {
  FixedVector<int, 4> v{1, 2, 3};
  v.resize(1);
  EXPECT_EQ(v, (FixedVector<int, 4>{1}));
  v.resize(3);
  EXPECT_EQ(v, (FixedVector<int, 4>{1, 0, 0})) << "what was there before is gone";
  v.resize(9);
  EXPECT_TRUE(v.full());
  EXPECT_EQ(v.size(), 4U);
  v.clear();
  EXPECT_TRUE(v.empty());
}

}  // namespace
}  // namespace stribeck::fixed_vector_test
