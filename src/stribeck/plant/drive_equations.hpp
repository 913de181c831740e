#pragma once
/// The equations of one drive without those of its friction (mechanics.hpp has the laws), over any Real scalar: a number for one
/// drive, a pack for several at a time (packed/).
///
///   state  x, v, states of friction, i (voltage drive), x_t, v_t (two masses)
///
/// Real time: safe.

#include <array>
#include <cstddef>
#include <stribeck/core/scalar.hpp>
#include <stribeck/plant/params.hpp>

namespace stribeck::plant {

/// What acts on a drive during one control period.
template <Real T>
struct HeldOf {
  T voltage{0.0};  ///< after the D/A converter and the delay [V]
  T force{0.0};    ///< load and noise against +x [N]
  T cutting{0.0};  ///< on the table against +x [N]
};
using Held = HeldOf<double>;

/// Kutta's third order is stable to a decay of 2.51 per step; the velocity may grow a little within the period. Where it grows more,
/// steps are divided.
inline constexpr double kStableStep = 2.3;
inline constexpr double kUnstableStep = 2.5;
/// Change of velocity within a step, as a share of the velocity, up to which one cell of the friction table serves the whole step.
inline constexpr double kNearStep = 1.0 / 40;
inline constexpr double kMostPlantSubsteps = 16384.0;

template <Real T, std::size_t kFrictionStates, bool kVoltage, bool kMode>
struct DriveEquations {
  static constexpr std::size_t kFriction = 2;
  static constexpr std::size_t kCurrent = kFriction + kFrictionStates;
  static constexpr std::size_t kTable = kCurrent + (kVoltage ? 1 : 0);
  static constexpr std::size_t kStates = kTable + (kMode ? 2 : 0);

  T inverse_mass{1.0};
  T gain{0.0};
  T resistance{1.0};
  T inductance{1.0};
  T voltage_gain{1.0};
  T force_per_ampere{0.0};
  T emf{0.0};
  T table_mass{0.0};
  T spring{0.0};
  T damper{0.0};

  /// All of them, so that a pack can be filled from the values of several drives.
  static constexpr std::array<T DriveEquations::*, 10> values() {
    using E = DriveEquations;
    return {&E::inverse_mass,     &E::gain, &E::resistance, &E::inductance, &E::voltage_gain,
            &E::force_per_ampere, &E::emf,  &E::table_mass, &E::spring,     &E::damper};
  }

  /// Force from the drive side to the table without lost motion [N].
  template <class State>
  [[nodiscard]] T spring_force(const State& y) const noexcept {
    const T stretch = y[0] - y[kTable];
    const T rate = y[1] - y[kTable + 1];
    return spring * stretch + damper * rate;
  }

  /// Rates of all but friction. Friction of the drive side, force to the table, and the sum of forces on the table [N]; the last two
  /// with two masses only.
  template <class State>
  void rates(const State& y, const T& friction, const T& transmitted, const T& on_table,
             const HeldOf<T>& held, State& d) const noexcept {
    const T v = y[1];
    T force = -friction - held.force;
    if constexpr (kVoltage) {
      force = force + force_per_ampere * y[kCurrent];
      d[kCurrent] = (voltage_gain * held.voltage - resistance * y[kCurrent] - emf * v) / inductance;
    } else {
      force = force + gain * held.voltage;
    }
    if constexpr (kMode) {
      force = force - transmitted;
      d[kTable] = y[kTable + 1];
      d[kTable + 1] = on_table / table_mass;
    } else {
      force = force - held.cutting;
    }
    d[0] = v;
    d[1] = force * inverse_mass;
  }
};

}  // namespace stribeck::plant
