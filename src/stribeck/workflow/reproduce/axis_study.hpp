#pragma once
/// Logs of one axis of a virtual machine and the models that the thesis identifies from them: A from pulses and jogs, B from
/// jogs, C over velocity, D over position; and a replay of all of them on an unseen run.
/// Real time: no. Errors: ident::Refused.

#include <cstdint>
#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow::reproduction {

/// Requested parts of a study.
struct Wanted {
  bool a = false, b = false, c = false, d = false, verify = false;
};

/// Model A from the pulses of one height.
struct Scale {
  double k_u = 0.0;
  ident::methods::LeastSquaresA found;
};

/// A model that was replayed on the unseen run.
struct Replayed {
  std::string name;
  bool of_thesis = false;  ///< one of the thesis's models: it is drawn, and among the figures
  ident::replay::OpenLoop open;
};

/// One axis: the request, and the result.
struct Study {
  const sim::Machine* machine = nullptr;
  std::size_t axis = 0;
  bool biaxial = false;
  std::uint64_t seed = 1;
  Wanted wanted;

  std::optional<ident::methods::LeastSquaresA> pulses;  ///< Model A before the viscous correction
  std::optional<ident::methods::LeastSquaresA> a;
  std::vector<Scale> scales;
  std::optional<ident::methods::Jog> b;
  std::optional<ident::Result> c;
  std::optional<ident::Result> d;
  std::optional<ident::Result>
      whole;  ///< the model of commission_axis: mass, friction, periodic terms and bristles in one fit
  ident::log::Record unseen;
  std::vector<Replayed> replayed;

  [[nodiscard]] const std::string& name() const { return machine->axes[axis].first; }
  [[nodiscard]] const sim::MachineAxis& truth() const { return machine->axes[axis].second; }
};

/// Records the logs and identifies the requested models.
void run_study(Study& study);

}  // namespace stribeck::workflow::reproduction
