#include <fmt/format.h>

#include <algorithm>
#include <stribeck/ident/shown.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/study/uncertain_models.hpp>
#include <string>
#include <string_view>

namespace stribeck::workflow {
namespace {

/// Null: there is none.
const KnownAxis* last_with_uncertainty(std::size_t axis, const std::vector<KnownAxis>& known) {
  const KnownAxis* last = nullptr;
  for (const KnownAxis& k : known) {
    if (k.axis == axis && k.file.uncertainty && !k.file.uncertainty->deviations.empty()) last = &k;
  }
  return last;
}

void take_model(plant::AxisParams& plant, const friction::AxisModel& model) {
  const friction::DynamicsVariant before = plant.friction.dynamics;
  plant.mass = model.mass, plant.load = model.load, plant.friction = model.friction;
  if (!friction::has_pre_sliding(model.friction.dynamics)) plant.friction.dynamics = before;
  // They would act on the identified friction, which holds them as far as it can.
  plant.friction_along_travel.reset();
  plant.viscous_exponent.reset();
}

[[noreturn]] void fail(const std::string& what) { throw io::InputError(io::Problem{{}, 0, {}, what}); }

const KnownAxis& with_uncertainty(const std::string& name, std::size_t axis,
                                  const std::vector<KnownAxis>& known) {
  if (const KnownAxis* last = last_with_uncertainty(axis, known)) return *last;
  const auto any =
      std::find_if(known.begin(), known.end(), [&](const KnownAxis& k) { return k.axis == axis; });
  if (any == known.end())
    fail(fmt::format(
        "axis {} has no axis file, expected one that identify wrote (add \"{}=FILE\" to axis_files)", name,
        name));
  fail(fmt::format(
      "{} does not say what its logs leave open (identify the axis again with method auto, from logs with motion in both "
      "directions)",
      io::in_quotes(any->path)));
}

}  // namespace

sim::Machine with_models(const sim::Machine& machine, const StudyFile& study,
                         const std::vector<std::size_t>& moved, const std::vector<KnownAxis>& known) {
  sim::Machine out = machine;
  for (const StudyFactor& f : study.factors) {
    if (!f.is_uncertainty()) continue;
    const std::string_view axis = std::string_view(f.key).substr(0, f.key.find('.'));
    for (const std::size_t i : moved) {
      auto& [name, own] = out.axes[i];
      const KnownAxis* of = axis == "*" || axis == name ? last_with_uncertainty(i, known) : nullptr;
      if (of != nullptr) take_model(own.plant, of->file.model);
    }
  }
  return out;
}

std::vector<BoundFactor> deviations_as_factors(const sim::Machine& machine,
                                               const std::vector<std::size_t>& axes,
                                               const std::vector<KnownAxis>& known) {
  std::vector<BoundFactor> all;
  for (const std::size_t axis : axes) {
    const std::string& name = machine.axes[axis].first;
    const friction::ModelUncertainty& open = *with_uncertainty(name, axis, known).file.uncertainty;
    for (std::size_t k = 0; k < open.deviations.size(); ++k) {
      BoundFactor one;
      one.key = fmt::format("{}.uncertainty.{}", name, k + 1);
      one.below = fmt::format("uncertainty.{}", k + 1);
      one.distribution = sim::Normal<double>{0.0, 1.0, std::nullopt, std::nullopt};
      one.axes = {axis};
      one.deviation = open.deviations[k];
      one.rise_speed = open.rise_speed;
      one.told_from = open.told_from;
      all.push_back(std::move(one));
    }
  }
  return all;
}

bool only_uncertainty(const std::vector<BoundFactor>& factors) {
  return !factors.empty() && std::all_of(factors.begin(), factors.end(),
                                         [](const BoundFactor& f) { return f.deviation.has_value(); });
}

std::string deviations_text(const std::vector<BoundFactor>& factors) {
  std::string text;
  for (const BoundFactor& f : factors) {
    if (f.deviation)
      text += fmt::format("\n# {}, with a rise that fades at {} m/s\n{}", f.key,
                          io::number_text(f.rise_speed), io::write_toml(*f.deviation));
  }
  return text;
}

std::vector<std::string> untold_at_rest(const sim::Machine& machine,
                                        const std::vector<BoundFactor>& factors) {
  std::vector<std::string> all;
  for (const BoundFactor& f : factors) {
    if (!f.deviation || f.below != "uncertainty.1" || !(f.told_from > 0.0)) continue;
    const auto& [name, axis] = machine.axes[f.axes.front()];
    all.push_back(fmt::format(
        "the logs of {} tell its friction from {} on; every reversal passes below it, and what may be there is in no band (add "
        "slow jogs and identify again)",
        name, ident::Shown("m", "N", axis.rotary).speed(f.told_from)));
  }
  return all;
}

void deviate_models(sim::Machine& machine, const std::vector<BoundFactor>& factors,
                    const std::vector<double>& values) {
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    friction::ModelDeviation change;
    double rise_speed = 0.0;
    for (std::size_t i = 0; i < factors.size(); ++i) {
      if (!factors[i].deviation || factors[i].axes.front() != axis) continue;
      change.add(values[i], *factors[i].deviation);
      rise_speed = factors[i].rise_speed;
    }
    if (rise_speed == 0.0) continue;
    plant::AxisParams& plant = machine.axes[axis].second.plant;
    friction::AxisModel model{plant.mass, plant.load, plant.friction};
    model = friction::deviated(model, change, rise_speed);
    plant.mass = model.mass, plant.load = model.load, plant.friction = model.friction;
  }
}

}  // namespace stribeck::workflow
