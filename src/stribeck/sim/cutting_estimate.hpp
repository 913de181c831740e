#pragma once
/// Estimates the cutting force from a run: one cutting-force observer per axis gets what a control knows (commanded forces,
/// reference, encoder, spindle speed, identified axis model). It runs beside the controller and does not affect it.
///
/// It looks for oscillations once per turn and once per tooth; the second only where it can be separated from the first and lies
/// below half the sampling rate. Without either, only the mean is estimated.
/// Not modelled: delay of the control word; rounding by the converter.
/// Real time: no.

#include <stribeck/control/setup.hpp>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::sim {

/// Fills cutting_estimate of every sample: the mean that is expected at a tick for the coming period, as in `cutting`.
template <std::size_t N>
void estimate_cutting(std::vector<ContourSample>& trace, const CuttingForce& cutting,
                      const control::Setup<N>& setup);

/// The force against the feed over the scored part, true and estimated [N].
struct CuttingFigures {
  struct Of {
    double mean = 0.0;
    double turn = 0.0;   ///< amplitude once per turn
    double tooth = 0.0;  ///< amplitude once per tooth
  };
  Of truth;
  Of estimate;
  double rms_truth = 0.0;
  double rms_error = 0.0;
};

/// NaN where no sample was scored. The feed is the direction of the reference's velocity.
CuttingFigures cutting_figures(const std::vector<ContourSample>& trace, const CuttingForce& cutting);

}  // namespace stribeck::sim
