#pragma once
/// The packed drives for each instruction set, and the widest that this computer has.
/// Real time: no.

#include <optional>
#include <stribeck/plant/packed/lane_block.hpp>
#include <string_view>
#include <vector>

namespace stribeck::plant {

/// Each in a file of its own, which is compiled for the instruction set.
PackedDrive packed_avx512();
PackedDrive packed_avx2();
PackedDrive packed_baseline();

struct InstructionSet {
  std::string_view name;
  PackedDrive drive;
};

/// Those that this computer has, the widest first; none where drives advance one by one.
const std::vector<InstructionSet>& instruction_sets();

}  // namespace stribeck::plant
