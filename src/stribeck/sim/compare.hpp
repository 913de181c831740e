#pragma once
/// The main experiment: several controllers on one machine along one path, at several speeds, over several
/// trials.
///
/// Every trial has its own noise, the same for every controller, so that controllers are compared like with
/// like. Runs are spread over threads; the result does not depend on how many.
/// Real time: no.

#include <cstdint>
#include <functional>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::sim {

enum class FrictionUse { kNone, kConventional, kGaussian };

/// One of the controllers (a)…(f) of the biaxial table, or another.
struct ControllerSpec {
  std::string id;
  std::string label;
  FrictionUse friction = FrictionUse::kNone;
  control::Observer observer = control::Observer::kNone;
};

/// (a) none, (b) conventional, (c) Gaussian, (d) observer, (e) observer + conventional, (f) observer +
/// Gaussian.
std::vector<ControllerSpec> biaxial_controllers();

/// What identification (or the thesis) says of one axis.
struct AxisKnowledge {
  friction::AxisModel conventional;
  friction::AxisModel gaussian;
};

struct CompareSpec {
  path::Curve curve;
  std::vector<double> speeds;  ///< [m/s]
  double laps = 2.0;
  double run_in = 1.0;          ///< [s]
  double omega_t = 40.0;        ///< double pole along the path [rad/s]
  double omega_n = 40.0;        ///< double pole across the path [rad/s]
  double observer_pole = 20.0;  ///< [1/s]
  control::Observer observer =
      control::Observer::kDisturbance;  ///< which one the controllers with an observer have
  control::ErrorRate error_rate = control::ErrorRate::kDifferenceOfError;
  std::vector<ControllerSpec> controllers;
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  double accuracy = 1e-9;  ///< of the simulated contour error, quantisers off [m]
  unsigned threads = 0;    ///< 0: as many as the machine has
};

/// One controller at one speed.
struct CompareRow {
  ControllerSpec controller;
  double speed = 0.0;                ///< [m/s]
  Metrics mean;                      ///< over the trials
  Metrics spread;                    ///< standard deviation over the trials; NaN for a single trial
  std::vector<ContourSample> trace;  ///< of the first trial
  StatusCounter status;              ///< of all trials together
  int substeps = 0;
};

struct CompareResult {
  std::string machine;
  CompareSpec spec;
  double period = 0.0;  ///< [s]
  std::vector<std::string> axes;
  std::vector<CompareRow> rows;  ///< speed by speed, controller by controller
};

/// progress(done, all) may be called from any thread, one call at a time.
CompareResult compare(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                      const CompareSpec& spec,
                      const std::function<void(std::size_t, std::size_t)>& progress = {});

/// The controller of a spec, as compare() builds it.
control::Contouring make_controller(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                                    const CompareSpec& spec, const ControllerSpec& which);

}  // namespace stribeck::sim
