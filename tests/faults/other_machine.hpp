#pragma once
/// Two axes on a circle under the C interface, on a plant that shares no code with Stribeck's: ten Maxwell slip elements, a lag of the
/// force, stiffness that depends on the position, and parameters that the controller knows roughly.

#include <stribeck/stribeck.h>

#include <array>
#include <cstddef>
#include <functional>
#include <string>

namespace stribeck::test {

class MaxwellAxis {
 public:
  static constexpr double kPeriod = 1e-3;

  explicit MaxwellAxis(double mass, double friction = 1.0, bool with_mode = false)
      : mass_(mass), friction_(friction), with_mode_(with_mode) {}

  void start(double position) { x = table_ = position; }
  /// One period under the force [N].
  void move(double force);
  [[nodiscard]] double encoder() const;  ///< on the drive [m]
  [[nodiscard]] double table() const { return with_mode_ ? table_ : x; }

  double x = 0.0;  ///< of the drive
  double v = 0.0;

 private:
  double mass_;
  double friction_;
  bool with_mode_;  ///< half of the mass on a spring, 40 Hz
  double acts_ = 0.0;
  double table_ = 0.0;
  double table_speed_ = 0.0;
  std::array<double, 10> spring_{};
};

/// The circle has 10 mm and is travelled at 10 mm/s after one second.
class OtherMachine {
 public:
  static constexpr double kPeriod = MaxwellAxis::kPeriod;
  /// How the plant differs from what is known of it.
  struct Odd {
    double force_limit = 250.0;  ///< [N]
    double friction = 1.0;
    double mass = 1.0;
    bool mode = false;
  };

  explicit OtherMachine(const std::string& law, const Odd& odd);
  explicit OtherMachine(const std::string& law) : OtherMachine(law, Odd{}) {}
  ~OtherMachine();
  OtherMachine(const OtherMachine&) = delete;
  OtherMachine& operator=(const OtherMachine&) = delete;

  void period();
  void run_to(double t);
  /// Largest tracking error on the way [m].
  double worst_to(double t);
  /// How far an axis moves until t, at most [m].
  double moved_to(double t);
  [[nodiscard]] double time() const { return kPeriod * k_; }
  [[nodiscard]] stribeck_supervision why() const;
  [[nodiscard]] stribeck_axis_signals signals(std::uint32_t axis) const;

  stribeck_controller* c = nullptr;
  std::array<MaxwellAxis, 2> axis;
  std::function<double(double time, std::size_t axis, double reading)> encoder;  ///< in place of the reading
  std::function<double(double time, std::size_t axis, double force)> acts;       ///< in place of the force
  double command_lost = 1e300;  ///< from when on the reference is NaN [s]
  std::array<double, 2> force{};
  stribeck_result result = STRIBECK_OK;
  double error = 0.0;    ///< true tracking error, of the worse axis [m]
  bool limited = false;  ///< a force was cut
  bool good = true;      ///< every force was a number within the limit

 private:
  void set(std::uint32_t i, const char* name, double x);
  void choose(std::uint32_t i, const char* name, const char* word);

  double limit_;
  std::size_t size_ = 0;
  void* memory_ = nullptr;
  int k_ = 0;
};

}  // namespace stribeck::test
