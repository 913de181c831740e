#pragma once
/// Backlash and wind-up between motor and table, from positions of both.
///
///   δ = x_m − x_s − o − γ·x_s − τ·v_s             o offset, γ scale error, τ delay between the encoders
///   f = m_1·a_m + l + F_1·h + c·v_m + k·p(δ)      the motor's side alone: what passes to the table is k·p(δ)
///   p(δ) = δ ∓ b/2 beyond ±b/2, else 0            b backlash, k stiffness of the wind-up
///   h' = (±1 − h)/ℓ by distance                   share of the motor's friction F_1 that has turned after a reversal
///
/// The fit takes the rows around each reversal, where the table stands and δ runs from one side to the other. While the
/// table slides, δ is b/2 + (its friction)/k: backlash and wind-up cannot be distinguished there, only their sum is known, the lost
/// motion. Without a force nothing else is known.
///
///   x_m, x_s motor and scale [m], v, a their rates, f force of the drive [N], m_1, l, F_1, c mass, load and friction of the
///   motor's side
///
/// Intervals: 95 %, from leaving out groups of reversals (jackknife). A quantity is absent where the data do not carry it;
/// `words` then says why.
/// Source: Nordin, Gutman 2002, doi:10.1016/S0005-1098(02)00047-X (dead zone with a shaft). Theory: docs/theory/lost-motion.md.
/// Not modelled: a stiffness that changes with its force; more than two masses; errors of an encoder within its period.
/// Real time: no. Errors: none; what cannot be found is absent.

#include <optional>
#include <string>
#include <vector>

namespace stribeck::ident::lost_motion {

/// One run with two encoders, at equal times.
struct Positions {
  double sample_time = 0.0;   ///< [s]
  std::vector<double> motor;  ///< [m]
  std::vector<double> scale;  ///< [m]
  std::vector<double> force;  ///< [N]; empty: none
};

struct Estimate {
  double value = 0.0;
  double half_width = 0.0;  ///< of the 95 % interval

  [[nodiscard]] double low() const noexcept { return value - half_width; }
  [[nodiscard]] double high() const noexcept { return value + half_width; }
};

struct LostMotion {
  std::optional<Estimate> total;           ///< between the directions while the table slides slowly [m]
  std::optional<Estimate> backlash;        ///< at position 0 where it varies, else everywhere [m]
  std::optional<Estimate> stiffness;       ///< [N/m]
  std::optional<Estimate> backlash_slope;  ///< absent: it does not change along the travel
  double table_friction = 0.0;             ///< that the wind-up carries while sliding slowly; 0: unknown [N]
  double motor_mass = 0.0;                 ///< of the motor's side; 0: unknown [kg]
  double build_up = 0.0;                   ///< ℓ; 0: unknown [m]
  double offset = 0.0;                     ///< of the encoders [m]
  double scale_error = 0.0;                ///< motor against scale
  double delay = 0.0;                      ///< scale later than motor [s]
  int reversals = 0;
  bool none = false;               ///< measured, and nothing is lost
  std::vector<std::string> words;  ///< what is absent and why, one sentence each
};

LostMotion identify(const std::vector<Positions>& runs);

}  // namespace stribeck::ident::lost_motion
