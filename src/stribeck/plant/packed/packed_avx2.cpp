#include <stribeck/plant/packed/instruction_sets.hpp>
#include <stribeck/plant/packed/packed_period.hpp>

namespace stribeck::plant {

PackedDrive packed_avx2() { return packed_drive<xsimd::avx2>(); }

}  // namespace stribeck::plant
