#pragma once
/// A five-axis machine of three linear axes and a tilting rotary table (A about x carries C about z), and a path for it.
///
///   tool tip and tool axis as the workpiece sees them     p = Rz(−c)·Rx(−a)·(x, y, z) − p₀,   o = Rz(−c)·Rx(−a)·e_z
///   inverse                                               a = atan2(√(o_x² + o_y²), o_z),   c = atan2(o_x, o_y),
///                                                         (x, y, z) = Rx(a)·Rz(c)·(p + p₀)
///
///   q = (x, y, z, ρ·a, ρ·c) [m]: a rotary axis enters as a linear one at the reference radius ρ, so its mass is J/ρ², its
///   force torque/ρ, its position angle·ρ. x, y, z tool against the point where A and C cross [m], p₀ place of the
///   workpiece's origin on the table seen from there [m], o unit vector; a ≥ 0.
///
/// Written once for any Real: the derivatives of axis motion and the Jacobian come from Taylor arithmetic.
/// At o = e_z (the pole) C is undefined; a path must keep away from it.
/// Not modelled: forces between the axes (a rotary table that tilts moves its weight); errors of the machine's geometry.
/// Real time: safe.

#include <array>
#include <concepts>
#include <stribeck/core/fields.hpp>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/frame.hpp>

namespace stribeck::path {

struct TiltingTable {
  double radius = 0.1;              ///< ρ [m]
  Vec<double, 3> workpiece_origin;  ///< p₀ [m]

  /// Tool tip in the workpiece [m].
  template <Real T>
  [[nodiscard]] Vec<T, 3> tip(const Vec<T, 5>& q) const noexcept {
    const Vec<T, 3> p = to_workpiece(q, {{q[0], q[1], q[2]}});
    return {{p[0] - T(workpiece_origin[0]), p[1] - T(workpiece_origin[1]), p[2] - T(workpiece_origin[2])}};
  }
  /// Tool axis in the workpiece, from the tip to the spindle.
  template <Real T>
  [[nodiscard]] Vec<T, 3> direction(const Vec<T, 5>& q) const noexcept {
    return to_workpiece(q, {{T(0.0), T(0.0), T(1.0)}});
  }
  /// Positions of the axes for a tip and a tool axis of length 1.
  template <Real T>
  [[nodiscard]] Vec<T, 5> axes(const Vec<T, 3>& tip, const Vec<T, 3>& o) const noexcept {
    const T across = sqrt(o[0] * o[0] + o[1] * o[1]);  // sin a; cos a is o_z
    const T sin_c = o[0] / across;
    const T cos_c = o[1] / across;
    const T px = tip[0] + T(workpiece_origin[0]);
    const T py = tip[1] + T(workpiece_origin[1]);
    const T pz = tip[2] + T(workpiece_origin[2]);
    const T y = sin_c * px + cos_c * py;
    return {{cos_c * px - sin_c * py, o[2] * y - across * pz, across * y + o[2] * pz,
             radius * atan2(across, o[2]), radius * atan2(o[0], o[1])}};
  }

 private:
  /// Rz(−c)·Rx(−a)·v.
  template <Real T>
  [[nodiscard]] Vec<T, 3> to_workpiece(const Vec<T, 5>& q, const Vec<T, 3>& v) const noexcept {
    const T a = (1.0 / radius) * q[3];
    const T c = (1.0 / radius) * q[4];
    const T y = cos(a) * v[1] + sin(a) * v[2];
    return {{cos(c) * v[0] + sin(c) * y, cos(c) * y - sin(c) * v[0], cos(a) * v[2] - sin(a) * v[1]}};
  }
};

/// Derivatives of tip and tool axis by each axis: column i holds ∂p/∂q_i [1] and ∂o/∂q_i [1/m].
struct TipJacobian {
  std::array<Vec<double, 3>, 5> tip;
  std::array<Vec<double, 3>, 5> direction;
};

inline TipJacobian jacobian(const TiltingTable& table, const Vec<double, 5>& q) noexcept {
  TipJacobian j;
  for (std::size_t i = 0; i < 5; ++i) {
    Vec<Taylor<1>, 5> s;
    for (std::size_t k = 0; k < 5; ++k) s[k] = k == i ? Taylor<1>::variable(q[k]) : Taylor<1>(q[k]);
    j.tip[i] = detail::derivative_of<1>(table.tip(s));
    j.direction[i] = detail::derivative_of<1>(table.direction(s));
  }
  return j;
}

/// Motion of the tip alone, as a path in the workpiece.
template <class C>
struct TipPath {
  static constexpr std::size_t kAxes = 3;
  C path;

  [[nodiscard]] double period() const noexcept { return path.period(); }
  [[nodiscard]] bool closed() const noexcept { return path.closed(); }
  template <Real T>
  [[nodiscard]] Vec<T, 3> point(const T& phi) const noexcept {
    return path.tip(phi);
  }
};

/// A path of five axes, given by tip and tool axis.
template <class C>
concept ToolPath = PathCurve<C> && C::kAxes == 5 && requires(const C& c, double phi) {
  { c.table } -> std::convertible_to<TiltingTable>;
  { c.tip(phi) } -> std::same_as<Vec<double, 3>>;
  { c.direction(phi) } -> std::same_as<Vec<double, 3>>;
};

/// Tool tip and tool axis in the workpiece, from the positions of the axes.
struct TipDeviation {
  double contour = 0.0;  ///< distance of the tip from its path [m]
  double orientation =
      0.0;  ///< angle between the tool axis and the one that belongs to the nearest point of the path [rad]
};

template <ToolPath C>
TipDeviation tip_deviation(const C& path, const Vec<double, 5>& q, double phi) noexcept {
  const Vec<double, 3> tip = path.table.tip(q);
  const TipPath<C> trace{path};
  const NearestPoint nearest = nearest_from(trace, tip, phi);
  // If the search does not converge, the tip is far from the path; the reference then replaces the nearest point.
  const double at = nearest.converged ? nearest.phi : phi;
  const Vec<double, 3> wanted = path.direction(at);
  const Vec<double, 3> is = path.table.direction(q);
  return {norm(tip - path.tip(at)), atan2(norm(cross(wanted, is)), dot(wanted, is))};
}

/// Forces [N] on the axes from a force on the tip [N], given in the workpiece: Jᵀ·f, by virtual work.
inline Vec<double, 5> to_axes(const TiltingTable& table, const Vec<double, 5>& q,
                              const Vec<double, 3>& force) noexcept {
  const TipJacobian j = jacobian(table, q);
  Vec<double, 5> f;
  for (std::size_t i = 0; i < 5; ++i) f[i] = dot(j.tip[i], force);
  return f;
}

/// Flank milling of a cone frustum whose axis leans by β from the table's towards y: in the manner of the test piece of
/// NAS 979 and ISO 10791-7, with a half angle θ below β so that no rotary axis turns right round and all five reverse.
///
///   tip        p = p_c + R·ρ(φ),   ρ = cos φ·e₁ + sin φ·e₂          e₁ = e_x,  e₂ = (0, cos β, −sin β)
///   tool axis  o = cos θ·w − sin θ·ρ(φ),   w = (0, sin β, cos β)      one lap: 2π, counter-clockwise about w
///
/// Real time: safe.
struct ConeFrustum {
  static constexpr std::size_t kAxes = 5;

  TiltingTable table;
  Vec<double, 3> centre;     ///< p_c, in the workpiece [m]
  double radius = 0.02;      ///< R [m]
  double inclination = 0.5;  ///< β [rad]
  double half_angle = 0.25;  ///< θ [rad]

  /// Whether the tool axis stays away from the pole, and the path closes.
  [[nodiscard]] bool possible() const noexcept {
    return radius > 0.0 && half_angle >= 0.0 && half_angle < inclination &&
           inclination + half_angle < 0.5 * kPi;
  }
  [[nodiscard]] double period() const noexcept { return 2.0 * kPi; }
  [[nodiscard]] static constexpr bool closed() noexcept { return true; }

  template <Real T>
  [[nodiscard]] Vec<T, 3> tip(const T& phi) const noexcept {
    const T s = sin(phi);
    return {{T(centre[0]) + radius * cos(phi), T(centre[1]) + (radius * cos(inclination)) * s,
             T(centre[2]) - (radius * sin(inclination)) * s}};
  }
  template <Real T>
  [[nodiscard]] Vec<T, 3> direction(const T& phi) const noexcept {
    const T s = sin(phi);
    const double lean = sin(half_angle);
    const double up = cos(half_angle);
    return {{-(lean * cos(phi)), T(up * sin(inclination)) - (lean * cos(inclination)) * s,
             T(up * cos(inclination)) + (lean * sin(inclination)) * s}};
  }
  template <Real T>
  [[nodiscard]] Vec<T, 5> point(const T& phi) const noexcept {
    return table.axes(tip(phi), direction(phi));
  }
};

}  // namespace stribeck::path
