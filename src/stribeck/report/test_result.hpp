#pragma once
/// A small comparison made by hand, for the tests of this folder. Included by tests only.

#include <cmath>
#include <limits>
#include <stribeck/ident/result.hpp>
#include <stribeck/report/page/page_files.hpp>
#include <stribeck/sim/experiments.hpp>
#include <string>

namespace stribeck::report::test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Text that is an attack on every language it passes through.
inline const std::string kHostile =
    "x\"><script>alert(1)</script> `touch stribeck_pwned` $(touch stribeck_pwned) @pwd {/Bold b}_c 50% %s "
    "'q' \\n \n\x01 \xff id='gnuplot_canvas' </svg>&amp;";

/// The page without the one script that belongs to it, whose text is no text of the page.
inline std::string without_script(std::string page) {
  const std::string own = "<script>" + std::string(page_script()) + "</script>";
  if (const std::size_t at = page.find(own); at != std::string::npos) page.erase(at, own.size());
  return page;
}

inline sim::Metrics metrics(double max, double rms) {
  sim::Metrics m;
  m.max_contour_error = max;
  m.quadrant_glitch = 0.5 * max;
  m.rms = rms;
  m.sd = rms;
  m.mean_abs = 0.5 * rms;
  m.mean_abs_tracking = {{rms, 2.0 * rms}};
  m.power = kNaN;
  m.mean_abs_ui = kNaN;
  m.input_variation = 0.125;
  return m;
}

inline sim::Metrics nothing() {
  sim::Metrics m = metrics(kNaN, kNaN);
  m.input_variation = kNaN;
  return m;
}

/// Controllers (a) and (b) on a circle of 10 mm at 9.5 mm/s; their errors are cosines of 8 and 2 µm.
inline sim::CompareResult two_controllers() {
  sim::CompareResult result;
  result.machine = "table";
  result.period = 5e-3;
  result.axes = {"x", "y"};
  const sim::Travel travel = sim::along(path::Shape::kCircle, 0.01, 9.5e-3, 1.0);
  result.spec.travels = {travel};
  result.spec.trials = 4;
  result.spec.seed = 7;
  const auto all = sim::biaxial_controllers();
  result.spec.controllers = {all[0], all[1]};
  const auto reference = sim::sample<2>(travel, result.period).points;
  const double scored_to = 1.0 + travel.law().cruise_time();
  double size = 8e-6;
  for (const auto& controller : result.spec.controllers) {
    sim::CompareRow row;
    row.controller = controller;
    row.speed = 9.5e-3;
    row.mean = metrics(size, 0.5 * size);
    row.spread = metrics(0.25e-6, 0.125e-6);
    row.spread.input_variation = 0.0;
    row.substeps = 4;
    for (std::size_t k = 0; k < reference.size(); ++k) {
      sim::ContourSample s;
      s.time = static_cast<double>(k) * result.period;
      s.phi = reference[k].phi;
      s.reference = s.position = sim::widened(reference[k].position);
      s.velocity = sim::widened(reference[k].velocity);
      s.acceleration = sim::widened(reference[k].acceleration);
      s.contour_error = size * std::cos(reference[k].phi);
      s.force = {{100.0, -100.0}};
      s.friction = {{90.0, -110.0}};
      s.scored = s.time >= 1.0 && s.time <= scored_to;
      row.trace.push_back(s);
    }
    result.rows.push_back(std::move(row));
    size = 2e-6;
  }
  return result;
}

/// A fit with one parameter that the data cannot tell.
inline ident::Result fit() {
  ident::Result r;
  r.method = ident::Method::kVelocityMap;
  r.set_steady(ident::SteadyModel::kGaussian);
  r.mass = 57650.123;
  r.mass_interval = {57600.0, 57700.5};
  r.velocity_range = {-9.5e-3, 9.5e-3};
  r.parameters = {{"mass", 57650.0, "kg", "N s2/mm", 57600.0, 57700.0, true},
                  {"eta1_positive", 102480.0, "N s/m", "N s/mm", 101000.0, 104000.0, true},
                  {"gaussian_1_a_positive", 12.5, "N", "N", kNaN, kNaN, false}};
  r.curve = {{-9.5e-3, -2000.0, -2010.0, -1990.0},
             {-0.5e-3, -800.0, -804.5, -795.5},
             {0.5e-3, 820.0, 816.0, 824.0},
             {9.5e-3, 2100.0, kNaN, kNaN}};
  r.held_out_rms = 20.5;
  r.models = {{"Gaussian, 1 term, v > 0", 1, 5, 20.5, 0.0, true},
              {"Gaussian, 0 terms, v > 0", 0, 2, 250.0, 12.0, false}};
  r.map = {{-5e-3, -1400.0, -1}, {5e-3, 1500.0, 1}};
  r.warnings = {"speeds above 9 mm/s were seen once"};
  friction::Conventional<double> map;
  map.alpha0 = 800.0;
  map.alpha2 = 1e5;
  r.friction.steady = map;
  r.rows = 1234;
  return r;
}

/// A fit with everything that a result may hold: a ripple of 2.5 mm, bristles, residuals, a spectrum.
inline ident::Result whole_fit() {
  ident::Result r = fit();
  r.method = ident::Method::kAuto;
  r.set_steady(ident::SteadyModel::kGaussian);
  r.model += " + periodic";
  r.load = -3.25;
  r.break_away_distance = 12e-6;
  r.parameters.push_back({"periodic_amplitude_1", 1.5, "N", "N", 1.25, 1.75, true});
  r.parameters.push_back({"periodic_period_1", 2.5e-3, "m", "mm", 2.4e-3, 2.6e-3, true});
  r.parameters.push_back({"force_shift", 1.5e-3, "s", "ms", 1.25e-3, 1.75e-3, true});
  r.friction.eccentric.push_back({1.5, 2.5e-3, 0.25, friction::EccentricForm::kProportional});
  r.friction.dynamics = friction::LuGre<double>{2e6, 0.0, {}};
  for (int k = 0; k < 400; ++k) {
    const double x = 1e-4 * k;
    r.residuals.push_back({0.01 * k, x, (k < 200 ? 1.0 : -1.0) * 5e-3, std::sin(6.0 * k), 0});
  }
  for (int k = 1; k < 100; ++k) r.spectrum.push_back({1e-4 * k, 0.05 + 0.2 * std::exp(-std::pow(k - 25, 2))});
  r.cannot_tell = {"the stiffness of pre-sliding: the encoder is too coarse"};
  return r;
}

/// The same with a force in ampere and, for `angle`, a position in radian.
inline ident::Result own_units(bool angle) {
  ident::Result r = whole_fit();
  r.force_unit = "A";
  if (angle) r.position_unit = "rad";
  r.warnings.clear();
  return r;
}

}  // namespace stribeck::report::test
