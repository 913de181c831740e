#pragma once
/// The units in which a result is shown. Usually N and mm; a log whose force has no known scale keeps its own
/// (A, %, V), and an axis without a lead keeps the angle. Every N of a unit then stands for that force and every m for that
/// position, and a mass in kg is in N·s²/m of these.
/// Real time: no.

#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <utility>

namespace stribeck::report {

class ShownUnits {
 public:
  ShownUnits() = default;
  ShownUnits(std::string force_unit, std::string position_unit);
  /// Of an axis that turns and is carried as a linear one at a radius of 1 m: deg, N m, kg m2. Not for keys of JSON, which
  /// keep the units of the linear one.
  static ShownUnits turning();

  /// Whether force is in N and position in m: names of units then hold literally.
  [[nodiscard]] bool physical() const noexcept { return linear_ && (force == "N" || in_degrees_); }
  [[nodiscard]] bool linear() const noexcept { return linear_; }

  /// Such an axis, in degrees.
  [[nodiscard]] bool in_degrees() const noexcept { return in_degrees_; }
  /// The unit in degrees and its factor, of an SI unit of the linear axis.
  static std::pair<std::string_view, double> degrees_of(std::string_view si) noexcept;

  /// A unit with N, m and kg replaced: "N s/m" → "A s/rad".
  [[nodiscard]] std::string named(std::string_view unit) const;
  /// Whether the unit for people is used: mm and the like, but not for an angle.
  [[nodiscard]] std::string_view chosen(std::string_view si, std::string_view shown) const noexcept;

  std::string force = "N";
  std::string position = "mm";
  std::string fine = "µm";  ///< of small ways
  std::string velocity = "mm/s";
  std::string mass = "N s2/mm";
  double per_position = 1e3;  ///< shown value = SI value times this
  double per_fine = 1e6;
  double per_velocity = 1e3;
  double per_mass = 1e-3;

 private:
  bool linear_ = true;
  bool in_degrees_ = false;
  std::string base_ = "m";
};

}  // namespace stribeck::report
