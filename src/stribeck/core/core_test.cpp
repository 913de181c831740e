#include <gtest/gtest.h>

#include <stribeck/core/fields.hpp>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/core/status.hpp>
#include <stribeck/core/taylor.hpp>
#include <stribeck/core/vec.hpp>
#include <string>

namespace stribeck {
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

TEST(Taylor, GivesTheKnownDerivativesOfElementaryFunctions) {
  const auto x = Taylor<4>::variable(0.7);
  const double s = std::sin(0.7);
  const double c = std::cos(0.7);
  for (const auto& [k, want] : {std::pair{0, s}, {1, c}, {2, -s}, {3, -c}, {4, s}}) {
    EXPECT_NEAR(sin(x).derivative(k), want, 1e-15) << k;
  }
  for (int k = 0; k <= 4; ++k) EXPECT_NEAR(exp(x).derivative(k), std::exp(0.7), 1e-14);
  // (1/x)'''' = 24/x^5; sqrt(x)''' = 3/8 x^(-5/2)
  EXPECT_NEAR((Taylor<4>(1.0) / x).derivative(4), 24.0 / std::pow(0.7, 5), 1e-11);
  EXPECT_NEAR(sqrt(x).derivative(3), 0.375 * std::pow(0.7, -2.5), 1e-13);
}

TEST(Taylor, SineOfWhatIsNotLinearFollowsTheChainRule) {
  const auto x = Taylor<4>::variable(0.7);
  const double s = std::sin(0.49);
  const double c = std::cos(0.49);
  // (sin x²)'' = 2 cos x² − 4x² sin x²,  (cos x²)' = −2x sin x²
  EXPECT_NEAR(sin(x * x).derivative(2), 2.0 * c - 4.0 * 0.49 * s, 1e-14);
  EXPECT_NEAR(sin(x * x).derivative(3), -12.0 * 0.7 * s - 8.0 * 0.343 * c, 1e-13);
  EXPECT_NEAR(cos(x * x).derivative(1), -2.0 * 0.7 * s, 1e-15);
  // 2x by the short way and by x + x² − x²
  EXPECT_NEAR(sin(2.0 * x).derivative(4), sin(2.0 * x + x * x - x * x).derivative(4), 1e-13);
}

TEST(Taylor, AngleOfAPointOnACircleIsItsParameter) {
  // Every quadrant; the radius does not matter, even when it changes.
  for (const double phi : {0.4, 2.0, -2.5, -0.9}) {
    const auto u = Taylor<4>::variable(phi);
    const Taylor<4> radius = Taylor<4>(2.0) + u * u;
    const Taylor<4> angle = atan2(radius * sin(u), radius * cos(u));
    EXPECT_NEAR(angle.c[0], phi, 1e-15);
    EXPECT_NEAR(angle.derivative(1), 1.0, 1e-14);
    for (int k = 2; k <= 4; ++k) EXPECT_NEAR(angle.derivative(k), 0.0, 1e-12) << k;
  }
  // atan u at 0.7: 1/(1 + u²), −2u/(1 + u²)², (6u² − 2)/(1 + u²)³.
  const Taylor<4> a = atan2(Taylor<4>::variable(0.7), Taylor<4>(1.0));
  EXPECT_NEAR(a.derivative(1), 1.0 / 1.49, 1e-15);
  EXPECT_NEAR(a.derivative(2), -1.4 / (1.49 * 1.49), 1e-15);
  EXPECT_NEAR(a.derivative(3), (6.0 * 0.49 - 2.0) / (1.49 * 1.49 * 1.49), 1e-14);
}

TEST(Taylor, ObeysPythagorasAndTheProductRuleToEveryOrder) {
  const auto x = Taylor<5>::variable(-1.3);
  const auto one = sin(x) * sin(x) + cos(x) * cos(x);
  EXPECT_NEAR(one.derivative(0), 1.0, 1e-15);
  for (int k = 1; k <= 5; ++k) EXPECT_NEAR(one.derivative(k), 0.0, 1e-12) << k;
  const auto back = (x * exp(x)) / exp(x);
  EXPECT_NEAR(back.derivative(1), 1.0, 1e-14);
  EXPECT_NEAR(back.derivative(5), 0.0, 1e-11);
}

TEST(FixedVector, RefusesMoreThanItHolds) {
  FixedVector<int, 2> v{1};
  EXPECT_TRUE(v.push_back(2));
  EXPECT_FALSE(v.push_back(3));
  EXPECT_EQ(v.size(), 2U);
  EXPECT_EQ(v, (FixedVector<int, 2>{1, 2}));
}

TEST(Vec, MatrixTimesVectorAndItsTranspose) {
  const Mat2 m{{{{{1, 2}}, {{3, 4}}}}};
  EXPECT_EQ(m * (Vec2{{5, 6}}), (Vec2{{17, 39}}));
  EXPECT_EQ(transpose(m) * (Vec2{{5, 6}}), (Vec2{{23, 34}}));
}

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
}

}  // namespace
}  // namespace stribeck
