#pragma once
/// Compensation of reversal spikes in TNC controls of HEIDENHAIN (TNC 426/430, iTNC 530): a constant speed is added for a short time.
///
///   at a reversal   MP712 per control cycle [mm], until their sum is MP711 [mm]
///   manual          t = width/360° · 2π·radius/feed,   MP712 = height · cycle/(t/2)
///
///   height and width of the spike as the circular test shows them: so the sum over half of its time is its height
///
/// Source: TNC 426/430 Technical Manual, 6.4.5 Compensation of Reversal Spikes during Circular Traverse. That the increments act on the
/// set-point of speed is taken from the backlash compensation of the same controls (iTNC 530, MP750/MP752); no manual at hand shows
/// where those of MP712 act.
/// Real time: no.

#include <string>

namespace stribeck::targets {

struct SpikeCompensation {
  double height = 0.0;     ///< MP711 [m]
  double increment = 0.0;  ///< MP712 [m] per control cycle

  [[nodiscard]] double speed(double cycle) const noexcept { return increment / cycle; }  ///< [m/s]
  [[nodiscard]] double time(double cycle) const noexcept {
    return increment > 0.0 ? height / increment * cycle : 0.0;
  }  ///< [s]
};

/// The same from height [m] and width [rad] of a spike, by the manual's formula.
SpikeCompensation spike_compensation(double height, double width, double radius, double feed, double cycle);
/// Width [rad] of the spike that these numbers belong to.
double spike_width(const SpikeCompensation& c, double radius, double feed, double cycle);

/// Lines of machine parameters for one axis ("0"), rounded as the text shows, and back.
std::string machine_parameters(const SpikeCompensation& c, const std::string& axis);
SpikeCompensation read_machine_parameters(const std::string& text, const std::string& axis);

}  // namespace stribeck::targets
