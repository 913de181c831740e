#pragma once
/// What the files of lost_motion share: the rows around reversals, and the fit over them.
/// Inside ident only: includes Eigen. Real time: no.

#include <Eigen/Core>
#include <stribeck/ident/lost_motion/lost_motion.hpp>

namespace stribeck::ident::lost_motion {

/// A low-pass of three boxes.
struct Smoothing {
  int reach = 0;  ///< rows to either side
  std::vector<double> weights;

  [[nodiscard]] Smoothing fine() const;  ///< a third as long
};
Smoothing smoothing_for(double sample_time);

/// How motor and table behave while they slide together.
struct Sliding {
  bool known = false;
  double offset = 0.0;  ///< between the encoders [m]
  double scale_error = 0.0;
  double half = 0.0;                 ///< half the lost motion, roughly [m]
  double friction = 0.0;             ///< of the whole axis, slowly [N]; 0: unknown
  double fallen = 0.0;               ///< share of it that falls with speed
  double stribeck = 1e-3;            ///< … within this speed [m/s]
  double viscous = 0.0;              ///< viscous friction as a share of it [s/m]
  double rounding_motor = 0.0;       ///< variance of the motor's encoder by its steps [µm²]
  double rounding_difference = 0.0;  ///< of both [µm²]
};
/// A part of the reversals: leaves out every pair i with i % groups == without; −1: none.
struct Part {
  int groups = 1;
  int without = -1;

  [[nodiscard]] bool has(std::size_t i) const noexcept {
    return without < 0 || static_cast<int>(i) % groups != without;
  }
};
Sliding find_sliding(const std::vector<Positions>& runs);
/// On strokes of constant speed, where the motor pulls the table.
struct WhileSliding {
  Estimate total;  ///< lost motion [m]
  double scale_error = 0.0;
};
/// Absent where there are fewer than four such strokes, or where they have one speed.
std::optional<WhileSliding> total_while_sliding(const std::vector<Positions>& runs, const Sliding& sliding);
/// 95 % half width of a value from those without each group (delete-a-group jackknife).
double jackknife_half_width(const std::vector<double>& without);
/// Friction of the whole axis over speed.
void find_shape(const std::vector<Positions>& runs, Sliding& sliding);

/// The rows from shortly before a reversal until the table slides the other way. The raw ones reach farther at either end, for the
/// low-pass.
struct Stretch {
  int direction = 0;             ///< after the reversal
  double sample_time = 0.0;      ///< [s]
  Eigen::VectorXd difference;    ///< raw: motor less scale [m]
  Eigen::VectorXd position;      ///< raw, of the scale [m]
  Eigen::VectorXd speed;         ///< of the scale, hardly filtered [m/s]
  Eigen::VectorXd motor;         ///< hardly filtered [m]
  Eigen::VectorXd velocity;      ///< of the motor, hardly filtered [m/s]
  Eigen::VectorXd acceleration;  ///< of the motor, filtered [m/s²]
  Eigen::VectorXd force;         ///< filtered [N]
};
std::vector<Stretch> find_stretches(const std::vector<Positions>& runs, const Sliding& sliding);

/// A fit of the motor's side.
struct Fit {
  bool good = false;
  double backlash = 0.0;  ///< at position 0 [m]
  double backlash_slope = 0.0;
  double offset = 0.0;          ///< beyond that of Sliding [m]
  double distance = 0.0;        ///< ℓ [m]
  double delay = 0.0;           ///< [s]
  double dip = 0.1e-3;          ///< speed below which friction falls to a lower value at rest [m/s]
  double stiffness = 0.0;       ///< [N/m]
  double motor_friction = 0.0;  ///< F_1 [N]
  double motor_mass = 0.0;      ///< m_1 [kg]
  double noise = 0.0;           ///< of the force [N]
};
/// Where a search begins: a small, a middle and a large backlash, with a short and a long ℓ.
std::vector<Fit> starts_for(const Sliding& sliding);
/// From a start, with equal weights.
Fit fit(const std::vector<Stretch>& stretches, const Sliding& sliding, bool slope, const Fit& start);
/// Near an earlier fit, which gives the weights of the rows.
Fit fit(const std::vector<Stretch>& stretches, const Sliding& sliding, bool slope, const Fit* earlier,
        const Part& part = {});

}  // namespace stribeck::ident::lost_motion
