#pragma once
/// Drives an identified model through a run that it has not seen, and compares it with what the machine did.
///
///   open loop     m·v̇ = f − load − F(v, x, bristles), f the logged force under its zero-order hold
///   closed loop   the same axis with f from a controller (replay_controller.hpp) that follows the logged r
///
/// Open loop has two results: free from the first row, where every error of the force has a lasting effect; and started anew at
/// each reversal with the measured position and velocity (bristles keep their state). Predicted and measured values of a row
/// belong together: force k acts from t(k) to t(k+1), x(k) and v(k) are at t(k). The measured velocity is that of the log,
/// otherwise that of Motion; rows without one do not count.
///
/// Friction without dynamics holds the axis exactly: at v = 0 it stays while the force is within the level of either direction.
/// The instant at which a velocity reaches zero inside a sub-step is searched, so that nothing chatters and no artificial
/// stiffness is needed. LuGre and GMS are integrated with their bristles. A model that would need more than 4096 sub-steps in a
/// sample is refused.
///
/// At the first row the velocity is the slope of a parabola through the first rows, or zero where it is less than three times
/// its own standard deviation. Bristles start as in sliding at that velocity; at rest they carry f(0).
///
/// Source: thesis §2.6, figs 2.30 and 2.31; closed loop: Janot, Gautier, Brunot 2019 (see idim_ls.hpp).
/// Not modelled: elasticity, noise, resolution of the encoder.
/// Real time: no. Errors: Refused; Diverged where the model runs away.

#include <cstddef>
#include <limits>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/replay_controller.hpp>
#include <vector>

namespace stribeck::ident::replay {

struct ReplayOptions {
  double delay = 0.0;  ///< how much later a force acts than it is logged [s]; may be negative in open loop
  std::vector<double> added{};  ///< closed loop: to the force of the controller, per row [N]; empty: nothing
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
  std::size_t outside = 0;  ///< rows at velocities outside the range of identification
};

struct OpenLoop {
  Replay free;                      ///< from the first row alone
  Replay restarted;                 ///< anew at every reversal
  std::vector<std::size_t> starts;  ///< rows at which `restarted` took the measured state
  std::vector<std::size_t>
      reversals;  ///< rows at which the axis turns for a travel, which vibration at rest is not
  std::vector<double> measured_velocity;  ///< [m/s]; NaN: not known in this row
};

/// A replay whose model runs away.
struct Diverged : Refused {
  using Refused::Refused;
};

/// What is measured, and no prediction: its columns and errors are NaN.
OpenLoop not_replayed(const log::Record& record);

OpenLoop replay_open_loop(const friction::AxisModel& model, const log::Record& record,
                          const ReplayOptions& options = {});

/// The record must hold the reference; the delay must not be negative.
Replay replay_closed_loop(const friction::AxisModel& model, const ReplayController& controller,
                          const log::Record& record, const ReplayOptions& options = {});

/// Whether a controller makes the logged force out of the logged positions.
struct ControllerCheck {
  double relative = std::numeric_limits<double>::quiet_NaN();  ///< ‖logged − made‖/‖logged‖
  double added_share =
      0.0;  ///< of the rows in which something was added to the command; 0: nothing, or no telling
  double added_rms = 0.0;     ///< of it, in these rows [N]
  std::vector<double> added;  ///< what was, per row [N]; empty: nothing
};
/// The record must hold the reference. Something was added where most rows agree and the others differ by far more.
ControllerCheck check_controller(const ReplayController& controller, const log::Record& record);

/// Position and velocity from which a replay starts at a row, estimated from this row and those after it; `noise` is that of
/// x [m].
struct Start {
  double x = 0.0;  ///< [m]
  double v = 0.0;  ///< [m/s]
};
Start start_of(const log::Record& record, std::size_t row, double noise);

}  // namespace stribeck::ident::replay
