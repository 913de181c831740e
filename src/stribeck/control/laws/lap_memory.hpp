#pragma once
/// Memory of one lap of a controller. The path parameter φ is divided into cells of equal width; each holds the mean of M numbers
/// over its width, so that laps may have any duration and speed.
///
///   place = φ·Cells/lap, counted on over the laps             the value of one lap ago is at place − Cells
///   read   Σ w(x)·cell,  w = 2·(Gaussian of σ) − (Gaussian of √2σ)  =  Q = 1 − (1 − G)²,  G = exp(−ω²σ²/2)
///
///   σ [cells]. Q has no phase: it uses cells before and after the place, because the last lap is known; ½ where ωσ = kHalfOfQ.
///   Between two entries values are interpolated linearly.
///
/// Ring ≥ Cells + kReach·σ + a few cells are kept. φ may be counted on over the laps or begin anew in each.
/// Source: Tomizuka, Tsao, Chew 1989, doi:10.1115/1.3153060 (zero-phase low-pass in the loop of a lap).
/// Real time: safe; a read takes 2·kReach·σ cells.

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stribeck/core/vec.hpp>

namespace stribeck::control {

/// ω·σ at which Q is ½.
inline constexpr double kHalfOfQ = 1.5670;

template <std::size_t M, std::int64_t Cells, std::int64_t Ring, class Real = double>
class LapMemory {
 public:
  using V = Vec<double, M>;

  /// At this distance [σ] the wider of Q's two Gaussians has decayed to exp(−8).
  static constexpr double kReach = 5.66;
  /// Smallest σ [cells]; below it the steps between cells would show.
  static constexpr double kLeastWidth = 0.8;

  struct State {
    std::array<Vec<Real, M>, static_cast<std::size_t>(Ring)> cell{};
    double place = 0.0;    ///< of this tick, counted on over the laps [cells]
    double phi = 0.0;      ///< of the last tick
    double written = 0.0;  ///< values are written up to this place
    V value;               ///< value at that place
    V sum;                 ///< over the cell that is being written
    double covered = 0.0;  ///< part of it
    std::int64_t first = std::numeric_limits<std::int64_t>::min();  ///< cells before this one are forgotten
    bool started = false;
    bool writing = false;
  };

  /// Follows φ; cells_per_phi = Cells/lap. Returns the cells moved since the last tick, from −Cells/2 to Cells/2.
  static double advance(State& s, double phi, double cells_per_phi) noexcept {
    constexpr double kCells = static_cast<double>(Cells);
    double moved = (phi - s.phi) * cells_per_phi;
    if (!s.started) moved = 0.0;
    moved -= kCells * std::floor(moved / kCells + 0.5);
    s.started = true;
    s.phi = phi;
    s.place += moved;
    return moved;
  }
  /// Whether a move jumps or runs backwards: writing must not continue across it.
  static constexpr bool breaks(double moved) noexcept {
    return moved < 0.0 || moved > static_cast<double>(Cells / 8);
  }
  /// Makes the next entry start anew instead of continuing the last one.
  static void interrupt(State& s) noexcept { s.writing = false; }
  /// Forgets all laps: what the ring holds counts again from the cell on in which the next entry begins.
  static void forget(State& s) noexcept {
    s.writing = false;
    s.first = kNone;
  }
  /// Whether the cells around a place have been written since the last forget().
  [[nodiscard]] static bool knows(const State& s, double place) noexcept {
    return place - 1.0 > static_cast<double>(s.first);
  }

  /// The first K numbers under Q at a place.
  template <std::size_t K = M>
  static Vec<double, K> read(const State& s, double place, double width) noexcept {
    const auto reach = static_cast<std::int64_t>(kReach * width) + 1;
    const auto middle = cell_at(place);
    // The wide Gaussian, exp(−x²/4σ²), cell by cell without calling exp(): the next one is this one times `ratio`, and `ratio` itself
    // changes by the constant factor `bend`. The narrow Gaussian, exp(−x²/2σ²), is the square of the wide one.
    const double scale = 0.25 / (width * width);
    const double x = static_cast<double>(middle - reach) - place;
    double wide = exp(-scale * x * x);
    double ratio = exp(-scale * (2.0 * x + 1.0));
    const double bend = exp(-2.0 * scale);
    // 2·(narrow one of area 1) − (wide one of area 1): the narrow one is √2 times as high, and counts twice. A common factor drops out,
    // because the sum is divided by `total`.
    constexpr double kNarrow = 2.0 * 1.41421356237309515;
    double total = 0.0;
    Vec<double, K> sum;
    std::size_t at = slot(middle - reach);
    for (std::int64_t k = middle - reach; k <= middle + reach; ++k) {
      const double weight = wide * (kNarrow * wide - 1.0);
      total += weight;
      if (k >= s.first) {
        for (std::size_t i = 0; i < K; ++i) sum[i] += weight * static_cast<double>(s.cell[at][i]);
      }
      wide *= ratio;
      ratio *= bend;
      at = at + 1 == static_cast<std::size_t>(Ring) ? 0 : at + 1;
    }
    return (1.0 / total) * sum;
  }

  /// The numbers at a place, interpolated linearly between the middles of cells.
  static V between(const State& s, double place) noexcept {
    const double below = std::floor(place);
    const double share = place - below;
    const auto bin = static_cast<std::int64_t>(below);
    const auto& a = s.cell[slot(bin)];
    const auto& b = s.cell[slot(bin + 1)];
    V v;
    for (std::size_t i = 0; i < M; ++i)
      v[i] = (1.0 - share) * static_cast<double>(a[i]) + share * static_cast<double>(b[i]);
    return v;
  }

  /// Enters values at a place. They are interpolated linearly from the last place, and each cell gets its mean.
  static void write(State& s, double place, const V& value) noexcept {
    if (!s.writing) {
      s.writing = true;
      s.covered = 0.0;
      s.sum = {};
      if (s.first == kNone) s.first = cell_at(place);
    } else {
      const double moved = place - s.written;
      double from = s.written;
      V at = s.value;
      while (from < place) {
        const double border = std::floor(from + 0.5) + 0.5;
        const double to = min_of(border, place);
        const V there = s.value + ((to - s.written) / moved) * (value - s.value);
        s.sum = s.sum + (0.5 * (to - from)) * (at + there);
        s.covered += to - from;
        if (to == border) {
          auto& cell = s.cell[slot(cell_at(from))];
          for (std::size_t i = 0; i < M; ++i) cell[i] = static_cast<Real>(s.sum[i] / s.covered);
          s.sum = {};
          s.covered = 0.0;
        }
        from = to;
        at = there;
      }
    }
    s.written = place;
    s.value = value;
  }

 private:
  /// Of `first`: all cells are forgotten.
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

  /// The cell whose middle is nearest.
  static std::int64_t cell_at(double place) noexcept {
    return static_cast<std::int64_t>(std::floor(place + 0.5));
  }
  static constexpr std::size_t slot(std::int64_t bin) noexcept {
    const std::int64_t r = bin % Ring;
    return static_cast<std::size_t>(r < 0 ? r + Ring : r);
  }
};

}  // namespace stribeck::control
