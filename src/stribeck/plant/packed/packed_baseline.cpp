#include <stribeck/plant/packed/instruction_sets.hpp>
#include <stribeck/plant/packed/packed_period.hpp>

namespace stribeck::plant {

#if defined(__aarch64__)
PackedDrive packed_baseline() { return packed_drive<xsimd::neon64>(); }
#else
PackedDrive packed_baseline() { return packed_drive<xsimd::sse2>(); }
#endif

}  // namespace stribeck::plant
