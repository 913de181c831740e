#pragma once
/// Numbers for tests that are the same everywhere.
///
/// For tests only.

#include <cstdint>

namespace stribeck::test {

/// Numbers between -1 and 1, the same for a seed on every machine.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 40) * 0x1p-23 - 1.0;
  }

 private:
  std::uint64_t state_;
};

}  // namespace stribeck::test
