#pragma once
/// Limits of supervision for one axis: the settings, and the values that follow from the axis where nothing is set.
///
///   A      greatest usual acceleration = min((force limit + F₀ + |load|)/m, max(4·acceleration limit, 3F₀/m)); for samples that a force
///          f has just moved, at least 1.5·(|f − load| + F₀)/m
///   jump   10 encoder steps + A·T²           how far a sample may lie from its prediction
///   n      samples bridged in a row = 10 ms/T, at least 3 and at most 50; one more is a fault
///   push   max(2F₀, force limit/4)                 a force that friction cannot hold
///   start  max(start share·force limit, 1.25·push)    force in addition to the load until the sign is proven (sign_proof.hpp)
///   speed  1.5·speed limit
///   following error   e₀ + 100 ms·|ṙ|,   e₀ = max(20 ms, 1/ω)·speed limit + 3F₀/(m·ω²), without ω 20 ms·speed limit
///   swing  max(force limit/2, min(3F₀, 1.5·force limit))      of an oscillation that is a fault
///
///   F₀ level of friction at rest [N], ω² = k_p of the loop [1/s²]. 3F₀: friction that turns over is 2F₀. The factor 1.5 is for a
///   model that is off: friction a fourth too small, mass a sixth too large.
/// A value that depends on an unknown limit is infinite: that check is off.
/// Source: Stribeck's own; docs/theory/supervision.md derives them.
/// Not modelled: a spring and an unbalance (friction/spring.hpp): their force counts as a push, and a safe stop does not hold it.
/// Real time: configure only. Errors: none.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <stribeck/control/compensation/compensation.hpp>
#include <stribeck/core/fields.hpp>
#include <string_view>
#include <utility>

namespace stribeck::control {

/// The checks of an axis.
enum class Checks : std::uint8_t {
  kNone,
  kLost,  ///< only samples and references that are NaN or infinite for too long; the law handles each single one itself
  kAll
};

}  // namespace stribeck::control

template <>
struct stribeck::EnumNames<stribeck::control::Checks> {
  using enum stribeck::control::Checks;
  static constexpr std::array names{std::pair{kNone, std::string_view{"none"}},
                                    std::pair{kLost, std::string_view{"lost"}},
                                    std::pair{kAll, std::string_view{"all"}}};
};

namespace stribeck::control {

struct SupervisionParams {
  Checks checks = Checks::kAll;
  std::optional<double> speed_limit{};         ///< [m/s]
  std::optional<double> acceleration_limit{};  ///< [m/s²]
  std::optional<double> jump{};                ///< [m]
  std::optional<double> push{};                ///< [N]
  std::optional<double> following_error{};     ///< at rest [m]
  std::optional<double> omega{};               ///< of the position loop [rad/s]
  double following_time = 0.1;                 ///< [s]
  double bridge_time = 10e-3;                  ///< [s]
  double stop_time = 50e-3;                    ///< [s]
  double saturation_time = 0.5;                ///< [s]
  double start_share = 0.5;                    ///< share of the force limit until the sign is proven

  static constexpr auto fields() {
    using P = SupervisionParams;
    return std::tuple{
        field("checks", &P::checks,
              "what is supervised: none, lost (encoder or command), or all (samples and motion as well)")
            .or_default(),
        field("speed_limit", &P::speed_limit, quantity("m/s", "mm/s").positive(),
              "largest speed of the axis; left out: speed and following error are not checked")
            .or_default(),
        field("acceleration_limit", &P::acceleration_limit, quantity("m/s2", "mm/s2").positive(),
              "largest acceleration of the axis; left out: what the force limit gives the mass")
            .or_default(),
        field("jump", &P::jump, quantity("m", "um").positive(),
              "how far a sample may lie from its prediction; left out: 10 encoder steps and the largest "
              "acceleration over a period")
            .or_default(),
        field("push", &P::push, quantity("N", "N").positive(),
              "force that friction cannot hold; left out: twice the level, at least a quarter of the force "
              "limit")
            .or_default(),
        field(
            "following_error", &P::following_error, quantity("m", "mm").positive(),
            "largest following error at rest; left out: 20 ms at the speed limit or what friction and a slow "
            "loop make")
            .or_default(),
        field(
            "omega", &P::omega, quantity("rad/s", "rad/s").positive(),
            "square root of the proportional gain of the loop, for the largest following error; left out: in "
            "the C interface that of the axis, else unknown")
            .or_default(),
        field("following_time", &P::following_time, quantity("s", "ms").not_negative(),
              "by how much the largest following error grows with the speed of the reference")
            .or_default(),
        field("bridge_time", &P::bridge_time, quantity("s", "ms").positive().at_most(0.1),
              "how long wild or missing samples are bridged, at least three")
            .or_default(),
        field("stop_time", &P::stop_time, quantity("s", "ms").positive().at_most(1.0),
              "from the first bad sample to the safe force")
            .or_default(),
        field("saturation_time", &P::saturation_time, quantity("s", "ms").positive(),
              "how long the force may stay at its limit")
            .or_default(),
        field("start_share", &P::start_share, pure_number().positive().at_most(1.0),
              "share of the force limit that is used until the axis has once moved as the force says")
            .or_default()};
  }
};

/// Values that the checks use; infinite: check off.
struct SupervisionLimits {
  static constexpr double kOff = std::numeric_limits<double>::infinity();

  Checks checks = Checks::kAll;
  double period = 1e-3;         ///< T [s]
  double step = 0.0;            ///< of the encoder [m]
  double mass = 1.0;            ///< [kg]
  double load = 0.0;            ///< [N]
  double force = 0.0;           ///< limit [N]
  double noise = 0.0;           ///< part of the jump that does not grow with bridged samples [m]
  double growth = kOff;         ///< A·T², for each period without a good sample [m]
  double pushed = 0.0;          ///< the same per force [m/N]
  double speed = kOff;          ///< [m/s]
  double level = 0.0;           ///< of friction at rest [N]
  double push = kOff;           ///< [N]
  double start = kOff;          ///< [N]
  double following = kOff;      ///< [m]
  double following_time = 0.0;  ///< [s]
  double swing = kOff;          ///< [N]
  int samples = 3;              ///< n
  int late_periods = 0;         ///< delay of the force, rounded up
  int stop_periods = 0;
  int saturation_periods = 0;

  SupervisionLimits() = default;
  SupervisionLimits(const SupervisionParams& p, const CompensationParams& axis, double force_limit,
                    double t) noexcept
      : checks(p.checks),
        period(t),
        step(axis.encoder_resolution),
        mass(axis.model.mass),
        load(axis.model.load),
        force(force_limit),
        noise(kSteps * step),
        following_time(p.following_time) {
    samples = periods(p.bridge_time, 3, 50);
    late_periods = static_cast<int>(std::ceil(clamp_to(axis.delay() / t, 0.0, 1.0 * kMostDelay) - 1e-6));
    stop_periods = periods(p.stop_time, 1, 100000);
    saturation_periods = periods(p.saturation_time, 1, 1000000);
    if (checks != Checks::kAll) return;
    level = axis.model.friction.parts(0.0, 0.0).level;
    const double turned = 2.0 * kModel * level;
    const double physical = (force_limit + level + abs(load)) / mass;
    const double usual =
        p.acceleration_limit ? max_of(kAcceleration * *p.acceleration_limit, turned / mass) : physical;
    growth = min_of(physical, usual) * t * t;
    pushed = kModel / mass * t * t;
    if (p.jump) {
      // The builder's value replaces noise + growth of one period, and large forces permit no more than that. Its part that grows with
      // bridged samples still follows from physics alone; otherwise bridging would not find back.
      growth = min_of(growth, *p.jump);
      pushed = 0.0;
      noise = *p.jump - growth;
    }
    speed = p.speed_limit ? kSpeed * *p.speed_limit : kOff;
    const double known = isfinite(force_limit) ? max_of(2.0 * level, 0.25 * force_limit) : 2.0 * level;
    push = p.push ? *p.push : known > 0.0 ? known : kOff;
    // Below push, a wrong sign would not be seen.
    if (p.start_share < 1.0) start = max_of(p.start_share * force_limit, kStart * push);
    if (p.following_error) {
      following = *p.following_error;
    } else if (p.speed_limit) {
      following = p.omega ? max_of(kFollowing, 1.0 / *p.omega) * *p.speed_limit +
                                turned / (mass * *p.omega * *p.omega)
                          : kFollowing * *p.speed_limit;
    }
    if (isfinite(force_limit)) swing = max_of(kSwing * force_limit, min_of(turned, kMostSwing * force_limit));
  }

  /// A·T² after a force f − load of this size [m].
  [[nodiscard]] double growth_after(double size) const noexcept {
    return max_of(growth, pushed * (size + level));
  }

  /// Velocities below this are the encoder's own steps [m/s].
  [[nodiscard]] double rattle() const noexcept { return 5.0 * step / period; }

 private:
  static constexpr double kSteps = 10.0;
  static constexpr double kAcceleration = 4.0;
  static constexpr double kSpeed = 1.5;
  static constexpr double kFollowing = 20e-3;
  static constexpr double kStart = 1.25;
  static constexpr double kModel = 1.5;  ///< acceleration by friction of a machine against that of its model
  static constexpr double kSwing = 0.5;  ///< of the force limit
  static constexpr double kMostSwing = 1.5;

  [[nodiscard]] int periods(double time, double least, double most) const noexcept {
    return static_cast<int>(clamp_to(std::floor(time / period + 1e-6), least, most));
  }
};

}  // namespace stribeck::control
