#pragma once
/// Designs of experiments: shares u in (0, 1) for sample n and dimension d, each computed alone. No list of samples is kept, so that
/// memory does not grow with their number and any sample can be made again.
///
///   random            independent
///   latin-hypercube   every dimension has one share in each of N equal parts; parts paired at random
///   sobol             Sobol' sequence, moved by a random shift of its binary digits; best with N a power of two
///
/// Shares depend on (seed, n, d) alone, for latin-hypercube also on N.
/// Source: Bratley, Fox 1988, doi:10.1145/42288.214372, with the directions of Joe and Kuo 2008 (Boost.Random); Kensler 2013,
/// Correlated Multi-Jittered Sampling, Pixar 13-01 (permutation); Steele et al. 2014, doi:10.1145/2660193.2660195 (mixing).
/// Real time: no.

#include <cstdint>
#include <stribeck/core/fields.hpp>
#include <vector>

namespace stribeck::sim {

enum class Sampling { kRandom, kLatinHypercube, kSobol, kGrid };

/// Most samples of a design.
inline constexpr std::uint64_t kMostSamples = 1'000'000'000;

/// 64 random bits for these numbers, the same on every platform.
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t a, std::uint64_t b) noexcept;
/// Uniform in (0, 1), with 52 bits.
double random_share(std::uint64_t seed, std::uint64_t a, std::uint64_t b) noexcept;

class Design {
 public:
  /// Not for kGrid, which has no shares. At most 200 dimensions.
  Design(Sampling sampling, std::uint64_t samples, std::size_t dimensions, std::uint64_t seed);

  [[nodiscard]] double share(std::uint64_t sample, std::size_t dimension) const noexcept;

 private:
  Sampling sampling_;
  std::uint64_t samples_;
  std::uint64_t seed_;
  std::vector<std::uint64_t> directions_;  ///< of Sobol', kBits for each dimension
};

}  // namespace stribeck::sim

template <>
struct stribeck::EnumNames<stribeck::sim::Sampling> {
  using enum stribeck::sim::Sampling;
  static constexpr std::array names{std::pair{kRandom, std::string_view{"random"}},
                                    std::pair{kLatinHypercube, std::string_view{"latin-hypercube"}},
                                    std::pair{kSobol, std::string_view{"sobol"}},
                                    std::pair{kGrid, std::string_view{"grid"}}};
};
