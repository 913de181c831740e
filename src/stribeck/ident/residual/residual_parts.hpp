#pragma once
/// Inside of residual.hpp: what is handed from the rows to the causes. Inside ident only. Real time: no.

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/residual/residual.hpp>
#include <stribeck/ident/shown.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::residual {

/// One record with its motion and what the model leaves.
struct Left {
  const log::Record* record = nullptr;
  log::Motion motion;
  std::vector<double> raw;           ///< residual of the force as logged; 0 in rows that do not count [N]
  std::vector<std::size_t> counted;  ///< rows that count
};

/// A row that counts; of a long log the mean of neighbours.
struct Row {
  int record = 0;
  std::size_t at = 0;  ///< number of the mean in its record
  int stretch = 0;     ///< counted over all records
  double t = 0.0;      ///< [s]
  double x = 0.0;      ///< [m]
  double v = 0.0;      ///< [m/s]
  double a = 0.0;      ///< [m/s²]
  double e = 0.0;      ///< residual behind the low-pass [N]
  double sign = 1.0;
  double f = 0.0;          ///< force behind the low-pass [N]
  double travelled = 0.0;  ///< since the reversal [m]
  double snap = 0.0;       ///< second derivative of the acceleration [m/s⁴]; NaN: not known
};

struct Rows {
  std::vector<Row> rows;
  std::vector<const log::Record*> records;
  double low = 0.0;       ///< travel [m]
  double high = 0.0;      ///< [m]
  double friction = 0.0;  ///< RMS [N]
  double mass = 0.0;      ///< of the model [kg]; 0: it has none
  std::string force_unit;
  std::string position_unit;
  bool rotary = false;      ///< positions are arcs at a radius of 1 m
  bool unbalanced = false;  ///< the model has the weight of an axis that turns
  bool drifts = false;      ///< the level of friction rises or falls over time

  /// Whether the position is an angle in radians.
  [[nodiscard]] bool turns() const noexcept { return rotary || position_unit == "rad"; }
  [[nodiscard]] double middle() const noexcept { return 0.5 * (low + high); }
  /// −1 … 1 over the travel.
  [[nodiscard]] double along(const Row& r) const noexcept { return (r.x - middle()) / (0.5 * (high - low)); }
  /// Units for sentences.
  [[nodiscard]] Shown shown() const { return Shown(*this); }
};

using Columns = std::vector<std::function<double(const Row&)>>;

/// Least squares of the residual, or of the whole force, on columns, those of the model first.
struct Fit {
  Eigen::MatrixXd X;
  Eigen::VectorXd theta, left;
  std::vector<double> half;  ///< of 95 %
  std::vector<double> told;  ///< share of each column that the others do not explain
  double square = 0.0;       ///< of what is left
};

// columns.cpp
/// Acceleration, and any friction over speed: straight pieces between knots for each direction, load included. A model
/// that was fitted without a cause has taken part of it for friction; these columns give it back.
Columns model_columns(const Rows& rows);
Fit fit(const Rows& rows, const Columns& columns, double Row::*target = &Row::e);
// lines.cpp
void find_lines(const std::vector<Left>& left, double mass, Quality& quality);
// causes.cpp
void find_causes(const std::vector<Left>& left, const Rows& rows, Diagnosis& out);
// one_sided.cpp
/// Nothing where a force in both directions explains as much.
void find_one_sided(const Rows& rows, Diagnosis& out);
// elastic.cpp
/// A table on a spring behind the motor, where it explains much of `force` [N] that the columns of the rigid model (`base`, the
/// acceleration first, one line for each row) leave; `rigid_mass`: mass of that model [kg].
std::optional<Elastic> find_table(const std::vector<Left>& left, const Rows& rows,
                                  const Eigen::MatrixXd& base, const Eigen::VectorXd& force,
                                  double rigid_mass);
// changes.cpp
/// Causes that show over time: a sudden change, speeds in order, logs that differ.
void find_changes(const Rows& rows, Diagnosis& out);

}  // namespace stribeck::ident::residual
