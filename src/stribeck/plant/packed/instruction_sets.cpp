#include <stribeck/plant/packed/instruction_sets.hpp>

namespace stribeck::plant {

const std::vector<InstructionSet>& instruction_sets() {
  static const std::vector<InstructionSet> found = [] {
    std::vector<InstructionSet> all;
#if STRIBECK_PACKS_AVX
    // Asked of the compiler's library, which also looks whether the system keeps the wide registers.
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512cd"))
      all.push_back({"AVX-512", packed_avx512()});
    if (__builtin_cpu_supports("avx2")) all.push_back({"AVX2", packed_avx2()});
#endif
#if STRIBECK_PACKS
      // Every processor of these kinds has it.
#if defined(__aarch64__)
    all.push_back({"NEON", packed_baseline()});
#else
    all.push_back({"SSE2", packed_baseline()});
#endif
#endif
    return all;
  }();
  return found;
}

}  // namespace stribeck::plant
