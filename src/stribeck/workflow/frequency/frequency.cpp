#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <complex>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/frequency/frequency.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

constexpr double kClose = 1.005;  ///< ratio of neighbouring points between lines
constexpr double kDrift = 0.05;   ///< of a resonance, by workpiece and place
constexpr double kMisses = 2.0;   ///< a fit that leaves more than this times the noise deserves a warning
constexpr double kFewUnits = 6.0;
constexpr double kSamePeriod = 0.01;  ///< by which rows and control period may differ
constexpr double kNearHalfRate =
    0.9;  ///< of half the row rate: lines up to there are folded ones, or cannot be told from them

/// Lines that are determined; between them the fit, bent to meet them.
sim::MeasuredPlant dense_plant(const ident::frequency::Response& response,
                               const ident::frequency::Plant& fit) {
  sim::MeasuredPlant out;
  out.period = response.sample_time;
  const ident::frequency::Line* before = nullptr;
  std::complex<double> ratio_before;
  const auto model = [&](double omega) {
    return ident::frequency::sampled_response(fit, omega, response.sample_time);
  };
  for (const ident::frequency::Line& line : response.lines) {
    if (!line.determined()) continue;
    const std::complex<double> ratio = line.plant / model(line.omega);
    if (before != nullptr) {
      const int parts = static_cast<int>(std::ceil(std::log(line.omega / before->omega) / std::log(kClose)));
      for (int i = 1; i < parts; ++i) {
        const double share = static_cast<double>(i) / parts;
        const double omega = before->omega * std::pow(line.omega / before->omega, share);
        out.omega.push_back(omega);
        out.response.push_back(model(omega) * ((1.0 - share) * ratio_before + share * ratio));
        out.half_width.push_back((1.0 - share) * before->half_width + share * line.half_width);
      }
    }
    out.omega.push_back(line.omega);
    out.response.push_back(line.plant);
    out.half_width.push_back(line.half_width);
    before = &line;
    ratio_before = ratio;
  }
  return out;
}

/// A negative delay beyond the hold shows that the log has the force that the drive makes, not its command: the hold of the control and the
/// delay of the drive are missing in the response, and a loop that is proposed from it may be unstable. Adds the hold. Returns the time
/// that was missing [s]; 0: none.
double add_hold(const ident::frequency::PlantFit& fit, sim::MeasuredPlant& plant) {
  constexpr double kLeast = 0.2;  // of the period
  if (!(fit.delay.high() < -kLeast * plant.period)) return 0.0;
  const double missing = -fit.delay.value;
  for (std::size_t i = 0; i < plant.omega.size(); ++i)
    plant.response[i] *= std::polar(1.0, -plant.omega[i] * missing);
  return missing;
}

/// Highest frequency at which the log is excited [rad/s]. Without a period every frequency has a line, also where nothing excites it.
double highest_excited(const ident::frequency::Response& r) {
  return r.period && !r.lines.empty() ? r.lines.back().omega : r.highest();
}

bool reaches_half_rate(const ident::frequency::Response& r) {
  return highest_excited(r) > kNearHalfRate * kPi / r.sample_time;
}

/// Of a log that is slower than the control period, which folds the lines above half its row rate onto those below: no fit can tell them apart.
/// The excitation ends well below half of its own rate: where lines fill the whole band, they were made for faster rows.
void refuse_folded(const AxisRecords& axis, const ident::frequency::Response& r,
                   const MachineDescription& machine) {
  if (!reaches_half_rate(r)) return;
  throw io::InputError(
      {axis.sources, 0, "t",
       fmt::format(
           "rows are {:.4g} ms apart and excited up to {:.3g} Hz, expected rows every {:.4g} ms, the control period of {}, or "
           "lines well below {:.4g} Hz, half the row rate: lines above it fold onto the others (record every period)",
           1e3 * r.sample_time, highest_excited(r) / (2.0 * kPi), 1e3 * machine.sample_time, machine.name,
           0.5 / r.sample_time)});
}

ident::frequency::Response estimate_of(const AxisRecords& axis, const ident::frequency::ResponseOptions& how,
                                       const MachineDescription* machine) {
  const double period = machine == nullptr ? 0.0 : machine->sample_time;
  const auto slower = [&](double rows) { return period > 0.0 && rows > (1.0 + kSamePeriod) * period; };
  try {
    ident::frequency::Response r = ident::frequency::estimate(axis.records, how);
    if (slower(r.sample_time)) refuse_folded(axis, r, *machine);
    return r;
  } catch (const ident::Refused& e) {
    if (axis.records.empty() || !slower(axis.records.front().sample_time)) throw;
    throw ident::Refused(fmt::format(
        "{}; rows are {:.4g} ms apart, the control period of {} is {:.4g} ms (record every period)", e.what(),
        1e3 * axis.records.front().sample_time, machine->name, 1e3 * period));
  }
}

/// Whether the rule is violated first near resonance and anti-resonance.
bool limited_by_resonance(const report::FrequencyAxis& a) {
  if (!a.fit.resonance || a.proposed.limit == sim::LoopLimit::kMeasured) return false;
  const double low = a.fit.antiresonance ? a.fit.antiresonance->value : a.fit.resonance->value;
  return a.proposed.limit_at > 0.7 * low && a.proposed.limit_at < 1.4 * a.fit.resonance->value;
}

std::vector<std::string> warnings_of(const report::FrequencyAxis& a) {
  std::vector<std::string> out;
  const ident::frequency::Response& r = a.response;
  if (r.units < static_cast<std::size_t>(kFewUnits))
    out.push_back(fmt::format("intervals rest on {} independent parts: record more strokes", r.units));
  if (a.fit.excess > kMisses)
    out.push_back(fmt::format(
        "the model misses the lines by {} times their noise: there is more in them than its structure has (look at "
        "the picture); the intervals are widened by that",
        ident::digits(a.fit.excess, 2)));
  if (a.fit.excess > kMisses && r.period && reaches_half_rate(r))
    out.push_back(fmt::format(
        "the lines reach {:.3g} Hz, half the row rate is {:.4g} Hz: if the control is faster than the rows of the log, lines above it are "
        "folded onto the others, and no number here holds (record every control period)",
        highest_excited(r) / (2.0 * kPi), 0.5 / r.sample_time));
  const auto unsure = std::count_if(r.lines.begin(), r.lines.end(),
                                    [](const ident::frequency::Line& l) { return !l.determined(); });
  if (unsure > 0)
    out.push_back(fmt::format(
        "{} of {} lines are not determined: noise is larger than what the excitation moves there; they are "
        "used for nothing",
        unsure, r.lines.size()));
  if (!r.period)
    out.emplace_back(
        "the excitation has no period: lines are means over bands, and a resonance narrower than a band is drawn too low "
        "(stribeck excite --method multisine)");
  if (a.fit.plant.mass > 0.0 && !a.units.physical())
    out.push_back(fmt::format(
        "force is in {} and position in {}: the mass is in {} and not in kg (give --gain, the force of one {})",
        a.units.force, a.units.position, a.units.named("kg"), a.units.force));
  return out;
}

/// Gains of the loop that the machine file describes, and their margins on the measured plant.
void add_present(const MachineDescription& machine, const std::string& axis, report::FrequencyAxis& out) {
  for (const auto& [name, a] : as_machine(machine).axes) {
    if (name != axis) continue;
    out.present = sim::MeasuredGains{a.commissioning.mass, a.commissioning.omega, {}};
    out.present_margins = sim::measured_margins(out.plant, *out.present);
  }
  for (const auto& [name, a] : machine.axes) {
    if (name == axis) out.present_is_proposed = !a.commissioning.omega;
  }
}

/// What the log and the machine file say against each other. Margins of the gains in the file would then be those of another loop: they are not given.
void doubt_present(const MachineDescription& machine, const LogsOfAxis& logs, report::FrequencyAxis& a) {
  std::vector<std::string> doubts = logs.notes;
  if (std::abs(a.response.sample_time / machine.sample_time - 1.0) > kSamePeriod) {
    doubts.push_back(fmt::format("rows of the log are {:.4g} ms apart, the control period of {} is {:.4g} ms",
                                 1e3 * a.response.sample_time, machine.name, 1e3 * machine.sample_time));
  }
  for (const auto& [name, axis] : machine.axes) {
    if (name == logs.axis && axis.drive_loop)
      doubts.push_back(fmt::format(
          "the drive of axis {} closes a {} loop of its own (drive_loop): the plant is that between its force and the position, and the gains that are "
          "proposed are those of a control that commands the force, not of this one",
          name, enum_name(axis.drive_loop->mode)));
    if (name != logs.axis || !a.units.physical()) continue;
    if (std::string wrong = mass_contradiction(axis, a.fit.mass.low(), a.fit.mass.high()); !wrong.empty())
      doubts.push_back(std::move(wrong));
  }
  if (doubts.empty()) return;
  a.present.reset();
  a.present_margins = {};
  for (std::string& doubt : doubts) doubt += "; margins of the gains in the machine file are not given";
  a.warnings.insert(a.warnings.begin(), doubts.begin(), doubts.end());
}

}  // namespace

report::FrequencyAxis frequency_of(const AxisRecords& axis, const FrequencyOptions& options,
                                   const MachineDescription* machine) {
  report::FrequencyAxis out;
  out.name = axis.axis;
  out.sources = axis.sources;
  if (!axis.records.empty())
    out.units = report::ShownUnits(axis.records.front().force_unit, axis.records.front().position_unit);
  if (axis.rotary && out.units.physical()) out.units = report::ShownUnits::turning();
  ident::frequency::ResponseOptions how;
  if (!options.period.empty())
    how.period = option_si("--period", options.period, quantity("s", "s").positive());
  out.response = estimate_of(axis, how, machine);
  out.fit = ident::frequency::fit_plant(out.response);
  out.plant = dense_plant(out.response, out.fit.plant);
  const double missing = add_hold(out.fit, out.plant);
  out.rule = {options.phase_margin * kPi / 180.0, std::pow(10.0, options.gain_margin / 20.0)};
  const double mass = out.fit.mass.value;
  out.proposed = sim::propose_loop(out.plant, mass, out.rule);
  out.resonance_limits = limited_by_resonance(out);
  if (out.resonance_limits)
    out.with_notch =
        sim::propose_notch(out.plant, mass, out.rule, out.fit.resonance->value, kDrift, out.proposed.omega);
  if (machine != nullptr && out.units.physical()) add_present(*machine, axis.axis, out);
  out.warnings = warnings_of(out);
  if (missing > 0.0)
    out.warnings.insert(
        out.warnings.begin(),
        fmt::format(
            "the force acts {} ms earlier than a command that is held for a period would: the log has the force that the drive makes, "
            "not the one that it is told. Proposals and margins count with a hold of one period, and with no delay of the drive, "
            "which this log does not show (log the command of the control as the force, or stay well below the proposal)",
            ident::digits(1e3 * missing, 3)));
  for (const std::string& note : axis.notes) out.warnings.push_back(note);
  return out;
}

report::FrequencyReportInput frequency_of_logs(const std::vector<std::string>& files, const LogOptions& log,
                                               const FrequencyOptions& options) {
  report::FrequencyReportInput out;
  if (!files.front().ends_with(".toml")) {
    out.axes.push_back(frequency_of(read_axis(files, log), options, nullptr));
    return out;
  }
  const MachineDescription machine = read_description(files.front());
  const std::vector<std::string> logs(files.begin() + 1, files.end());
  if (logs.empty()) refuse_option("LOG", "missing, expected logs after the machine file");
  for (const LogsOfAxis& one : logs_by_axis(machine, logs, log)) {
    out.axes.push_back(frequency_of(read_axis(one.logs, one.options), options, &machine));
    doubt_present(machine, one, out.axes.back());
  }
  if (out.axes.empty()) refuse_option("--axis", fmt::format("got {}, of which there is no log", log.axis));
  return out;
}

}  // namespace stribeck::workflow
