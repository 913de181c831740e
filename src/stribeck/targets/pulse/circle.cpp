#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/targets/pulse/circle.hpp>

namespace stribeck::targets {

namespace {

constexpr double kAccuracy = 1e-8;  ///< of the simulated contour error [m]
constexpr double kShareOfError =
    5e-4;  ///< allowed error of the simulation, as a share of the error without a pulse
constexpr double kCoarse = 1e-6;  ///< at most [m]
constexpr int kMostDelay = 8;     ///< of the plant [control periods]

sim::Travel circle_travel(double radius, double feed, double laps) {
  sim::Travel t;
  t.path = path::Curve{path::Shape::kCircle, radius};
  t.name = "circle";
  t.speed = feed;
  t.laps = laps;
  // The axes break away from rest at its beginning.
  t.settle_laps = 0.25;
  return t;
}

}  // namespace

sim::Machine machine_of(const std::array<friction::AxisModel, 2>& axes, double period) {
  sim::Machine m;
  m.name = "identified axes";
  m.sample_time = period;
  for (const friction::AxisModel& known : axes) {
    sim::MachineAxis a;
    a.plant.mass = known.mass;
    a.plant.load = known.load;
    a.plant.drive = plant::CurrentDrive{1.0, {}};
    // Converter and encoder do not round in these runs, and no force saturates.
    a.plant.converter.range = 1e9;
    a.plant.encoder.resolution = 1e-9;
    a.plant.friction = known.friction;
    const double periods = known.delay_or_none() / period;
    if (!(periods <= kMostDelay)) {
      throw sim::Refused(fmt::format(
          "the delay of an axis, {:.4g} ms, is more than {} control periods of {:.4g} ms: the circle cannot be simulated (correct delay in "
          "the axis file, or the control period, --period)",
          1e3 * known.delay_or_none(), kMostDelay, 1e3 * period));
    }
    a.plant.delay_periods = static_cast<int>(std::floor(periods));
    if (const double rest = periods - a.plant.delay_periods; rest > 1e-6) a.plant.delay_fraction = rest;
    m.axes.emplace_back(m.axes.empty() ? "x" : "y", a);
  }
  return m;
}

Circle::Circle(const CircleAxes& axes, double radius, double feed, double laps, int substeps)
    : axes_(axes),
      route_(sim::sample<2>(circle_travel(radius, feed, laps), axes.machine.sample_time)),
      drives_(axes.machine, {0, 1}, 1.2 * feed),
      substeps_(substeps) {
  if (substeps_ > 0) return;
  const auto choose = [&](double accuracy) {
    substeps_ = sim::choose_substeps<2>(drives_, controller(sim::FrictionUse::kNone), route_, accuracy);
  };
  try {
    choose(kCoarse);
    const double accuracy = std::max(kAccuracy, kShareOfError * without().quadrant);
    if (accuracy < kCoarse) choose(accuracy);
  } catch (const sim::Refused& e) {
    throw sim::Refused(fmt::format(
        "{}; this was a circle of {:.4g} mm at {:.4g} mm/s with the loop {}: give the loop of the machine with --controller, or another circle with --speed and --size",
        e.what(), 1e3 * radius, 1e3 * feed, axes_.loop.id));
  }
}

sim::AnyController<2> Circle::controller(sim::FrictionUse use) const {
  sim::ControllerSpec spec = axes_.loop;
  spec.friction = use;
  spec.observer = control::Observer::kNone;
  spec.adaptation.enabled = false;
  spec.feedforward = control::Feedforward::kDynamic;
  std::vector<sim::AxisKnowledge> knowledge(axes_.machine.axes.size());
  for (std::size_t i = 0; i < 2; ++i) knowledge[i].whole = axes_.known[i];
  return sim::make_controller<2>(spec.law, sim::make_setup<2>(axes_.machine, knowledge, {0, 1}, spec));
}

CircleError Circle::error_of(const sim::AnyController<2>& controller) {
  const sim::Metrics m = drives_.run<2>(controller, route_, {substeps_, false, false}, 1, 0);
  return {m.quadrant_glitch, m.max_contour_error};
}

CircleError Circle::without() { return error_of(controller(sim::FrictionUse::kNone)); }

CircleError Circle::with(const std::array<Pulse, 2>& pulses) {
  return error_of(std::make_shared<const PulsedCascade>(controller(sim::FrictionUse::kNone), axes_.cascade(),
                                                        axes_.machine.sample_time, pulses));
}

CircleError Circle::with(const std::array<TableForce, 2>& tables) {
  return error_of(std::make_shared<const TableCascade>(controller(sim::FrictionUse::kNone), tables));
}

CircleError Circle::with_model() { return error_of(controller(sim::FrictionUse::kWhole)); }

}  // namespace stribeck::targets
