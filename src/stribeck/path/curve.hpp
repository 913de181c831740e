#pragma once
/// Plane curves q(φ), written once each; derivatives come from Taylor arithmetic and are exact.
///
///   circle     R·(cos φ, sin φ)                                            one lap: 2π, counter-clockwise
///   eight      R·(sin φ, sin φ·cos φ)                                      one lap: 2π
///   trifolium  (R·cos²φ·(4sin²φ − 1) + R, R·cos φ·sin φ·(4sin²φ − 1))      one lap: π; x, y of (4.7)
///
///   R size [m]. All three are regular: |q'(φ)| > 0 everywhere.
/// Real time: safe.

#include <stribeck/core/fields.hpp>
#include <stribeck/core/taylor.hpp>
#include <stribeck/core/vec.hpp>
#include <utility>

namespace stribeck::path {

enum class Shape { kCircle, kEight, kTrifolium };

struct Curve {
  Shape shape = Shape::kCircle;
  double size = 0.01;

  static constexpr auto fields() {
    return std::tuple{
        field("shape", &Curve::shape, "circle, eight or trifolium"),
        field("size", &Curve::size, quantity("m", "mm").positive(), "radius of the circle, or half width")};
  }

  /// Parameter φ of one lap [rad].
  [[nodiscard]] double period() const noexcept { return shape == Shape::kTrifolium ? kPi : 2.0 * kPi; }

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

  /// Value and derivatives with respect to φ up to order N: element k is the k-th derivative.
  template <int N>
  [[nodiscard]] std::array<Vec2, N + 1> derivatives(double phi) const noexcept {
    const Vec<Taylor<N>, 2> q = point(Taylor<N>::variable(phi));
    std::array<Vec2, N + 1> d;
    for (int k = 0; k <= N; ++k) d[k] = {{q[0].derivative(k), q[1].derivative(k)}};
    return d;
  }

  /// Arc length per φ, |q'(φ)| [m/rad].
  [[nodiscard]] double stretch(double phi) const noexcept { return norm(derivatives<1>(phi)[1]); }

  /// Length of one lap [m].
  [[nodiscard]] double lap_length() const noexcept {
    // The integrand is periodic and analytic: the trapezoidal rule converges exponentially; 4096 points reach
    // rounding.
    constexpr int kPoints = 4096;
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) sum += stretch(period() * i / kPoints);
    return sum * period() / kPoints;
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
