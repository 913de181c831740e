#include <gtest/gtest.h>

#include <stribeck/core/vec.hpp>

namespace stribeck::vec_test {
namespace {

TEST(Vec, MatrixTimesVectorAndItsTranspose) {
  const Mat2 m{{{{{1, 2}}, {{3, 4}}}}};
  EXPECT_EQ(m * (Vec2{{5, 6}}), (Vec2{{17, 39}}));
  EXPECT_EQ(transpose(m) * (Vec2{{5, 6}}), (Vec2{{23, 34}}));
}

}  // namespace
}  // namespace stribeck::vec_test
