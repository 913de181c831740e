#pragma once
/// First-order coloured noise, one value per control period.
///
///   n_{k+1} = ρ·n_k + rms·√(1 − ρ²)·g_k,   ρ = exp(−T/correlation time),   g_k standard normal; n_0 from the
///   stationary law
///
/// Seeded and local: a stream depends on (seed, trial, axis) and nothing else, so that every controller of a
/// trial meets the same noise. Boost.Random, because the sequence of std::normal_distribution is not fixed by
/// the standard.
/// Real time: configure only (the generator's state is large).

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cstdint>
#include <random>
#include <stribeck/plant/params.hpp>

namespace stribeck::plant {

/// Names a random stream.
struct Stream {
  std::uint64_t seed = 1;
  std::uint32_t trial = 0;
  std::uint32_t axis = 0;
};

class NoiseSource {
 public:
  NoiseSource() = default;
  NoiseSource(const ForceNoise& noise, double period, const Stream& stream)
      : rms_(noise.rms), pole_(std::exp(-period / noise.correlation_time)) {
    std::seed_seq sequence{static_cast<std::uint32_t>(stream.seed),
                           static_cast<std::uint32_t>(stream.seed >> 32), stream.trial, stream.axis};
    generator_.seed(sequence);
    value_ = rms_ * normal_(generator_);
    drive_ = rms_ * std::sqrt(1.0 - pole_ * pole_);
  }

  /// The force of the coming period [N].
  double next() {
    const double now = value_;
    if (rms_ > 0.0) value_ = pole_ * value_ + drive_ * normal_(generator_);
    return now;
  }

 private:
  boost::random::mt19937_64 generator_;
  boost::random::normal_distribution<double> normal_;
  double rms_ = 0.0;
  double pole_ = 0.0;
  double drive_ = 0.0;
  double value_ = 0.0;
};

}  // namespace stribeck::plant
