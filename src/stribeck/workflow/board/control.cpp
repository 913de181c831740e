#include <algorithm>
#include <chrono>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/board/control.hpp>
#include <stribeck/workflow/board/outside_law.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/parameters.hpp>

namespace stribeck::workflow {
namespace {

constexpr int kCurvePoints = 20;  ///< of the friction given to programs, in each direction

const std::vector<std::size_t> kBothAxes{0, 1};

/// What a program is told of an axis.
BoardAxis told(const friction::AxisModel& model, const sim::MachineAxis& axis, std::string model_file) {
  const sim::NamePlate plate = axis.name_plate();
  BoardAxis a{model.mass, model.load, model.delay_or_none(), plate.force, plate.encoder_resolution, 0.0, 0.0};
  a.model_file = std::move(model_file);
  std::visit(
      [&](const auto& law) {
        if constexpr (requires { law.stiffness(); }) {
          a.stiffness = law.stiffness();
          a.damping = law.damping();
        }
      },
      model.friction.dynamics);
  for (int i = -kCurvePoints; i <= kCurvePoints; ++i) {
    if (i == 0) continue;
    // Denser at low speeds, where the curve bends.
    const double share = static_cast<double>(i) / kCurvePoints;
    const double v = axis.limits.speed * share * std::abs(share);
    a.speed.push_back(v);
    a.friction.push_back(model_force(model, axis, v) - model.load);
  }
  return a;
}

}  // namespace

const std::vector<sim::Travel>& board_travels() {
  static const std::vector<sim::Travel> all = [] {
    std::vector<sim::Travel> t{sim::along(path::Shape::kCircle, 10e-3, 9.5e-3, 1.0),
                               sim::along(path::Shape::kEight, 10e-3, 4e-3, 1.0)};
    for (sim::Travel& one : t) one.settle_laps = 2.0;
    return t;
  }();
  return all;
}

std::vector<BoardController> built_in_contestants() {
  std::vector<sim::ControllerSpec> specs = sim::biaxial_controllers();
  for (sim::ControllerSpec& c : sim::beyond_controllers(specs.back())) specs.push_back(std::move(c));
  for (const char* name :
       {"pid", "cascade", "zpetc", "cross-coupled", "repetitive", "learning", "sliding-mode"}) {
    sim::ControllerSpec c = read_controller(name);
    // The same model for every law, at the velocity of the reference.
    c.friction = sim::FrictionUse::kWhole;
    specs.push_back(std::move(c));
  }
  std::vector<BoardController> all;
  for (sim::ControllerSpec& c : specs) all.push_back({std::move(c), {}});
  return all;
}

BoardController contestant(const BoardEntry& entry, const std::vector<std::string>& host) {
  BoardController c;
  c.outside = true;
  c.source = entry.source;
  c.folder = entry.folder;
  if (!entry.controller.empty()) {
    c.spec = read_controller(entry.controller);
  } else if (!entry.shared_object.empty()) {
    c.words = host;
    c.words.push_back(entry.shared_object);
    c.folder.clear();
  } else {
    c.words = io::split_command(entry.command, entry.name);
  }
  c.spec.id = entry.name;
  c.spec.label = entry.label;
  return c;
}

sim::AxisKnowledge board_knowledge(const BoardAnswer& model, const BoardAnswer* conventional) {
  sim::AxisKnowledge k;
  k.whole = model.model;
  k.eccentric = model.model;
  k.eccentric->friction.dynamics = friction::Static{};
  k.gaussian = k.eccentric;
  k.gaussian->friction.eccentric = {};
  if (conventional != nullptr) k.conventional = conventional->model;
  return k;
}

struct BoardControl::Parts {
  const BoardMachine& board;
  std::vector<sim::AxisKnowledge> knowledge;
  std::vector<std::string> model_files;
  std::uint64_t seed;
  std::uint32_t machine;
  std::vector<std::shared_ptr<const sim::Route<2>>> routes;
  std::unique_ptr<sim::JudgedRuns<2>> runs;

  [[nodiscard]] sim::AnyController<2> make(const BoardController& c, const sim::Route<2>& route,
                                           std::vector<std::string>* notes = nullptr) const {
    if (c.words.empty()) {
      auto setup = sim::make_setup<2>(board.machine, knowledge, kBothAxes, c.spec);
      for (const std::size_t i : sim::calm<2>(setup, c.spec)) {
        if (notes == nullptr) continue;
        notes->push_back(without_kalman_observer(
            board.machine.axes[i].first,
            setup.compensation[i].model.delay_or_none() / board.machine.sample_time, c.spec.id));
      }
      setup.lap = route.lap;
      return sim::make_controller<2>(c.spec.law, setup);
    }
    OutsideProgram program{c.words, {}, {board.machine.sample_time, {}}};
    program.limits.folder = c.folder;
    program.limits.answer = c.answer_seconds;
    program.limits.first_answer = 4.0 * c.answer_seconds;
    for (const std::size_t i : kBothAxes)
      program.setup.axes.push_back(told(*knowledge[i].whole, board.machine.axes[i].second, model_files[i]));
    // A handle of the program that never runs itself: each run begins with its copy().
    return std::make_shared<const OutsideLaw>(std::move(program));
  }
};

BoardControl::BoardControl(const BoardMachine& board, std::vector<sim::AxisKnowledge> knowledge,
                           std::vector<std::string> model_files, std::uint64_t seed, std::uint32_t machine)
    : parts_(std::make_unique<Parts>(
          Parts{board, std::move(knowledge), std::move(model_files), seed, machine, {}, {}})) {
  double fastest = 0.0;
  for (const sim::Travel& travel : board_travels()) {
    parts_->routes.push_back(
        std::make_shared<const sim::Route<2>>(sim::sample<2>(travel, board.machine.sample_time)));
    for (const auto& p : parts_->routes.back()->points)
      fastest = std::max(fastest, std::hypot(p.velocity[0], p.velocity[1]));
  }
  parts_->runs = std::make_unique<sim::JudgedRuns<2>>(board.machine, kBothAxes, 1.05 * fastest);
}

BoardControl::~BoardControl() = default;

BoardRun BoardControl::run(const BoardController& controller, std::size_t travel) {
  const sim::Route<2>& route = *parts_->routes[travel];
  try {
    BoardRun out;
    const sim::AnyController<2> made = parts_->make(controller, route, &out.notes);
    out.run = parts_->runs->run(made, route, parts_->seed, parts_->machine);
    return out;
  } catch (const sim::Refused& e) {
    return {{}, e.what()};
  } catch (const io::ProgramFailed& e) {
    return {{}, e.what()};
  }
}

report::BoardCost BoardControl::cost(const BoardController& controller) {
  const sim::Route<2>& route = *parts_->routes.front();
  report::BoardCost cost{controller.spec.id, kNaN, false};
  try {
    const auto made = parts_->make(controller, route);
    std::vector<sim::ContourSample> seen;
    static_cast<void>(parts_->runs->run(made, route, parts_->seed, parts_->machine, &seen));
    for (int pass = 0; pass < 3; ++pass) {
      const auto law = made->copy();
      const std::span<const path::PathPoint<2>> points = route.points;
      const auto begin = std::chrono::steady_clock::now();
      for (std::size_t k = 0; k < points.size(); ++k)
        static_cast<void>(law->step_ahead(points.subspan(k), {seen[k].encoder[0], seen[k].encoder[1]}));
      double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() /
                       static_cast<double>(points.size());
      if (auto* const outside = dynamic_cast<OutsideLaw*>(law.get())) {
        const std::optional<double> told_by_host = outside->finish();
        cost.over_a_pipe = !told_by_host;
        seconds = told_by_host.value_or(seconds);
      }
      cost.seconds = std::fmin(cost.seconds, seconds);
    }
  } catch (const sim::Refused&) {
    cost.seconds = kNaN;
  } catch (const io::ProgramFailed&) {
    cost.seconds = kNaN;
  }
  return cost;
}

}  // namespace stribeck::workflow
