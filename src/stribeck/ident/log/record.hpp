#pragma once
/// One run of one axis: the input of every identification method.
///
///   t  time [s]                  r  reference position [m]; empty: not logged
///   x  measured position [m]     f  force of the drive [N]
///   v  measured velocity [m/s], where the log has one; empty: from x
///
/// All columns have the same length. Time is uniform with the period T of the controller. f is the commanded force under a
/// zero-order hold: f[k] acts from t[k] to t[k+1]; x[k] is read at t[k]. A positive force pushes towards larger x.
///
/// A log whose force has no known scale keeps its own unit (force_unit "A", "%", "V"). One of an axis without a lead keeps
/// the angle (position_unit "rad"). N and m then stand for these units everywhere. A log that was cut at gaps is several records
/// with the same source.
///
/// Not modelled: a delay between the columns; such a log must be shifted before.
/// Real time: no.
/// Errors: problems() lists everything that is wrong, each with its row.

#include <cstdint>
#include <optional>
#include <stribeck/ident/force_filter.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::log {

/// How the force was made. This decides which signal is free of noise: the reference or the force itself.
enum class Loop {
  kAutomatic,  ///< closed if there is a reference; open if the force looks programmed; otherwise unknown
  kOpen,       ///< the force was programmed and did not react to the axis
  kClosed      ///< a position controller made the force
};

struct Record {
  std::string source;        ///< file or other origin, for messages and reports
  double sample_time = 0.0;  ///< T [s]
  std::vector<double> t;     ///< [s]
  std::vector<double> r;     ///< [m], may be empty
  std::vector<double> x;     ///< [m]
  std::vector<double> f;     ///< [N]
  Loop loop = Loop::kAutomatic;
  std::vector<double> v;           ///< [m/s], may be empty
  std::vector<std::uint8_t> skip;  ///< 1: the row is not fitted (sign of the force unsure, …); may be empty
  std::string force_unit = "N";
  std::string position_unit = "m";
  bool rotary = false;      ///< positions are arcs at a radius of 1 m
  bool measured = false;    ///< f is the force that the drive made: it shows no delay of its command
  bool integrated = false;  ///< x is the integral of v: the log has no position
  double spring = 0.0;      ///< stiffness of a spring whose force was taken off f [N/m]
  std::optional<ForceFilter> filter{};  ///< that was taken off f (drive/smoothing/before_filter.hpp)

  /// Whether the position is an angle in radians.
  [[nodiscard]] bool turns() const noexcept { return rotary || position_unit == "rad"; }
};

/// All reasons why a record cannot be identified, one sentence each with place, value found and value expected; empty for a
/// good record. Time stamps may jitter by 1 % of the period.
std::vector<std::string> problems(const Record& record);

}  // namespace stribeck::ident::log
