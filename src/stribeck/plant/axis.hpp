#pragma once
/// A virtual drive as a controller sees it: the input is a voltage once per control period, the output an encoder
/// position.
///
///   voltage → limited to the range, rounded to the D/A converter's step → delayed → Mechanics
///   → rounded to the encoder's step
///
/// With a drive_loop the input is a velocity or a position, and a force offset; the loops of the drive make the voltage
/// (drive_loop.hpp), which no converter rounds.
/// The constructor decides which friction law, drive and mechanics the axis has.
/// Real time: no (set-up allocates; step() does not).

#include <cstdint>
#include <memory>
#include <stribeck/plant/noise.hpp>
#include <stribeck/plant/params.hpp>

namespace stribeck::plant {

/// How a drive is simulated.
struct Fidelity {
  int substeps = 8;       ///< per control period, with a drive_loop per cycle of it
  bool quantised = true;  ///< encoder and D/A converter round
  bool noisy = true;      ///< force noise acts
};

class Axis {
 public:
  /// params must be valid; period of the controller [s]; v_max [m/s] bounds the table of the friction curve.
  Axis(const AxisParams& params, double period, double v_max);
  ~Axis();
  Axis(Axis&&) noexcept;
  Axis& operator=(Axis&&) noexcept;

  /// Starts a new run: at rest at position x [m], bristles relaxed, noise from the beginning of its stream.
  void start(double x, const Fidelity& fidelity, const Stream& stream);

  /// One control period under the command: voltage [V], or what the drive_loop takes, with a force offset [N]. Cutting force on
  /// the table against +x [N].
  void step(double command, double cutting = 0.0, double offset = 0.0);

  /// The same for two drives without drive_loop; faster than two single calls, with the same result.
  static void step_together(Axis& a, double voltage_a, Axis& b, double voltage_b, double cutting_a = 0.0,
                            double cutting_b = 0.0);

  [[nodiscard]] double encoder() const;         ///< [m]
  [[nodiscard]] EncoderSide feedback() const;   ///< the side of encoder()
  [[nodiscard]] double second_encoder() const;  ///< on the other side [m]; NaN: none
  [[nodiscard]] double position() const;        ///< true, of the table [m]
  [[nodiscard]] double velocity() const;        ///< true, of the drive side [m/s]
  [[nodiscard]] double friction_force() const;  ///< true [N]
  /// Of the drive, mean over the last period, as its current tells it: with back EMF and delay, without torque ripple [N].
  [[nodiscard]] double force() const;
  [[nodiscard]] bool has_loop() const;       ///< whether it has a drive_loop
  [[nodiscard]] bool reports_force() const;  ///< whether its drive_loop has force_feedback
  [[nodiscard]] double voltage()
      const;  ///< last, after the D/A converter; mean over the period with a drive_loop [V]
  [[nodiscard]] double current()
      const;  ///< motor current [A]; NaN when the machine file does not have the data

  /// Electrical power R·i² + K_e·θ̇·i [W]; NaN when the machine file does not have the data of the motor.
  [[nodiscard]] double power() const;

  /// Fastest rate of the equations, without the decay of friction, for sub-steps per period [1/s]: with a drive_loop divided by
  /// its cycles in a period.
  [[nodiscard]] double rate_bound() const;

 private:
  friend class AxisGroup;
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stribeck::plant
