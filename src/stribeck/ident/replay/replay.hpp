#pragma once
/// An identified model driven through a run that it has not seen, beside what the machine did.
///
///   open loop     m·v̇ = f − load − F(v, x, bristles), f the logged force under its zero-order hold
///   closed loop   the same axis with f from a controller (replay_controller.hpp) that follows the logged r
///
/// Open loop is given twice: free from the first row, where every error of the force is kept for ever, and
/// started anew at each reversal with the measured position and velocity (bristles keep what they were).
/// Predicted and measured stand at the same row: force k acts from t(k) to t(k+1), x(k) and v(k) are at t(k).
/// The measured velocity is that of the log, else Motion's; rows without one do not count.
///
/// Friction without dynamics holds exactly: at v = 0 the axis stays while the force is within the level of
/// either direction. The instant at which a velocity reaches zero inside a sub-step is searched, so that
/// nothing chatters and no stiffness is invented. LuGre and GMS are integrated with bristles. A model that
/// would need more than 4096 sub-steps in a sample is refused.
///
/// At the first row the velocity is the slope of a parabola through the first rows, or zero where that is within
/// three times its own deviation; bristles are where sliding at it puts them, at rest where they carry f(0).
///
/// Source: thesis §2.6, figs 2.30 and 2.31; closed loop: Janot, Gautier, Brunot 2019 (see idim_ls.hpp).
/// Not modelled: elasticity, noise, resolution of the encoder.
/// Real time: no. Errors: Refused.

#include <cstddef>
#include <limits>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/replay/replay_controller.hpp>
#include <vector>

namespace stribeck::ident::replay {

struct ReplayOptions {
  double delay =
      0.0;  ///< by which a force acts later than it stands in the log [s]; may be negative in open loop
};

/// Predicted columns, one entry per row of the record, and how far they are from the measured ones.
struct Replay {
  std::vector<double> x;  ///< [m]
  std::vector<double> v;  ///< [m/s]
  std::vector<double> f;  ///< [N]; in open loop the logged one

  double velocity_rms = std::numeric_limits<double>::quiet_NaN();       ///< of the error [m/s]
  double velocity_relative = std::numeric_limits<double>::quiet_NaN();  ///< ‖error‖/‖measured‖
  double position_rms = std::numeric_limits<double>::quiet_NaN();       ///< of the error [m]
  double position_most = std::numeric_limits<double>::quiet_NaN();      ///< largest error [m]
  double force_rms = std::numeric_limits<double>::quiet_NaN();          ///< of the error [N]; open loop: NaN
  double force_relative = std::numeric_limits<double>::quiet_NaN();     ///< open loop: NaN
  std::size_t outside = 0;  ///< rows at velocities that the model was not identified on
};

struct OpenLoop {
  Replay free;                            ///< from the first row alone
  Replay restarted;                       ///< anew at every reversal
  std::vector<std::size_t> starts;        ///< rows at which `restarted` took the measured state
  std::vector<double> measured_velocity;  ///< [m/s]; NaN: not known in this row
};

OpenLoop replay_open_loop(const friction::AxisModel& model, const log::Record& record,
                          const ReplayOptions& options = {});

/// The record must hold the reference; a delay must not be negative.
Replay replay_closed_loop(const friction::AxisModel& model, const ReplayController& controller,
                          const log::Record& record, const ReplayOptions& options = {});

/// Position and velocity of a row, as a replay starts from them, from this row and those after it; `noise` is
/// that of x [m].
struct Start {
  double x = 0.0;  ///< [m]
  double v = 0.0;  ///< [m/s]
};
Start start_of(const log::Record& record, std::size_t row, double noise);

}  // namespace stribeck::ident::replay
