#include <stribeck/plant/packed/instruction_sets.hpp>

#if STRIBECK_PACKS
#include <xsimd/xsimd.hpp>
#endif

namespace stribeck::plant {

const std::vector<InstructionSet>& instruction_sets() {
  static const std::vector<InstructionSet> found = [] {
    std::vector<InstructionSet> all;
#if STRIBECK_PACKS
    const auto computer = xsimd::available_architectures();
#if STRIBECK_PACKS_AVX
    if (computer.avx512dq) all.push_back({"AVX-512", packed_avx512()});
    if (computer.avx2) all.push_back({"AVX2", packed_avx2()});
#endif
#if defined(__aarch64__)
    if (computer.neon64) all.push_back({"NEON", packed_baseline()});
#else
    if (computer.sse2) all.push_back({"SSE2", packed_baseline()});
#endif
#endif
    return all;
  }();
  return found;
}

}  // namespace stribeck::plant
