#include <fmt/format.h>
#include <array>
#include <nlohmann/json.hpp>

#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/commissioning/parts.hpp>
#include <stribeck/workflow/excitation.hpp>

namespace stribeck::workflow::commissioning {
namespace {

using ident::excitation::ExcitationMethod;

struct Motion {
  ExcitationMethod method;
  const char* log;  ///< in the name of its log; "verify" is held out (stages/stages.hpp)
  std::optional<int> periods;
};
constexpr std::array<Motion, 3> kMotions{
    {{ExcitationMethod::kConstantAcceleration, "constant-acceleration", {}},
     {ExcitationMethod::kSine, "sine", 4},
     {ExcitationMethod::kPositionSine, "verify", 2}}};

/// The machine file, with the limits that LinuxCNC has.
MachineDescription narrowed(const Work& work) {
  MachineDescription out = work.description;
  for (auto& [name, axis] : out.axes) {
    for (const RunningAxis& a : work.axes.axes) {
      if (a.name == name) axis.limits = a.limits;
    }
  }
  return out;
}

void record_axis(Work& work, const MachineDescription& machine, const RunningAxis& a, io::Json& logs) {
  std::size_t index = 0;
  while (machine.axes[index].first != a.name) ++index;
  for (const Motion& m : kMotions) {
    ExcitationOptions options;
    options.method = m.method;
    options.periods = m.periods;
    const auto safe = make_excitation(options, machine, index);
    const auto& e = safe.excitation;
    const std::string name = fmt::format("{}-{}", a.name, m.log);
    work.ask(fmt::format("axis {}: {}\n  It {}.", a.name, e.says,
                         report::joined(safety_notes(safe, machine, index), "; ")));
    const std::string raw = work.folder + '/' + name + ".halsampler";
    // LinuxCNC needs longer than the design: it rounds the corners of the moves.
    run_program(work, name, ident::excitation::as_gcode(e, a.name, io::one_line(machine.name)),
                2.0 * e.t.back() + 10.0, raw);
    const auto rows = read_record(work.axes, raw);
    io::make_directory(work.folder + "/logs");
    const std::string log = fmt::format("{}/logs/{}.csv", work.folder, name);
    write_axis_log(work.axes, rows[static_cast<std::size_t>(&a - work.axes.axes.data())], log);
    logs.push_back(name + ".csv");
    work.found(fmt::format("axis {}: recorded {} ({} rows)", a.name, m.log, rows.front().r.size()));
  }
}

}  // namespace

io::Json record(Work& work) {
  require_ready(work);
  const MachineDescription machine = narrowed(work);
  io::Json logs = io::Json::array();
  for (const RunningAxis& a : work.axes.axes) record_axis(work, machine, a, logs);
  return {{"logs", logs}};
}

}  // namespace stribeck::workflow::commissioning
