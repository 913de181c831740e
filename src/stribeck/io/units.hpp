#pragma once
/// Converts between text with a unit and SI numbers. The units library is udunits2; added are deg, Nm, rev, pct and the
/// workshop unit U/min.
///
///   to_si("57.65 N s2/mm", quantity("kg", "N s2/mm"))  →  57650
///   from_si(57650, quantity("kg", "N s2/mm"))          →  "57.65 N s2/mm"
///
/// Nothing is guessed. Only proportional conversions are accepted: no offsets (degC), no reciprocals (s for Hz). The radian counts as
/// a dimension: to_si() takes "5 Hz" for 2π·5 rad/s and "20 rad/s" for 20 1/s, but no Hz for 1/s. A conversion by a power of
/// ten moves the decimal point of the text: its result is the double nearest to the written number, and
/// every double has a text that reads back to it bit for bit. Threads: safe. Real time: no.
/// Errors: InputError without a place; the reader that knows the place adds it.

#include <optional>
#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io {

/// A proportional conversion from one unit to another: factor, exactly 10^power where it is one.
struct Conversion {
  double factor = 1.0;
  bool decimal = false;
  int power = 0;

  [[nodiscard]] double operator()(double x) const noexcept;
};

/// From a unit text, e.g. of a column header, to an SI unit. Throws on an unknown unit or a wrong dimension.
Conversion conversion(std::string_view unit_text, std::string_view si_unit);
double unit_factor(std::string_view unit_text, std::string_view si_unit);

/// Whether the library knows the text as a unit; "" is none.
bool is_unit(std::string_view unit_text);

/// Whether the text is a number with a unit of this quantity.
bool is_convertible(std::string_view text, const Quantity& quantity);

/// Reads a number with its unit and checks the permitted range. A bare number is accepted for a pure number
/// only.
double to_si(std::string_view text, const Quantity& expected);

/// The quantity of an axis that turns in place of one of an axis that moves, at a radius of 1 m: an angle for a length, a torque for
/// a force, an inertia for a mass ("90 deg" is π/2 m, "2 kg m2" is 2 kg). Nothing where both axes have the same. `text` chooses among
/// spellings: "N m s" and "N m s/rad".
std::optional<Quantity> rotary_quantity(const Quantity& linear, std::string_view text);

/// Checks the range of an SI value; the message shows it as `got`.
void check_range(double si, const Quantity& expected, std::string_view got);

/// The shortest text with the shown unit that to_si reads back to the same double. The SI unit is used where no such text exists,
/// which happens for units that are no power of ten away. Not finite: "nan", "inf".
std::string from_si(double si, const Quantity& quantity);

/// The unit in which people read such a value: the shown one, but kg for a mass below 20 t.
std::string_view shown_unit(double si, const Quantity& quantity) noexcept;

/// The permitted range, e.g. "above 0 mm", "0 % to 99 %"; "" when every number is permitted.
std::string range_text(const Quantity& quantity);

/// The shortest text that reads back to the same double; scientific below 1e-5 and from 1e16.
std::string number_text(double x);

}  // namespace stribeck::io
