#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>
#include <thread>

namespace stribeck::io::units_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr Quantity kMass = quantity("kg", "N s2/mm");
constexpr Quantity kLength = quantity("m", "mm");
constexpr Quantity kSpeed = quantity("m/s", "mm/s");

std::string refusal(std::string_view text, const Quantity& q) {
  try {
    const double x = to_si(text, q);
    return "accepted as " + number_text(x);
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(Units, ReadsWhatMachineFilesHold) {
  // Expected values by hand from the definitions of the units.
  EXPECT_EQ(to_si("57.65 N s2/mm", kMass), 57650.0);
  EXPECT_EQ(to_si("57650 kg", kMass), 57650.0);
  EXPECT_EQ(to_si("5 ms", quantity("s", "ms")), 0.005);
  EXPECT_EQ(to_si("25 nm", quantity("m", "nm")), 25e-9);
  EXPECT_EQ(to_si("60 1/s", quantity("1/s", "1/s")), 60.0);
  EXPECT_EQ(to_si("0.05 mm/s", kSpeed), 5e-5);
  EXPECT_EQ(to_si("-10 V", quantity("V", "V")), -10.0);
  EXPECT_EQ(to_si("1048 N/V", quantity("N/V", "N/V")), 1048.0);
  EXPECT_EQ(to_si("3 µm", kLength), 3e-6);
  EXPECT_EQ(to_si("3 μm", kLength), 3e-6);  // the Greek letter, not the micro sign
  EXPECT_EQ(to_si("3 um", kLength), 3e-6);
  EXPECT_EQ(to_si("1 N·s/mm", quantity("N s/m", "N s/mm")), 1000.0);
  EXPECT_EQ(to_si("1 N⋅s/mm", quantity("N s/m", "N s/mm")), 1000.0);
  EXPECT_EQ(to_si("1 N*s/mm", quantity("N s/m", "N s/mm")), 1000.0);
  EXPECT_EQ(to_si("1e5 N/mm", quantity("N/m", "N/mm")), 1e8);
  EXPECT_EQ(to_si("16 %", quantity("", "%")), 0.16);
  EXPECT_EQ(to_si("0.16", pure_number()), 0.16);
  EXPECT_EQ(to_si(" +5mm ", kLength), 0.005);
  EXPECT_EQ(to_si("0.7 Nm/A", quantity("N m/A", "N m/A")), 0.7);
  EXPECT_EQ(to_si("1.2 ohm", quantity("ohm", "ohm")), 1.2);
  EXPECT_EQ(to_si("1.2 Ω", quantity("ohm", "ohm")), 1.2);
  EXPECT_EQ(to_si("3 mH", quantity("H", "mH")), 0.003);
  EXPECT_NEAR(to_si("180 deg", quantity("rad", "deg")), 3.14159265358979323846, 1e-15);
  EXPECT_NEAR(to_si("60 rpm", quantity("rad/s", "rad/s")), 2 * 3.14159265358979323846, 1e-14);
  EXPECT_NEAR(to_si("60 U/min", quantity("rad/s", "rad/s")), 2 * 3.14159265358979323846, 1e-14);
  EXPECT_NEAR(to_si("600 mm/min", kSpeed), 0.01, 1e-17);
  EXPECT_EQ(to_si("2 g", quantity("m/s2", "mm/s2")),
            2.0 * 9.80665);  // an acceleration, as data sheets say it
  EXPECT_EQ(to_si("2 g", quantity("kg", "kg")), 0.002);
  EXPECT_EQ(to_si("20 Hz", quantity("Hz", "Hz")), 20.0);
  EXPECT_EQ(to_si("0.3 V s/rad", quantity("V s/rad", "V s/rad")), 0.3);
}

TEST(Units, ResultIsTheDoubleNearestToTheText) {
  // 35·0.001 is 0.035000000000000003 in doubles; the text means 0.035.
  EXPECT_EQ(to_si("35 mm", kLength), 0.035);
  EXPECT_EQ(to_si("9.5 mm/s", kSpeed), 0.0095);
  EXPECT_EQ(to_si("1.1e1 um", kLength), 11e-6);
  EXPECT_EQ(conversion("mm", "m")(35.0), 0.035);
}

// An inch times a pound of mass is nothing that a data sheet means.
TEST(Units, TorquesOfDataSheetsAreForcesAtADistance) {
  EXPECT_NEAR(to_si("35 in-lb", quantity("N m", "N m")), 3.95446, 1e-5);
  EXPECT_NEAR(to_si("35 lb-in", quantity("N m", "N m")), 3.95446, 1e-5);
  EXPECT_NEAR(to_si("2 ft-lb", quantity("N m", "N m")), 2.71164, 1e-5);
  EXPECT_NEAR(to_si("25 oz-in/A", quantity("N m/A", "N m/A")), 0.176539, 1e-6);
  EXPECT_NEAR(to_si("54 gcm²", quantity("kg m2", "kg m2")), 5.4e-6, 1e-18);
  EXPECT_NEAR(to_si("2.4 kgm²", quantity("kg m2", "kg m2")), 2.4, 1e-15);
  EXPECT_NEAR(to_si("1.2 kgcm2", quantity("kg m2", "kg m2")), 1.2e-4, 1e-18);
  EXPECT_THROW(to_si("12/3 mm", quantity("m", "mm")), InputError);
  // A position gain as controls have it.
  EXPECT_NEAR(to_si("2.5 1000/min", quantity("1/s", "1/s")), 2500.0 / 60.0, 1e-12);
  EXPECT_NEAR(to_si("2500/min", quantity("1/s", "1/s")), 2500.0 / 60.0, 1e-12);
  EXPECT_NEAR(to_si("0.005 oz-in-s2", quantity("kg m2", "kg m2")), 3.53078e-5, 1e-9);
  // An ounce of mass at an inch: 28.3495 g and 25.4 mm.
  for (const char* text : {"2 oz-in2", "2 oz-in^2", "2 oz in^2"})
    EXPECT_NEAR(to_si(text, quantity("kg m2", "kg m2")), 2.0 * 28.349523e-3 * 0.0254 * 0.0254, 1e-11) << text;
  EXPECT_NEAR(to_si("0.005 oz-in-s^2", quantity("kg m2", "kg m2")), 3.53078e-5, 1e-9);
  EXPECT_NEAR(to_si("1200 ipm", quantity("m/s", "mm/s")), 0.508, 1e-12);
  EXPECT_NEAR(to_si("41 N/Arms", quantity("N/A", "N/A")), 41.0, 1e-12);
  EXPECT_NEAR(to_si("3 lb in2", quantity("kg m2", "kg m2")), 8.77919e-4, 1e-8);
}

TEST(Units, ReadsImperialUnitsInThePluralAndWithDots) {
  for (const char* text : {"18 in-lbs", "18 in·lb", "18 lbf.in", "18 lb*in", "18 lbs-in"})
    EXPECT_NEAR(to_si(text, quantity("N m", "N m")), 18.0 * 0.1129848, 1e-5) << text;
  EXPECT_NEAR(to_si("0.0012 in-lb-s²", quantity("kg m2", "kg m2")), 0.0012 * 0.1129848, 1e-9);
  EXPECT_NEAR(to_si("600 lbs", quantity("kg", "kg")), 272.1554, 1e-3);
  EXPECT_NEAR(to_si("500 IPM", quantity("m/s", "mm/s")), 500.0 * 0.0254 / 60.0, 1e-12);
  EXPECT_THAT(refusal("600 lbs", quantity("N", "N")), testing::HasSubstr("is a unit of mass"));
}

// Where turns per minute are meant, the data sheet writes 1/min.
TEST(Units, ASpeedOfAMotorMayBePerMinute) {
  for (const char* text : {"3000 min^-1", "3000 1/min", "3000/min", "3000 min-1"})
    EXPECT_NEAR(to_si(text, quantity("rad/s", "rpm")), 314.159265, 1e-6) << text;
  EXPECT_NEAR(to_si("3 1000/min", quantity("rad/s", "rpm")), 314.159265, 1e-6);
  EXPECT_THAT(refusal("3000 1/s", quantity("rad/s", "rpm")), testing::HasSubstr("another kind"));
}

TEST(Units, APureNumberMayBeARatio) {
  EXPECT_EQ(to_si("5:2", pure_number()), 2.5);
  EXPECT_EQ(to_si("1 : 50", pure_number()), 0.02);
  EXPECT_THAT(refusal("5:0", pure_number()), testing::HasSubstr("finite"));
  EXPECT_THAT(refusal("5:2", quantity("m", "mm")), testing::HasSubstr("not a known unit"));
  EXPECT_THAT(refusal("5:2:3", pure_number()), testing::HasSubstr("not a known unit"));
}

TEST(Units, RefusesWhatIsNotMeant) {
  EXPECT_THAT(refusal("5", kLength), testing::HasSubstr("missing unit: write \"5 mm\""));
  EXPECT_THAT(refusal("5 N", kLength), testing::HasSubstr("expected a unit like mm"));
  EXPECT_THAT(refusal("5 mmm", kLength), testing::HasSubstr("\"mmm\" is not a known unit"));
  EXPECT_THAT(refusal("mm", kLength), testing::HasSubstr("expected a number"));
  EXPECT_THAT(refusal("", kLength), testing::HasSubstr("expected a number"));
  EXPECT_THAT(refusal("nan mm", kLength), testing::HasSubstr("finite"));
  EXPECT_THAT(refusal("inf mm", kLength), testing::HasSubstr("finite"));
  EXPECT_THAT(refusal("1e999 mm", kLength), testing::HasSubstr("finite"));
  EXPECT_THAT(refusal("1e308 km", kLength), testing::HasSubstr("finite"));
  EXPECT_THAT(refusal("5,5 mm", kLength), testing::HasSubstr("decimal point"));
  EXPECT_THAT(refusal("5 000 mm", kLength), testing::HasSubstr("one number"));
  EXPECT_THAT(refusal("5 10 mm", kLength), testing::HasSubstr("one number"));
  EXPECT_THAT(refusal("5 - 3 mm", kLength), testing::HasSubstr("one number"));
  EXPECT_THAT(refusal("+-5 mm", kLength), testing::HasSubstr("expected a number"));
  EXPECT_THAT(refusal("5 mm", pure_number()), testing::HasSubstr("pure number"));
  EXPECT_THAT(refusal("0 mm", kLength.positive()), testing::HasSubstr("got \"0 mm\", expected above 0 mm"));
  EXPECT_THAT(refusal("-1 mm", kLength.at_least(0).at_most(0.5)),
              testing::HasSubstr("expected 0 mm to 500 mm"));
  EXPECT_THAT(refusal("1 m", kLength.at_most(0.5)), testing::HasSubstr("expected at most 500 mm"));
}

// Both are the same motion; a gain in 1/s is no number of periods, and stays refused below.
TEST(Units, ReadsAPoleInTheUnitsThatPeopleWriteForIt) {
  EXPECT_DOUBLE_EQ(to_si("5 Hz", quantity("rad/s", "rad/s")), 10 * 3.14159265358979323846);
  EXPECT_THAT([] { to_si("8 kHz", quantity("s", "ms")); },
              ::testing::ThrowsMessage<std::exception>(::testing::HasSubstr("write \"0.125 ms\"")));
  EXPECT_DOUBLE_EQ(to_si("5 kHz", quantity("rad/s", "rad/s")), 10e3 * 3.14159265358979323846);
  EXPECT_EQ(to_si("20 rad/s", quantity("1/s", "1/s")), 20.0);
  EXPECT_THAT(refusal("-5 Hz", quantity("rad/s", "rad/s").positive()), testing::HasSubstr("above 0"));
}

TEST(Units, AcceptsOnlyProportionalConversions) {
  // udunits2 itself converts each of these.
  EXPECT_THAT(refusal("5 s", quantity("Hz", "Hz")), testing::HasSubstr("another kind"));
  EXPECT_THAT(refusal("5 ms", quantity("1/s", "1/s")), testing::HasSubstr("another kind"));
  EXPECT_THAT(refusal("20 degC", quantity("K", "K")), testing::HasSubstr("another kind"));
  EXPECT_THAT(refusal("5 Hz", quantity("1/s", "1/s")), testing::HasSubstr("whole periods"));
  EXPECT_THAT(refusal("60 rpm", quantity("Hz", "Hz")), testing::HasSubstr("another kind"));
  EXPECT_THAT(refusal("60 1/min", quantity("rad/s", "rad/s")), testing::HasSubstr("another kind"));
  EXPECT_THAT(refusal("3 deg", pure_number()), testing::HasSubstr("pure number"));
  EXPECT_THAT(refusal("5 s since 2000-01-01", quantity("s", "s")), testing::HasSubstr("expected"));
}

TEST(Units, ShowsTheShortestText) {
  EXPECT_EQ(from_si(57650.0, kMass), "57.65 N s2/mm");
  EXPECT_EQ(from_si(45.0, kMass), "45 kg");
  EXPECT_EQ(from_si(0.0, kMass), "0 N s2/mm");
  EXPECT_EQ(from_si(0.005, quantity("s", "ms")), "5 ms");
  EXPECT_EQ(from_si(25e-9, quantity("m", "nm")), "25 nm");
  EXPECT_EQ(from_si(0.035, kLength), "35 mm");
  EXPECT_EQ(from_si(-0.0095, kSpeed), "-9.5 mm/s");
  EXPECT_EQ(from_si(1e8, quantity("N/m", "N/mm")), "100000 N/mm");
  EXPECT_EQ(from_si(0.3, pure_number()), "0.3");
  EXPECT_EQ(from_si(0.16, quantity("", "%")), "16 %");
  EXPECT_EQ(from_si(to_si("45 deg", quantity("rad", "deg")), quantity("rad", "deg")), "45 deg");
  EXPECT_EQ(from_si(0.0, kLength), "0 mm");
  EXPECT_EQ(from_si(std::nan(""), kLength), "nan mm");
  EXPECT_EQ(number_text(1e300), "1e300");
  EXPECT_EQ(number_text(123456.5), "123456.5");
  EXPECT_EQ(number_text(0.00012), "0.00012");
  EXPECT_EQ(number_text(1.5e-7), "1.5e-7");
}

TEST(Units, EveryDoubleRoundTripsBitForBit) {
  const std::uint64_t seed = 20240607;
  std::mt19937_64 random(seed);
  const std::vector<Quantity> quantities{kMass,
                                         kLength,
                                         kSpeed,
                                         quantity("s", "ms"),
                                         quantity("m", "nm"),
                                         quantity("N/m", "N/mm"),
                                         quantity("N s/m", "N s/mm"),
                                         quantity("", "%"),
                                         pure_number(),
                                         quantity("rad", "deg"),
                                         quantity("rad/s", "rpm"),
                                         quantity("m/s", "mm/min")};
  std::uniform_real_distribution<double> exponent(-12.0, 12.0);
  for (int k = 0; k < 20000; ++k) {
    for (const auto& q : quantities) {
      double x = std::bit_cast<double>(random());
      if (k % 2 == 0) x = std::pow(10.0, exponent(random));  // the magnitudes of machines
      if (!std::isfinite(x) || std::abs(x) > 1e290 || (x != 0.0 && std::abs(x) < 1e-290)) continue;
      const std::string text = from_si(x, q);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(to_si(text, q)), std::bit_cast<std::uint64_t>(x))
          << text << " seed " << seed << " case " << k;
    }
  }
  EXPECT_TRUE(std::signbit(to_si(from_si(-0.0, kLength), kLength)));
  const double tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(to_si(from_si(tiny, kLength), kLength), tiny);
}

TEST(Units, FactorsOfColumns) {
  EXPECT_EQ(unit_factor("mm", "m"), 1e-3);
  EXPECT_EQ(unit_factor("kN", "N"), 1e3);
  EXPECT_NEAR(unit_factor("deg", "rad"), 0.017453292519943295, 1e-17);
  EXPECT_NEAR(unit_factor("mm/min", "m/s"), 1e-3 / 60, 1e-20);
  EXPECT_EQ(unit_factor("pct", ""), 0.01);
  EXPECT_THAT([&] { unit_factor("N", "m"); }, ThrowsMessage<InputError>(HasSubstr("got \"N\"")));
  EXPECT_THAT([&] { unit_factor("xyz", "m"); }, ThrowsMessage<InputError>(HasSubstr("got \"xyz\"")));
  EXPECT_TRUE(is_unit("mm/s"));
  EXPECT_FALSE(is_unit("CurrentFeedback"));
  EXPECT_FALSE(is_unit(""));
}

TEST(Units, RangeAsText) {
  EXPECT_EQ(range_text(kLength), "");
  EXPECT_EQ(range_text(kLength.positive()), "above 0 mm");
  EXPECT_EQ(range_text(kLength.not_negative()), "at least 0 mm");
  EXPECT_EQ(range_text(pure_number().positive().at_most(1)), "above 0, at most 1");
}

TEST(Units, ThreadsMayParseAtOnce) {
  std::vector<std::thread> threads;
  std::vector<double> sums(4);
  for (std::size_t t = 0; t < sums.size(); ++t) {
    threads.emplace_back([&, t] {
      for (int k = 1; k <= 200; ++k)
        sums[t] += to_si(std::to_string(k) + " mm" + std::string(k % 2, ' '), kLength);
      for (int k = 1; k <= 200; ++k) sums[t] += unit_factor(std::to_string(k) + " mm", "m");
    });
  }
  for (auto& t : threads) t.join();
  for (const double s : sums) EXPECT_NEAR(s, 40.2, 1e-9);
}

// An angle is the arc at a radius of 1 m, a torque the force there, an inertia the mass there.
TEST(Units, AnAxisThatTurnsIsCarriedAtARadiusOfOneMetre) {
  constexpr double kHalfTurn = 3.14159265358979323846;
  const auto si = [](const std::string& text, const Quantity& linear) {
    return to_si(text, rotary_quantity(linear, text).value_or(linear));
  };
  EXPECT_NEAR(si("180 deg", kLength), kHalfTurn, 1e-15);
  EXPECT_NEAR(si("180 Grad", kLength), kHalfTurn, 1e-15);  // no gigaradians
  EXPECT_NEAR(si("30 rpm", kSpeed), kHalfTurn, 1e-14);
  EXPECT_NEAR(si("90 deg/s2", quantity("m/s2", "mm/s2")), kHalfTurn / 2.0, 1e-14);
  EXPECT_EQ(si("3 N m", quantity("N", "N")), 3.0);
  EXPECT_EQ(si("20000 kg mm2", quantity("kg", "N s2/mm")), 0.02);
  EXPECT_EQ(si("4 N m s/rad", quantity("N s/m", "N s/mm")), 4.0);
  EXPECT_EQ(si("4 N m s", quantity("N s/m", "N s/mm")), 4.0);
  EXPECT_FALSE(rotary_quantity(quantity("N m", "N m"), "3 N m").has_value());
  EXPECT_FALSE(rotary_quantity(quantity("s", "ms"), "3 ms").has_value());
  EXPECT_THROW(si("180 mm", kLength), InputError);
  EXPECT_THROW(si("3", kLength), InputError);
  EXPECT_THROW(si("-3 N m", quantity("N", "N").positive()), InputError);
}

}  // namespace
}  // namespace stribeck::io::units_test
