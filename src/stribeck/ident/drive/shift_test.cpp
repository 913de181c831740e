#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <tuple>

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::shift_test {
namespace {

double force(double, double v, double a) { return 250.0 * a + (v > 0.0 ? 40.0 : -40.0) + 900.0 * v; }

/// The measured force stands `late` rows later than its motion, with white noise.
test::SyntheticLog late_log(double late) {
  test::SyntheticLog s = test::synthetic_log(force);
  const std::vector<double> right = s.log.force[0];
  std::mt19937_64 engine(4);
  std::normal_distribution<double> noise(0.0, 0.02);
  const double whole = std::floor(late), part = late - whole;
  std::vector<double>& f = s.log.force[0];
  for (std::size_t k = 0; k < f.size(); ++k) {
    const auto at = [&](double row) {
      return right[static_cast<std::size_t>(std::clamp(row, 0.0, static_cast<double>(f.size() - 1)))];
    };
    const double row = static_cast<double>(k) - whole;
    f[k] = (1.0 - part) * at(row) + part * at(row - 1.0) + noise(engine);
  }
  return s;
}

Rows rows_of(const test::SyntheticLog& s) { return gather(s.log, extent_of(s.log), {4e-3, 0.1, 0.0}, 160); }

LinearFit second_pass(const test::SyntheticLog& s, const Rows& rows, const Terms& terms) {
  const LinearFit first = solve(s.log, rows, terms);
  return solve(s.log, rows, terms, &first);
}

TEST(Shift, IsFoundWhereTheResidualIsLeast) {
  for (const double late : {-3.0, 0.0, 4.0, 6.5}) {
    const test::SyntheticLog s = late_log(late);
    const std::optional<double> found = find_shift(s.log, rows_of(s), std::nullopt);
    ASSERT_TRUE(found) << late;
    EXPECT_NEAR(*found, late, 0.3) << late;
    const std::optional<double> with_mass = find_shift(s.log, rows_of(s), 250.0);
    ASSERT_TRUE(with_mass) << late;
    EXPECT_NEAR(*with_mass, late, 0.3) << late;
  }
}

TEST(Shift, BeyondTheSearchThereIsNone) {
  const test::SyntheticLog s = late_log(60.0);
  EXPECT_FALSE(find_shift(s.log, rows_of(s), 250.0));
}

// From one row beside it, Gauss–Newton comes to the shift, and the mass with it.
TEST(Shift, IsRefined) {
  test::SyntheticLog s = late_log(4.0);
  Rows rows = rows_of(s);
  align(s.log, 3.2, rows);
  Terms terms;
  const LinearFit before = second_pass(s, rows, terms);
  terms.shift = true;
  const LinearFit fit = refine_shift(s.log, rows, terms, before);
  EXPECT_NEAR(s.log.shift, 4.0, 0.1);
  EXPECT_NEAR(fit.mass, 250.0, 0.5);
  EXPECT_LT(shift_half_width(s.log, rows, terms, fit), 0.5);
}

TEST(Shift, IsKeptWhenTheResidualIsSmallerForIt) {
  test::SyntheticLog s = late_log(4.0);
  Rows rows = rows_of(s);
  align(s.log, 4.0, rows);
  Terms terms;
  const LinearFit before = second_pass(s, rows, terms);
  terms.shift = true;
  const LinearFit fit = judge_shift(s.log, rows, terms, before);
  EXPECT_TRUE(terms.shift);
  EXPECT_NEAR(s.log.shift, 4.0, 0.1);
  EXPECT_EQ(fit.value.size(), 2);
}

/// One sine of 20 mm at 0.5 Hz: 300 kg, 100 N of friction of which `slow` comes within 80 um and the rest within 5 um, the force `late` rows
/// later.
log::Record one_sine(int late, double viscous, double noise_level, double slow = 0.0) {
  constexpr int kFine = 10, kRows = 12'000, kMore = 40;
  constexpr double kStep = 1e-3, kW = M_PI;
  constexpr std::array kDistance{5e-6, 80e-6};
  const std::array share{1.0 - slow, slow};
  std::mt19937_64 engine(6);
  std::normal_distribution<double> noise(0.0, noise_level);
  log::Record r;
  r.source = "sine.csv";
  r.sample_time = kStep;
  std::array bristle{1.0, 1.0};
  std::vector<double> force;
  for (int k = 0; k < kFine * (kRows + kMore); ++k) {
    const double t = kStep / kFine * k, v = 0.02 * kW * std::cos(kW * t);
    double friction = 0.0;
    for (std::size_t i = 0; i < share.size(); ++i) {
      const double left = std::exp(-std::abs(v) * kStep / kFine / kDistance[i]);
      bristle[i] = left * bristle[i] + (v > 0.0 ? 1.0 : -1.0) * (1.0 - left);
      friction += 100.0 * share[i] * bristle[i];
    }
    if (k % kFine != 0) continue;
    const double x = 0.02 * std::sin(kW * t);
    force.push_back(-300.0 * kW * kW * x + viscous * v + friction + noise(engine));
    if (k / kFine < kMore / 2 || k / kFine >= kRows + kMore / 2) continue;
    r.t.push_back(t);
    r.x.push_back(1e-8 * std::round(x / 1e-8));
  }
  for (std::size_t k = 0; k < r.x.size(); ++k)
    r.f.push_back(force[static_cast<std::size_t>(static_cast<int>(k) + kMore / 2 - late)]);
  return r;
}

// In the rows that slide, the pre-sliding that is left behind each reversal looked like a shift of −19 rows and a mass of 236 kg.
TEST(Shift, OnOneSineTheReversalsTellIt) {
  for (const auto& [late, viscous, noise] :
       {std::tuple{0, 3333.0, 1.0}, {-10, 3333.0, 1.0}, {3, 800.0, 1.0}, {10, 3333.0, 5.0}}) {
    const Result found = identify_drive({one_sine(late, viscous, noise)});
    EXPECT_LT(found.mass_interval.low, 300.0) << late;
    EXPECT_GT(found.mass_interval.high, 300.0) << late;
    EXPECT_NEAR(found.mass, 300.0, 4.0) << late;
    const Parameter* shift = found.find("force_shift");
    EXPECT_EQ(shift == nullptr, late == 0);
    if (shift != nullptr) {
      EXPECT_NEAR(1e3 * shift->value, late, 0.5);
    }
  }
}

// With one distance of pre-sliding the reversals said -7 rows and 274 (263 to 285) kg.
TEST(Shift, FrictionThatComesInTwoStagesIsNone) {
  const Result found = identify_drive({one_sine(0, 3333.0, 1.0, 0.6)});
  EXPECT_EQ(found.find("force_shift"), nullptr);
  EXPECT_LT(found.mass_interval.low, 300.0);
  EXPECT_GT(found.mass_interval.high, 300.0);
}

// A force under its hold belongs to −½: nothing is estimated there.
TEST(Shift, IsDroppedWhereTheForceActsUnderItsHold) {
  test::SyntheticLog s = late_log(kHeldForce);
  Rows rows = rows_of(s);
  align(s.log, kHeldForce, rows);
  Terms terms;
  const LinearFit before = second_pass(s, rows, terms);
  terms.shift = true;
  const LinearFit fit = judge_shift(s.log, rows, terms, before);
  EXPECT_FALSE(terms.shift);
  EXPECT_EQ(s.log.shift, kHeldForce);
  EXPECT_EQ(fit.value.size(), 1);
}

// m·a + F of the predicted motion, differenced over two rows.
TEST(Shift, TheReferenceAsksForItsOwnChange) {
  test::SyntheticLog s = late_log(0.0);
  Rows rows = rows_of(s);
  const LinearFit fit = second_pass(s, rows, {});
  s.log.predicted[0] = s.log.motions[0].v;
  ask_reference(s.log, rows, {}, fit);
  const log::Motion& m = s.log.motions[0];
  for (std::size_t i = 0; i < rows.size(); i += 53) {
    const std::size_t k = rows.at[i];
    const auto at = [&](std::size_t row) {
      const std::size_t side = m.v[row] > 0.0 ? 0 : 1;
      return fit.mass * m.instrument[row] + map::kDirection[side] * fit.curve[side](std::abs(m.v[row]));
    };
    ASSERT_DOUBLE_EQ(rows.asked_change[i], 0.5 * (at(k + 1) - at(k - 1))) << i;
    ASSERT_EQ(shift_instrument(s.log, rows, i, 7.0), rows.asked_change[i]);
  }
  s.log.predicted[0].clear();
  EXPECT_EQ(shift_instrument(s.log, rows, 0, 7.0), 7.0);  // no reference: the change itself
}

}  // namespace
}  // namespace stribeck::ident::drive::shift_test
