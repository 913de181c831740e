#pragma once
/// By how much the friction at each speed differs from its mean over the time of the logs, because the level of friction
/// drifts: warming up, running in.
///
///   e_i·sgn v = F(|v_i|)·(α_r + β_r·P1(τ_i) + γ_r·P2(τ_i)) + noise       τ from −1 at the beginning of log r to 1 at its end
///
/// e is the residual of the map [N], F the map without load [N], P1 and P2 Legendre polynomials, α, β, γ shares of friction. α of the
/// first log is 0. All columns are taken about the means of the bins of speed, so that the curve itself is free. The drift
/// shows where the same speed occurs at two times. A speed that was run early is then known to have been run cold. The
/// shares have a prior of 0 ± 0.3, so that speeds in order, which show no drift, give none.
///
/// Used where α or β of a log is more than twice its 95 % half width and more than 2 %; where no drift shows, force and intervals stay as they are.
/// at_mean_level() then takes the drift out of the force, and everything is fitted again.
/// Not modelled: a level that jumps; viscous friction that drifts otherwise than Coulomb friction.
/// Inside ident only. Real time: no.

#include <array>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/map/static_fit.hpp>
#include <vector>

namespace stribeck::ident::drive {

class LevelDrift {
 public:
  LevelDrift() = default;
  /// `residual` of each row, as in Intervals.
  LevelDrift(const AlignedLog& log, const Rows& rows, const map::StaticFit& map,
             const std::vector<double>& residual);

  /// Whether the logs show a drift.
  [[nodiscard]] bool found() const { return found_; }
  /// Largest distance of the friction of the rows around a speed from that of the mean over time, 95 %, as a share of friction.
  [[nodiscard]] double at(int side, double speed) const { return largest(side, speed, &Bin::away); }
  /// Half width of what is not known of that distance: what is left once the drift is taken out.
  [[nodiscard]] double unsure(int side, double speed) const { return largest(side, speed, &Bin::unsure); }
  /// Share of friction by which the level rises from the beginning to the end of the log of this record; 0 where that is not sure.
  [[nodiscard]] double rise(std::size_t record) const { return found_ ? courses_[record].rise : 0.0; }
  /// Level of friction over its mean at a row of a record.
  [[nodiscard]] double level(const log::Record& record, std::size_t number, std::size_t row) const;

 private:
  struct Bin {
    double rows = 0.0;
    double away = 0.0;    ///< share of friction, not signed
    double unsure = 0.0;  ///< its half width
  };
  /// Level over its mean less one, as polynomials over the time of a log.
  struct Course {
    double begin = 0.0, end = 1.0;  ///< [s]
    std::array<double, 3> share{};
    double rise = 0.0;  ///< from begin to end, where it is sure
  };
  [[nodiscard]] double largest(int side, double speed, double Bin::*what) const;

  std::vector<Course> courses_;  ///< of each record
  std::array<std::vector<Bin>, map::kSides> bins_;
  std::array<map::Grid, map::kSides> grid_;
  bool found_ = false;
};

/// The records with the force that they would have at the mean level of friction: what force and acceleration leave of friction
/// is divided by the level of its time.
std::vector<log::Record> at_mean_level(const AlignedLog& log, const LevelDrift& drift, double mass,
                                       double load);

}  // namespace stribeck::ident::drive
