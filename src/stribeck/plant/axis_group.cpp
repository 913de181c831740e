#include <stdexcept>
#include <stribeck/plant/axis_group.hpp>
#include <stribeck/plant/axis_parts.hpp>
#include <stribeck/plant/packed/instruction_sets.hpp>
#include <utility>

namespace stribeck::plant {
namespace {

/// With fewer drives than this a pack is mostly empty.
constexpr std::size_t kFewestInBlock = 4;

template <bool kVoltage, bool kMode>
using PackedMechanics = Mechanics<AxisMap, friction::LuGre<double>, kVoltage, kMode>;

/// Kinds of drives that a block may hold together.
struct BlockKind {
  bool voltage = false;
  bool mode = false;
  bool fades = false;  ///< bristle damping that fades with speed

  friend bool operator==(const BlockKind&, const BlockKind&) = default;
};

AdvanceLanes function_for(const PackedDrive& drive, const BlockKind& kind) {
  if (kind.voltage) return kind.mode ? drive.voltage_mode : drive.voltage;
  return kind.mode ? drive.current_mode : drive.current;
}

/// Calls act(mechanics, kind) for mechanics that fit into a block.
template <class Act>
void if_packed(AnyMechanics<AxisMap>& any, Act&& act) {
  const auto try_kind = [&]<bool kVoltage, bool kMode>() {
    auto* m = std::get_if<PackedMechanics<kVoltage, kMode>>(&any);
    if (m == nullptr || !m->map().eccentric.empty() || !m->map().places.empty() || m->map().spring) return;
    act(*m, BlockKind{kVoltage, kMode, m->law().damping_velocity.has_value()});
  };
  try_kind.template operator()<false, false>();
  try_kind.template operator()<false, true>();
  try_kind.template operator()<true, false>();
  try_kind.template operator()<true, true>();
}

/// Position of p behind `from`, in doubles; the two may belong to different axes.
std::int64_t doubles_between(const double* from, const double* p) {
  const auto bytes = reinterpret_cast<std::intptr_t>(p) - reinterpret_cast<std::intptr_t>(from);
  return bytes / static_cast<std::intptr_t>(sizeof(double));
}

template <class M>
void read_state(M& m, const LaneBlock& block, std::size_t lane) {
  for (std::size_t k = 0; k < M::kStates; ++k) m.state()[k] = block.state[k][lane];
}
template <class M>
void write_state(M& m, LaneBlock& block, std::size_t lane) {
  for (std::size_t k = 0; k < M::kStates; ++k) block.state[k][lane] = m.state()[k];
}

template <class M>
void substep_alone(void* drive, LaneBlock& block, std::size_t lane, double h) {
  M& m = *static_cast<M*>(drive);
  read_state(m, block, lane);
  block.spare[lane] = m.substep_alone({block.voltage[lane], block.force[lane], block.cutting[lane]}, h,
                                      block.level[lane], block.spare[lane]);
  write_state(m, block, lane);
}

/// Puts a drive into a lane. The first drive of a block comes first.
template <class M>
void fill(LaneBlock& block, std::size_t lane, M& m, int substeps) {
  if (block.tables == nullptr) block.tables = m.map().base.side(0).cells;
  write_state(m, block, lane);
  block.substeps[lane] = substeps;
  constexpr auto kValues = M::Equations::values();
  for (std::size_t i = 0; i < kValues.size(); ++i) block.value[i][lane] = m.equations().*kValues[i];
  block.sigma0[lane] = m.law().sigma0;
  block.sigma1[lane] = m.law().sigma1;
  block.fades = m.law().damping_velocity.has_value();
  block.damping_velocity[lane] = m.law().damping_velocity.value_or(0.0);
  for (const std::size_t side : {0U, 1U}) {
    const friction::Table::Side of = m.map().base.side(side);
    block.side[side].scale[lane] = of.scale;
    block.side[side].viscous[lane] = of.viscous;
    block.side[side].cells[lane] = doubles_between(block.tables, of.cells);
    block.side[side].border[lane] = doubles_between(block.tables, of.border);
  }
  block.drive[lane] = &m;
  block.substep_alone = &substep_alone<M>;
}

}  // namespace

struct AxisGroup::Blocks {
  struct Member {
    Axis::Implementation* axis = nullptr;
    std::size_t index = 0;  ///< among all axes
  };
  struct Block {
    BlockKind kind;
    AdvanceLanes advance = nullptr;
    std::vector<Member> members;
    std::unique_ptr<LaneBlock> lanes = std::make_unique<LaneBlock>();
  };

  Blocks(std::vector<Axis*> given, const InstructionSet* with) : axes(std::move(given)) {
    if (!axes.empty()) period = axes.front()->implementation_->period;
    for (const Axis* a : axes) {
      if (a->implementation_->period != period)
        throw std::invalid_argument("the drives of a group need one control period");
    }
    for (std::size_t i = 0; i < axes.size(); ++i) {
      Axis::Implementation& axis = *axes[i]->implementation_;
      bool fits = false;
      if (with != nullptr && !axis.loop && axis.params.delay_fraction.value_or(0.0) <= 0.0 && !axis.varies())
        if_packed(axis.mechanics, [&](auto&, const BlockKind& kind) {
          fits = true;
          block_for(kind, with->drive).members.push_back({&axis, i});
        });
      if (!fits) alone.push_back(i);
    }
    for (auto b = blocks.begin(); b != blocks.end();) {
      if (b->members.size() >= kFewestInBlock) {
        fill_lanes(*b++);
        continue;
      }
      for (const Member& m : b->members) alone.push_back(m.index);
      b = blocks.erase(b);
    }
  }

  Block& block_for(const BlockKind& kind, const PackedDrive& drive) {
    for (Block& b : blocks) {
      if (b.kind == kind && b.members.size() < LaneBlock::kLanes) return b;
    }
    Block& b = blocks.emplace_back();
    b.kind = kind;
    b.advance = function_for(drive, kind);
    return b;
  }

  /// Lanes without a drive repeat the first one.
  static void fill_lanes(Block& b) {
    for (std::size_t lane = 0; lane < LaneBlock::kLanes; ++lane) {
      Axis::Implementation& axis = *b.members[lane < b.members.size() ? lane : 0].axis;
      if_packed(axis.mechanics,
                [&](auto& m, const BlockKind&) { fill(*b.lanes, lane, m, axis.fidelity.substeps); });
    }
  }

  void step(Block& b, std::span<const AxisInput> inputs) const {
    LaneBlock& lanes = *b.lanes;
    for (std::size_t lane = 0; lane < b.members.size(); ++lane) {
      const AxisInput& in = inputs[b.members[lane].index];
      const Held held = b.members[lane].axis->held(in.command, in.cutting);
      lanes.voltage[lane] = held.voltage;
      lanes.force[lane] = held.force;
      lanes.cutting[lane] = held.cutting;
    }
    for (std::size_t lane = b.members.size(); lane < LaneBlock::kLanes; ++lane) {
      lanes.voltage[lane] = lanes.voltage[0];
      lanes.force[lane] = lanes.force[0];
      lanes.cutting[lane] = lanes.cutting[0];
    }
    b.advance(lanes, period);
    for (std::size_t lane = 0; lane < b.members.size(); ++lane)
      if_packed(b.members[lane].axis->mechanics,
                [&](auto& m, const BlockKind&) { read_state(m, lanes, lane); });
  }

  /// Two at a time, which is faster, where both have no loop of their own.
  void step_alone(std::span<const AxisInput> inputs) const {
    for (std::size_t k = 0; k < alone.size(); ++k) {
      const std::size_t i = alone[k];
      const std::size_t j = k + 1 < alone.size() ? alone[k + 1] : i;
      if (j != i && !axes[i]->has_loop() && !axes[j]->has_loop()) {
        Axis::step_together(*axes[i], inputs[i].command, *axes[j], inputs[j].command, inputs[i].cutting,
                            inputs[j].cutting);
        ++k;
      } else {
        axes[i]->step(inputs[i].command, inputs[i].cutting, inputs[i].offset);
      }
    }
  }

  std::vector<Axis*> axes;
  std::vector<std::size_t> alone;
  std::vector<Block> blocks;
  double period = 0.0;
};

AxisGroup::AxisGroup(std::vector<Axis*> axes, const InstructionSet* with)
    : blocks_(std::make_unique<Blocks>(std::move(axes), with)) {}
AxisGroup::AxisGroup(std::vector<Axis*> axes)
    : AxisGroup(std::move(axes), instruction_sets().empty() ? nullptr : &instruction_sets().front()) {}
AxisGroup::~AxisGroup() = default;
AxisGroup::AxisGroup(AxisGroup&&) noexcept = default;
AxisGroup& AxisGroup::operator=(AxisGroup&&) noexcept = default;

void AxisGroup::step(std::span<const AxisInput> inputs) {
  for (Blocks::Block& b : blocks_->blocks) blocks_->step(b, inputs);
  blocks_->step_alone(inputs);
}

std::size_t AxisGroup::packed() const { return blocks_->axes.size() - blocks_->alone.size(); }

}  // namespace stribeck::plant
