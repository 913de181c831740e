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

  /// Three digits and the unit; small lengths are in um.
  [[nodiscard]] std::string length(double x) const {
    constexpr double kSmall = 1e-3;
    if (unit_ == "mm" && std::abs(x) < kSmall) return fmt::format("{:.3g} um", 1e6 * x);
    return fmt::format("{:.3g} {}", scale_ * x, unit_);
  }
  [[nodiscard]] std::string speed(double v) const { return fmt::format("{:.3g} {}/s", scale_ * v, unit_); }
  /// With the sign of a direction.
  [[nodiscard]] std::string velocity(double v) const {
    return fmt::format("{:+.3g} {}/s", scale_ * v, unit_);
  }
  [[nodiscard]] std::string force(double f) const { return fmt::format("{:.3g} {}", f, force_); }
  /// A stiffness.
  [[nodiscard]] std::string force_per_length(double k) const {
    return fmt::format("{:.3g} {}/{}", k / scale_, force_, unit_);
  }

  [[nodiscard]] const std::string& length_unit() const noexcept { return unit_; }
  [[nodiscard]] const std::string& force_unit() const noexcept { return force_; }
  /// Factor from the unit of the log to length_unit().
  [[nodiscard]] double scale() const noexcept { return scale_; }

 private:
  std::string unit_ = "mm";
  double scale_ = 1e3;
  std::string force_ = "N";
};

}  // namespace stribeck::ident
