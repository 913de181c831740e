#pragma once
/// A log of strokes for the tests of this folder. Included by tests only.

#include <cmath>
#include <cstdint>
#include <random>
#include <stribeck/ident/log/condition.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::test {

/// Trapezoids of 100 mm at 40, 80 and 120 mm/s and 0.8 m/s², 1 ms, m = 100 kg, F = 20 N, c = 200 N s/m. The position
/// follows its reference by 6 ms and has an encoder of 50 nm.
inline log::RawLog strokes(std::uint64_t seed, bool reference) {
  constexpr double kStroke = 0.1, kRate = 0.8, kStep = 1e-3, kLag = 6e-3;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> speeds;
  for (int turn = 0; turn < 6; ++turn)
    speeds.push_back((turn % 2 == 0 ? 1.0 : -1.0) * (0.04 + 0.04 * (turn / 2)));
  std::vector<double> r, v, a;
  double at = 0.0;
  const auto add = [&](double speed, double rate) {
    r.push_back(at), v.push_back(speed), a.push_back(rate);
    at += kStep * speed;
  };
  for (const double top : speeds) {
    const double sign = top > 0.0 ? 1.0 : -1.0;
    const int ramp = static_cast<int>(std::round(std::abs(top) / kRate / kStep));
    const int even = static_cast<int>(std::round((kStroke / std::abs(top)) / kStep)) - ramp;
    for (int k = 0; k < ramp; ++k) add(sign * kRate * kStep * k, sign * kRate);
    for (int k = 0; k < even; ++k) add(top, 0.0);
    for (int k = 0; k < ramp; ++k) add(top - sign * kRate * kStep * k, -sign * kRate);
    for (int k = 0; k < 150; ++k) add(0.0, 0.0);
  }
  const auto lag = static_cast<std::size_t>(std::round(kLag / kStep));
  log::RawLog log;
  log.source = "log.csv";
  for (std::size_t k = lag; k < r.size(); ++k) {
    const std::size_t i = k - lag;
    log.x.t.push_back(kStep * static_cast<double>(i));
    log.x.y.push_back(5e-8 * std::round((r[i] + 3e-8 * normal(engine)) / 5e-8));
    if (reference) log.r.y.push_back(r[k]);
    const double friction = v[i] == 0.0 ? 0.0 : std::copysign(20.0, v[i]);
    log.f.y.push_back(100.0 * a[i] + 200.0 * v[i] + friction + 0.5 * normal(engine));
  }
  return log;
}

inline std::vector<std::string> kinds(const log::Conditioned& c) {
  std::vector<std::string> out;
  for (const log::Finding& f : c.findings) out.push_back(f.kind);
  return out;
}

inline std::string texts(const log::Conditioned& c) {
  std::string out;
  for (const log::Finding& f : c.findings) out += f.kind + ": " + f.text + "\n";
  return out;
}

}  // namespace stribeck::ident::test
