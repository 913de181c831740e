#include <stribeck/plant/packed/instruction_sets.hpp>
#include <stribeck/plant/packed/packed_period.hpp>

namespace stribeck::plant {

PackedDrive packed_avx512() { return packed_drive<xsimd::avx512dq>(); }

}  // namespace stribeck::plant
