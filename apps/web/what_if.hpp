#pragma once
/// The what-if view: a machine with some values changed, on a short motion, under a few controllers.
///
/// The result is that of `compare --trials 1 --laps 1` (workflow/run): same identification, same simulation, same figures of merit. The
/// machine is identified once, unchanged, and that model is kept; on request the changed machine is identified instead. A value
/// changes as a factor of a study does (workflow/study/factors.hpp).
/// Real time: no.
/// Errors: InputError, sim::Refused, ident::Refused; Outdated where a newer request waits.

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/sim/endless_run.hpp>
#include <stribeck/workflow/run/comparison.hpp>
#include <string>
#include <vector>

#include <apps/web/machines.hpp>

namespace stribeck::web {

/// A value of the plant that differs from the file.
struct Change {
  std::string key;
  std::optional<double> scale;
  std::optional<std::string> value;

  static constexpr auto fields() {
    return std::tuple{
        field("key", &Change::key, "AXIS.KEY below [axes.AXIS.plant], or *.KEY, as a factor of a study"),
        field("scale", &Change::scale, pure_number().at_least(0.01).at_most(100.0),
              "by which the value of the file is multiplied")
            .or_default(),
        field("value", &Change::value, "the value itself, with its unit").or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (scale.has_value() == value.has_value()) report("key", "expected one of scale and value");
  }
};

struct WhatIfRequest {
  std::string machine;
  std::string motion;
  std::string size;
  std::string speed;
  std::vector<std::string> controllers;
  std::vector<Change> changes;
  std::string sample_time;
  std::string omega_t;
  std::string omega_n;
  std::string observer_pole;
  std::string parameters = "identified";
  bool identify_changed = false;
  std::uint64_t seed = 1;
  std::string client;

  static constexpr auto fields() {
    using W = WhatIfRequest;
    return std::tuple{
        field("machine", &W::machine, "id of the list of machines"),
        field("motion", &W::motion, "circle, eight, trifolium, own or experiment; left out: by the machine")
            .or_default(),
        field("size", &W::size, "as --size of compare").or_default(),
        field("speed", &W::speed, "as --speed of compare").or_default(),
        field("controllers", &W::controllers, "ids of the experiment, or names of built-in controllers"),
        field("changes", &W::changes, "what differs from the file").or_default(),
        field("sample_time", &W::sample_time, "control period; left out: of the file").or_default(),
        field("omega_t", &W::omega_t, "as --omega-t of compare").or_default(),
        field("omega_n", &W::omega_n, "as --omega-n of compare").or_default(),
        field("observer_pole", &W::observer_pole, "as --observer-pole of compare").or_default(),
        field("parameters", &W::parameters, "identified or thesis, as --parameters of compare").or_default(),
        field("identify_changed", &W::identify_changed,
              "identify the changed machine in place of that of the file")
            .or_default(),
        field("seed", &W::seed, "of the noise").or_default(),
        field("client", &W::client, "name of the asking page, of which only the newest request is computed")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (controllers.empty() || controllers.size() > 12)
      report("controllers", "expected 1 to 12 of the machine's list");
    if (changes.size() > 100) report("changes", "expected at most 100");
    if (parameters != "identified" && parameters != "thesis")
      report("parameters", "expected identified or thesis");
    if (client.size() > 64) report("client", "expected at most 64 characters");
  }
};

/// A newer request of the same page waits.
struct Outdated {};

class WhatIf {
 public:
  explicit WhatIf(const Machines& machines) : machines_(machines) {}

  using IsOld = std::function<bool()>;
  /// Figures as `compare --json` writes them, and curves for drawing. One call at a time.
  nlohmann::ordered_json run(const WhatIfRequest& request, const IsOld& is_old);

  /// The same machine, motion and first controller, lap after lap; the words say what runs. One call at a time with run().
  std::pair<std::unique_ptr<sim::EndlessRun>, std::string> endless(const WhatIfRequest& request,
                                                                   const IsOld& is_old);

  /// The changed machine as a file.
  [[nodiscard]] std::string machine_file(const WhatIfRequest& request) const;

  /// What may be chosen and changed of a machine: motions, controllers, values with their units.
  [[nodiscard]] nlohmann::ordered_json form(const std::string& machine) const;

 private:
  struct Known {
    sim::Machine machine;
    workflow::Needs needs;
    std::string source;
    std::uint64_t seed;
    std::vector<std::size_t> axes;
    workflow::Parameters parameters;
  };
  const workflow::Parameters& parameters_for(const workflow::ComparisonPlan& plan, const std::string& file,
                                             const std::string& source);

  const Machines& machines_;
  std::list<Known> known_;  ///< the last used first
};

}  // namespace stribeck::web
