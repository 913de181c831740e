#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/run/loop_figures.hpp>

namespace stribeck::report {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostDecibels = 60.0;
constexpr Range kPlaneX{-3.0, 1.0};
constexpr Range kPlaneY{-2.0, 2.0};
constexpr double kGoodModulus = 0.5;  ///< of 1 + L

double in_decibels(double factor) { return 20.0 * std::log10(factor); }

Series curve_of(const LoopCurve& c) {
  Series s;
  s.label = c.label;
  s.color = c.color;
  s.dashed = c.dashed;
  return s;
}

/// A value over frequency for every curve.
template <class Value>
Plot over_frequency(const std::vector<LoopCurve>& curves, std::string title, std::string y_label,
                    Value value) {
  Plot p{.title = std::move(title),
         .x_label = "frequency [Hz]",
         .y_label = std::move(y_label),
         .log_x = true,
         .width = 560,
         .height = 320};
  for (const LoopCurve& c : curves) {
    Series s = curve_of(c);
    const std::vector<double> y = value(*c.loop);
    for (std::size_t k = 0; k < y.size(); ++k) {
      s.x.push_back(c.loop->omega[k] / (2.0 * kPi));
      s.y.push_back(y[k]);
    }
    p.series.push_back(std::move(s));
  }
  return p;
}

Series circle(double x, double y, double radius) {
  Series s{.color = "#999999", .width = 1.0, .dashed = true};
  for (int k = 0; k <= 120; ++k) {
    const double angle = 2.0 * kPi * k / 120.0;
    s.x.push_back(x + radius * std::cos(angle));
    s.y.push_back(y + radius * std::sin(angle));
  }
  return s;
}

Plot nyquist(const std::vector<LoopCurve>& curves) {
  Plot p{.title = "Nyquist plane",
         .x_label = "real part of L",
         .y_label = "imaginary part of L",
         .x_range = kPlaneX,
         .y_range = kPlaneY,
         .equal_aspect = true,
         .notes = {{-1.0, 0.0, "−1", "#444444"}},
         .width = 560,
         .height = 560};
  p.series.push_back(circle(-1.0, 0.0, kGoodModulus));
  for (const LoopCurve& c : curves) {
    Series s = curve_of(c);
    for (const std::complex<double>& l : c.loop->loop) {
      const bool inside = l.real() >= kPlaneX.low && l.real() <= kPlaneX.high && l.imag() >= kPlaneY.low &&
                          l.imag() <= kPlaneY.high;
      s.x.push_back(inside ? l.real() : kNoValue);
      s.y.push_back(inside ? l.imag() : kNoValue);
    }
    p.series.push_back(std::move(s));
  }
  return p;
}

std::vector<double> gains(const sim::LoopResponse& loop) {
  std::vector<double> out;
  for (const std::complex<double>& l : loop.loop) out.push_back(in_decibels(std::abs(l)));
  return out;
}

std::vector<double> sensitivities(const sim::LoopResponse& loop) {
  std::vector<double> out;
  for (const std::complex<double>& l : loop.loop) out.push_back(-in_decibels(std::abs(1.0 + l)));
  return out;
}

/// Values beyond the drawing are gaps.
std::vector<double> within(std::vector<double> values, double most) {
  for (double& v : values) {
    if (!(std::abs(v) <= most)) v = kNoValue;
  }
  return values;
}

}  // namespace

std::vector<double> loop_phase(const sim::LoopResponse& loop) {
  std::vector<double> out;
  double turns = 0.0;
  for (const std::complex<double>& l : loop.loop) {
    double angle = std::arg(l) * kDegrees;
    if (out.empty() && angle > 0.0) turns = -360.0;
    if (!out.empty()) {
      while (angle + turns - out.back() > 180.0) turns -= 360.0;
      while (angle + turns - out.back() < -180.0) turns += 360.0;
    }
    out.push_back(angle + turns);
  }
  return out;
}

std::vector<Plot> loop_plots(const std::vector<LoopCurve>& curves) {
  return {over_frequency(curves, "Open loop: gain", "|L| [dB]",
                         [](const auto& loop) { return within(gains(loop), kMostDecibels); }),
          over_frequency(curves, "Open loop: phase", "phase of L [deg]", loop_phase), nyquist(curves),
          over_frequency(curves, "Sensitivity", "|1/(1 + L)| [dB]",
                         [](const auto& loop) { return within(sensitivities(loop), kMostDecibels); })};
}

nlohmann::ordered_json loop_json(const sim::LoopResponse& loop, const std::string& axis) {
  std::vector<double> hertz;
  for (const double omega : loop.omega) hertz.push_back(omega / (2.0 * kPi));
  return {{"axis", axis},
          {"frequency_Hz", io::numbers(hertz)},
          {"gain_dB", io::numbers(gains(loop))},
          {"phase_deg", io::numbers(loop_phase(loop))},
          {"sensitivity_dB", io::numbers(sensitivities(loop))}};
}

}  // namespace stribeck::report
