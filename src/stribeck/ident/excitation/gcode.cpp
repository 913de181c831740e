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
double scale_of(GcodeUnit unit, double radius) {
  return unit == GcodeUnit::kDegree ? 180.0 / kPi / radius : 1e3;
}

/// How a program is written. LinuxCNC's is the dialect of most controls; SINUMERIK has comments, units and dwells of its own, and names
/// of axes with a number.
struct Dialect {
  bool sinumerik = false;
  std::string axis;  ///< what stands before a position: "X", "X1="

  [[nodiscard]] std::string comment(const std::string& text) const {
    return sinumerik ? "; " + text + '\n' : '(' + text + ")\n";
  }
  [[nodiscard]] std::string dwell(const std::string& seconds) const {
    return fmt::format("G4 {}{}\n", sinumerik ? 'F' : 'P', seconds);
  }
};

Dialect dialect_for(const std::string& axis) {
  if (const std::string why = why_no_gcode(axis); !why.empty()) throw Refused("G-code: " + why);
  std::string word = gcode_word(axis);
  return {word.back() == '=', std::move(word)};
}

/// The lines before the first move.
std::string head_of(const Excitation& e, const Dialect& d, const std::string& machine, GcodeUnit unit) {
  // Parentheses end a comment, and with some controls a semicolon ends the line and a percent sign the program.
  std::string name = machine;
  std::erase_if(name, [](char c) { return std::string_view("();%\n\r").find(c) != std::string_view::npos; });
  std::string axis = d.axis;
  std::erase(axis, '=');
  std::string out =
      d.comment(fmt::format("{} of axis {}, {}", enum_name(e.method), axis, name)) +
      d.comment(fmt::format("{:.1f} s; {}; record position and drive force meanwhile", e.t.back(),
                            unit == GcodeUnit::kDegree ? "degrees, degrees per minute"
                                                       : "millimetres, millimetres per minute"));
  if (d.sinumerik)
    out += d.comment(fmt::format("for SINUMERIK; other controls, as LinuxCNC, know no axis {}", axis));
  if (axis.front() == 'X' && unit == GcodeUnit::kMillimetre)
    out += d.comment(
        d.sinumerik
            ? "X counts the travel: on a lathe switch diameter programming off before, DIAMOF"
            : "X counts the travel: on a lathe switch diameter programming off before, LinuxCNC G8, SINUMERIK DIAMOF");
  // Not G53 in each move: it is a rapid move in the dialects of Fanuc, whatever the feed.
  out += d.comment(
      d.sinumerik
          ? "positions are those of the machine: G500 D0 switches zero offset and tool off; no base frame, TRANS, ROT or MIRROR may act"
          : "positions are those of the machine: no work offset, G52, G92 or rotation may act; LinuxCNC G10 L2 P1 X0 Y0 Z0 R0, G92.1");
  if (!d.sinumerik)
    out += d.comment("G49 switches the tool length off, also for what comes after this program");
  return out +
         d.comment("the control adds its own ramps: feed override 100 %, nothing else moving, no cutting") +
         (e.method == ExcitationMethod::kMultisine
              ? d.comment(fmt::format(
                    "moves of {:.0f} ms: lines above {:.0f} Hz are weaker, those above {:.0f} Hz missing; for these give the table to the control",
                    1e3 * kGcodeStep, 0.25 / kGcodeStep, 0.5 / kGcodeStep))
              : std::string()) +
         // G71 would leave the feed in the unit of the machine's basic system; G710 is for lengths and feed.
         (d.sinumerik ? "G500 D0\nG710 G90 G94 G64\n" : "G49\nG21 G90 G94 G64\n");
}

/// Rounded as it is printed, without a sign before zero.
double printed(double metres, double scale) { return std::round(metres * scale * 1e6) * 1e-6 + 0.0; }

}  // namespace

std::string gcode_word(const std::string& axis) {
  static constexpr std::string_view kLetters = "XYZABCUVW";
  if (axis.empty()) return {};
  const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(axis[0])));
  const std::string number = axis.substr(1);
  if (kLetters.find(letter) == std::string_view::npos ||
      number.find_first_not_of("0123456789") != std::string::npos)
    return {};
  return number.empty() ? std::string(1, letter) : letter + number + '=';
}

std::string why_no_gcode(const std::string& axis) {
  if (!gcode_word(axis).empty()) return {};
  return fmt::format(
      "axis {} has no letter of its own, expected one of X Y Z A B C U V W, for SINUMERIK with a number behind it (X1): rename the axis in "
      "the machine file, or leave the G-code out and give the table to the control",
      axis);
}

std::string as_gcode(const Excitation& e, const std::string& axis, const std::string& machine, GcodeUnit unit,
                     double radius) {
  if (e.r.empty()) {
    throw Refused(
        std::string(enum_name(e.method)) +
        ": G-code commands positions and cannot command forces in open loop; give the table to a control that takes forces, or choose jog, sine, position-sine or constant-acceleration");
  }
  const Dialect dialect = dialect_for(axis);
  const double scale = scale_of(unit, radius);
  std::string out = head_of(e, dialect, machine, unit) +
                    fmt::format("G0 {}{:.6f}\n", dialect.axis, printed(e.r.front(), scale)) +
                    dialect.dwell("1");
  const double T = e.sample_time;
  const bool flats = e.method == ExcitationMethod::kJog;
  const auto dense = static_cast<std::size_t>(std::max(1.0, std::round(kGcodeStep / T)));
  std::size_t k = 0;
  while (k + 1 < e.r.size()) {
    std::size_t last = k + 1;
    const double step = e.r[last] - e.r[k];
    if (step == 0.0) {
      while (last + 1 < e.r.size() && e.r[last + 1] == e.r[last]) ++last;
      out += dialect.dwell(fmt::format("{:.3f}", static_cast<double>(last - k) * T));
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
        out += dialect.dwell(fmt::format("{:.3f}", static_cast<double>(last - k) * T));
        k = last;
        continue;
      }
      fastest = std::abs(e.r[last] - e.r[k]) / static_cast<double>(last - k);
    }
    out += fmt::format("G1 {}{:.6f} F{:.5f}\n", dialect.axis, printed(e.r[last], scale),
                       fastest / T * 60.0 * scale);
    k = last;
  }
  return out + "M2\n";
}

}  // namespace stribeck::ident::excitation
