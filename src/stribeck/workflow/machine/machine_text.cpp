// A machine as a file that can be read again, axes that turn in their own units.
#include <array>
#include <cstddef>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <string>
#include <string_view>

namespace stribeck::workflow {
namespace {

/// Quantities of a linear axis that an axis which turns has in other units (io/units.hpp).
constexpr std::array<std::string_view, 11> kLinear{"m",   "m/s", "m/s2", "m/s3", "N",    "N/s",
                                                   "N/V", "N/A", "kg",   "N/m",  "N s/m"};

/// "150 mm" is "8.594 deg" at a radius of 1 m; other texts stay.
std::string turned(const std::string& text) {
  for (const std::string_view unit : kLinear) {
    const Quantity linear = quantity(unit, unit);
    if (io::is_convertible(text, linear))
      return io::from_si(io::to_si(text, linear), *io::rotary_quantity(linear, ""));
  }
  return text;
}

/// A line with every quoted text turned.
std::string turned_line(std::string_view line) {
  std::string out;
  std::size_t at = 0;
  for (auto open = line.find('"'); open != std::string_view::npos; open = line.find('"', at)) {
    const auto close = line.find('"', open + 1);
    if (close == std::string_view::npos) break;
    out += line.substr(at, open + 1 - at);
    out += turned(std::string(line.substr(open + 1, close - open - 1))) + '"';
    at = close + 1;
  }
  return out + std::string(line.substr(at));
}

bool is_rotary_table(const sim::Machine& machine, std::string_view heading, std::string& first) {
  for (const auto& [name, axis] : machine.axes) {
    const std::string table = "[axes." + name + ".";
    if (!axis.rotary || !heading.starts_with(table)) continue;
    first = "[axes." + name + "]";
    return true;
  }
  return false;
}

}  // namespace

std::string machine_text(const sim::Machine& machine, const std::string& comment) {
  const std::string text = io::write_toml(machine, comment);
  std::string out;
  std::string said;     // the last axis that was said to turn
  bool turns = false;   // the table of this line
  bool weight = false;  // what is heavy in an unbalance has a mass and a distance
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.starts_with('[')) {
      std::string first;
      turns = is_rotary_table(machine, line, first);
      weight = line.ends_with(".unbalance]");
      if (turns && first != said) out += first + "\nrotary = true\n\n", said = first;
    }
    const bool as_it_is = !turns || weight || line.starts_with("unbalance");
    out += (as_it_is ? line : turned_line(line)) + '\n';
  }
  return out;
}

}  // namespace stribeck::workflow
