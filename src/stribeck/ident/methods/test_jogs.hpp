#pragma once
/// Jogs with known friction, for the tests of this folder. Included by tests only.

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::test {

inline constexpr double kPeriod = 0.005;
inline constexpr excitation::Limits kTable{-0.075, 0.075, 0.010, 0.2, 10480.0};

/// Motion forward and back at each speed with rests and ramps between, and the force of the given friction; the axis has no mass.
inline log::Record ideal(const std::vector<double>& speeds,
                         const std::function<double(double, double)>& friction, double noise = 0.0,
                         std::uint64_t seed = 1) {
  excitation::JogDesign design;
  design.speeds = speeds;
  log::Record r;
  r.source = "ideal";
  r.sample_time = kPeriod;
  r.r = excitation::design_jog(kTable, kPeriod, design).r;
  r.x = r.r;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < r.r.size(); ++k) {
    r.t.push_back(kPeriod * static_cast<double>(k));
    const double v = k + 1 < r.r.size() ? (r.r[k + 1] - r.r[k]) / kPeriod : 0.0;
    r.f.push_back((v == 0.0 ? 0.0 : friction(v, r.x[k])) + noise * normal(engine));
  }
  return r;
}

inline double printed(double v, double load) {  // Table 4.2, x
  const double s = v > 0.0 ? 1.0 : -1.0;
  return load + s * (20.0 + 15.0 * std::exp(-std::pow(v / 0.6e-3, 2.0))) + 5000.0 * v;
}

}  // namespace stribeck::ident::test
