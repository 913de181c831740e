#include <gtest/gtest.h>

#include <clocale>
#include <cstdlib>
#include <string>

#include <stribeck/io/test_folder.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::units_library_test {
namespace {

// A program with windows sets the locale of its user. With a decimal comma "2.5 mm" was 2 mm, and the database of the units was not read.
TEST(UnitsLibrary, ADecimalCommaOfTheProgramChangesNothing) {
  const ::stribeck::test::Folder folder;
  const std::string made = folder / "comma.UTF-8";
  if (std::system(("localedef -c -i de_DE -f UTF-8 '" + made + "' >/dev/null 2>&1").c_str()) != 0)
    GTEST_SKIP() << "localedef or its sources are not installed";
  ASSERT_EQ(setenv("LOCPATH", (folder / "").c_str(), 1), 0);
  ASSERT_NE(std::setlocale(LC_ALL, "comma.UTF-8"), nullptr);
  ASSERT_STREQ(std::localeconv()->decimal_point, ",");
  EXPECT_DOUBLE_EQ(unit_factor("2.5 mm", "m"), 2.5e-3);
  EXPECT_DOUBLE_EQ(to_si("1.5 N s/mm", quantity("N s/m", "N s/mm")), 1500.0);
  EXPECT_EQ(from_si(0.0125, quantity("m", "mm")), "12.5 mm");
  EXPECT_STREQ(std::localeconv()->decimal_point, ",");
  std::setlocale(LC_ALL, "C");
}

}  // namespace
}  // namespace stribeck::io::units_library_test
