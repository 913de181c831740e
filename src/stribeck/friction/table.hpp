#pragma once
/// A steady map as a table of cubics, for loops that evaluate it millions of times.
///
///   level(v) = c0 + c1·d + c2·d² + c3·d³,   d = distance from the left edge of the cell that holds |v|/v_max
///
/// The cells divide every octave of |v| into 64, over twelve octaves below v_max; one more cell reaches down to rest. A
/// Stribeck rise of a few micrometres per second is thus resolved as well as a Gaussian of a few millimetres per second. The cell
/// follows from the bits of |v|, without a search or a logarithm. Each direction has its own cells. Beyond v_max the level keeps
/// its value at the border. Each cubic equals the map at four points of its cell: for Table 2.3 the largest deviation is below
/// 1e-4 N (test), which moves an axis of 57 N·s²/mm by picometres.
///
/// near(v) returns the cubic of one cell, for the stages of a small step that stay close to v: finding the cell costs as much as
/// evaluating the cubic.
///
/// For double only, because the cell is computed from the bits of |v|.
/// Not modelled: viscous parts that are not proportional to v; additive parts of the base map.
/// Real time: safe; build() configure only.

#include <array>
#include <bit>
#include <cstdint>
#include <stribeck/friction/steady.hpp>

namespace stribeck::friction {

class Table {
 public:
  static constexpr int kOctaves = 12;
  static constexpr int kCellsPerOctave = 64;

  /// Tabulates a map up to |v| = v_max [m/s], > 0. A map that keeps a constant value beyond its identified range is tabulated
  /// exactly up to that border: a kink inside a cell would cause errors of newtons.
  template <SteadyMap<double> M>
  static Table build(const M& map, double v_max) noexcept {
    static_assert(
        requires { map.viscous_coefficient(1.0); },
        "the table holds viscous friction as one coefficient for each direction: give the map "
        "viscous_coefficient(side), and put into its level whatever is not proportional to v");
    Table t;
    std::array<double, 2> ends{v_max, v_max};
    if constexpr (requires { map.identified_range(); }) {
      if (const auto range = map.identified_range()) ends = {(*range)[1], -(*range)[0]};
    }
    for (const int side : {0, 1}) {
      const double direction = side == 0 ? 1.0 : -1.0;
      const double end = ends[static_cast<std::size_t>(side)];
      t.scale_[side] = 1.0 / end;
      t.viscous_[side] = map.parts(direction * end, 0.0).viscous / (direction * end);
      t.border_[side] = {map.parts(direction * end, 0.0).level, 0.0, 0.0, 0.0};
      for (int k = 0; k < kCells; ++k) {
        const double left = edge(k);
        const double width = edge(k + 1) - left;
        double y[4];
        for (int i = 0; i < 4; ++i)
          y[i] = map.parts(direction * end * max_of(left + width * i / 3.0, kAtRest), 0.0).level;
        // Newton's divided differences at 0, 1/3, 2/3, 1 of the cell, written as powers of d.
        const double d1 = (y[1] - y[0]) * 3.0;
        const double d2 = (y[2] - 2.0 * y[1] + y[0]) * 4.5;
        const double d3 = (y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0]) * 4.5;
        t.cells_[side][k] = {y[0], (d1 - d2 / 3.0 + d3 * 2.0 / 9.0) / width, (d2 - d3) / (width * width),
                             d3 / (width * width * width)};
      }
    }
    return t;
  }

  /// Level [N] at distance d from the left edge of a cell with these coefficients.
  template <Real T>
  static T cubic(const T& c0, const T& c1, const T& c2, const T& c3, const T& d) noexcept {
    return (c0 + d * c1) + d * d * (c2 + d * c3);
  }

  /// The cubic of the cell that holds v. Valid for |v'| within a cell's width of it, |v|/64, because it continues smoothly.
  class Near {
   public:
    [[nodiscard]] SteadyParts<double> parts(double v, double) const noexcept {
      const double d = abs(v) * scale_ - left_;
      const auto& c = *cell_;
      return {cubic(c[0], c[1], c[2], c[3], d), viscous_ * v, 0.0};
    }

   private:
    friend class Table;
    const std::array<double, 4>* cell_ = nullptr;
    double left_ = 0.0;
    double scale_ = 1.0;
    double viscous_ = 0.0;
  };
  [[nodiscard]] Near near(double v) const noexcept {
    const int side = v < 0.0 ? 1 : 0;
    const double u = abs(v) * scale_[side];
    Near n;
    n.viscous_ = viscous_[side];
    if (!(u < kHighest)) {  // keeps the value at the border; NaN also ends here and stays NaN
      n.cell_ = &border_[side];
      n.scale_ = 0.0;
      return n;
    }
    n.scale_ = scale_[side];
    if (u < kLowest) {
      n.cell_ = &cells_[side][0];
      return n;
    }
    const auto bits = std::bit_cast<std::uint64_t>(u);
    n.cell_ = &cells_[side][(bits >> kShift) - kFirst + 1];
    n.left_ = std::bit_cast<double>(bits >> kShift << kShift);
    return n;
  }

  [[nodiscard]] SteadyParts<double> parts(double v, double x) const noexcept { return near(v).parts(v, x); }

  /// How near() finds a cell, for those who look up several tables at a time (plant/packed/): u = |v|·scale; from kHighest on, the
  /// border; below kLowest, the first cell; otherwise cell (bits of u >> kShift) − kFirst + 1, whose left edge are the bits of u
  /// without the lowest kShift.
  static constexpr int kShift = 52 - std::countr_zero(static_cast<unsigned>(kCellsPerOctave));
  static constexpr double kLowest = 1.0 / (1 << kOctaves);
  static constexpr double kHighest = 1.0 - 0x1p-53;
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(kLowest) >> kShift;
  struct Side {
    const double* cells;   ///< four coefficients of each
    const double* border;  ///< four coefficients
    double scale;          ///< [s/m]
    double viscous;        ///< [N·s/m]
  };
  /// side: 0 for v ≥ 0, 1 for v < 0.
  [[nodiscard]] Side side(std::size_t side) const noexcept {
    return {cells_[side][0].data(), border_[side].data(), scale_[side], viscous_[side]};
  }

 private:
  static constexpr int kCells = kOctaves * kCellsPerOctave + 1;
  static constexpr double kAtRest = 1e-12;  ///< close to rest, but with the right sign

  static constexpr double edge(int k) noexcept {
    return k == 0 ? 0.0 : std::bit_cast<double>((kFirst + static_cast<std::uint64_t>(k - 1)) << kShift);
  }

  std::array<std::array<std::array<double, 4>, kCells>, 2> cells_{};
  std::array<std::array<double, 4>, 2> border_{};  ///< constants
  std::array<double, 2> viscous_{};
  std::array<double, 2> scale_{1.0, 1.0};
};

}  // namespace stribeck::friction
