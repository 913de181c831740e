#pragma once
/// Equations of motion of one drive between two ticks of the controller: amplifier and motor, screw, axis
/// with friction, and between drive and table the first axial mode or lost motion where there is one.
///
///   rigid        m·v̇ = f_u − F − w                         f_u = gain·u                      current drive
///   axial mode   (m − m_t)·v̇ = f_u − F − w − s             L·i̇ = k_u·u − R·i − K_e·r_g·v,
///                m_t·v̇_t = s − c                           f_u = K_t·r_g·i                   voltage drive
///                s = k·(x − x_t) + d·(v − v_t),  k = m_t·ω²,  d = 2ζω·m_t
///   lost motion  both with (1 − φ)·F(v) and φ·F(v_t),  m_t·v̇_t = s − φ·F(v_t) − c
///                s = k·p(x − x_t) + d·(v − v_t) in contact, never pulling;  p(δ) = δ ∓ b/2 beyond ±b/2, else 0
///
///   x, v drive side [m, m/s], x_t, v_t table, i current [A], F friction [N] on the drive side, w load and
///   noise [N], c cutting force on the table [N], ω = 2π·frequency, b backlash [m], φ share of the table's friction
///
/// The level and the viscous part of F and the stiffness of the bristles may be scaled from one control period to the next (a drive
/// that warms up, friction that differs from place to place).
/// With a voltage drive the back-EMF acts through i; the friction model must then not contain it again.
/// Sign: friction, load, noise and cutting force are positive against +x.
/// Not modelled: more than two masses, friction of the table side with an axial mode, impact losses other than d, saturation
/// of the current.
/// Real time: safe.

#include <algorithm>
#include <stribeck/friction/model.hpp>
#include <stribeck/plant/drive_equations.hpp>
#include <stribeck/plant/integrator.hpp>

namespace stribeck::plant {

/// One drive; Map is the steady-state curve, Friction the law over it. kMode: two masses; kLost: with lost motion between them.
template <class Map, friction::PreSlidingLaw Friction, bool kVoltage, bool kMode, bool kLost = false>
class Mechanics {
  static_assert(kMode || !kLost, "lost motion is between two masses");

 public:
  using Equations = DriveEquations<double, friction::Integrated<Friction>::kCount, kVoltage, kMode>;
  static constexpr std::size_t kFriction = Equations::kFriction;
  static constexpr std::size_t kCurrent = Equations::kCurrent;
  static constexpr std::size_t kTable = Equations::kTable;
  static constexpr std::size_t kTableFriction = kTable + 2;
  static constexpr std::size_t kStates =
      Equations::kStates + (kLost ? friction::Integrated<Friction>::kCount : 0);
  using StateVector = Vec<double, kStates>;

  Mechanics(const AxisParams& p, const Map& map, const Friction& law) noexcept
      : map_(map), law_(law), friction_(law), table_friction_(law) {
    set(p);
  }

  /// At rest at position x [m], bristles relaxed, friction cold.
  void reset(double x) noexcept {
    y_ = {};
    level_share_ = viscous_share_ = 1.0;
    set_stiffness_share(1.0);
    y_[0] = x;
    if constexpr (kMode) y_[kTable] = x;
    friction_.place({}, &y_[kFriction]);
    if constexpr (kLost) table_friction_.place({}, &y_[kTableFriction]);
  }

  /// Level and viscous part of friction from now on, as shares of the values of the map; 1 after reset().
  void set_friction_share(double level, double viscous) noexcept {
    level_share_ = level;
    viscous_share_ = viscous;
  }
  /// Stiffness of the bristles from now on, as a share of that of the law; 1 after reset().
  void set_stiffness_share(double share) noexcept {
    if (share == stiffness_share_) return;
    stiffness_share_ = share;
    friction_.set_law(law_.stiffened(share));
    table_friction_.set_law(law_.stiffened(share));
  }

  /// Advances by dt [s] in equal sub-steps: as many as requested for accuracy, more where friction decays too
  /// fast for them.
  void advance(const Held& held, double dt, int substeps) noexcept {
    const int n = count(dt, substeps);
    for (int i = 0; i < n; ++i) substep(held, dt / n);
  }

  /// The same for two drives at a time. Their chains of arithmetic do not wait for each other, which makes it 1.6 times
  /// faster (bench/).
  friend void advance_together(Mechanics& a, const Held& held_a, int substeps_a, Mechanics& b,
                               const Held& held_b, int substeps_b, double dt) noexcept {
    const int n_a = a.count(dt, substeps_a);
    const int n_b = b.count(dt, substeps_b);
    const int both = std::min(n_a, n_b);
    for (int i = 0; i < both; ++i) {
      a.substep(held_a, dt / n_a);
      b.substep(held_b, dt / n_b);
    }
    for (int i = both; i < n_a; ++i) a.substep(held_a, dt / n_a);
    for (int i = both; i < n_b; ++i) b.substep(held_b, dt / n_b);
  }

  /// What a step of several drives at a time needs (packed/): values, and the state between two sub-steps.
  [[nodiscard]] const Equations& equations() const noexcept { return drive_; }
  [[nodiscard]] const Map& map() const noexcept { return map_; }
  [[nodiscard]] const Friction& law() const noexcept { return friction_.law(); }
  [[nodiscard]] StateVector& state() noexcept { return y_; }
  /// One sub-step of h [s] of a period that began with this level of friction [N], and in which `spare` more sub-steps than counted
  /// may still be made; returns how many are left.
  int substep_alone(const Held& held, double h, double level, int spare) noexcept {
    level_ = level;
    spare_ = spare;
    substep(held, h);
    return spare_;
  }

  [[nodiscard]] double drive_position() const noexcept { return y_[0]; }
  [[nodiscard]] double drive_velocity() const noexcept { return y_[1]; }
  [[nodiscard]] double table_position() const noexcept {
    if constexpr (kMode) {
      return y_[kTable];
    } else {
      return y_[0];
    }
  }
  /// Motor current [A] of a voltage drive, else NaN: a current drive has no such value.
  [[nodiscard]] double current() const noexcept {
    if constexpr (kVoltage) {
      return y_[kCurrent];
    } else {
      return std::numeric_limits<double>::quiet_NaN();
    }
  }
  /// Friction force at the present state [N].
  [[nodiscard]] double friction_force() const noexcept {
    std::array<double, friction::Integrated<Friction>::kCount> rate;
    const double drive = friction_.evaluate(&y_[kFriction], y_[1], parts(map_, y_[1], y_[0]), rate.data());
    if constexpr (kLost) {
      const double v = y_[kTable + 1];
      const double table =
          table_friction_.evaluate(&y_[kTableFriction], v, parts(map_, v, y_[kTable]), rate.data());
      return drive + on_table_ * (table - drive);
    } else {
      return drive;
    }
  }

  /// Fastest rate [1/s] of the equations, without the decay of friction, which advance() itself handles.
  [[nodiscard]] double rate_bound() const noexcept {
    double fastest = std::sqrt(friction_.law().stiffness() / mass_) + friction_.law().damping() / mass_;
    if constexpr (kVoltage) fastest = std::max(fastest, drive_.resistance / drive_.inductance);
    if constexpr (kMode) {
      const double w2 = drive_.spring / mass_ + drive_.spring / drive_.table_mass;
      fastest = std::max(fastest, std::sqrt(w2) + drive_.damper / mass_ + drive_.damper / drive_.table_mass);
    }
    if constexpr (kLost) {
      const double stiffness = on_table_ * friction_.law().stiffness();
      fastest =
          std::max(fastest, std::sqrt((drive_.spring + stiffness) / drive_.table_mass) +
                                (drive_.damper + on_table_ * friction_.law().damping()) / drive_.table_mass);
    }
    return fastest;
  }

 private:
  /// Parts of the map as warm as it is, and at this place.
  template <class AnyMap>
  [[nodiscard]] friction::SteadyParts<double> parts(const AnyMap& map, double v, double x) const noexcept {
    friction::SteadyParts<double> p = map.parts(v, x);
    p.level *= level_share_;
    p.viscous *= viscous_share_;
    return p;
  }

  // How many steps: count() chooses the number for the whole period from the speed at its start. substep() looks again at each of them, and
  // where the axis has become so fast that a step would be unstable, divide() makes several of it; spare_ bounds how many more a period may
  // get in all.

  /// Sub-steps for a period of dt [s].
  [[nodiscard]] int count(double dt, int substeps) noexcept {
    spare_ = static_cast<int>(kMostPlantSubsteps);
    level_ = parts(map_, y_[1], y_[0]).level;
    double decay = friction_.law().rate_bound(std::abs(y_[1]), level_) * dt;
    if constexpr (kLost) {
      const double v = y_[kTable + 1];
      table_level_ = parts(map_, v, y_[kTable]).level;
      decay = std::max(decay, table_friction_.law().rate_bound(std::abs(v), table_level_) * dt);
    }
    const double steps = decay * (1.0 / kStableStep);
    // A run that has diverged (NaN) keeps the given number, so that a search for a stable number can see the
    // divergence.
    if (!(steps >= substeps)) return substeps;
    return static_cast<int>(std::min(steps, kMostPlantSubsteps)) + 1;
  }

  /// Decay of friction within a sub-step of h [s] that begins with these accelerations, at the level of the period's start.
  [[nodiscard]] double decay(const StateVector& rates, double h) const noexcept {
    const double reach = std::abs(y_[1]) + h * std::abs(rates[1]);
    double most = friction_.law().rate_bound(reach, level_) * h;
    if constexpr (kLost) {
      const double table_reach = std::abs(y_[kTable + 1]) + h * std::abs(rates[kTable + 1]);
      most = std::max(most, table_friction_.law().rate_bound(table_reach, table_level_) * h);
    }
    return most;
  }

  void substep(const Held& held, double h) noexcept {
    const double before = y_[1];
    [[maybe_unused]] double table_before = 0.0;
    if constexpr (kLost) table_before = y_[kTable + 1];
    const auto near = friction::near_or_itself(map_, before);
    const StateVector k1 = derivative(near, y_, held);
    // A large force reaches a speed that the count for the whole period did not know of.
    if (const double most = decay(k1, h); most > kUnstableStep && spare_ > 0) return divide(held, h, most);
    // While the velocity stays within half a cell of the table, the cell of the first stage serves all stages.
    if (std::abs(k1[1]) * h < kNearStep * std::abs(before)) {
      y_ = rk3_step(y_, k1, h, [&](const StateVector& y) noexcept { return derivative(near, y, held); });
    } else {
      y_ = rk3_step(y_, k1, h, [&](const StateVector& y) noexcept { return derivative(map_, y, held); });
    }
    if constexpr (friction::Integrated<Friction>::kSettles) {
      friction_.settle(&y_[kFriction], before, y_[1], parts(map_, y_[1], y_[0]));
      if constexpr (kLost) {
        const double v = y_[kTable + 1];
        table_friction_.settle(&y_[kTableFriction], table_before, v, parts(map_, v, y_[kTable]));
      }
    }
  }

  /// A sub-step in so many parts that each is stable. A period has kMostPlantSubsteps more of them at most: an axis that leaves all bounds
  /// would ask for more and more.
  void divide(const Held& held, double h, double decay_in_h) noexcept {
    const int parts = static_cast<int>(std::min(decay_in_h * (1.0 / kStableStep), 1.0 * spare_)) + 1;
    spare_ -= parts;
    for (int i = 0; i < parts; ++i) substep(held, h / parts);
  }

  void set(const AxisParams& p) noexcept {
    mass_ = p.total_mass();
    if constexpr (kVoltage) {
      const auto& d = std::get<VoltageDrive>(p.drive);
      drive_.resistance = d.resistance;
      drive_.inductance = d.inductance;
      drive_.voltage_gain = d.amplifier_gain;
      drive_.force_per_ampere = d.torque_constant * d.screw_ratio();
      drive_.emf = d.back_emf * d.screw_ratio();
    } else {
      drive_.gain = std::get<CurrentDrive>(p.drive).gain;
    }
    if constexpr (kLost) {
      const LostMotion& m = *p.lost_motion;
      drive_.table_mass = m.table_share * mass_;
      mass_ -= drive_.table_mass;
      drive_.spring = m.stiffness;
      drive_.damper = 2.0 * m.damping_ratio * std::sqrt(m.stiffness * drive_.table_mass);
      backlash_ = m.backlash;
      backlash_slope_ = m.backlash_slope;
      on_table_ = m.table_friction;
    } else if constexpr (kMode) {
      const AxialMode& m = *p.axial_mode;
      const double w = 2.0 * kPi * m.frequency;
      drive_.table_mass = m.table_share * mass_;
      mass_ -= drive_.table_mass;
      drive_.spring = drive_.table_mass * w * w;
      drive_.damper = 2.0 * m.damping_ratio * w * drive_.table_mass;
    }
    drive_.inverse_mass = 1.0 / mass_;
  }

  /// Force from the drive side to the table [N].
  [[nodiscard]] double transmitted(const StateVector& y) const noexcept {
    if constexpr (kLost) {
      const double stretch = y[0] - y[kTable];
      const double rate = y[1] - y[kTable + 1];
      const double half = 0.5 * std::max(0.0, backlash_ + backlash_slope_ * y[kTable]);
      if (half > 0.0) {
        if (stretch > half) return std::max(0.0, drive_.spring * (stretch - half) + drive_.damper * rate);
        if (stretch < -half) return std::min(0.0, drive_.spring * (stretch + half) + drive_.damper * rate);
        return 0.0;
      }
    }
    return drive_.spring_force(y);
  }

  template <class AnyMap>
  [[nodiscard]] StateVector derivative(const AnyMap& map, const StateVector& y,
                                       const Held& held) const noexcept {
    StateVector d;
    const double v = y[1];
    const auto p = parts(map, v, y[0]);
    double friction = friction_.evaluate(&y[kFriction], v, p, &d[kFriction]);
    if constexpr (kLost) friction *= 1.0 - on_table_;
    double transmitted_force = 0.0;
    double on_table = 0.0;
    if constexpr (kMode) {
      transmitted_force = transmitted(y);
      on_table = transmitted_force - held.cutting;
    }
    if constexpr (kLost) {
      // The table's velocity has a cell of the map of its own.
      const double v_t = y[kTable + 1];
      on_table -= on_table_ * table_friction_.evaluate(&y[kTableFriction], v_t, parts(map_, v_t, y[kTable]),
                                                       &d[kTableFriction]);
    }
    drive_.rates(y, friction, transmitted_force, on_table, held, d);
    return d;
  }

  Map map_;
  Friction law_;
  friction::Integrated<Friction> friction_;
  friction::Integrated<Friction> table_friction_;
  StateVector y_{};
  double level_share_ = 1.0;
  double viscous_share_ = 1.0;
  double stiffness_share_ = 1.0;
  double level_ = 1.0;  ///< of friction at the start of the period [N]
  double table_level_ = 1.0;
  int spare_ = 0;  ///< sub-steps that may still be added in this period
  Equations drive_;
  double mass_ = 1.0;  ///< of the drive side [kg]
  double backlash_ = 0.0;
  double backlash_slope_ = 0.0;
  double on_table_ = 0.0;
};

}  // namespace stribeck::plant
