#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <initializer_list>
#include <string_view>

#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

namespace {

/// Rough data of the drive from an axis file: its friction at two speeds, the larger of both directions.
ident::excitation::RoughDrive rough_idea(const std::string& axis_file, const sim::AxisLimits& limits) {
  const auto model = io::read_toml<friction::AxisModel>(axis_file);
  ident::Result result;
  result.mass = model.mass;
  constexpr int kPoints = 20;
  for (int i = -kPoints; i <= kPoints; ++i) {
    if (i == 0) continue;
    const double v = 0.9 * limits.speed * i / kPoints;
    const auto p = model.friction.parts(v, 0.0);
    const double f = p.level * sign(v) + p.viscous;
    result.curve.push_back({v, f, f, f});
  }
  return ident::excitation::rough_drive(result);
}

ident::excitation::Excitation designed(const ExcitationOptions& o, const sim::Machine& machine,
                                       std::size_t which) {
  const sim::MachineAxis& axis = machine.axes[which].second;
  const ident::excitation::Limits limits{axis.limits.travel_min, axis.limits.travel_max, axis.limits.speed,
                                         axis.limits.acceleration, axis.force_limit()};
  const double middle = 0.5 * (limits.travel_min + limits.travel_max);
  const std::optional<ident::excitation::RoughDrive> known =
      o.known.empty() ? std::nullopt : std::optional(rough_idea(o.known, axis.limits));
  if (o.method == "jog") {
    ident::excitation::JogDesign jog;
    jog.start = middle;
    jog.speeds =
        ident::excitation::jog_speeds(ident::excitation::fastest_jog(limits, machine.sample_time, jog));
    if (!o.speeds.empty()) jog.speeds.clear();
    for (const std::string& speed : o.speeds) {
      jog.speeds.push_back(option_si("--speeds", speed, quantity("m/s", "mm/s").positive()));
    }
    if (!o.lead.empty()) jog.period = option_si("--lead", o.lead, quantity("m", "mm").positive());
    return ident::excitation::design_jog(limits, machine.sample_time, jog);
  }
  if (o.method == "ramp") {
    ident::excitation::RampDesign ramp;
    ramp.start = middle;
    ramp.repeats = o.repeats.value_or(ramp.repeats);
    if (!o.rise.empty()) ramp.rise = option_si("--rise", o.rise, quantity("s", "s").positive());
    return ident::excitation::design_ramp(limits,
                                          known.value_or(ident::excitation::RoughDrive{
                                              axis.commissioning.mass, axis.commissioning.friction, 0.0}),
                                          machine.sample_time, ramp);
  }
  if (o.method == "constant-acceleration") {
    ident::excitation::AccelerationDesign triangles;
    triangles.start = middle;
    triangles.repeats = o.repeats.value_or(triangles.repeats);
    return ident::excitation::design_constant_acceleration(limits, machine.sample_time, triangles);
  }
  const int periods = o.method == "position-sine" ? kPositionPeriods : kSinePeriods;
  return workflow::design(machine, which, o.method, o.periods.value_or(periods), known);
}

/// The option that sets a parameter of a design; empty: there is none.
std::string option_of(const std::string& parameter) {
  if (parameter == "period") return "--lead";
  for (const char* same : {"rise", "speeds", "periods", "repeats"}) {
    if (parameter == same) return std::string("--") + same;
  }
  return {};
}

}  // namespace

void check_excitation(const ExcitationOptions& o) {
  const auto only = [&](bool given, const char* option, std::initializer_list<std::string_view> methods) {
    if (!given || std::find(methods.begin(), methods.end(), o.method) != methods.end()) return;
    refuse_option(
        option, fmt::format("does not apply to --method {}, only to {}", o.method, fmt::join(methods, ", ")));
  };
  only(o.periods.has_value(), "--periods", {"sine", "position-sine"});
  only(o.repeats.has_value(), "--repeats", {"ramp", "constant-acceleration"});
  only(!o.known.empty(), "--known", {"pulses", "ramp"});
  only(!o.speeds.empty(), "--speeds", {"jog"});
  only(!o.lead.empty(), "--lead", {"jog"});
  only(!o.rise.empty(), "--rise", {"ramp"});
}

ident::excitation::Excitation make_excitation(const ExcitationOptions& o, const sim::Machine& machine,
                                              std::size_t axis) {
  try {
    return designed(o, machine, axis);
  } catch (const ident::excitation::BadDesign& bad) {
    const std::string option = option_of(bad.parameter);
    if (option.empty()) throw;
    refuse_option(option, bad.what());
  }
}

}  // namespace stribeck::workflow
