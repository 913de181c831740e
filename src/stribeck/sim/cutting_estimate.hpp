#pragma once
/// What can be learnt of the cutting force from a run: one cutting-force observer per axis, fed with what a control knows (forces
/// asked, reference, encoder, spindle speed, identified axis model), beside the controller and without effect on it.
///
/// Waves once per turn and once per tooth are looked for, the second only where it can be told from the first and lies below
/// half the sampling rate. Without either the mean is estimated alone.
/// Not modelled: delay of the control word; rounding by the converter.
/// Real time: no.

#include <stribeck/control/setup.hpp>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::sim {

/// Fills cutting_estimate of every sample: at each tick the mean expected over the coming period, as `cutting` is.
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

/// NaN where nothing was scored. The feed is the direction of the reference's velocity.
CuttingFigures cutting_figures(const std::vector<ContourSample>& trace, const CuttingForce& cutting);

}  // namespace stribeck::sim
