#pragma once
/// Detects that a loop oscillates, and reduces the trust in everything that closes a loop beyond the control law itself.
///
///   swing      the force without the feed-forward, averaged over four periods, reverses by more than `threshold` [N]
///   run        swings whose distances in time lie within a factor of two of each other, none longer than 0.5 s
///   after 8 swings in a run:   trust ← trust/2, counted; below 1/8 it is 0
///
/// trust is the remaining share of the observer's estimate and of the adaptation. Before it takes any, a Kalman observer is replaced
/// (compensation.hpp). trust does not recover until the state is
/// constructed anew: a machine that oscillated once must not try again by itself. A reversal of the reference also makes the
/// force swing; it begins a new run.
/// Source: hunting with an integrator and friction, Armstrong-Hélouvry, Dupont, Canudas de Wit 1994,
/// doi:10.1016/0005-1098(94)90209-7; counting turning points is Stribeck's own.
/// Not modelled: an oscillation that grows within fewer than 8 swings; oscillation slower than 1 Hz.
/// Real time: safe.

#include <array>
#include <cstdint>
#include <stribeck/core/scalar.hpp>

namespace stribeck::control {

class OscillationGuard {
 public:
  struct State {
    double trust = 1.0;
    double extreme = 0.0;    ///< extreme since the last turn [N]
    double direction = 0.0;  ///< of the present swing
    double reference = 0.0;  ///< direction of the reference
    std::array<double, 4> last{};
    int ticks = 0;     ///< since the last turn
    int interval = 0;  ///< between the last two turns [periods]
    int run = 0;
    std::uint32_t found = 0;  ///< how many oscillations were found
  };

  OscillationGuard() = default;
  /// threshold [N] > 0, well above the answer of the law to one encoder step; period [s].
  OscillationGuard(double threshold, double period) noexcept
      : threshold_(threshold), longest_(static_cast<int>(kLongest / period)) {}

  /// One period: force beyond the feed-forward [N] and reference velocity [m/s]. Returns true when an oscillation has just been found.
  bool step(State& s, double now, double velocity) const noexcept {
    if (!(threshold_ > 0.0)) return false;
    // Jumps between two encoder steps last a few periods and are no oscillation of the loop.
    for (std::size_t i = 3; i > 0; --i) s.last[i] = s.last[i - 1];
    s.last[0] = now;
    const double force = 0.25 * (s.last[0] + s.last[1] + s.last[2] + s.last[3]);
    if (sign(velocity) * s.reference < 0.0) s.run = 0;
    if (velocity != 0.0) s.reference = sign(velocity);
    if (s.ticks <= longest_) ++s.ticks;
    if (s.direction == 0.0) {
      s.direction = 1.0;
      s.extreme = force;
    }
    if ((force - s.extreme) * s.direction >= 0.0) {
      s.extreme = force;
      if (s.ticks > longest_) s.run = 0;
      return false;
    }
    if ((s.extreme - force) * s.direction < threshold_) return false;
    const bool regular = s.ticks <= longest_ && s.ticks <= 2 * s.interval && s.interval <= 2 * s.ticks;
    s.run = regular ? s.run + 1 : 0;
    s.interval = s.ticks;
    s.ticks = 0;
    s.direction = -s.direction;
    s.extreme = force;
    if (s.run < kSwings) return false;
    s.run = 0;
    s.trust = s.trust > kLeast ? 0.5 * s.trust : 0.0;
    if (s.found != UINT32_MAX) ++s.found;
    return true;
  }

 private:
  static constexpr int kSwings = 8;
  static constexpr double kLongest = 0.5;
  static constexpr double kLeast = 0.125;

  double threshold_ = 0.0;
  int longest_ = 0;
};

}  // namespace stribeck::control
