#pragma once
/// Plane curves q(φ).
///
///   circle     R·(cos φ, sin φ)                                            one lap: 2π, counter-clockwise
///   eight      R·(sin φ, sin φ·cos φ)                                      one lap: 2π
///   trifolium  (R·cos²φ·(4sin²φ − 1) + R, R·cos φ·sin φ·(4sin²φ − 1))      one lap: π; x, y of (4.7)
///
///   R size [m]. All three are regular: |q'(φ)| > 0 everywhere.
/// Real time: safe.

#include <stribeck/core/fields.hpp>
#include <stribeck/path/derivatives.hpp>
#include <utility>

namespace stribeck::path {

enum class Shape { kCircle, kEight, kTrifolium };

struct Curve {
  static constexpr std::size_t kAxes = 2;

  Shape shape = Shape::kCircle;
  double size = 0.01;

  static constexpr auto fields() {
    return std::tuple{
        field("shape", &Curve::shape, "circle, eight or trifolium"),
        field("size", &Curve::size, quantity("m", "mm").positive(), "radius of the circle, or half width")};
  }

  /// Parameter φ of one lap [rad].
  [[nodiscard]] double period() const noexcept { return shape == Shape::kTrifolium ? kPi : 2.0 * kPi; }
  [[nodiscard]] static constexpr bool closed() noexcept { return true; }

  template <Real T>
  [[nodiscard]] Vec<T, 2> point(const T& phi) const noexcept {
    const T s = sin(phi);
    const T c = cos(phi);
    const T r(size);
    switch (shape) {
      case Shape::kCircle:
        return {{r * c, r * s}};
      case Shape::kEight:
        return {{r * s, r * s * c}};
      case Shape::kTrifolium:
        break;
    }
    const T lobe = r * c * (T(4.0) * s * s - T(1.0));
    return {{lobe * c + r, lobe * s}};
  }
};

}  // namespace stribeck::path

template <>
struct stribeck::EnumNames<stribeck::path::Shape> {
  static constexpr std::array names{
      std::pair{stribeck::path::Shape::kCircle, std::string_view{"circle"}},
      std::pair{stribeck::path::Shape::kEight, std::string_view{"eight"}},
      std::pair{stribeck::path::Shape::kTrifolium, std::string_view{"trifolium"}}};
};
