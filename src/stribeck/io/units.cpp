#include <fast_float/fast_float.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/io/units/units_library.hpp>
#include <utility>

namespace stribeck::io {

namespace {

constexpr double kTurn = 2.0 * kPi;  // [rad]

[[noreturn]] void fail(std::string message) { throw InputError(Problem{"", 0, "", std::move(message)}); }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Length of the number at the start of a text, and its value; 0 if there is none.
struct Number {
  std::size_t length = 0;
  double value = 0.0;
};

Number parse_number(std::string_view text) {
  const std::size_t sign = !text.empty() && text[0] == '+' ? 1 : 0;
  if (sign == 1 && text.size() > 1 && text[1] == '-') return {};
  Number n;
  const auto [end, error] = fast_float::from_chars(text.data() + sign, text.data() + text.size(), n.value);
  if (error == std::errc()) n.length = static_cast<std::size_t>(end - text.data());
  return n;
}

/// The decimal number in `text` times 10^power, with a single rounding.
double shifted(std::string_view text, int power) {
  if (text[0] == '+') text.remove_prefix(1);
  const auto e = text.find_first_of("eE");
  long exponent = 0;
  if (e != std::string_view::npos) {
    auto digits = text.substr(e + 1);
    if (!digits.empty() && digits[0] == '+') digits.remove_prefix(1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (error != std::errc()) exponent = digits[0] == '-' ? -100000 : 100000;
  }
  const std::string moved = std::string(text.substr(0, e)) + 'e' + std::to_string(exponent + power);
  return parse_number(moved).value;
}

/// x as text with its decimal point moved: x·10^power, with the shortest digits of x; optionally fewer.
std::string decimal_text(double x, int power, int precision = -1) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0.0 ? "inf" : "-inf";
  std::array<char, 40> buffer{};
  const auto made =
      precision < 0
          ? std::to_chars(buffer.begin(), buffer.end(), x, std::chars_format::scientific)
          : std::to_chars(buffer.begin(), buffer.end(), x, std::chars_format::scientific, precision);
  const std::string_view text(buffer.data(), static_cast<std::size_t>(made.ptr - buffer.data()));
  const auto e = text.find('e');
  int exponent = std::atoi(text.data() + e + 1);
  std::string sign;
  std::string digits;
  for (const char c : text.substr(0, e)) {
    if (c == '-') sign = "-";
    if (is_digit(c)) digits += c;
  }
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.empty()) return sign + "0";
  exponent += power;
  const int n = static_cast<int>(digits.size());
  if (exponent < -5 || exponent >= 16) {
    if (n > 1) digits.insert(1, ".");
    return sign + digits + 'e' + std::to_string(exponent);
  }
  if (exponent < 0) return sign + "0." + std::string(static_cast<std::size_t>(-exponent - 1), '0') + digits;
  if (exponent + 1 >= n) return sign + digits + std::string(static_cast<std::size_t>(exponent + 1 - n), '0');
  digits.insert(static_cast<std::size_t>(exponent) + 1, ".");
  return sign + digits;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::string with_unit(std::string number, std::string_view unit) {
  if (!unit.empty()) number.append(" ").append(unit);
  return number;
}

/// An example of a valid text, e.g. `"5 mm"`.
std::string example(std::string_view number, const Quantity& q) {
  return '"' + with_unit(std::string(number), q.shown.empty() ? q.unit : q.shown) + '"';
}

/// A pole or an angular frequency in another unit that people write for it: "10 Hz" is 2π·10 rad/s, and a pole of "20 rad/s"
/// one of 20 1/s. The other way round Hz stays refused: a gain in 1/s is no number of periods. The speed of a motor in "1/min" is in
/// turns.
std::optional<double> rate_of(double value, std::string_view unit, const Quantity& q) {
  const std::string_view expected = q.unit;
  if (q.shown == "rpm" && unit.find("min") != std::string_view::npos) {
    if (const auto [verdict, found] = detail::find_unit(unit, "1/min"); verdict == detail::UnitVerdict::kGood)
      return found(value) * kTurn / 60.0;
  }
  const bool hertz = expected == "rad/s" && unit.find("Hz") != std::string_view::npos;
  const bool radians = expected == "1/s" && unit.find("rad") != std::string_view::npos;
  if (!hertz && !radians) return std::nullopt;
  const auto [verdict, found] = detail::find_unit(unit, hertz ? "Hz" : "rad/s");
  const double si = found(value) * (hertz ? kTurn : 1.0);
  if (verdict != detail::UnitVerdict::kGood || !std::isfinite(si)) return std::nullopt;
  return si;
}

/// "5:2" of a gear, where a pure number is wanted.
std::optional<double> ratio_of(double value, std::string_view rest, const Quantity& expected) {
  if (!expected.unit.empty() || rest.empty() || rest[0] != ':') return std::nullopt;
  const std::string_view second = detail::without_blanks(rest.substr(1));
  const Number number = parse_number(second);
  if (number.length == 0 || number.length != second.size()) return std::nullopt;
  return value / number.value;
}

/// An acceleration in g: data sheets write it so, and for the units library "g" is a gram.
std::optional<double> in_g(double value, std::string_view unit, std::string_view expected) {
  constexpr double kGravity = 9.80665;  // [m/s²]
  if (expected != "m/s2" || unit != "g") return std::nullopt;
  return value * kGravity;
}

std::string_view or_one(std::string_view unit) { return unit.empty() ? std::string_view("1") : unit; }

/// The time of one period of a rate, "8 kHz", where a time is wanted; "" for other units.
std::string period_of_rate(std::string_view got, std::string_view unit, const Quantity& q) {
  if (q.unit != "s" || unit.find("Hz") == std::string_view::npos) return {};
  double rate = 0.0;
  const auto [end, error] = std::from_chars(got.data(), got.data() + got.size(), rate);
  const auto [verdict, hertz] = detail::find_unit(unit, "Hz");
  const std::string shown(q.shown.empty() ? q.unit : q.shown);
  const double period = conversion("s", shown)(1.0 / hertz(rate));
  if (error != std::errc{} || verdict != detail::UnitVerdict::kGood || !(period > 0.0) ||
      !std::isfinite(period))
    return {};
  std::array<char, 32> digits{};
  const auto last =
      std::to_chars(digits.data(), digits.data() + digits.size(), period, std::chars_format::general, 6);
  return " (that is a rate; write " + in_quotes(std::string(digits.data(), last.ptr) + " " + shown) + ")";
}

[[noreturn]] void fail_wrong_dimension(std::string_view got, std::string_view unit, const Quantity& q) {
  const std::string wanted(or_one(q.shown.empty() ? q.unit : q.shown));
  std::string message =
      "got " + in_quotes(got) + ", expected " + (q.unit.empty() ? "a pure number" : "a unit like " + wanted);
  if (const std::string period = period_of_rate(got, unit, q); !period.empty()) {
    message += period;
  } else if (unit.find("Hz") != std::string_view::npos && q.unit.find("/s") != std::string_view::npos) {
    message += " (Hz counts whole periods; convert it to " + wanted + ")";
  } else if (q.unit == "N" && detail::find_unit(unit, "kg").verdict == detail::UnitVerdict::kGood) {
    message += " (" + in_quotes(unit) + " is a unit of mass; write a force in N, kgf or lbf)";
  } else {
    message += " (" + in_quotes(unit) + " is another kind of quantity)";
  }
  fail(std::move(message));
}

}  // namespace

namespace detail {

std::string_view without_blanks(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r\n") - first + 1);
}

Conversion conversion_by(double factor) {
  Conversion c{factor, false, 0};
  constexpr double kRounding = 1e-14;
  // 10^±22 are the last powers of ten that a double holds exactly.
  const double power = std::round(std::log10(factor));
  if (std::abs(power) <= 22.0 && std::abs(factor / std::pow(10.0, power) - 1.0) < kRounding) {
    c.decimal = true;
    c.power = static_cast<int>(power);
    c.factor = c(1.0);
  }
  return c;
}

}  // namespace detail

double Conversion::operator()(double x) const noexcept {
  // A division by an exact power of ten is rounded once; a product with 1e-3 would be rounded twice.
  if (decimal && power < 0) return x / std::pow(10.0, -power);
  return x * factor;
}

Conversion conversion(std::string_view unit_text, std::string_view si_unit) {
  const auto [verdict, found] = detail::find_unit(or_one(detail::without_blanks(unit_text)), or_one(si_unit));
  if (verdict == detail::UnitVerdict::kUnknownUnit) {
    fail("got " + in_quotes(unit_text) + ", expected a unit like " + std::string(or_one(si_unit)) +
         " (not a known unit)");
  }
  if (verdict == detail::UnitVerdict::kWrongDimension)
    fail_wrong_dimension(unit_text, unit_text, {si_unit, si_unit});
  return found;
}

double unit_factor(std::string_view unit_text, std::string_view si_unit) {
  return conversion(unit_text, si_unit).factor;
}

bool is_unit(std::string_view unit_text) { return detail::known_unit(unit_text); }

double to_si(std::string_view text, const Quantity& expected) {
  const std::string_view all = detail::without_blanks(text);
  const Number number = parse_number(all);
  if (number.length == 0) {
    fail("got " + in_quotes(text) + ", expected a number" + (expected.unit.empty() ? "" : " with its unit") +
         " (write it like " + example("5", expected) + ")");
  }
  const std::string_view digits = all.substr(0, number.length);
  if (!std::isfinite(number.value)) fail("got " + in_quotes(text) + ", expected a finite number");
  std::string_view unit = detail::without_blanks(all.substr(number.length));
  // "2500/min" is 2500 1/min.
  std::string per;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (unit.size() > 1 && unit[0] == '/' && is_letter(unit[1])) unit = per = "1" + std::string(unit);
  if (unit.empty() && !expected.unit.empty()) {
    fail("got " + in_quotes(text) + ", expected a unit after the number (missing unit: write " +
         example(digits, expected) + ")");
  }
  if (!unit.empty() && unit[0] == ',') {
    fail("got " + in_quotes(text) + ", expected a decimal point (write 1.5, not 1,5)");
  }
  // "5 000 mm" or "5 10 mm": udunits2 would multiply. Only 1/… begins a unit with a digit, and the 1000/min of position gains.
  const auto slash = unit.find('/');
  const std::string_view before =
      slash == std::string_view::npos ? "" : detail::without_blanks(unit.substr(0, slash));
  const bool reciprocal =
      before == "1" || (before == "1000" && detail::without_blanks(unit.substr(slash + 1)) == "min");
  if (!unit.empty() && !reciprocal &&
      (is_digit(unit[0]) || unit[0] == '.' || unit[0] == '+' || unit[0] == '-')) {
    fail("got " + in_quotes(text) + ", expected one number and its unit (write it like " +
         example("5", expected) + ")");
  }

  if (const auto si = ratio_of(number.value, unit, expected)) {
    if (!std::isfinite(*si)) fail("got " + in_quotes(text) + ", expected a finite number");
    check_range(*si, expected, text);
    return *si;
  }
  if (const auto si = rate_of(number.value, unit, expected)) {
    check_range(*si, expected, text);
    return *si;
  }
  if (const auto si = in_g(number.value, unit, expected.unit)) {
    check_range(*si, expected, text);
    return *si;
  }
  const auto [verdict, found] = detail::find_unit(or_one(unit), or_one(expected.unit));
  if (verdict == detail::UnitVerdict::kUnknownUnit) {
    fail("got " + in_quotes(text) + ", expected " +
         (expected.unit.empty() ? "a pure number" : "a unit like ") +
         std::string(expected.shown.empty() ? expected.unit : expected.shown) + " (" + in_quotes(unit) +
         " is not a known unit)");
  }
  if (verdict == detail::UnitVerdict::kWrongDimension) fail_wrong_dimension(text, unit, expected);
  const double si = found.decimal ? shifted(digits, found.power) : number.value * found.factor;
  if (!std::isfinite(si)) fail("got " + in_quotes(text) + ", expected a finite number");
  check_range(si, expected, text);
  return si;
}

bool is_convertible(std::string_view text, const Quantity& quantity) {
  const std::string_view all = detail::without_blanks(text);
  const std::string_view unit = detail::without_blanks(all.substr(parse_number(all).length));
  return !unit.empty() && detail::find_unit(unit, quantity.unit).verdict == detail::UnitVerdict::kGood;
}

std::optional<Quantity> rotary_quantity(const Quantity& linear, std::string_view text) {
  struct Pair {
    std::string_view linear;
    std::string_view rotary;
    std::string_view shown;
  };
  static constexpr std::array<Pair, 13> kPairs{{{"m", "rad", "deg"},
                                                {"m/s", "rad/s", "deg/s"},
                                                {"m/s2", "rad/s2", "deg/s2"},
                                                {"m/s3", "rad/s3", "deg/s3"},
                                                {"N", "N m", "N m"},
                                                {"N/s", "N m/s", "N m/s"},
                                                {"N/V", "N m/V", "N m/V"},
                                                {"N/A", "N m/A", "N m/A"},
                                                {"kg", "kg m2", "kg m2"},
                                                {"N s/m", "N m s/rad", "N m s/rad"},
                                                {"N s/m", "N m s", "N m s"},
                                                {"N/m", "N m/rad", "N m/rad"},
                                                {"N/m", "N m", "N m"}}};
  std::optional<Quantity> found;
  for (const Pair& pair : kPairs) {
    if (pair.linear != linear.unit) continue;
    const bool spelt = is_convertible(text, {pair.rotary, pair.shown});
    if (found && !spelt) continue;
    found = linear;
    found->unit = pair.rotary;
    found->shown = pair.shown;
    if (spelt) return found;
  }
  return found;
}

std::string_view shown_unit(double si, const Quantity& q) noexcept {
  // The thesis counts its tables of many tonnes in N·s²/mm; nobody reads a machine of his own so.
  constexpr double kLight = 20e3;  // [kg]
  if (q.unit == "kg" && si > 0.0 && si < kLight) return q.unit;
  return q.shown.empty() ? q.unit : q.shown;
}

void check_range(double si, const Quantity& expected, std::string_view got) {
  if (std::isnan(si)) fail("got " + in_quotes(got) + ", expected a number");
  if (!expected.permits(si)) fail("got " + in_quotes(got) + ", expected " + range_text(expected));
}

std::string from_si(double si, const Quantity& q) {
  const std::string_view shown = shown_unit(si, q);
  const auto [verdict, c] = detail::find_unit(or_one(shown), or_one(q.unit));
  if (verdict != detail::UnitVerdict::kGood) {
    fail("unit " + in_quotes(shown) + " of the program does not convert to " + in_quotes(q.unit));
  }
  if (c.decimal) return with_unit(decimal_text(si, -c.power), shown);
  if (!std::isfinite(si)) return with_unit(decimal_text(si, 0), shown);
  // The shortest number whose product with the factor rounds to si. Its neighbours are tried too, because the quotient is
  // rounded.
  const double factor = c.factor;
  const double near = si / factor;
  const auto reads_back = [&](std::string_view text) {
    return same_bits(parse_number(text).value * factor, si);
  };
  for (int precision = 0; precision < 17; ++precision) {
    if (auto text = decimal_text(near, 0, precision); reads_back(text))
      return with_unit(std::move(text), shown);
  }
  double below = near;
  double above = near;
  for (int k = 0; k < 4; ++k) {
    below = std::nextafter(below, -INFINITY);
    above = std::nextafter(above, INFINITY);
    for (const double x : {below, above}) {
      if (auto text = decimal_text(x, 0); reads_back(text)) return with_unit(std::move(text), shown);
    }
  }
  return with_unit(decimal_text(si, 0), q.unit);
}

std::string range_text(const Quantity& q) {
  const bool below = std::isfinite(q.min);
  const bool above = std::isfinite(q.max);
  std::string text;
  Quantity one = q;  // both ends in one unit
  if (below && above) one.shown = shown_unit(q.min, q);
  if (below) text = (q.min_excluded ? "above " : above ? "" : "at least ") + from_si(q.min, one);
  if (above && below) text += q.min_excluded ? ", at most " : " to ";
  if (above && !below) text = "at most ";
  if (above) text += from_si(q.max, one);
  return text;
}

std::string number_text(double x) { return decimal_text(x, 0); }

}  // namespace stribeck::io
