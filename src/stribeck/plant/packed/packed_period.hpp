#pragma once
/// One control period of several drives with LuGre friction at a time. Every lane gets the bits that Mechanics (mechanics.hpp)
/// would get alone: the same equations, law, table and order of operations, with a select() where it branches.
///
/// Two packs advance alternately, because their chains of arithmetic do not wait for each other. Lanes that need fewer sub-steps
/// than others stand still in the meantime. A sub-step that must be divided is rare: the lane takes it alone, by
/// Mechanics::substep_alone().
/// Not modelled: other laws, places, periodic terms, springs, lost motion; such drives advance one by one (axis_group.hpp).
/// Real time: safe.

#include <array>
#include <stribeck/core/vec.hpp>
#include <stribeck/friction/lugre.hpp>
#include <stribeck/friction/table.hpp>
#include <stribeck/plant/drive_equations.hpp>
#include <stribeck/plant/integrator.hpp>
#include <stribeck/plant/packed/lane_block.hpp>
#include <stribeck/plant/packed/pack.hpp>

namespace stribeck::plant {

template <class Arch, bool kVoltage, bool kMode>
class PackedPeriod {
 public:
  static void advance(LaneBlock& block, double dt) {
    constexpr std::size_t kTogether = 2 * T::kLanes;
    static_assert(LaneBlock::kLanes % kTogether == 0);
    for (std::size_t from = 0; from < LaneBlock::kLanes; from += kTogether) {
      PackedPeriod a(block, from);
      PackedPeriod b(block, from + T::kLanes);
      const int most_a = a.begin(dt);
      const int most_b = b.begin(dt);
      const int most = most_a < most_b ? most_b : most_a;
      for (int i = 0; i < most; ++i) {
        a.substep(i);
        b.substep(i);
      }
      a.store_state();
      b.store_state();
    }
  }

 private:
  using T = Pack<Arch>;
  using Mask = typename T::Mask;
  using Integers = typename T::Integers;
  using Equations = DriveEquations<T, 1, kVoltage, kMode>;
  using State = Vec<T, Equations::kStates>;

  /// One cell of the table in each lane.
  struct Cell {
    T c0, c1, c2, c3, left, scale, viscous;

    [[nodiscard]] friction::SteadyParts<T> parts(const T& v) const {
      return {friction::Table::cubic(c0, c1, c2, c3, abs(v) * scale - left), viscous * v, T(0.0)};
    }
    [[nodiscard]] static Cell chosen(const Mask& where, const Cell& a, const Cell& b) {
      return {select(where, a.c0, b.c0),          select(where, a.c1, b.c1),
              select(where, a.c2, b.c2),          select(where, a.c3, b.c3),
              select(where, a.left, b.left),      select(where, a.scale, b.scale),
              select(where, a.viscous, b.viscous)};
    }
  };

  PackedPeriod(LaneBlock& block, std::size_t from) : block_(block), from_(from) {
    load_state();
    held_ = {row(block.voltage), row(block.force), row(block.cutting)};
    constexpr auto kValues = Equations::values();
    static_assert(kValues.size() == LaneBlock::kValues && Equations::kStates <= LaneBlock::kMostStates);
    for (std::size_t i = 0; i < kValues.size(); ++i) equations_.*kValues[i] = row(block.value[i]);
    law_.sigma0 = row(block.sigma0);
    law_.sigma1 = row(block.sigma1);
    if (block.fades) law_.damping_velocity = row(block.damping_velocity);
  }

  [[nodiscard]] T row(const LaneBlock::Row<double>& values) const { return T::load(values.data() + from_); }
  [[nodiscard]] Integers row(const LaneBlock::Row<std::int64_t>& values) const {
    return Integers::load_unaligned(values.data() + from_);
  }
  void load_state() {
    for (std::size_t i = 0; i < Equations::kStates; ++i) y_[i] = row(block_.state[i]);
  }
  void store_state() const {
    for (std::size_t i = 0; i < Equations::kStates; ++i) y_[i].store(block_.state[i].data() + from_);
  }

  /// As Table::near.
  [[nodiscard]] Cell near(const T& v) const {
    using friction::Table;
    const Mask negative = v < T(0.0);
    const LaneBlock::Side& plus = block_.side[0];
    const LaneBlock::Side& minus = block_.side[1];
    Cell cell;
    cell.scale = select(negative, row(minus.scale), row(plus.scale));
    cell.viscous = select(negative, row(minus.viscous), row(plus.viscous));
    const Integers first = select_integers<Arch>(negative, row(minus.cells), row(plus.cells));
    const Integers border = select_integers<Arch>(negative, row(minus.border), row(plus.border));
    const T u = abs(v) * cell.scale;
    const Mask inside = u < T(Table::kHighest);
    const Mask lowest = u < T(Table::kLowest);
    const auto number = u.high_bits(Table::kShift);
    const auto four_each = (number - typename T::Unsigned(Table::kFirst - 1)) << 2;
    Integers at = first + xsimd::bitwise_cast<Integers>(four_each);
    cell.left = select(lowest, T(0.0), T::of_bits(number << Table::kShift));
    at = select_integers<Arch>(lowest, first, at);
    at = select_integers<Arch>(inside, at, border);
    cell.left = select(inside, cell.left, T(0.0));
    cell.scale = select(inside, cell.scale, T(0.0));
    cell.c0 = T::gather(block_.tables, at);
    cell.c1 = T::gather(block_.tables + 1, at);
    cell.c2 = T::gather(block_.tables + 2, at);
    cell.c3 = T::gather(block_.tables + 3, at);
    return cell;
  }

  /// Counts the sub-steps of every lane, as Mechanics does; returns the largest number.
  int begin(double dt) {
    level_ = near(y_[1]).parts(y_[1]).level;
    level_.store(block_.level.data() + from_);
    T counted = row(block_.substeps);
    const T steps = law_.rate_bound(abs(y_[1]), level_) * T(dt) * T(1.0 / kStableStep);
    alignas(64) double count[T::kLanes];
    counted.store(count);
    if (any(steps >= counted)) {
      alignas(64) double needed[T::kLanes];
      steps.store(needed);
      for (std::size_t i = 0; i < T::kLanes; ++i) {
        if (!(needed[i] >= count[i])) continue;
        const double bounded = needed[i] < kMostPlantSubsteps ? needed[i] : kMostPlantSubsteps;
        count[i] = static_cast<int>(bounded) + 1;
      }
      counted = T::load(count);
    }
    count_ = counted;
    h_ = T(dt) / counted;
    double most = 0.0;
    for (std::size_t i = 0; i < T::kLanes; ++i) {
      most = count[i] > most ? count[i] : most;
      block_.spare[from_ + i] = static_cast<int>(kMostPlantSubsteps);
    }
    return static_cast<int>(most);
  }

  [[nodiscard]] State rates(const Cell& cell, const State& y) const {
    State d;
    const T v = y[1];
    const friction::SteadyParts<T> p = cell.parts(v);
    const T& z = y[Equations::kFriction];
    const T bristle = law_.rate(z, v, p);
    d[Equations::kFriction] = bristle;
    T transmitted(0.0);
    T on_table(0.0);
    if constexpr (kMode) {
      transmitted = equations_.spring_force(y);
      on_table = transmitted - held_.cutting;
    }
    equations_.rates(y, law_.force(z, bristle, v, p), transmitted, on_table, held_, d);
    return d;
  }

  void substep(int number) {
    const Mask moves = T(static_cast<double>(number)) < count_;
    if (!any(moves)) return;
    const T before = y_[1];
    const Cell cell = near(before);
    const State k1 = rates(cell, y_);
    const T decay = law_.rate_bound(abs(before) + h_ * abs(k1[1]), level_) * h_;
    const Mask stays = abs(k1[1]) * h_ < T(kNearStep) * abs(before);
    const bool all_stay = xsimd::all(stays);
    const State next = rk3_step(y_, k1, h_, [&](const State& y) {
      return rates(all_stay ? cell : Cell::chosen(stays, cell, near(y[1])), y);
    });
    const Mask divides = (decay > T(kUnstableStep)) & moves;
    if (any(divides)) return substep_one_by_one(next, moves, decay);
    for (std::size_t i = 0; i < Equations::kStates; ++i) y_[i] = select(moves, next[i], y_[i]);
  }

  /// The same where sub-steps of some lanes are divided.
  void substep_one_by_one(const State& next, const Mask& moves, const T& decay) {
    alignas(64) double most[T::kLanes];
    alignas(64) double h[T::kLanes];
    alignas(64) double moving[T::kLanes];
    decay.store(most);
    h_.store(h);
    select(moves, T(1.0), T(0.0)).store(moving);
    store_state();
    for (std::size_t i = 0; i < T::kLanes; ++i) {
      const std::size_t lane = from_ + i;
      if (moving[i] == 0.0) continue;
      if (most[i] > kUnstableStep && block_.spare[lane] > 0) {
        block_.substep_alone(block_.drive[lane], block_, lane, h[i]);
        continue;
      }
      alignas(64) double values[T::kLanes];
      for (std::size_t k = 0; k < Equations::kStates; ++k) {
        next[k].store(values);
        block_.state[k][lane] = values[i];
      }
    }
    load_state();
  }

  LaneBlock& block_;
  std::size_t from_;
  State y_;
  HeldOf<T> held_;
  Equations equations_;
  friction::LuGre<T> law_;
  T level_;
  T count_;
  T h_;
};

template <class Arch>
PackedDrive packed_drive() {
  return {&PackedPeriod<Arch, false, false>::advance, &PackedPeriod<Arch, true, false>::advance,
          &PackedPeriod<Arch, false, true>::advance, &PackedPeriod<Arch, true, true>::advance};
}

}  // namespace stribeck::plant
