#include <fmt/format.h>

#include <stribeck/targets/linuxcnc/hal_axis.hpp>

namespace stribeck::targets::linuxcnc {

bool counts_degrees(std::string_view axis) {
  return axis.size() == 1 && std::string_view("abcABC").find(axis) != std::string_view::npos;
}

double unit_of(std::string_view axis, bool rotary) {
  if (rotary) return kPi / 180.0;
  return counts_degrees(axis) ? HalAxis{}.radius * kPi / 180.0 : 1e-3;
}

bool angular(const HalAxis& a) { return counts_degrees(a.letter); }

double unit_of(const HalAxis& a) { return angular(a) ? a.radius * kPi / 180.0 : 1e-3; }

std::string_view unit_name(const HalAxis& a) { return angular(a) ? "deg" : "mm"; }

double in_units(const HalAxis& a, double metres) { return metres / unit_of(a); }

std::string number(double x) { return fmt::format("{:.9g}", x); }

double home_of(const HalAxis& a) {
  const sim::AxisLimits& l = a.can.limits;
  return l.travel_min <= 0.0 && l.travel_max >= 0.0 ? 0.0 : 0.5 * (l.travel_min + l.travel_max);
}

std::string capital(const HalAxis& a) {
  return std::string(1, static_cast<char>(a.letter.front() - 'a' + 'A'));
}

std::string each(const Axes& axes, const std::function<std::string(const HalAxis&, std::size_t)>& text) {
  std::string out;
  for (std::size_t i = 0; i < axes.size(); ++i) out += text(axes[i], i);
  return out;
}

std::string names(const Axes& axes, std::string_view prefix) {
  std::string out;
  for (const HalAxis& a : axes) out += fmt::format("{}{}{}", out.empty() ? "" : ",", prefix, a.letter);
  return out;
}

}  // namespace stribeck::targets::linuxcnc
