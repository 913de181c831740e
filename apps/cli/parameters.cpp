#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <apps/cli/parameters.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/parallel.hpp>

namespace stribeck::cli {

void add_parameter_options(CLI::App& verb, ParameterOptions& options) {
  verb.add_option(
          "--parameters", options.source,
          "Parameters of the compensators: identified (from logs recorded here) or thesis (as printed)")
      ->check(CLI::IsMember({"identified", "thesis"}))
      ->capture_default_str();
  verb.add_option(
          "--axis-file", options.axis_files,
          "Axis file that identify wrote, for one axis; repeat for more axes or for a second kind of model")
      ->type_name("AXIS=FILE");
}

Parameters get_parameters(const sim::Machine& machine, const std::string& path,
                          const ParameterOptions& options, std::uint64_t seed) {
  Parameters p;
  p.knowledge.resize(machine.axes.size());
  if (options.source == "thesis") {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const auto& [name, axis] = machine.axes[i];
      if (!axis.published.conventional || !axis.published.gaussian) {
        throw io::InputError(
            {path, 0, "axes." + name + ".published",
             "no printed parameters, expected conventional and gaussian (or leave out --parameters thesis)"});
      }
      p.knowledge[i] = {*axis.published.conventional, *axis.published.gaussian};
    }
    p.words = "printed parameters of the thesis (Tables 2.1 and 2.3)";
  } else {
    p.learned.resize(machine.axes.size());
    sim::parallel_for(
        machine.axes.size(), 0, [] { return 0; },
        [&](int&, std::size_t i) { p.learned[i] = learn_axis(machine, i, seed); });
    for (std::size_t i = 0; i < machine.axes.size(); ++i) p.knowledge[i] = p.learned[i].knowledge;
    p.words = fmt::format(
        "identified from logs of this machine: pulses and {} periods of a sine on each axis", kSinePeriods);
  }
  for (const std::string& text : options.axis_files) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      refuse_option("--axis-file",
                    fmt::format("got {}, expected AXIS=FILE, e.g. x=x.toml", io::in_quotes(text)));
    }
    const std::size_t i = axis_index(machine, path, text.substr(0, equals));
    const auto model = io::read_toml<friction::AxisModel>(text.substr(equals + 1));
    // A Gaussian-augmented map without a Gaussian is Coulomb and viscous friction, by direction.
    const auto* map = std::get_if<friction::Gaussian<double>>(&model.friction.steady);
    const bool gaussian =
        map != nullptr && !(map->positive.gaussians.empty() && map->negative.gaussians.empty());
    (gaussian ? p.knowledge[i].gaussian : p.knowledge[i].conventional) = model;
    p.words += fmt::format("; {} model of axis {} from {}", gaussian ? "Gaussian" : "conventional",
                           machine.axes[i].first, text.substr(equals + 1));
  }
  return p;
}

}  // namespace stribeck::cli
