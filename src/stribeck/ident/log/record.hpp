#pragma once
/// One run of one axis, as every identification method takes it.
///
///   t  time [s]                  r  reference position [m]; empty: not logged
///   x  measured position [m]     f  force of the drive [N]
///   v  measured velocity [m/s], where the log has one; empty: from x
///
/// All columns have one length. Time is uniform with the period T of the controller. f is the force that was
/// asked for, under a zero-order hold: f[k] acts from t[k] to t[k+1]; x[k] is read at t[k]. Force is positive
/// towards larger x.
///
/// A log whose force has no known scale keeps its own unit (force_unit "A", "%", "V"), and one of an axis without
/// a lead keeps the angle (position_unit "rad"); then N and m stand for these everywhere. A log that was cut at
/// gaps is several records with one source.
///
/// Not modelled: a delay between the columns; a log that has one must be shifted before.
/// Real time: no.
/// Errors: problems() lists everything that is wrong, each with its row.

#include <cstdint>
#include <string>
#include <vector>

namespace stribeck::ident::log {

/// How the force came about. It decides which signal is free of the noise: the reference or the force itself.
enum class Loop {
  kAutomatic,  ///< closed if there is a reference, open if the force looks like a programme, else unknown
  kOpen,       ///< the force was programmed; the axis did not act back on it
  kClosed      ///< a position controller made the force
};

struct Record {
  std::string source;        ///< where it comes from, for messages and reports
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
};

/// Everything that keeps a record from being identified, one sentence each with place, what was got and what
/// was expected; empty when it is good. Time stamps may jitter by 1 % of the period.
std::vector<std::string> problems(const Record& record);

}  // namespace stribeck::ident::log
