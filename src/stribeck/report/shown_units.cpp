#include <array>
#include <cctype>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/shown_units.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {

ShownUnits::ShownUnits(std::string force_unit, std::string position_unit)
    : force(clean_text(force_unit)), linear_(position_unit == "m"), base_(clean_text(position_unit)) {
  if (!linear_) {
    position = base_;
    fine = "m" + base_;
    velocity = base_ + "/s";
    per_position = 1.0;
    per_fine = 1e3;
    per_velocity = 1.0;
    per_mass = 1.0;
  }
  mass = linear_ ? named("N s2/mm") : named("N s2/m");
}

ShownUnits ShownUnits::turning() {
  ShownUnits u;
  u.in_degrees_ = true;
  u.force = "N m";
  u.position = "deg";
  u.fine = "arcsec";
  u.velocity = "deg/s";
  u.mass = "kg m2";
  u.per_position = u.per_velocity = kDegrees;
  u.per_fine = 3600.0 * kDegrees;
  u.per_mass = 1.0;
  return u;
}

std::pair<std::string_view, double> ShownUnits::degrees_of(std::string_view si) noexcept {
  struct Pair {
    std::string_view si, shown;
    double factor;
  };
  static constexpr std::array<Pair, 8> kPairs{{{"N", "N m", 1.0},
                                               {"kg", "kg m2", 1.0},
                                               {"m", "deg", kDegrees},
                                               {"m/s", "deg/s", kDegrees},
                                               {"m/s2", "deg/s2", kDegrees},
                                               {"N s/m", "N m s/deg", 1.0 / kDegrees},
                                               {"N/m", "N m/deg", 1.0 / kDegrees},
                                               {"N/s", "N m/s", 1.0}}};
  for (const Pair& p : kPairs) {
    if (p.si == si) return {p.shown, p.factor};
  }
  return {si, 1.0};
}

std::string ShownUnits::named(std::string_view unit) const {
  if (physical()) return std::string(unit);
  std::string out;
  // The force unit of the log may stand there already; the m of "N m" is no position.
  const bool there =
      force != "N" && unit.starts_with(force) &&
      (unit.size() == force.size() || std::isalpha(static_cast<unsigned char>(unit[force.size()])) == 0);
  std::size_t i = there ? force.size() : 0;
  out += unit.substr(0, i);
  while (i < unit.size()) {
    std::size_t j = i;
    while (j < unit.size() && std::isalpha(static_cast<unsigned char>(unit[j])) != 0) ++j;
    const std::string_view word = unit.substr(i, j - i);
    if (word == "N") {
      out += force;
    } else if (word == "kg") {
      out += force + " s2/" + base_;
    } else if (word == "m") {
      out += base_;
    } else {
      out += word;
    }
    if (j < unit.size()) out += unit[j++];
    i = j;
  }
  return out;
}

std::string_view ShownUnits::chosen(std::string_view si, std::string_view shown) const noexcept {
  return shown.empty() || !linear_ ? si : shown;
}

}  // namespace stribeck::report
