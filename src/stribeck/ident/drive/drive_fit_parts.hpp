#pragma once
/// identify_drive() from inside: what its passes share. Each part of the work has a file of its own.
///
///   drive_fit.cpp            the passes in their order; records to motions
///   drive_fit_rows.cpp       rows of settled sliding motion, blocks of them, a sample of them
///   drive_fit_linear.cpp     mass, periodic terms and shift with friction of every bin free
///   drive_fit_shift.cpp      the shift between force and motion: search, Gauss–Newton, judgement
///   drive_fit_map.cpp        the steady map over the bins, alone and together with periodic terms
///   drive_fit_intervals.cpp  covariance of linear terms and map
///   drive_fit_result.cpp     the result in words and numbers; pre-sliding and drift
///
/// Inside ident only. Real time: no.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/relaxation.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/map/drive_rows.hpp>
#include <stribeck/ident/map/periodic.hpp>
#include <stribeck/ident/map/static_fit.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

std::string text(const char* format, auto... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// A term periodic in position: two columns, sine and cosine.
struct Wave {
  double period = 1.0;
  friction::EccentricForm form = friction::EccentricForm::kAdditive;
  Interval period_interval;
  std::vector<std::vector<double>> sine,
      cosine;  // of each record, through the window that the force has passed
};

class DriveFit {
 public:
  DriveFit(const std::vector<log::Record>& records, const DriveFitOptions& options)
      : records_(records), options_(options) {}
  Result run();

 private:
  void prepare();
  /// The motion that the reference alone explains, v̂ = Σ h_j·ṙ(k − l_j): free of the noise, and close to the
  /// measured motion even behind a slow position loop. Its acceleration is the instrument of the mass.
  void predict(const log::Record& record, log::Motion& m);
  void warn(std::string words) { result_.warnings.push_back(std::move(words)); }

  // ---- rows -----------------------------------------------------------------------------------------------
  void gather(double exclude, double slowest_share, double relaxation);
  /// Blocks of motion for held-out errors: whole stretches, dealt out in turn; where there are few, pieces.
  void deal();
  [[nodiscard]] const log::Motion& motion(std::size_t i) const {
    return motions_[static_cast<std::size_t>(rows_.record[i])];
  }
  [[nodiscard]] double velocity(std::size_t i) const { return motion(i).v[rows_.at[i]]; }
  [[nodiscard]] double direction(std::size_t i) const { return map::kDirection[rows_.side[i]]; }

  // ---- terms that are linear ------------------------------------------------------------------------------
  [[nodiscard]] std::size_t columns() const {
    return (options_.mass ? 0u : 1u) + 2 * waves_.size() + (shift_free_ ? 1u : 0u);
  }
  /// Columns of row i; the force that is left when a known mass is taken off.
  double fill(std::size_t i, double* c) const {
    const log::Motion& m = motion(i);
    const std::size_t k = rows_.at[i];
    double f = m.f[k] - rows_.lag[i];
    if (options_.mass) {
      f -= *options_.mass * m.a[k];
    } else {
      *c++ = m.a[k];
    }
    const auto r = static_cast<std::size_t>(rows_.record[i]);
    for (const Wave& w : waves_) {
      const double d = w.form == friction::EccentricForm::kProportional ? direction(i) : 1.0;
      *c++ = d * w.sine[r][k];
      *c++ = d * w.cosine[r][k];
    }
    if (shift_free_) *c = 0.5 * (m.f[k + 1] - m.f[k - 1]);
    return f;
  }
  /// What least squares multiplies with instead of the change of the force, which a controller makes react to
  /// the noise: the change of the force that the reference asks for.
  [[nodiscard]] double shift_instrument(std::size_t i, double change) const {
    return asked_.empty() || !asks(static_cast<std::size_t>(rows_.record[i])) ? change : asked_[i];
  }
  [[nodiscard]] bool asks(std::size_t record) const { return !predicted_[record].empty(); }
  /// m·a + F(v) of the predicted motion, differenced, at the rows in use.
  void ask();
  /// Least squares of the linear terms with friction of each bin taken out; then the map without a model.
  /// `instruments`: the map of the pass before is there, to take slopes within a bin out and to make an
  /// instrument of a programmed force.
  void solve(bool instruments);
  /// Friction over the bins without its load, for the level of the bristle.
  [[nodiscard]] Level level();

  // ---- passes ---------------------------------------------------------------------------------------------
  /// Friction near reversals unknown: generous exclusion.
  void pilot();
  /// Goes on with a sample of the rows. Until friction and shift have settled no more is needed. False: these
  /// are all.
  bool thin_out();
  /// All rows again, with the force at all of them.
  void take_all();
  void settle();
  /// As far as rows are in use.
  void align(double shift);
  /// Rows in sequence, spread over everything, for what is only looked at.
  [[nodiscard]] std::vector<std::size_t> sample() const;
  /// Shift of least residual when friction of every bin and the mass are free.
  void find_shift();
  /// Gauss–Newton on the column of the shift.
  void newton_shift();
  /// With friction settled: the shift again, and whether it is one. A commanded force acts under its hold,
  /// exactly: nothing is gained by estimating what is known.
  void judge_shift();
  /// Σ residual² with friction of every bin free [N²].
  [[nodiscard]] double left_over() const;
  /// 95 % half width of the shift beside the mass [rows].
  [[nodiscard]] double shift_half_width() const;

  // ---- the map --------------------------------------------------------------------------------------------
  map::StaticChoice choose();

  // ---- friction of velocity and of position together --------------------------------------------------------
  /// A steady map with the linear terms that belong to it.
  struct Joint {
    map::StaticFit fit;
    VectorXd linear;
    bool good = false;
  };
  /// Gauss–Newton on linear terms and map together, on the sums of all blocks but one. On a sine every speed has
  /// two positions only: bins of speed would take the even part of a periodic term for friction; a map of few
  /// parameters does not.
  Joint fit_jointly(const map::StaticFit& start, std::size_t without) const;
  /// Σ residual² of one block.
  [[nodiscard]] double joint_loss(const Joint& joint, std::size_t k) const;
  /// Families of few parameters fitted together with the periodic terms, beside what the bins have chosen.
  void join(map::StaticChoice& choice);
  void add_wave(const map::PeriodicTerm& term);
  /// Terms periodic in position, if held-out motion is better for them.
  map::StaticChoice try_periodic(map::StaticChoice without);

  // ---- uncertainty ----------------------------------------------------------------------------------------
  void intervals();
  /// Column that multiplies the residual in place of column j: an instrument or itself.
  [[nodiscard]] std::size_t multiplier(std::size_t j) const {
    const std::size_t q = columns();
    if (j == 0 && !options_.mass && !weak_) return q;
    return shift_free_ && j + 1 == q ? q + 1 : j;
  }
  /// Standard error of hᵀθ, θ = (linear terms, map).
  [[nodiscard]] double error_of(const VectorXd& h) const;
  [[nodiscard]] double error_at(std::size_t i) const;

  // ---- result ---------------------------------------------------------------------------------------------
  [[nodiscard]] std::string in_units(std::string unit) const;
  void add(std::string name, double value, const std::string& unit, const std::string& shown, double error,
           bool seen);
  Result finish();
  void write_map();
  void write_waves();
  void write_curve(int s);
  void write_points();
  /// Pre-sliding from the reversals. Records of a closed loop where there are any: their slow reversals tell more
  /// than the ringing after a pulse.
  void bristle();
  /// Friction or offset that moves with time, on the longest record.
  void drift();
  const std::vector<log::Record>& records_;
  const DriveFitOptions& options_;
  Result result_;
  std::vector<log::Motion> motions_;
  std::vector<std::vector<double>> force_;  // smoothed, not aligned
  double shift_ = -0.5;
  bool shift_free_ = false;
  std::vector<std::vector<double>> predicted_;  // velocity that the reference explains [m/s]
  std::vector<double> asked_;  // change of the force that the reference asks for, by row in use [N]
  double near_ = 0.0;
  std::array<double, map::kSides> top_{};
  map::Rows rows_, all_rows_;  // in use; put aside while a sample is
  std::size_t blocks_ = 5;
  std::vector<std::uint8_t> block_, all_blocks_;
  bool thin_ = false;
  std::array<map::Grid, map::kSides> grid_;
  std::array<map::BinCurve, map::kSides> line_, bare_;
  double offset_ = 0.0;
  double mass_ = 0.0;
  double plain_mass_ = 0.0;
  bool weak_ = false;
  std::vector<Wave> waves_;
  VectorXd linear_;
  std::vector<VectorXd> linear_held_;
  MatrixXd moments_, instrument_moments_;
  std::vector<MatrixXd> raw_cross_;                          // by block: products of the columns
  std::array<std::vector<double>, map::kSides> block_sums_;  // by side: block, bin, column
  std::vector<std::vector<double>> mean_;  // sums by side, bin and column, then rows and speed
  map::StaticChoice choice_;
  std::optional<VectorXd> joint_;  // linear terms of a map that was fitted together with them
  std::vector<double> residual_;
  stats::Memory memory_;
  MatrixXd covariance_, pooled_;
  std::vector<double> blind_;
  double factor_ = 1.96;
};

}  // namespace stribeck::ident::drive
