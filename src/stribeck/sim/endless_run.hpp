#pragma once
/// A machine that travels a closed path lap after lap under one controller, one period at a time, for as long as the caller likes: the
/// same loop as run_once(), in bounded memory.
///
/// The run begins at rest and reaches its speed within the run-in of the travel. Points of the reference are made as they are needed.
/// Not modelled: cutting forces, part programs, paths that are not closed, compensation of lost motion.
/// Real time: no.
/// Errors: Refused where the run would mean nothing.

#include <memory>
#include <stribeck/sim/compare.hpp>
#include <string>
#include <vector>

namespace stribeck::sim {

class EndlessRun {
 public:
  EndlessRun() = default;
  EndlessRun(const EndlessRun&) = delete;
  EndlessRun& operator=(const EndlessRun&) = delete;
  virtual ~EndlessRun() = default;

  /// The first controller of the spec on its first travel.
  static std::unique_ptr<EndlessRun> make(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                                          const CompareSpec& spec);

  /// One period.
  virtual ContourSample step() = 0;
  /// State of adaptation, one entry per axis that adapts.
  [[nodiscard]] virtual std::vector<control::Drift> drift() const = 0;

  [[nodiscard]] const std::vector<std::string>& axes() const { return axes_; }
  [[nodiscard]] double period() const { return period_; }  ///< [s]

 protected:
  std::vector<std::string> axes_;
  double period_ = 0.0;
};

}  // namespace stribeck::sim
