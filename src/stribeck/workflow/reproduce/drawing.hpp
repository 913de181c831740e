#pragma once
/// Common parts of the sections of the reproduction: figures, plots and curves in their colours.
/// Real time: no.

#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/workflow/reproduce/numbers.hpp>
#include <string>
#include <utility>

namespace stribeck::workflow::reproduction {

using report::Plot;
using report::ReproducedFigure;
using report::ReproducedSection;
using report::Series;
using report::Style;

inline constexpr const char* kPointColor = "#b4bac0";
inline constexpr const char* kOursColor = "#0072b2";
inline constexpr const char* kOtherColor = "#e69f00";
inline constexpr const char* kPrintColor = "#000000";

ReproducedSection section(std::string id, std::string title, std::string source, std::string setting,
                          const sim::Machine& machine);

/// Adds a figure: the printed value beside the computed one.
void add(ReproducedSection& s, std::string what, std::string of, std::string unit, double print,
         const Estimate& ours, std::string source, int digits);

Plot plot(std::string title, std::string x_label, std::string y_label);
Series points(std::string label, const char* color, double size);
Series curve(std::string label, const char* color, bool dashed);

/// A map from −top to top, with a gap at standstill.
template <class Force>
Series map_curve(std::string label, const char* color, bool dashed, double top, Force&& force) {
  constexpr int kEach = 150;
  Series s = curve(std::move(label), color, dashed);
  for (int i = -kEach; i <= kEach; ++i) {
    const double v = top * i / kEach;
    s.x.push_back(v / kMilli);
    s.y.push_back(i == 0 ? kNaN : force(v));
  }
  return s;
}

inline double two_levels(double v, double plus, double minus, double slope) {
  return (v > 0.0 ? plus : -minus) + slope * v;
}

}  // namespace stribeck::workflow::reproduction
