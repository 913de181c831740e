#include <fmt/format.h>
#include <stribeck/stribeck.h>
#include <algorithm>
#include <cstdint>

#include <capi/parameters.hpp>
#include <stribeck/control/compensation/compensation_settings.hpp>
#include <stribeck/control/supervision/limits.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/targets/linuxcnc/hal_lines.hpp>

namespace stribeck::targets::linuxcnc {
namespace {

/// The name of a parameter as HAL spells it.
std::string hal_name(std::string_view name) {
  std::string out(name);
  std::replace(out.begin(), out.end(), '_', '-');
  return out;
}

/// Lines for every parameter of a struct.
std::string setp_all(const std::string& component, const Value& group) {
  std::string out;
  capi::values_of(group, [&](std::string_view key, double x, std::string_view word) {
    out += setp(component, key, x, word);
  });
  return out;
}

/// A parameter that is a choice, with the other choices as a comment.
std::string choice(const std::string& component, const char* parameter, std::size_t index) {
  std::string words;
  std::string chosen;
  const char* word = nullptr;
  for (std::uint32_t i = 0; (word = stribeck_controller_parameter_word(parameter, i)) != nullptr; ++i) {
    if (i == index) chosen = word;
    words += fmt::format("{}{} {}", i == 0 ? "" : ", ", i, word);
  }
  return setp(component, parameter, static_cast<double>(index), fmt::format("{} ({})", chosen, words));
}

/// A comment where friction differs along the travel: a list of thirteen places would take more of HAL's memory than all the rest.
std::string places_left_out(const std::string& name, const friction::Places& places) {
  if (places.empty()) return {};
  return fmt::format(
      "# {}: friction.places (friction along the travel) is left out: HAL has no room for it\n", name);
}

}  // namespace

std::string setp(const std::string& component, std::string_view parameter, double value,
                 std::string_view word) {
  std::string line = fmt::format("setp {}.{} {}", component, hal_name(parameter), value);
  if (!word.empty()) line += fmt::format("  # {}", word);
  return line + '\n';
}

std::string controller_lines(const std::string& name, const friction::AxisModel& model, double omega,
                             const std::string& feedforward) {
  const bool bristles = friction::has_pre_sliding(model.friction.dynamics);
  using control::Feedforward;
  const Feedforward own = bristles ? Feedforward::kDynamic : Feedforward::kReversal;
  const Feedforward which = enum_value<Feedforward>(feedforward).value_or(own);
  friction::AxisModel held = model;
  held.friction.places = {};
  const std::string left_out = places_left_out(name, model.friction.places);
  return left_out + setp(name, "omega", omega) + choice(name, "law", 0) +
         choice(name, "feedforward", static_cast<std::size_t>(which)) + choice(name, "observer", 0) +
         setp(name, "adaptation.enabled", 0.0, "1: the model is corrected on line") +
         setp(name, "guarded", 1.0) + setp_all(name, value_of(held));
}

std::string supervision_lines(const std::string& name, const sim::MachineAxis& axis) {
  const double step = axis.name_plate().encoder_resolution;
  return choice(name, "supervision.checks", static_cast<std::size_t>(control::Checks::kAll)) +
         setp(name, "supervision.speed_limit", axis.limits.speed) +
         setp(name, "supervision.acceleration_limit", axis.limits.acceleration) +
         (step > 0.0 ? setp(name, "encoder_resolution", step) : std::string());
}

double initial_value(std::string_view parameter) {
  stribeck_parameter p;
  for (std::uint32_t i = 0; stribeck_controller_parameter(i, &p) == STRIBECK_OK; ++i) {
    if (hal_name(p.name) == parameter) return p.value;
  }
  return kNaN;
}

std::string plant_lines(const std::string& name, const sim::MachineAxis& axis) {
  plant::AxisParams p = axis.plant;
  const std::string left_out = places_left_out(name, p.friction.places);
  p.friction.places = {};
  return left_out + setp_all(name, value_of(p));
}

}  // namespace stribeck::targets::linuxcnc
