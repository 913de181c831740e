#include <bit>
#include <boost/random/sobol.hpp>
#include <stribeck/sim/uncertainty/design.hpp>

namespace stribeck::sim {
namespace {

/// Digits of a sample's number that count.
constexpr std::size_t kBits = 32;

/// Separate the uses of one seed.
constexpr std::uint64_t kPlace = 0x706c616365;
constexpr std::uint64_t kOrder = 0x6f72646572;
constexpr std::uint64_t kShift = 0x7368696674;

std::uint64_t mixed(std::uint64_t z) noexcept {
  z += 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

/// In the middle between two multiples of 2⁻⁵², which a double holds exactly: never 0 or 1.
double share_of(std::uint64_t bits) noexcept { return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52; }

/// Place of i in a random order of [0, n), 0 < n < 2³²; another order for each key.
std::uint32_t place_of(std::uint32_t i, std::uint32_t n, std::uint32_t key) noexcept {
  const std::uint32_t w = n <= 1 ? 0 : 0xffffffffU >> std::countl_zero(n - 1);
  do {
    i ^= key;
    i *= 0xe170893dU;
    i ^= key >> 16;
    i ^= (i & w) >> 4;
    i ^= key >> 8;
    i *= 0x0929eb3fU;
    i ^= key >> 23;
    i ^= (i & w) >> 1;
    i *= 1U | key >> 27;
    i *= 0x6935fa69U;
    i ^= (i & w) >> 11;
    i *= 0x74dcb303U;
    i ^= (i & w) >> 2;
    i *= 0x9e501cc3U;
    i ^= (i & w) >> 2;
    i *= 0xc860a3dfU;
    i &= w;
    i ^= i >> 5;
  } while (i >= n);
  return static_cast<std::uint32_t>((static_cast<std::uint64_t>(i) + key) % n);
}

}  // namespace

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t a, std::uint64_t b) noexcept {
  return mixed(mixed(mixed(seed) ^ a) ^ b);
}

double random_share(std::uint64_t seed, std::uint64_t a, std::uint64_t b) noexcept {
  return share_of(random_bits(seed, a, b));
}

Design::Design(Sampling sampling, std::uint64_t samples, std::size_t dimensions, std::uint64_t seed)
    : sampling_(sampling), samples_(samples), seed_(seed) {
  if (sampling != Sampling::kSobol || dimensions == 0) return;
  // Sample n is the sum without carry of the directions at the digits of n's Gray code; n = 2^(k+1) − 1 has the digit k alone.
  directions_.resize(kBits * dimensions);
  boost::random::sobol sequence(dimensions);
  for (std::size_t k = 0; k < kBits; ++k) {
    sequence.seed((std::uint64_t{2} << k) - 2);  // Boost leaves out sample 0
    for (std::size_t d = 0; d < dimensions; ++d) directions_[kBits * d + k] = sequence();
  }
}

double Design::share(std::uint64_t sample, std::size_t dimension) const noexcept {
  switch (sampling_) {
    case Sampling::kLatinHypercube: {
      const auto key = static_cast<std::uint32_t>(random_bits(seed_, kOrder, dimension));
      const auto place =
          place_of(static_cast<std::uint32_t>(sample), static_cast<std::uint32_t>(samples_), key);
      const double within = random_share(seed_ ^ kPlace, sample, dimension);
      const double u = (place + within) / static_cast<double>(samples_);
      return u < 1.0 ? u : 1.0 - 0x1p-53;
    }
    case Sampling::kSobol: {
      std::uint64_t bits = random_bits(seed_, kShift, dimension);
      for (std::uint64_t gray = sample ^ (sample >> 1); gray != 0; gray &= gray - 1)
        bits ^= directions_[kBits * dimension + static_cast<std::size_t>(std::countr_zero(gray))];
      return share_of(bits);
    }
    case Sampling::kRandom:
    case Sampling::kGrid:
      break;
  }
  return random_share(seed_ ^ kPlace, sample, dimension);
}

}  // namespace stribeck::sim
