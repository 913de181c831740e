#include <cctype>
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
