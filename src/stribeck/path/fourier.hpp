#pragma once
/// A path whose axes are sums of harmonics of one parameter, such as circles in space, figures of eight and the printed contours
/// of chapter 4.
///
///   q_i(φ) = c_i + Σ_j A_ij·cos(k_ij·φ + p_ij)           one lap: `lap` in φ
///
///   c, A [m], k [1], p [rad]. With whole multiples of 2π/lap as k the path is closed.
/// Real time: safe.

#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/path/derivatives.hpp>

namespace stribeck::path {

struct Harmonic {
  double amplitude = 0.0;  ///< A [m]
  double order = 1.0;      ///< k
  double phase = 0.0;      ///< p [rad]
};

template <std::size_t N>
struct Fourier {
  static constexpr std::size_t kAxes = N;
  static constexpr std::size_t kMaxTerms = 3;
  struct Axis {
    double offset = 0.0;  ///< c [m]
    FixedVector<Harmonic, kMaxTerms> terms;
  };

  std::array<Axis, N> axis;
  double lap = 2.0 * kPi;

  [[nodiscard]] double period() const noexcept { return lap; }
  [[nodiscard]] static constexpr bool closed() noexcept { return true; }

  template <Real T>
  [[nodiscard]] Vec<T, N> point(const T& phi) const noexcept {
    Vec<T, N> q;
    T wave(0.0);
    const Harmonic* last = nullptr;
    for (std::size_t i = 0; i < N; ++i) {
      q[i] = T(axis[i].offset);
      for (const Harmonic& h : axis[i].terms) {
        // Axes of one contour often share harmonics, and the cosine takes most of the time.
        if (last == nullptr || h.order != last->order || h.phase != last->phase)
          wave = cos(h.order * phi + T(h.phase));
        last = &h;
        q[i] = q[i] + h.amplitude * wave;
      }
    }
    return q;
  }
};

}  // namespace stribeck::path
