#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include <stribeck/io/toml.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/parameters.hpp>

namespace stribeck::workflow {

namespace {

/// The printed models for these needs, or an error that names the missing one.
sim::AxisKnowledge printed(const sim::Machine& machine, const std::string& path, std::size_t i,
                           const Needs& needs) {
  const std::string& name = machine.axes[i].first;
  const sim::MachineAxis& axis = machine.axes[i].second;
  const auto need = [&](bool wanted, const std::optional<friction::AxisModel>& model, const char* kind) {
    if (wanted && !model) {
      throw io::InputError(
          {path, 0, "axes." + name + ".published." + kind,
           "no printed parameters, which these controllers need (leave out --parameters thesis)"});
    }
  };
  const sim::Published& p = axis.published;
  need(needs.conventional, p.conventional, "conventional");
  need(needs.gaussian, p.gaussian, "gaussian");
  need(needs.eccentric, p.eccentric, "eccentric");
  if (needs.whole) {
    throw io::InputError(
        {path, 0, "axes." + name + ".published",
         "the thesis prints no pre-sliding parameters, which these controllers need (leave out --parameters "
         "thesis)"});
  }
  return {p.conventional, p.gaussian, p.eccentric, {}};
}

/// An axis file that a user gave.
struct Given {
  std::size_t axis;
  std::string file;
  sim::AxisFile content;
};

std::vector<Given> given_models(const sim::Machine& machine, const std::string& path,
                                const std::vector<std::string>& texts) {
  std::vector<Given> models;
  for (const std::string& text : texts) {
    const auto [axis, file] = axis_and_file(text);
    const std::size_t i = axis_index(machine, path, axis);
    models.push_back({i, file, io::read_toml<sim::AxisFile>(file)});
    const bool rotary = machine.axes[i].second.rotary;
    if (models.back().content.rotary.value_or(false) != rotary) {
      throw io::InputError(
          {file, 0, "rotary",
           fmt::format("the file is of a {} axis, but axis {} of {} is {} (give the file of that axis)",
                       rotary ? "linear" : "rotary", axis, path, rotary ? "rotary" : "linear")});
    }
  }
  return models;
}

bool is_gaussian(const friction::AxisModel& model) {
  const auto* map = std::get_if<friction::Gaussian<double>>(&model.friction.steady);
  return map != nullptr && !(map->positive.gaussians.empty() && map->negative.gaussians.empty());
}

/// Whether a file has all models of its axis that the controllers need: nothing is identified beside it.
bool has_all(const Given& given, const sim::MachineAxis& axis, const Needs& needs) {
  const friction::AxisModel& model = given.content.model;
  const bool gaussian = is_gaussian(model);
  const bool eccentric = !gaussian && !model.friction.eccentric.empty();
  const bool conventional = !gaussian && !eccentric;
  if (needs.mass_alone) return true;
  const bool bristles = friction::has_pre_sliding(model.friction.dynamics) || !axis.truth_from.empty();
  return (!needs.gaussian || gaussian) && (!needs.eccentric || eccentric) &&
         (!needs.conventional || conventional) && (!needs.whole || bristles);
}

/// Adds a part to the sentence that tells where the models are from.
void say(Parameters& p, const std::string& part) { p.words += (p.words.empty() ? "" : "; ") + part; }

/// In place of what was identified or printed.
void take(const Given& given, const sim::Machine& machine, Parameters& p) {
  const friction::AxisModel& model = given.content.model;
  sim::AxisKnowledge& knowledge = p.knowledge[given.axis];
  // A Gaussian-augmented map without a Gaussian is Coulomb and viscous friction, by direction.
  const bool gaussian = is_gaussian(model);
  const bool eccentric = !gaussian && !model.friction.eccentric.empty();
  // A model without bristles does not take the place of one that has them.
  if (!knowledge.whole || friction::has_pre_sliding(model.friction.dynamics)) knowledge.whole = model;
  (gaussian ? knowledge.gaussian : eccentric ? knowledge.eccentric : knowledge.conventional) = model;
  knowledge.lost_motion = given.content.lost_motion;
  say(p, fmt::format("{} model of axis {} from {}",
                     gaussian    ? "Gaussian"
                     : eccentric ? "eccentric"
                                 : "conventional",
                     machine.axes[given.axis].first, given.file));
}

/// Takes it out where it is not wanted; says in words what is compensated, and where it cannot be.
void use_lost_motion(Parameters& p, const sim::Machine& machine, const std::string& use) {
  for (std::size_t i = 0; i < p.knowledge.size(); ++i) {
    std::optional<control::LostMotionParams>& lost = p.knowledge[i].lost_motion;
    if (!lost) continue;
    const auto& [name, axis] = machine.axes[i];
    if (use == "off") {
      say(p, fmt::format("lost motion of axis {} is known and not compensated (--lost-motion off)", name));
      lost.reset();
    } else if (axis.plant.encoder.side == plant::EncoderSide::kTable) {
      say(p, fmt::format("lost motion of axis {} is within its loop, which closes over the table", name));
      lost.reset();
    } else {
      say(p,
          fmt::format("lost motion of axis {} compensated: backlash {:.3g} um", name, 1e6 * lost->backlash));
      if (lost->stiffness)
        p.words += fmt::format(" and wind-up {:.3g} um ({:.3g} N/um)",
                               2e6 * lost->table_friction / *lost->stiffness, 1e-6 * *lost->stiffness);
    }
  }
}

/// What the axes that were identified here did for it.
std::string excitation_words(const sim::Machine& machine, const std::vector<std::size_t>& commissioned,
                             const Needs& needs, const std::vector<CommissionedAxis>& axes) {
  if (commissioned.empty()) return {};  // the files say it
  // Axes that cannot take pulses have logs of their own (commission.hpp).
  std::vector<std::string> closed;
  for (const std::size_t i : commissioned) {
    const auto pulses = [](const CommissionedLog& log) {
      return log.method == ident::excitation::ExcitationMethod::kPulses;
    };
    if (std::none_of(axes[i].logs.begin(), axes[i].logs.end(), pulses))
      closed.push_back(machine.axes[i].first);
  }
  const std::string in_closed_loop = fmt::format(
      "strokes of constant acceleration, {} periods of a sine about the middle and jogs", kPositionPeriods);
  std::vector<std::string> what{"pulses"};
  const bool own = !is_of_thesis(machine);
  const bool by_jogs = own || (needs.conventional && machine.axes.size() > 2);
  if (!own && (needs.eccentric || by_jogs || (needs.whole && machine.axes.size() > 2)))
    what.push_back(fmt::format("{} periods of a sine about the middle", kPositionPeriods));
  if (by_jogs) what.push_back("jogs");
  if (own || needs.gaussian || (needs.whole && machine.axes.size() <= 2))
    what.push_back(fmt::format("{} periods of a sine", kSinePeriods));
  std::string words = "identified from simulated logs of this machine: ";
  if (closed.size() == commissioned.size()) return words + in_closed_loop + " on each axis";
  if (!closed.empty()) words += fmt::format("{} on {}; ", in_closed_loop, report::listed(closed));
  return words + report::listed(what) + (closed.empty() ? " on each axis" : " on the others");
}

/// What the units of a comparison mean where an axis turns.
std::string figures_of_turning(const sim::Machine& machine, const std::vector<std::size_t>& axes,
                               const sim::CompareSpec& spec) {
  const bool tip = std::any_of(spec.travels.begin(), spec.travels.end(), [](const sim::Travel& t) {
    return std::holds_alternative<path::ConeFrustum>(t.path);
  });
  if (tip) return "contour errors here are lengths at the tip of the tool";
  if (std::all_of(axes.begin(), axes.end(), [&](std::size_t i) { return machine.axes[i].second.rotary; }))
    return "so um stands for urad and mm/s for mrad/s in these figures";
  return "so in a contour error a urad of this axis counts as a um";
}

}  // namespace

Parameters get_parameters(const sim::Machine& machine, const std::string& path,
                          const ParameterOptions& options, const sim::CompareSpec& spec) {
  const std::vector<std::size_t> axes = sim::chosen_axes(machine, spec);
  const Needs needs = Needs::of(spec.controllers);
  // First: identification takes seconds, and a file that is wrong should not wait for it.
  const std::vector<Given> models = given_models(machine, path, options.axis_files);
  Parameters p;
  p.knowledge.resize(machine.axes.size());
  p.files.resize(machine.axes.size());
  p.told_from.assign(machine.axes.size(), 0.0);
  if (options.source == "thesis") {
    for (const std::size_t i : axes) p.knowledge[i] = printed(machine, path, i, needs);
    p.words = "printed parameters of the thesis";
  } else {
    p.axes.resize(machine.axes.size());
    std::vector<std::size_t> commissioned;
    for (const std::size_t i : axes) {
      const bool given = std::any_of(models.begin(), models.end(), [&](const Given& g) {
        const sim::MachineAxis& axis = machine.axes[i].second;
        return g.axis == i && (!axis.truth_from.empty() || has_all(g, axis, needs));
      });
      if (!given) commissioned.push_back(i);
    }
    sim::parallel_for(
        commissioned.size(), spec.threads, [] { return 0; },
        [&](int&, std::size_t k) {
          const std::size_t i = commissioned[k];
          p.axes[i] = commission_axis(machine, i, needs, spec.seed);
        });
    for (const std::size_t i : commissioned) {
      p.knowledge[i] = p.axes[i].knowledge;
      p.assumed.insert(p.assumed.end(), p.axes[i].assumed.begin(), p.axes[i].assumed.end());
    }
    p.words = excitation_words(machine, commissioned, needs, p.axes);
  }
  for (const Given& given : models) {
    take(given, machine, p);
    p.files[given.axis] = given.file;
    const auto& uncertainty = given.content.uncertainty;
    p.told_from[given.axis] = uncertainty ? uncertainty->told_from : 0.0;
    const std::string& name = machine.axes[given.axis].first;
    if (given.content.axis && !given.content.axis->empty() && *given.content.axis != name)
      p.assumed.push_back(fmt::format("{} says that it is of axis {}, and is used for axis {}", given.file,
                                      *given.content.axis, name));
    if (std::find(axes.begin(), axes.end(), given.axis) == axes.end())
      p.assumed.push_back(
          fmt::format("{} has no effect: the path does not move axis {} (choose a path that does, --path)",
                      given.file, name));
  }
  for (const std::size_t i : axes)
    if (!machine.axes[i].second.truth_from.empty()) fill_in(p.knowledge[i], machine.axes[i].second);
  use_lost_motion(p, machine, options.lost_motion);
  for (const std::string& name : machine.left_out)
    p.assumed.push_back(fmt::format(
        "axis {0} does not move here: {1} has no plant for it, and no axis file was given (--axis-file {0}=FILE)",
        name, path));
  for (const std::size_t i : axes) {
    const auto& [name, axis] = machine.axes[i];
    if (axis.rotary)
      p.assumed.push_back(
          fmt::format("axis {} is {}; {}", name, kRotaryAsLinear, figures_of_turning(machine, axes, spec)));
    if (axis.truth_from.empty()) continue;
    say(p, fmt::format("the machine file has no plant for axis {}: its identified model is simulated", name));
    p.assumed.push_back(fmt::format(
        "axis {} is simulated as the model in {} says, because {} has no plant: noise, drift and whatever else the model does not "
        "hold are not in these figures, so the machine itself will have larger errors; its input counts in volts all the same, {:g} V for the "
        "largest force of the drive",
        name, axis.truth_from, path, axis.plant.converter.range));
  }
  return p;
}

namespace {

/// What adaptation says of friction on this axis at this travel is no news of the machine.
void take_back_verdicts(sim::CompareResult& result, std::size_t travel, std::size_t axis) {
  using enum control::DriftVerdict;
  for (sim::CompareRow& row : result.rows) {
    if (row.travel != travel || axis >= row.drift.size()) continue;
    control::DriftVerdict& verdict = row.drift[axis].verdict;
    if (verdict != kNotYet && verdict != kAsCommissioned && verdict != kAnotherMass &&
        verdict != kAnotherDelay)
      verdict = kAnotherShape;
  }
}

/// The axes whose bristles are not known to a controller that would use them.
void note_missing_bristles(const sim::CompareResult& result, const std::vector<std::size_t>& axes,
                           const Parameters& parameters, std::vector<std::string>& to) {
  for (const sim::ControllerSpec& c : result.spec.controllers) {
    if (c.friction == sim::FrictionUse::kNone) continue;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const friction::AxisModel model = parameters.knowledge[axes[i]].model(c.friction, result.axes[i]);
      if (sim::feedforward_with(c, model) == c.feedforward) continue;
      to.push_back(fmt::format(
          "axis {}: its pre-sliding was not identified, so ({}) lets friction build up over a distance after each reversal, as (j) does",
          result.axes[i], c.id));
    }
  }
}

/// The axes on which a controller goes without its Kalman observer (sim::calm()).
void note_calmed(const sim::CompareResult& result, const std::vector<std::size_t>& axes,
                 const Parameters& parameters, std::vector<std::string>& to) {
  for (const sim::CompareRow& row : result.rows) {
    if (row.travel != 0) continue;  // gains and delays are the same for all
    for (const std::size_t i : row.calmed) {
      const double delay =
          parameters.knowledge[axes[i]].model(row.controller.friction, result.axes[i]).delay_or_none();
      to.push_back(without_kalman_observer(result.axes[i], delay / result.period, row.controller.id));
    }
  }
}

/// Between these two speeds, one of each direction, nothing is known of the friction of an axis; 0 and 0: it is, or nobody says.
std::array<double, 2> told_speeds(const Parameters& parameters, std::size_t axis) {
  if (!parameters.files[axis].empty()) return {-parameters.told_from[axis], parameters.told_from[axis]};
  std::array<double, 2> begin{0.0, 0.0};
  if (parameters.axes.empty()) return begin;
  for (const CommissionedModel& m : parameters.axes[axis].models) {
    const auto [back, forward] = report::curve_begin(m.result);
    begin = {std::fmin(begin[0], back), std::fmax(begin[1], forward)};
  }
  return begin;
}

}  // namespace

std::vector<std::string> unknown_delays(const sim::Machine& machine, const sim::CompareSpec& spec,
                                        const Parameters& parameters) {
  std::vector<std::string> all;
  for (const std::size_t i : sim::chosen_axes(machine, spec)) {
    const friction::AxisModel* model = parameters.files[i].empty() ? nullptr : parameters.knowledge[i].best();
    if (model == nullptr || model->delay || model->drive_loop || machine.axes[i].second.known_loop())
      continue;
    all.push_back(fmt::format(
        "axis {}: {} does not say the delay of the drive, so the margins count with none and the gains may be too high; write it there, "
        "e.g. delay = \"{:.3g} ms\", from the data sheet of drive and fieldbus, or measure it (stribeck frequency with the commanded force)",
        machine.axes[i].first, parameters.files[i], 2e3 * machine.sample_time));
  }
  return all;
}

std::vector<std::string> uncounted_delays(const sim::Machine& machine, const sim::CompareSpec& spec) {
  std::vector<std::string> all;
  for (const std::size_t i : sim::chosen_axes(machine, spec)) {
    const auto& [name, axis] = machine.axes[i];
    if (!axis.known_loop()) continue;
    const double delay = axis.plant.delay_periods + axis.plant.delay_fraction.value_or(0.0);
    all.push_back(fmt::format(
        "axis {}: its drive closes a loop of its own, and the margins do not count with the way of the command there ({}): the gains may be "
        "too high, up to oscillation; begin with half of the proposed omega and look at the motion",
        name,
        delay > 0.0
            ? fmt::format("plant.delay_periods, {:g} periods here", delay)
            : std::string("a fieldbus and the cycle of the drive often take 2 to 4 control periods")));
  }
  return all;
}

std::string without_kalman_observer(const std::string& axis, double delay_periods,
                                    const std::string& controller) {
  return fmt::format(
      "axis {}: with a delay of {:.2g} control periods a loop with a Kalman observer is close to oscillating at these gains, so ({}) has a disturbance "
      "observer there, as (g) has; slower gains bring the other one back",
      axis, delay_periods, controller);
}

std::vector<std::string> check_coverage(sim::CompareResult& result, const std::vector<std::size_t>& axes,
                                        const Parameters& parameters) {
  constexpr double kLong = 0.2;  // share of the motion
  std::vector<std::string> all = parameters.assumed;
  note_missing_bristles(result, axes, parameters, all);
  note_calmed(result, axes, parameters, all);
  for (std::size_t travel = 0; travel < result.spec.travels.size(); ++travel) {
    const auto row = std::find_if(result.rows.begin(), result.rows.end(), [&](const sim::CompareRow& r) {
      return r.travel == travel && !r.trace.empty();
    });
    if (row == result.rows.end()) continue;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const std::array<double, 2> begin = told_speeds(parameters, axes[i]);
      double moving = 0.0;
      double below = 0.0;
      for (const sim::ContourSample& s : row->trace) {
        const double v = s.velocity[i];
        if (v == 0.0) continue;
        moving += 1.0;
        below += v > begin[0] && v < begin[1] ? 1.0 : 0.0;
      }
      if (!(below > kLong * moving)) continue;
      take_back_verdicts(result, travel, i);
      if (const std::string& file = parameters.files[axes[i]]; !file.empty()) {
        all.push_back(fmt::format(
            "axis {} at {}: {:.0f} % of its motion is slower than {:.3g} mm/s, where the logs behind {} do not tell the friction: there its "
            "model may be far off, and with it the order of the controllers (record slow jogs, excite --method jog, and give identify "
            "both logs)",
            result.axes[i], result.spec.travels[travel].pace_in_words(), 100.0 * below / moving,
            begin[1] * 1e3, file));
        continue;
      }
      all.push_back(fmt::format(
          "axis {} at {}: {:.0f} % of its motion is between {:.3g} and {:.3g} mm/s, where a model of it was not "
          "identified (excite with --method jog, and give the result with --axis-file)",
          result.axes[i], result.spec.travels[travel].pace_in_words(), 100.0 * below / moving, begin[0] * 1e3,
          begin[1] * 1e3));
    }
  }
  return all;
}

std::vector<std::string> coverage_of(const sim::Machine& machine, const sim::CompareSpec& spec,
                                     const Parameters& parameters) {
  Parameters no_words = parameters;
  no_words.assumed.clear();
  std::vector<std::string> all;
  for (const sim::Travel& travel : spec.travels) {
    sim::CompareSpec one = spec;
    one.travels = {travel};
    try {
      sim::CompareResult run = sim::run_once(machine, parameters.knowledge, one, 0);
      for (std::string& warning : check_coverage(run, sim::chosen_axes(machine, spec), no_words))
        if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(std::move(warning));
    } catch (const sim::Refused&) {
      // The work itself says which of its runs mean nothing.
    }
  }
  return all;
}

}  // namespace stribeck::workflow
