#include <fmt/format.h>
#include <cmath>
#include <utility>

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/reproduce/axis_study.hpp>

namespace stribeck::workflow::reproduction {

namespace {

/// Each run has its own noise: a model must not have been identified with the noise of the run on which it is judged.
enum Run : std::uint64_t { kPulses, kFewJogs, kJogs, kSine, kUnseen };
constexpr std::uint64_t kBetweenRuns = 1000003;

ident::log::Record log_of(const Study& s, const ident::excitation::Excitation& e, Run run) {
  return as_record(play(*s.machine, s.axis, e.r, e.force, s.seed + run * kBetweenRuns),
                   fmt::format("{}-{}", s.name(), enum_name(e.method)));
}

ident::excitation::Limits limits_of(const Study& s) {
  const sim::AxisLimits& l = s.truth().limits;
  return {l.travel_min, l.travel_max, l.speed, l.acceleration, s.truth().force_limit()};
}

ident::log::Record jog(const Study& s, std::vector<double> speeds, Run run) {
  ident::excitation::JogDesign design;
  design.speeds = std::move(speeds);
  return log_of(s, ident::excitation::design_jog(limits_of(s), s.machine->sample_time, design), run);
}

/// Each pair of pulses separately, with the dead band of all; pairs that do not move the axis are left out (fig 2.11).
std::vector<Scale> by_scale(const ident::log::Record& log, const std::vector<double>& force,
                            double dead_band) {
  ident::methods::LeastSquaresAOptions options;
  options.dead_band = dead_band;
  std::vector<std::size_t> starts;
  for (std::size_t k = 1; k < force.size(); ++k) {
    if (force[k] > 0.0 && force[k - 1] <= 0.0) starts.push_back(k - 1);
  }
  starts.push_back(log.x.size());
  const std::vector<double> k_u = ident::excitation::PulseDesign().scales;
  std::vector<Scale> scales;
  for (std::size_t i = 0; i + 1 < starts.size() && i < k_u.size(); ++i) {
    ident::log::Record part = log;
    for (auto* column : {&part.t, &part.x, &part.f}) {
      const auto begin = column->begin();
      *column = {begin + static_cast<std::ptrdiff_t>(starts[i]),
                 begin + static_cast<std::ptrdiff_t>(starts[i + 1])};
    }
    try {
      scales.push_back({k_u[i], ident::methods::identify_least_squares_a({part}, options)});
    } catch (const ident::Refused&) {
      continue;
    }
  }
  return scales;
}

/// r = 10 cos 0.85 t mm (§3.1.4) for the biaxial table, y of (4.6) for the machine tool.
ident::excitation::Excitation unseen_motion(const Study& s) {
  const ident::excitation::SineDesign table{10e-3, 10e-3, 0.85, 3};
  ident::excitation::SineDesign tool{0.0, 10e-3, 4.0 * kPi / 15.0, 2};
  tool.from_middle = true;
  return ident::excitation::design_sine(limits_of(s), s.machine->sample_time, s.biaxial ? table : tool);
}

void replay(Study& s) {
  s.unseen = log_of(s, unseen_motion(s), kUnseen);
  const auto add = [&](const char* name, bool of_thesis, const friction::AxisModel& model) {
    s.replayed.push_back({name, of_thesis, ident::replay::replay_open_loop(model, s.unseen)});
  };
  add("Model A", true, as_model(s.a->result));
  add("Model B", true, as_model(s.b->result));
  if (s.c) add("Model C", true, as_model(*s.c));
  if (s.d) add("Model D", true, as_model(*s.d));
  add("Model A without the viscous correction", false, as_model(s.pulses->result));
  add("whole, with bristles", false, as_model(*s.whole));
  const plant::AxisParams& p = s.truth().plant;
  add("the machine itself", false, {p.mass, p.load, p.friction});
}

}  // namespace

void run_study(Study& s) {
  const Wanted& w = s.wanted;
  ident::log::Record pulses;
  if (w.a || w.c || w.verify) {
    // The first run only tells the forces for the second one.
    const ident::excitation::Excitation first =
        design(*s.machine, s.axis, ident::excitation::ExcitationMethod::kPulses, 0);
    const auto drive = ident::excitation::rough_drive(
        ident::methods::identify_least_squares_a({log_of(s, first, kPulses)}).result);
    const ident::excitation::Excitation second =
        design(*s.machine, s.axis, ident::excitation::ExcitationMethod::kPulses, 0, drive);
    pulses = log_of(s, second, kPulses);
    s.pulses = ident::methods::identify_least_squares_a({pulses});
    if (w.a) s.scales = by_scale(pulses, second.force, s.pulses->dead_band);
  }
  if (w.a || w.verify) {
    // Speeds of §2.3.2.
    const std::vector<double> speeds{0.1e-3, 0.2e-3, 0.3e-3, 0.5e-3, 1e-3, 2e-3, 4e-3, 6e-3, 8e-3, 10e-3};
    s.a = ident::methods::identify_least_squares_a({pulses}, {jog(s, speeds, kFewJogs)});
  }
  const ident::log::Record sine =
      w.b || w.c || w.d || w.verify
          ? log_of(s,
                   design(*s.machine, s.axis,
                          s.biaxial ? ident::excitation::ExcitationMethod::kSine
                                    : ident::excitation::ExcitationMethod::kPositionSine,
                          s.biaxial ? kSinePeriods : kPositionPeriods),
                   kSine)
          : ident::log::Record{};
  if (w.b || w.verify) {
    ident::methods::JogOptions conventional;
    conventional.gaussians = false;
    const double fastest = s.biaxial ? 9e-3 : 15e-3;  // §2.3.3, §4.4.1
    s.b = ident::methods::identify_jog({jog(s, ident::excitation::jog_speeds(fastest), kJogs), sine},
                                       conventional);
  }
  if (s.biaxial && (w.c || w.verify)) {
    ident::methods::VelocityMapOptions options;
    options.curve_points = 96;  // the curve is drawn with straight lines between its points
    s.c = ident::methods::identify_velocity_map({pulses, sine}, options);
  }
  if (!s.biaxial && (w.d || w.verify)) s.d = ident::methods::identify_position_map({sine});
  if (w.verify) {
    s.whole = ident::drive::identify_drive({pulses, sine});
    replay(s);
  }
}

}  // namespace stribeck::workflow::reproduction
