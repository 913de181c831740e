#pragma once
/// Many virtual drives that move through the same control periods, of one machine or of many: those with LuGre friction advance several
/// at a time, in the packs of the computer's processor (packed/), the others one by one. The states of every drive are the bits that it
/// would have alone.
///
/// Measured with bench/closed_loop_bench.cpp; docs/decisions/0022-packs.md.
/// Real time: no (the constructor allocates; step() does not).

#include <memory>
#include <span>
#include <stribeck/plant/axis.hpp>
#include <vector>

namespace stribeck::plant {

struct InstructionSet;

/// What Axis::step() takes.
struct AxisInput {
  double command = 0.0;
  double cutting = 0.0;
  double offset = 0.0;
};

class AxisGroup {
 public:
  /// The axes must outlive the group, and must have been started; after another start() make another group. with: null for no packs.
  /// std::invalid_argument where their control periods differ.
  AxisGroup(std::vector<Axis*> axes, const InstructionSet* with);
  /// With the widest packs of this computer.
  explicit AxisGroup(std::vector<Axis*> axes);
  ~AxisGroup();
  AxisGroup(AxisGroup&&) noexcept;
  AxisGroup& operator=(AxisGroup&&) noexcept;

  /// One control period of all axes, in the order of the constructor.
  void step(std::span<const AxisInput> inputs);

  /// How many of them advance in packs.
  [[nodiscard]] std::size_t packed() const;

 private:
  struct Blocks;
  std::unique_ptr<Blocks> blocks_;
};

}  // namespace stribeck::plant
