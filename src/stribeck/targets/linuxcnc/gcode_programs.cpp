#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/targets/linuxcnc/configuration.hpp>

namespace stribeck::targets::linuxcnc {

namespace {

/// Rounds down to whole tenths of a millimetre or degree; below one to two digits, because an axis may have less room than a tenth.
double rounded(const HalAxis& a, double metres) {
  const double units = in_units(a, metres);
  const double step = std::abs(units) < 1.0 && units != 0.0
                          ? std::pow(10.0, std::floor(std::log10(std::abs(units))) - 1.0)
                          : 0.1;
  return std::floor(units / step + 1e-9) * step * unit_of(a);
}

/// Middle of the programs [m]: zero where the travel permits.
double middle_of(const HalAxis& a) {
  const sim::AxisLimits& l = a.can.limits;
  return l.travel_min <= 0.0 && l.travel_max >= 0.0 &&
                 std::min(-l.travel_min, l.travel_max) > 0.2 * (l.travel_max - l.travel_min)
             ? 0.0
             : rounded(a, 0.5 * (l.travel_min + l.travel_max));
}

/// Free travel on both sides of the middle [m].
double room_of(const HalAxis& a) {
  const sim::AxisLimits& l = a.can.limits;
  return std::min(middle_of(a) - l.travel_min, l.travel_max - middle_of(a));
}

/// Coordinate of an axis in a program.
std::string word(const HalAxis& a, double metres) {
  return fmt::format("{}{:.10g}", capital(a), std::round(1e4 * in_units(a, metres)) / 1e4 + 0.0);
}

/// Feed [machine units/min], rounded to a readable number.
std::string feed(const HalAxis& a, double speed) {
  const double f = 60.0 * in_units(a, speed);
  const double step = std::pow(10.0, std::floor(std::log10(f)) - 1.0);
  return fmt::format("F{:.6g}", std::floor(f / step + 1e-9) * step);
}

/// Two axes for which LinuxCNC has circles, and its code for their plane.
struct Plane {
  const HalAxis* u;
  const HalAxis* v;
  std::string_view code;
  char i;
  char j;
};

std::vector<Plane> planes(const Configuration& c) {
  const auto find = [&](std::string_view letter) -> const HalAxis* {
    for (const HalAxis& a : c.axes) {
      if (a.letter == letter) return &a;
    }
    return nullptr;
  };
  std::vector<Plane> out;
  if (find("x") != nullptr && find("y") != nullptr) out.push_back({find("x"), find("y"), "G17", 'I', 'J'});
  if (find("x") != nullptr && find("z") != nullptr) out.push_back({find("x"), find("z"), "G18", 'I', 'K'});
  if (find("y") != nullptr && find("z") != nullptr) out.push_back({find("y"), find("z"), "G19", 'J', 'K'});
  return out;
}

/// A full circle about the middle from u = radius; G2 or G3.
std::string circle(const Plane& p, int g, double radius) {
  return fmt::format("G{} {} {} {}{:.4g} {}0", g, word(*p.u, middle_of(*p.u) + radius),
                     word(*p.v, middle_of(*p.v)), p.i, -1e3 * radius, p.j);
}

std::string to_middle(const Configuration& c) {
  std::string out = "G0";
  for (const HalAxis& a : c.axes) out += ' ' + word(a, middle_of(a));
  return out + '\n';
}

}  // namespace

std::string demo(const Configuration& c) {
  const std::vector<Plane> ways = planes(c);
  std::string out;
  std::size_t more = 0;
  if (!ways.empty()) {
    const Plane& p = ways.front();
    const sim::AxisLimits& u = p.u->can.limits;
    const sim::AxisLimits& v = p.v->can.limits;
    const double radius = rounded(*p.u, std::min(10e-3, 0.5 * std::min(room_of(*p.u), room_of(*p.v))));
    const double acceleration = std::min(u.acceleration, v.acceleration);
    const double speed =
        std::min({10e-3, 0.8 * std::min(u.speed, v.speed), std::sqrt(0.5 * acceleration * radius)});
    const std::string f = feed(*p.u, speed);
    out += fmt::format(
        "({}: two revolutions in each direction, R = {:.4g} mm at {} mm/min; lines 7 and 9 count)\n", p.code,
        1e3 * radius, f.substr(1));
    out += fmt::format("G21 {} G90 G94 G64 P0.001\n", p.code) + to_middle(c);
    out += fmt::format("G1 {} {} {}\nG4 P0.5\n", word(*p.u, middle_of(*p.u) + radius),
                       word(*p.v, middle_of(*p.v)), f);
    for (const int g : {3, 3, 2, 2}) out += circle(p, g, radius) + '\n';
    out += "G4 P0.5\n" + to_middle(c);
    more = 2;
  } else {
    out += "(forth and back, faster and faster)\nG21 G90 G94 G64 P0.001\n" + to_middle(c);
  }
  for (std::size_t i = 0; i < c.axes.size(); ++i) {
    const HalAxis& a = c.axes[i];
    if (more > 0 && (ways.front().u == &a || ways.front().v == &a)) continue;
    const double way = rounded(a, 0.5 * std::min(20.0 * unit_of(a), room_of(a)));
    for (const double share : {0.1, 0.3, 0.8}) {
      out += fmt::format("G1 {} {}\nG1 {}\n", word(a, middle_of(a) + way),
                         feed(a, share * a.can.limits.speed), word(a, middle_of(a) - way));
    }
    out += fmt::format("G1 {}\n", word(a, middle_of(a)));
  }
  return out + "M2\n";
}

/// Excites every axis: circles are sines of two axes at once; rapid moves determine the mass.
std::string identify(const Configuration& c) {
  std::string out =
      "(Motion that tells friction, screw and mass of every axis. On a machine: clear of everything, "
      "nothing cutting.)\n"
      "(circles are sines, at several speeds and amplitudes; rapid moves are for the mass)\n"
      "G21 G90 G94 G64 P0.001\n" +
      to_middle(c);
  std::vector<const HalAxis*> alone;
  for (const HalAxis& a : c.axes) alone.push_back(&a);
  for (const Plane& p : planes(c)) {
    std::erase(alone, p.u);
    std::erase(alone, p.v);
    const HalAxis& u = *p.u;
    const double room = std::min(room_of(u), room_of(*p.v));
    const double wide = rounded(u, std::min(12e-3, 0.3 * room));
    const double narrow = rounded(u, 7.0 / 12.0 * wide);
    const double acceleration = std::min(u.can.limits.acceleration, p.v->can.limits.acceleration);
    const double fastest = std::min(std::min(u.can.limits.speed, p.v->can.limits.speed),
                                    std::sqrt(0.5 * acceleration * narrow) / 0.94);
    const auto start = [&](double radius) {
      out += fmt::format("G1 {} {}\n", word(u, middle_of(u) + radius), feed(u, 0.53 * fastest));
    };
    out += fmt::format("{}\n", p.code);
    start(wide);
    out += circle(p, 3, wide) + ' ' + feed(u, 0.73 * fastest) + '\n' + circle(p, 3, wide) + '\n';
    start(narrow);
    out += circle(p, 2, narrow) + ' ' + feed(u, 0.94 * fastest) + '\n' + circle(p, 2, narrow) + '\n';
    out += circle(p, 3, narrow) + ' ' + feed(u, 0.125 * fastest) + '\n';
    out += to_middle(c);
  }
  out += "G17\n";
  for (const HalAxis* a : alone) {
    const double way = rounded(*a, std::min(20.0 * unit_of(*a), 0.5 * room_of(*a)));
    for (const double share : {0.1, 0.25, 0.5, 0.75, 0.94}) {
      out += fmt::format("G1 {} {}\nG1 {}\n", word(*a, middle_of(*a) + way),
                         feed(*a, share * a->can.limits.speed), word(*a, middle_of(*a) - way));
    }
    out += to_middle(c);
  }
  out += "(rapid moves: longer, shorter, either way)\no100 repeat [8]\n";
  const auto rapid = [&](std::initializer_list<double> way) {
    out += "  G0";
    std::size_t i = 0;
    for (const HalAxis& a : c.axes) {
      const double most = std::min(3.0 * unit_of(a), 0.5 * room_of(a));
      out += ' ' + word(a, middle_of(a) + *(way.begin() + i % way.size()) * most);
      ++i;
    }
    out += '\n';
  };
  rapid({1.0, 0.83, 0.67});
  out += "  G4 P0.1\n";
  rapid({0.0});
  out += "  G4 P0.1\n";
  rapid({-0.33});
  rapid({0.17, 0.23, 0.3});
  return out + "o100 endrepeat\n" + to_middle(c) + "M2\n";
}

}  // namespace stribeck::targets::linuxcnc
