#pragma once
/// A log with exact motion and a force by formula, for the tests of the steps: the right answer is known to the last digit.
/// Included by tests only.

#include <cmath>
#include <functional>
#include <memory>
#include <stribeck/ident/drive/aligned_log.hpp>
#include <vector>

namespace stribeck::ident::test {

struct SyntheticLog {
  std::unique_ptr<std::vector<log::Record>> records = std::make_unique<std::vector<log::Record>>();
  drive::AlignedLog log;
};

/// x = 0.1·sin t + second·sin 7.3t m over 40 s, 1000 rows a second; force(x, v, a) in N.
inline SyntheticLog synthetic_log(const std::function<double(double, double, double)>& force,
                                  double second = 0.003) {
  constexpr double kTime = 40.0, kStep = 1e-3, kFast = 7.3;
  log::Record rec;
  log::Motion m;
  rec.source = "formula";
  rec.sample_time = m.sample_time = kStep;
  m.loop = log::Loop::kAutomatic;
  int stretch = 0;
  double reversal = 0.0;
  for (double t = 0.0; t < kTime; t += kStep) {
    const double x = 0.1 * std::sin(t) + second * std::sin(kFast * t);
    const double v = 0.1 * std::cos(t) + second * kFast * std::cos(kFast * t);
    const double a = -0.1 * std::sin(t) - second * kFast * kFast * std::sin(kFast * t);
    const auto direction = static_cast<std::int8_t>(v > 0.0 ? 1 : -1);
    if (!m.direction.empty() && direction != m.direction.back()) {
      ++stretch;
      reversal = x;
      m.reversals.push_back(m.rows());
    }
    m.x.push_back(x), m.v.push_back(v), m.a.push_back(a), m.instrument.push_back(a);
    m.direction.push_back(direction), m.stretch.push_back(stretch);
    m.distance.push_back(std::abs(x - reversal));
    m.f.push_back(force(x, v, a));
    rec.t.push_back(t), rec.x.push_back(x), rec.f.push_back(m.f.back());
  }
  m.stroke = 0.2 + 2.0 * second;
  m.reach = 1;
  SyntheticLog out;
  out.records->push_back(std::move(rec));
  out.log.records = *out.records;
  out.log.force.push_back(m.f);
  out.log.predicted.emplace_back();
  out.log.motions.push_back(std::move(m));
  return out;
}

}  // namespace stribeck::ident::test
