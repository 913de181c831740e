#pragma once
/// Control loops over frequency as drawings and numbers: Bode diagram, Nyquist plane, sensitivity.
///
///   open loop      |L| [dB] and arg L [deg], in one piece from the lowest frequency on
///   Nyquist        L in the plane about −1; the circle |1 + L| = 0.5, which a good loop does not enter
///   sensitivity    |1/(1 + L)| [dB]: what the loop leaves of a disturbance of the position; above 0 dB it amplifies
///
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/plot/plot.hpp>
#include <stribeck/sim/study/loop_margins.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct LoopCurve {
  std::string label;
  const sim::LoopResponse* loop = nullptr;
  std::string color;
  bool dashed = false;
};

/// Gain, phase, Nyquist plane and sensitivity, in this order.
std::vector<Plot> loop_plots(const std::vector<LoopCurve>& curves);

/// arg L [deg] in one piece: the first one is above −360 and at most 0.
std::vector<double> loop_phase(const sim::LoopResponse& loop);

/// {"axis", "frequency_Hz", "gain_dB", "phase_deg", "sensitivity_dB"}
nlohmann::ordered_json loop_json(const sim::LoopResponse& loop, const std::string& axis);

}  // namespace stribeck::report
