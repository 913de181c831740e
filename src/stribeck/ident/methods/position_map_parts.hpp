#pragma once
/// Inside of position_map.hpp: the values that each step hands to the next, from the logs to the result.
///
///   position_map_rows.cpp     logs → Rows: sliding rows, smoothed, in groups
///   position_map_fit.cpp      Rows, Shape, Nonlinear → Fit: least squares, Stribeck velocity, periods
///   position_map_choice.cpp   which parts of the law are needed, judged on passes that were left out
///   position_map_result.cpp   Fit → Result: intervals, parameters, curve, points
///   position_map_holding.cpp  the whole method for an axis held at standstill
///
/// Inside ident only: includes Eigen. Real time: no.

#include <Eigen/Core>
#include <cstddef>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/map/periodic.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::methods::position_map {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Approximate number of points kept for plots.
inline constexpr std::size_t kPlotted = 1200;
inline constexpr const char* kHoming =
    "the phase of a periodic term belongs to the homing of this log: after another homing it must be found "
    "again";

Parameter parameter(std::string name, double value, const char* unit, const char* shown, double half,
                    bool seen = true);

/// Consecutive rows of one stretch, averaged; a group is a single row unless the log is very long.
struct Group {
  int record = 0;
  std::size_t first = 0;
  std::size_t rows = 1;
  double sign = 1.0;
  int block = 0;
};

/// The rows that are fitted; each column has one entry for each group.
struct Rows {
  const std::vector<log::Record>* records = nullptr;
  std::vector<log::Motion> motions;
  std::vector<Group> groups;
  std::size_t rows = 0;      ///< number before they were joined
  std::size_t together = 1;  ///< largest number of rows in a group
  bool both = false;         ///< the rows have both directions
  double top = 0.0;          ///< largest speed [m/s]
  double slowest = 0.0;      ///< [m/s]
  double middle = 0.0;       ///< of the travel [m]
  double length = 0.0;       ///< of the travel [m]
  VectorXd y;                ///< force, less that of a given mass [N]
  VectorXd a, v, x;          ///< motion
  VectorXd instrument;       ///< of the acceleration
  VectorXd s;                ///< +1 forward, −1 backward

  /// Means over the groups, of a column of every record.
  [[nodiscard]] VectorXd mean_of(const std::vector<std::vector<double>>& columns) const;
};

/// Throws Refused for records that do not belong together and for too few rows. Writes warnings.
Rows gather(const std::vector<log::Record>& records, const PositionMapOptions& options, Result& result);

/// a·sin(2πf·u) + b·cos(2πf·u), u measured from the middle of the travel; `reversing`: times the direction.
struct Term {
  double f = 0.0;
  double a = 0.0;
  double b = 0.0;
  bool reversing = false;
};

/// The parts that the law has.
struct Shape {
  bool mass = true;
  bool load = true;
  bool asymmetric = false;
  bool rise = false;
  bool periodic = false;

  [[nodiscard]] int count(std::size_t terms) const {
    return (mass ? 1 : 0) + 2 + (load ? 1 : 0) + (asymmetric ? 1 : 0) + (rise ? 2 : 0) +
           (periodic ? 3 * static_cast<int>(terms) : 0);
  }
  [[nodiscard]] std::string name() const {
    std::string s = "conventional";
    if (rise) s += ", Stribeck rise";
    if (asymmetric) s += ", viscous by direction";
    if (periodic) s += ", periodic";
    return s;
  }
};

/// Parameters in which the force is not linear.
struct Nonlinear {
  double v0 = 1e-3;  ///< Stribeck velocity [m/s]
  std::vector<Term> terms;
};

struct Fit {
  Shape shape;
  MatrixXd X;      ///< regressors
  MatrixXd W;      ///< regressors with the acceleration projected on the instrument
  VectorXd theta;  ///< [mass] coulomb viscous [load] [viscous difference] [rise] [sin cos]…
  VectorXd e;
  bool weak = false;

  [[nodiscard]] Index coulomb() const { return shape.mass ? 1 : 0; }
  [[nodiscard]] Index viscous() const { return coulomb() + 1; }
  [[nodiscard]] Index load() const { return viscous() + 1; }
  [[nodiscard]] Index asymmetric() const { return viscous() + 1 + (shape.load ? 1 : 0); }
  [[nodiscard]] Index rise() const { return asymmetric() + (shape.asymmetric ? 1 : 0); }
  [[nodiscard]] Index term(std::size_t j) const {
    return rise() + (shape.rise ? 1 : 0) + 2 * static_cast<Index>(j);
  }
  [[nodiscard]] std::size_t terms() const { return static_cast<std::size_t>(theta.size() - term(0)) / 2; }
};

/// All linear parameters by two-stage least squares.
Fit solve(const Rows& rows, const Shape& shape, const Nonlinear& nonlinear);
/// Finds the Stribeck velocity with the smallest sum of squares, on a grid and then more finely; returns the old one where no
/// speed is slow enough.
double find_rise(const Rows& rows, const Shape& shape, const Nonlinear& nonlinear);
/// Searches periodic terms in the residual, to which the terms of the fit are added back.
map::PeriodicResult search(const Rows& rows, const Fit& fit, const PositionMapOptions& options);
/// Gauss–Newton over the periods, except those that `exact` marks as known; all other parameters are linear.
Fit refine(const Rows& rows, const Shape& shape, bool exact, Nonlinear& nonlinear);
VectorXd rise_slope(const Rows& rows, double v0);
/// ∂/∂f of a term.
VectorXd term_slope(const Rows& rows, const Term& term);

/// The simplest shape that predicts held-out passes within one standard error of the best. Writes all shapes that were tried
/// into the result.
Shape choose(const Rows& rows, const Shape& full, const Nonlinear& nonlinear, Result& result);

/// 95 % half widths of any linear function of the parameters, those included in which the force is not linear.
class Intervals {
 public:
  Intervals(const Rows& rows, const Fit& fit, const Nonlinear& nonlinear, bool exact);

  [[nodiscard]] VectorXd unit(Index i) const { return VectorXd::Unit(scale_.size(), i); }
  [[nodiscard]] double half(Index i) const { return width(unit(i)); }
  /// Half width of gᵀθ; NaN where it depends on directions that these rows do not determine.
  [[nodiscard]] double width(const VectorXd& g) const;
  /// Whether some combination of parameters is not determined at all, e.g. Coulomb against viscous friction at one speed.
  [[nodiscard]] bool some_unseen() const { return unseen_.cols() > 0; }

 private:
  Intervals(const Rows& rows, const Fit& fit, const MatrixXd& X);

  VectorXd scale_;   ///< one over the norm of each column
  MatrixXd unseen_;  ///< directions that are not determined: orthonormal columns, in these scales
  stats::Uncertainty uncertainty_;
};

/// Everything that a result is made of.
struct Described {
  const Rows& rows;
  const Fit& fit;
  const Nonlinear& nonlinear;
  const map::PeriodicResult& found;  ///< of the last search that found a term
  const PositionMapOptions& options;
  const Intervals& intervals;
};
/// Writes parameters, curve and points into the result. `no_mass`: the motion did not determine the mass.
void describe(const Described& d, bool no_mass, Result& result);

Result identify_held(const std::vector<log::Record>& records, const PositionMapOptions& options);

}  // namespace stribeck::ident::methods::position_map
