#include <gtest/gtest.h>

#include <set>
#include <string>

#include <stribeck/ident/result.hpp>

namespace stribeck::ident::result_test {
namespace {

TEST(Result, EveryMethodAndModelHasItsWord) {
  std::set<std::string_view> methods, models;
  for (int m = 0; m <= static_cast<int>(Method::kConstantAcceleration); ++m)
    methods.insert(name_of(static_cast<Method>(m)));
  for (int m = 0; m <= static_cast<int>(SteadyModel::kCogging); ++m)
    models.insert(name_of(static_cast<SteadyModel>(m)));
  EXPECT_EQ(methods.size(), 9u);
  EXPECT_EQ(models.size(), 5u);
  EXPECT_EQ(name_of(Method::kBreakAway), "break-away");
  EXPECT_EQ(name_of(Method::kConstantAcceleration), "constant-acceleration");
  EXPECT_EQ(name_of(SteadyModel::kAsymmetric), "asymmetric");
}

TEST(Result, TheModelIsNamedAfterItsSteadyPart) {
  Result r;
  EXPECT_EQ(r.steady, SteadyModel::kNone);
  r.set_steady(SteadyModel::kGaussian);
  r.model += " + periodic";
  EXPECT_EQ(r.steady, SteadyModel::kGaussian);
  EXPECT_EQ(r.model, "gaussian + periodic");
}

TEST(Result, AParameterIsFoundByItsWholeName) {
  Result r;
  r.parameters.push_back({"mass", 5.0, "kg", "kg"});
  r.parameters.push_back({"alpha0", 7.0, "N", "N"});
  ASSERT_NE(r.find("alpha0"), nullptr);
  EXPECT_EQ(r.find("alpha0")->value, 7.0);
  EXPECT_EQ(r.find("alpha"), nullptr);
}

}  // namespace
}  // namespace stribeck::ident::result_test
