#pragma once
/// Lengths, speeds and forces of a log in the units that people read, for sentences.
///
///   position in m      mm, or um below a millimetre; mm/s
///   of a rotary axis   deg, deg/s, N m        positions are arcs at a radius of 1 m
///   in rad             rad, rad/s
///
/// Real time: no.

#include <fmt/core.h>

#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <string>
#include <string_view>

namespace stribeck::ident {

class Shown {
 public:
  Shown() = default;
  Shown(std::string_view position_unit, std::string_view force_unit, bool rotary) : force_(force_unit) {
    if (rotary) {
      unit_ = "deg", scale_ = 180.0 / kPi;
      if (force_ == "N") force_ = "N m";
    } else if (position_unit != "m") {
      unit_ = position_unit, scale_ = 1.0;
    }
  }
  /// Of a log::Record, an ident::Result or another type with these members.
  template <class T>
  explicit Shown(const T& of) : Shown(of.position_unit, of.force_unit, of.rotary) {}

  /// Three digits and the unit, four from a hundred on; small lengths are in um.
  [[nodiscard]] std::string length(double x) const {
    constexpr double kSmall = 1e-3;
    if (unit_ == "mm" && x != 0.0 && std::abs(x) < kSmall) return three(1e6 * x) + " um";
    constexpr double kFourDigits = 100.0;
    const double shown = scale_ * x;
    return std::abs(shown) < kFourDigits     ? fmt::format("{:.3g} {}", shown, unit_)
           : std::abs(shown) < kExponentFrom ? fmt::format("{:.4g} {}", shown, unit_)
                                             : three(shown) + " " + unit_;
  }
  [[nodiscard]] std::string speed(double v) const { return fmt::format("{} {}/s", three(scale_ * v), unit_); }
  /// With the sign of a direction.
  [[nodiscard]] std::string velocity(double v) const {
    return fmt::format("{}{} {}/s", v < 0.0 ? "" : "+", three(scale_ * v + 0.0), unit_);
  }
  [[nodiscard]] std::string force(double f) const { return fmt::format("{} {}", three(f), force_); }
  /// A stiffness.
  [[nodiscard]] std::string force_per_length(double k) const {
    return fmt::format("{} {}/{}", three(k / scale_), force_, unit_);
  }

  [[nodiscard]] const std::string& length_unit() const noexcept { return unit_; }
  [[nodiscard]] const std::string& force_unit() const noexcept { return force_; }
  /// Factor from the unit of the log to length_unit().
  [[nodiscard]] double scale() const noexcept { return scale_; }

 private:
  static constexpr double kExponentFrom = 999.5;  ///< "{:.3g}" would write 1.5e+03

  /// Three digits without zeros behind them; from a thousand on all that stand before the point.
  static std::string three(double value) {
    return std::abs(value) < kExponentFrom ? fmt::format("{:.3g}", value) : digits(value);
  }

  std::string unit_ = "mm";
  double scale_ = 1e3;
  std::string force_ = "N";
};

}  // namespace stribeck::ident
