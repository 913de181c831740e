#include <gtest/gtest.h>

#include <cmath>

#include <stribeck/core/fields.hpp>
#include <tuple>

namespace stribeck::fields_test {
namespace {

struct Screw {
  double lead = 0.005;
  double pitch_error = 0.0;
  static constexpr auto fields() {
    return std::tuple{
        field("lead", &Screw::lead, quantity("m", "mm").positive(), "travel per turn"),
        field("pitch_error", &Screw::pitch_error, quantity("m", "um").at_most(1e-4), "").or_default()};
  }
};

TEST(Fields, AreListedOnceWithTheirRanges) {
  std::string names;
  for_each_field<Screw>([&](const auto& f) { names += std::string(f.name) + (f.required ? "! " : " "); });
  EXPECT_EQ(names, "lead! pitch_error ");
  const auto lead = std::get<0>(Screw::fields());
  EXPECT_FALSE(lead.quantity.permits(0.0));
  EXPECT_TRUE(lead.quantity.permits(1e-9));
  EXPECT_FALSE(lead.quantity.permits(std::nan("")));
  EXPECT_FALSE(std::get<1>(Screw::fields()).quantity.permits(2e-4));
  EXPECT_TRUE(std::get<1>(Screw::fields()).quantity.permits(1e-4));
  const Quantity from_three = pure_number().at_least(3.0);
  EXPECT_TRUE(from_three.permits(3.0));
  EXPECT_TRUE(from_three.permits(4.0));
  EXPECT_FALSE(from_three.permits(2.9));
}

}  // namespace
}  // namespace stribeck::fields_test
