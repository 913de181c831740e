#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/targets/pulse/circle.hpp>
#include <variant>

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

/// Smallest and largest signed contour error that a law saw [m].
struct Errors {
  double smallest = 0.0;
  double largest = 0.0;
  bool any = false;

  void add(double error) noexcept {
    smallest = any ? std::min(smallest, error) : error;
    largest = any ? std::max(largest, error) : error;
    any = true;
  }
};

/// A law whose contour errors are noted from a time on, as the encoders of the table show them.
class NotedLaw final : public sim::LawRunner<2> {
 public:
  /// `errors` outlives the runs.
  NotedLaw(const sim::AnyController<2>& law, path::Curve curve, double period, double from, Errors* errors)
      : law_(law->copy()), curve_(curve), period_(period), from_(from), errors_(errors) {}

  [[nodiscard]] std::unique_ptr<LawRunner> copy() const override {
    return std::unique_ptr<LawRunner>(new NotedLaw(*this));
  }
  Vec<double, 2> step(const Point& now, const Vec<double, 2>& measured) override {
    note(now, measured);
    return law_->step(now, measured);
  }
  Vec<double, 2> step_ahead(std::span<const Point> points, const Vec<double, 2>& measured) override {
    note(points.front(), measured);
    return law_->step_ahead(points, measured);
  }
  void acted(const Vec<double, 2>& force) override { law_->acted(force); }
  [[nodiscard]] Vec<double, 2> command() const override { return law_->command(); }
  [[nodiscard]] Vec<double, 2> offset() const override { return law_->offset(); }
  [[nodiscard]] double lag() const override { return law_->lag(); }
  [[nodiscard]] const StatusCounter& status() const override { return law_->status(); }
  [[nodiscard]] std::vector<control::Drift> drift(double period) const override {
    return law_->drift(period);
  }

 private:
  NotedLaw(const NotedLaw& other)
      : LawRunner(other),
        law_(other.law_->copy()),
        curve_(other.curve_),
        period_(other.period_),
        from_(other.from_),
        errors_(other.errors_) {}

  void note(const Point& now, const Vec<double, 2>& measured) {
    const double time = period_ * static_cast<double>(ticks_++);
    if (time >= from_) errors_->add(path::contour_error(curve_, measured, now.phi));
  }

  std::unique_ptr<LawRunner> law_;
  path::Curve curve_;
  double period_;
  double from_;
  Errors* errors_;
  std::uint64_t ticks_ = 0;
};

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
  Errors errors;
  const sim::AnyController<2> noted = std::make_shared<const NotedLaw>(
      controller, std::get<path::Curve>(route_.path), axes_.machine.sample_time, route_.scored_from, &errors);
  const sim::Metrics m = drives_.run<2>(noted, route_, {substeps_, false, false}, 1, 0);
  return {m.quadrant_glitch, m.max_contour_error, errors.largest - errors.smallest};
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
