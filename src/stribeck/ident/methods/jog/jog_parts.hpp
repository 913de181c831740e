#pragma once
/// Inside of identify_jog(): candidate curves over mean forces, the choice among them, their intervals, and the search for
/// runs of different days.
///
///   jog.cpp            records to runs, groups and the result
///   jog_fit.cpp        the candidates and how each is fitted
///   jog_choice.cpp     every speed left out in turn; one standard error
///   jog_intervals.cpp  intervals of parameters and of the curve
///   jog_jump.cpp       finds a jump of friction that no friction curve has
///
/// Inside ident only. Real time: no.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/ident/map/gaussian_fit.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::methods::jog {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

inline constexpr int kMostGaussians = 6;

/// Mean force of one run.
struct Point {
  double v = 0.0;      // [m/s]
  double f = 0.0;      // [N]
  double error = 0.0;  // [N]
  double weight = 1.0;
  std::size_t fold = 0;
  std::size_t run = 0;
};

/// The points of one direction, 0: v > 0.
std::vector<Point> side_of(const std::vector<Point>& points, int side);
/// Median error of the points [N].
double typical_error(const std::vector<Point>& points);

// jog_fit.cpp

enum class Family { kLine, kStribeck, kFreeStribeck, kLines, kCommonStribeck, kOwnStribeck, kGaussians };

struct Kind {
  Family family;
  int terms;  // of kGaussians
  [[nodiscard]] bool symmetric() const { return family <= Family::kFreeStribeck; }
};

/// Parameters in the order of the law, linear ones first:
///   kLine α0, α2, load;  kStribeck + rise, v0;  kFreeStribeck + rise, v0, δ
///   kLines η0+, η1+, η0−, η1− (against the motion);  kCommonStribeck + a+, a−, c;  kOwnStribeck + a+, a−, c+, c−
///   kGaussians: in `branch`
struct Fit {
  Kind kind{};
  std::vector<double> p;
  std::array<map::BranchFit, 2> branch;
  double top = 0.0;  // speed that stands for u = 1

  [[nodiscard]] std::size_t parameters() const {
    return kind.family == Family::kGaussians ? branch[0].parameters() + branch[1].parameters() : p.size();
  }
  [[nodiscard]] double operator()(double v) const;
  /// ∂f/∂parameters.
  [[nodiscard]] VectorXd gradient(double v) const;
};

/// Gaussian fits of one set of points with 0, 1, … terms; each starts from the one before.
struct Ladders {
  bool done = false;
  std::vector<map::BranchFit> side[2];
};

class Fitter {
 public:
  Fitter(const JogOptions& options, bool both) : options_(options), both_(both) {}

  /// Empty where the points do not determine the candidate.
  [[nodiscard]] std::optional<Fit> fit(const Kind& kind, const std::vector<Point>& points,
                                       Ladders& ladders) const;

 private:
  [[nodiscard]] std::vector<map::BranchFit> ladder_of(const std::vector<Point>& points, int side, double top,
                                                      int terms) const;

  const JogOptions& options_;
  bool both_;
};

std::string name_of(const Kind& kind);
/// As friction::Gaussian; the branches have signs as in Table 2.3.
friction::Gaussian<double> as_map(const Fit& fit, const std::array<double, 2>& range);
/// Whether friction opposes the motion; otherwise it cannot be the level of a hysteresis.
bool opposes(const Fit& fit, double low, double high);

// jog_choice.cpp

struct Chosen {
  Fit fit;
  std::vector<Candidate> candidates;
  double held_out = std::numeric_limits<double>::quiet_NaN();
  bool chosen_by_leaving_out = false;
};
Chosen choose(const std::vector<Point>& points, std::size_t folds, const Fitter& fitter,
              const JogOptions& options, bool both, double low, double high);

// jog_intervals.cpp

/// Half widths of 95 % intervals of any linear function of the parameters.
class Spread {
 public:
  Spread(const Fit& fit, const std::vector<Point>& points);
  [[nodiscard]] double half_width(const VectorXd& gradient) const;

 private:
  VectorXd scale_;
  MatrixXd left_, means_;
  double factor_ = 0.0;
};

void add_parameters(const Fit& fit, const Spread& spread, Result& r);

// jog_jump.cpp

/// Friction of one direction over speed; runs at the same speed are joined.
struct SpeedMean {
  double v = 0.0, f = 0.0, variance = 0.0, n = 0.0;
};
std::vector<SpeedMean> means_of(const std::vector<Point>& ascending, int side);

/// A step of friction between two neighbouring speeds that no friction curve has: measured on another day.
struct Jump {
  double below = 0.0, above = 0.0;  // [m/s]
  double share = 0.0;               // of the force, signed
  double errors = 0.0;              // its size in standard errors
};
/// The largest step that both directions have between the same speeds and with the same sign.
std::optional<Jump> find_jump(const std::vector<Point>& ascending);
/// For the search for different days: where each record is one run and its speed wandered, the mean of the record replaces
/// that of each of its pieces.
std::vector<Point> by_record(const std::vector<Point>& points, const std::vector<map::SteadyRun>& runs,
                             const std::vector<log::Record>& records);
/// Sorts by speed and gives each run the number of its speed. Returns how many speeds there are.
std::size_t number_folds(std::vector<Point>& points);

}  // namespace stribeck::ident::methods::jog
