#pragma once
/// Mass, viscous slope, delay and the first resonance of a measured frequency response.
///
///   V(s) = 1/(m·s + c)                                                      rigid
///        · 1/(T·s + 1)                                                      rigid, behind a current loop or filter of first order
///        · (s²/ωz² + 2ζz·s/ωz + 1)/(s²/ωp² + 2ζp·s/ωp + 1)                  two masses, encoder on the drive side
///        · (2ζp·s/ωp + 1)/(s²/ωp² + 2ζp·s/ωp + 1)                           two masses, encoder on the table
///   G(z) = sampled V(s)/s·exp(−τ·s) behind a zero-order hold, exact for any τ, also a negative one
///
///   m mass [kg]   c slope of friction at the speed of the strokes [N·s/m], may be negative   τ delay beyond the hold [s]
///   T lag of the force [s]
///   ωz anti-resonance, ωp resonance [rad/s]: (ωp/ωz)² − 1 is the mass behind the spring over the mass before it
///
/// Weighted least squares on G_model/G − 1. The model: least error on lines that its fit did not see (every fifth, in turn), and of
/// two masses only where that is far better than rigid and the resonance is known to 10 %, below the highest line; a lag only where it is
/// as much better, known to a third, and leaves no more than three times the noise.
/// Intervals: 95 %, Student's t, widened by what the fit leaves beyond the noise. That of the mass is wider by |c|/ω of the highest line:
/// bristles that relax faster than the lines show look like a mass of up to this size, and shift the resonance by half its share. Source: Pintelon, Schoukens 2012, ch. 9, 11;
/// Åström, Wittenmark 1997, Computer-Controlled Systems, 2.3, 3.2.
/// Not modelled: a lag beside two masses, further modes, friction of the table apart from damping, a resonance above half the sampling frequency, which folds.
/// Real time: no. Errors: Refused where fewer than six lines, or not the mass, are determined.

#include <array>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/frequency/response.hpp>
#include <stribeck/ident/result.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::ident::frequency {

enum class Structure { kRigid, kTwoMassDrive, kTwoMassTable, kRigidLag };

/// The model in numbers.
struct Plant {
  Structure structure = Structure::kRigid;
  double mass = 0.0;           ///< [kg]
  double viscous = 0.0;        ///< [N·s/m]
  double delay = 0.0;          ///< [s]
  double antiresonance = 0.0;  ///< [rad/s]; 0: none
  double resonance = 0.0;      ///< [rad/s]; 0: none
  double zero_damping = 0.0;   ///< ζz
  double damping = 0.0;        ///< ζp
  double lag = 0.0;            ///< T [s]; 0: none
};

/// Position for a unit force [m/N] as a controller with this period sees it.
Complex sampled_response(const Plant& plant, double omega, double sample_time);

struct Value {
  double value = 0.0;
  double half_width = 0.0;  ///< 95 %

  [[nodiscard]] double low() const noexcept { return value - half_width; }
  [[nodiscard]] double high() const noexcept { return value + half_width; }
};

struct PlantFit {
  Plant plant;
  Value mass, viscous, delay;
  std::optional<Value> resonance, antiresonance;  ///< [rad/s]
  std::optional<Value> damping;                   ///< ζp
  std::optional<Value> lag;                       ///< T [s]
  double misfit = 0.0;                            ///< RMS of |G_model/G − 1| over the lines
  double excess = 1.0;           ///< RMS residual over that of the noise; 1: the model is as good as the data
  std::vector<double> held_out;  ///< error on held-out lines of each Structure, in noise; NaN: not fitted
  bool beyond = false;           ///< one mass is not enough, and the lines determine no resonance
  std::string reason;            ///< why this structure
};

PlantFit fit_plant(const Response& response);

}  // namespace stribeck::ident::frequency

template <>
struct stribeck::EnumNames<stribeck::ident::frequency::Structure> {
  using S = stribeck::ident::frequency::Structure;
  static constexpr std::array names{std::pair{S::kRigid, std::string_view{"rigid"}},
                                    std::pair{S::kTwoMassDrive, std::string_view{"two-mass-drive"}},
                                    std::pair{S::kTwoMassTable, std::string_view{"two-mass-table"}},
                                    std::pair{S::kRigidLag, std::string_view{"rigid-lag"}}};
};
