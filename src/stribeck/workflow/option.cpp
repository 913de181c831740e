#include <fmt/format.h>
#include <algorithm>
#include <optional>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

void refuse_option(const std::string& option, const std::string& message) {
  throw io::InputError(io::Problem{{}, 0, option, message});
}

double option_si(const std::string& option, const std::string& text, const Quantity& quantity) {
  try {
    return io::to_si(text, quantity);
  } catch (const io::InputError& e) {
    refuse_option(option, e.problems().front().message);
  }
}

double travel_si(const std::string& option, const std::string& text, const Quantity& quantity, bool rotary) {
  const std::optional<Quantity> turning = rotary ? io::rotary_quantity(quantity, text) : std::nullopt;
  return option_si(option, text, turning && io::is_convertible(text, *turning) ? *turning : quantity);
}

std::string of_one_turn(std::string text) {
  const std::size_t slash = text.rfind('/');
  if (slash == std::string::npos) return text;
  std::string unit = io::lower_case(text.substr(slash + 1));
  std::erase(unit, ' ');
  for (const std::string_view turn : {"rev", "turn", "r", "u", "umdr", "revolution", "umdrehung"}) {
    if (unit != turn) continue;
    text.erase(slash);
    text.erase(text.find_last_not_of(' ') + 1);
    break;
  }
  return text;
}

std::pair<std::string, std::string> halves(const std::string& option, const std::string& text,
                                           const std::string& expected) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    refuse_option(option, fmt::format("got {}, expected {}", io::in_quotes(text), expected));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::pair<std::string, std::string> axis_and_file(const std::string& text) {
  return halves("--axis-file", text, "AXIS=FILE, e.g. x=x.toml");
}

io::InputError no_truth(const std::string& file, const std::string& axis) {
  return io::InputError(
      {file, 0, fmt::format("axes.{}.plant", axis),
       fmt::format(
           "missing, expected the truth of a virtual axis (mass, drive, converter, encoder, friction with bristles), or its "
           "identified model in its place (--axis-file {0}=FILE, in a study \"{0}=FILE\" among axis_files)",
           axis)});
}

std::size_t axis_index(const sim::Machine& machine, const std::string& file, const std::string& axis) {
  std::string names;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].first == axis) return i;
    names += (names.empty() ? "" : ", ") + machine.axes[i].first;
  }
  if (std::find(machine.left_out.begin(), machine.left_out.end(), axis) != machine.left_out.end())
    throw no_truth(file, axis);
  throw io::InputError(
      {file, 0, "axes", fmt::format("no axis {}, the machine has {}", io::in_quotes(axis), names)});
}

}  // namespace stribeck::workflow
