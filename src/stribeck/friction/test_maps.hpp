#pragma once
/// Maps for the tests of this folder and of others: Table 2.3 of the thesis, and a flat level.

#include <initializer_list>
#include <stribeck/friction/gaussian.hpp>

namespace stribeck::friction::test {

/// Branch from the units of the table: N, N·s/mm, mm/s.
template <Real T = double>
GaussianBranch<T> branch(double eta0, double eta1, std::initializer_list<std::array<double, 3>> terms) {
  GaussianBranch<T> b{T(eta0), T(eta1 * 1e3), {}};
  for (const auto& t : terms) b.gaussians.push_back({T(t[0]), T(t[1] * 1e-3), T(t[2] * 1e-3)});
  return b;
}

template <Real T = double>
Gaussian<T> table_2_3_x() {
  return {
      branch<T>(768.6, 102.48, {{517.4, 1.763, 3.091}, {509.3, 5.806, 1.825}, {1995.9, 10.668, 1.876}}),
      branch<T>(-768.6, 102.48, {{-378.2, -2.163, 2.265}, {-547.5, -5.912, 1.761}, {-4472, -13.99, 3.659}}),
      {-9.5e-3, 9.5e-3}};
}

template <Real T = double>
Gaussian<T> table_2_3_y() {
  return {branch<T>(640.5, 140.91, {{518.0, 1.766, 1.986}, {852.0, 5.872, 2.733}, {1059.1, 10.27, 1.744}}),
          branch<T>(-640.5, 140.91,
                    {{-371.34, -1.963, 2.997}, {-236.1, -5.804, 1.223}, {-354.97, -9.311, 0.475}}),
          {-9.5e-3, 9.5e-3}};
}

/// The same level [N] at every velocity, nothing else.
struct Flat {
  double level = 1000.0;
  [[nodiscard]] SteadyParts<double> parts(double, double) const noexcept { return {level, 0.0, 0.0}; }
};

}  // namespace stribeck::friction::test
