#pragma once
/// A force periodic in position that the window of the motion takes off together with the noise of the encoder: at 60 mm/s a period of
/// 0.8 mm is 75 Hz, and a window of 24 Hz leaves nothing of it.
///
///   h[k] = f[k] − W f[k]                  the force that the window W takes off, at the rows in motion
///   mean of h and of h·sgn v over position  →  spectrum over 1/period
///
/// The loop of the drive answers a ripple with its force as far as it is fast enough: the ripple has at least the amplitude of h. A
/// period that stands out by far tells with which low-pass the fit shows it: twice the frequency that it has at most speeds.
///
/// Not modelled: a ripple beyond the bandwidth of the loop, which shows in the position alone.
/// Inside ident only. Real time: no.

#include <optional>
#include <stribeck/ident/drive/aligned_log.hpp>

namespace stribeck::ident::drive {

struct HiddenRipple {
  double period = 0.0;     ///< [m]
  double amplitude = 0.0;  ///< of the force that the window took off [N]
  double cut_off = 0.0;    ///< of the low-pass that shows it [Hz]
};

/// `least`: amplitude that is worth it [N]. Absent where no period stands out.
std::optional<HiddenRipple> find_hidden_ripple(const AlignedLog& log, double least);

}  // namespace stribeck::ident::drive
