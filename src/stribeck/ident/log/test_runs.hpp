#pragma once
/// Records at constant speeds, for the tests of this folder. Included by tests only.

#include <cmath>
#include <functional>
#include <random>
#include <stribeck/ident/log/record.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::test {

/// Ten speeds, each forward and back, with friction F(v); with `two_lengths` the slow runs are eight times as long.
inline std::vector<log::Record> steady_runs(const std::function<double(double)>& friction, bool two_lengths) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  std::vector<log::Record> out;
  for (const double speed : {1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 10e-3, 20e-3, 30e-3, 40e-3, 60e-3}) {
    for (const double sign : {1.0, -1.0}) {
      log::Record r;
      r.source = "run";
      r.sample_time = 0.015;
      const std::size_t rows = two_lengths && speed < 4.5e-3 ? 2667 : 334;
      for (std::size_t k = 0; k < rows; ++k) {
        const double t = 0.015 * static_cast<double>(k);
        r.t.push_back(t);
        r.x.push_back(sign * speed * t);
        r.f.push_back(sign * friction(speed) + 30.0 * std::sin(r.x.back()) + 0.1 * normal(engine));
      }
      out.push_back(std::move(r));
    }
  }
  return out;
}

}  // namespace stribeck::ident::test
