// A motion as G-code.
#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/excitation/excitation.hpp>
#include <string_view>

namespace stribeck::ident::excitation {
namespace {

constexpr double kGcodeStep = 0.02;  // [s]
constexpr double kFinest = 1e-7;     // shortest move of G-code [m]

/// Units per metre.
double scale_of(GcodeUnit unit) { return unit == GcodeUnit::kDegree ? 180.0 / kPi : 1e3; }

/// Rounded as it is printed, without a sign before zero.
double printed(double metres, GcodeUnit unit) {
  return std::round(metres * scale_of(unit) * 1e6) * 1e-6 + 0.0;
}

}  // namespace

std::string as_gcode(const Excitation& e, const std::string& axis, const std::string& machine,
                     GcodeUnit unit) {
  if (e.r.empty()) {
    throw Refused(
        std::string(enum_name(e.method)) +
        ": G-code commands positions and cannot command forces in open loop; give the table to a control that takes forces, or choose jog, sine, position-sine or constant-acceleration");
  }
  static constexpr std::string_view kLetters = "XYZABCUVW";
  const char letter =
      axis.size() == 1 ? static_cast<char>(std::toupper(static_cast<unsigned char>(axis[0]))) : '?';
  if (kLetters.find(letter) == std::string_view::npos) {
    throw Refused("G-code: axis " + axis + " has no letter of its own, expected one of X Y Z A B C U V W");
  }
  // Parentheses end a comment, and with some controls a semicolon ends the line and a percent sign the program.
  std::string name = machine;
  std::erase_if(name, [](char c) { return std::string_view("();%\n\r").find(c) != std::string_view::npos; });
  std::string out =
      fmt::format("({} of axis {}, {})\n", enum_name(e.method), letter, name) +
      fmt::format("({:.1f} s; {}; record position and drive force meanwhile)\n", e.t.back(),
                  unit == GcodeUnit::kDegree ? "degrees, degrees per minute"
                                             : "millimetres, millimetres per minute") +
      "(the control adds its own ramps: feed override 100 %, nothing else moving, no cutting)\n" +
      "G21 G90 G94 G64\n" + fmt::format("G0 {}{:.6f}\nG4 P1\n", letter, printed(e.r.front(), unit));
  const double T = e.sample_time;
  const bool flats = e.method == ExcitationMethod::kJog;
  const auto dense = static_cast<std::size_t>(std::max(1.0, std::round(kGcodeStep / T)));
  std::size_t k = 0;
  while (k + 1 < e.r.size()) {
    std::size_t last = k + 1;
    const double step = e.r[last] - e.r[k];
    if (step == 0.0) {
      while (last + 1 < e.r.size() && e.r[last + 1] == e.r[last]) ++last;
      out += fmt::format("G4 P{:.3f}\n", static_cast<double>(last - k) * T);
      k = last;
      continue;
    }
    double fastest = std::abs(step);
    if (flats) {
      // One stroke: the control makes the ramps; the feed is that of the constant part.
      while (last + 1 < e.r.size() && (e.r[last + 1] - e.r[last]) * step > 0.0) {
        ++last;
        fastest = std::max(fastest, std::abs(e.r[last] - e.r[last - 1]));
      }
    } else {
      while (last + 1 < e.r.size() && (e.r[last + 1] - e.r[last]) * step > 0.0 &&
             (last - k < dense || std::abs(e.r[last] - e.r[k]) < kFinest)) {
        ++last;
      }
      if (std::abs(e.r[last] - e.r[k]) < kFinest) {  // the control refuses a feed of nearly zero
        out += fmt::format("G4 P{:.3f}\n", static_cast<double>(last - k) * T);
        k = last;
        continue;
      }
      fastest = std::abs(e.r[last] - e.r[k]) / static_cast<double>(last - k);
    }
    out += fmt::format("G1 {}{:.6f} F{:.5f}\n", letter, printed(e.r[last], unit),
                       fastest / T * 60.0 * scale_of(unit));
    k = last;
  }
  return out + "M2\n";
}

}  // namespace stribeck::ident::excitation
