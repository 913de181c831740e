#pragma once
/// Force noise, one value per control period.
///
///   gaussian   n_{k+1} = ρ·n_k + rms·√(1 − ρ²)·g_k,   ρ = exp(−T/correlation time),   g_k standard normal;
///              n_0 from the stationary law
///   uniform    n_k = √3·rms·(2·w_k − 1),   w_k uniform in [0, 1)
///
/// Seeded and local: a stream depends on (seed, trial, axis) and nothing else, so that every controller of a
/// trial meets the same noise. Boost.Random, because the sequence of std::normal_distribution is not fixed by
/// the standard.
/// Real time: configure only (the generator's state is large).

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstdint>
#include <random>
#include <stribeck/plant/params.hpp>

namespace stribeck::plant {

/// Identifies a random stream.
struct Stream {
  std::uint64_t seed = 1;
  std::uint32_t trial = 0;
  std::uint32_t axis = 0;
};

class NoiseSource {
 public:
  NoiseSource() = default;
  NoiseSource(const ForceNoise& noise, double period, const Stream& stream)
      : rms_(noise.rms),
        uniform_(noise.distribution == NoiseKind::kUniform),
        pole_(uniform_ ? 0.0 : std::exp(-period / noise.correlation_time)) {
    std::seed_seq sequence{static_cast<std::uint32_t>(stream.seed),
                           static_cast<std::uint32_t>(stream.seed >> 32), stream.trial, stream.axis};
    generator_.seed(sequence);
    value_ = uniform_ ? draw_uniform() : rms_ * normal_(generator_);
    drive_ = rms_ * std::sqrt(1.0 - pole_ * pole_);
  }

  /// The force of the coming period [N].
  double next() {
    const double now = value_;
    if (rms_ > 0.0) value_ = uniform_ ? draw_uniform() : pole_ * value_ + drive_ * normal_(generator_);
    return now;
  }

 private:
  /// 53 random bits, the same on every platform.
  double draw_uniform() {
    return std::sqrt(3.0) * rms_ * (static_cast<double>(generator_() >> 11) * 0x1p-52 - 1.0);
  }

  boost::random::mt19937_64 generator_;
  boost::random::normal_distribution<double> normal_;
  double rms_ = 0.0;
  bool uniform_ = false;
  double pole_ = 0.0;
  double drive_ = 0.0;
  double value_ = 0.0;
};

}  // namespace stribeck::plant
