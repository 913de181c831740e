#include <gtest/gtest.h>

#include <stribeck/core/scalar.hpp>
#include <stribeck/core/taylor.hpp>
#include <string>

namespace stribeck::scalar_test {
namespace {

static_assert(Real<double>);
static_assert(Real<Taylor<4>>);
static_assert(!Real<std::string>);

TEST(Scalar, SignIsZeroAtZeroOfEitherSign) {
  EXPECT_EQ(sign(0.0), 0.0);
  EXPECT_EQ(sign(-0.0), 0.0);
  EXPECT_EQ(sign(-1e-300), -1.0);
  EXPECT_EQ(clamp_to(5.0, -1.0, 2.0), 2.0);
  EXPECT_EQ(clamp_to(-5.0, -1.0, 2.0), -1.0);
}

}  // namespace
}  // namespace stribeck::scalar_test
