#include <fmt/format.h>

#include <stribeck/io/toml.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/parallel.hpp>
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
  friction::AxisModel model;
};

std::vector<Given> given_models(const sim::Machine& machine, const std::string& path,
                                const std::vector<std::string>& texts) {
  std::vector<Given> models;
  for (const std::string& text : texts) {
    const auto [axis, file] = axis_and_file(text);
    const std::size_t i = axis_index(machine, path, axis);
    models.push_back({i, file, io::read_toml<friction::AxisModel>(file)});
  }
  return models;
}

/// In place of what was identified or printed.
void take(const Given& given, const sim::Machine& machine, Parameters& p) {
  const friction::AxisModel& model = given.model;
  sim::AxisKnowledge& knowledge = p.knowledge[given.axis];
  // A Gaussian-augmented map without a Gaussian is Coulomb and viscous friction, by direction.
  const auto* map = std::get_if<friction::Gaussian<double>>(&model.friction.steady);
  const bool gaussian =
      map != nullptr && !(map->positive.gaussians.empty() && map->negative.gaussians.empty());
  const bool eccentric = !gaussian && !model.friction.eccentric.empty();
  // A model without bristles does not take the place of one that has them.
  if (!knowledge.whole || friction::has_pre_sliding(model.friction.dynamics)) knowledge.whole = model;
  (gaussian ? knowledge.gaussian : eccentric ? knowledge.eccentric : knowledge.conventional) = model;
  p.words += fmt::format("; {} model of axis {} from {}",
                         gaussian    ? "Gaussian"
                         : eccentric ? "eccentric"
                                     : "conventional",
                         machine.axes[given.axis].first, given.file);
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
  if (options.source == "thesis") {
    for (const std::size_t i : axes) p.knowledge[i] = printed(machine, path, i, needs);
    p.words = "printed parameters of the thesis";
  } else {
    p.axes.resize(machine.axes.size());
    sim::parallel_for(
        axes.size(), spec.threads, [] { return 0; },
        [&](int&, std::size_t k) { p.axes[axes[k]] = commission_axis(machine, axes[k], needs, spec.seed); });
    for (const std::size_t i : axes) p.knowledge[i] = p.axes[i].knowledge;
    std::vector<std::string> what{"pulses"};
    const bool by_jogs = needs.conventional && machine.axes.size() > 2;
    if (needs.eccentric || by_jogs || (needs.whole && machine.axes.size() > 2))
      what.push_back(fmt::format("{} periods of a sine about the middle", kPositionPeriods));
    if (by_jogs) what.push_back("jogs");
    if (needs.gaussian || (needs.whole && machine.axes.size() <= 2))
      what.push_back(fmt::format("{} periods of a sine", kSinePeriods));
    p.words = "identified from logs of this machine: " + report::listed(what) + " on each axis";
  }
  for (const Given& given : models) take(given, machine, p);
  return p;
}

}  // namespace stribeck::workflow
