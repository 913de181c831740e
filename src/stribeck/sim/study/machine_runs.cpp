#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/sim/study/machine_runs.hpp>
#include <utility>

namespace stribeck::sim {
namespace {

/// A loop that is at the limit of its drives for more than this share of the ticks, and whose input varies by more than that share of
/// its range while it is scored, is held together by the limit. Stable loops of V2 vary by 1 % with the coarsest encoder.
constexpr double kMostLimited = 1e-3;
constexpr double kMostShaking = 0.02;

/// Sub-steps of order three at 0.8 of the fastest rate: twice as fine as stability needs, and no fewer than for nominal machines.
constexpr double kRatePerSubstep = 0.8;
constexpr int kFewestSubsteps = 6;

int substeps_of(const Drives& drives) {
  const double n = std::ceil(drives.rate_bound() * drives.period() / kRatePerSubstep);
  if (!(n <= kMostSubsteps))
    throw Refused(fmt::format(
        "the machine needs {} sub-steps per control period for its fastest rate, expected at most {} (a shorter control period, less damping or less pre-sliding stiffness)",
        n, kMostSubsteps));
  return std::max(kFewestSubsteps, static_cast<int>(n));
}

}  // namespace

template <std::size_t N>
JudgedRuns<N>::JudgedRuns(const Machine& machine, const std::vector<std::size_t>& axes, double v_max)
    : drives_(machine, axes, v_max),
      range_(std::numeric_limits<double>::infinity()),
      substeps_(substeps_of(drives_)) {
  for (const std::size_t i : axes) range_ = std::min(range_, machine.axes[i].second.plant.converter.range);
}

template <std::size_t N>
RobustRun JudgedRuns<N>::run(const AnyController<N>& controller, const Route<N>& route, std::uint64_t seed,
                             std::uint32_t trial, std::vector<ContourSample>* seen) {
  StatusCounter status;
  const Metrics metrics =
      drives_.run<N>(controller, route, {substeps_, true, true}, seed, trial, seen, &status);
  return judged(metrics, status, route);
}

template <std::size_t N>
RobustRun JudgedRuns<N>::judged(const Metrics& metrics, const StatusCounter& status,
                                const Route<N>& route) const {
  RobustRun r;
  r.metrics = metrics;
  r.limited = status.count(Status::kOutputLimited) / static_cast<double>(N * route.points.size());
  r.lost = !(r.metrics.max_contour_error <= kLost * route.size) ||
           (r.limited > kMostLimited && r.metrics.input_variation > kMostShaking * range_);
  return r;
}

template <std::size_t N>
std::vector<RobustRun> JudgedRuns<N>::run_together(std::span<const Member> members,
                                                   const AnyController<N>& controller, const Route<N>& route,
                                                   std::uint64_t seed) {
  std::vector<RunTogether<N>> all;
  for (const Member& m : members)
    all.push_back({&m.runs->drives_, controller, {m.runs->substeps_, true, true}, m.trial});
  const std::vector<RunResult> results = Drives::run_together<N>(all, route, seed);
  std::vector<RobustRun> judged_runs;
  for (std::size_t i = 0; i < members.size(); ++i)
    judged_runs.push_back(members[i].runs->judged(results[i].metrics, results[i].status, route));
  return judged_runs;
}

template class JudgedRuns<1>;
template class JudgedRuns<2>;
template class JudgedRuns<3>;
template class JudgedRuns<5>;

class MachineRuns::Loops {
 public:
  Loops() = default;
  Loops(const Loops&) = delete;
  Loops& operator=(const Loops&) = delete;
  virtual ~Loops() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual const std::vector<Calmed>& calmed() const = 0;
  [[nodiscard]] virtual std::vector<RunsOfMachine> run(std::span<const MachineTrial> machines) const = 0;
};

template <std::size_t N>
class MachineRuns::LoopsOf : public Loops {
 public:
  LoopsOf(const Machine& nominal, const std::vector<AxisKnowledge>& knowledge,
          const std::vector<Travel>& travels, const std::vector<std::size_t>& axes,
          const std::vector<ControllerSpec>& specs, std::uint64_t seed)
      : axes_(axes), seed_(seed) {
    for (const Travel& travel : travels) {
      const auto route = std::make_shared<const Route<N>>(sample<N>(travel, nominal.sample_time));
      for (const auto& p : route->points) fastest_ = std::max(fastest_, norm(p.velocity));
      for (const ControllerSpec& c : specs) {
        auto setup = make_setup<N>(nominal, knowledge, axes, c);
        for (const std::size_t i : calm<N>(setup, c)) {
          if (controllers_.size() < specs.size()) calmed_.push_back({controllers_.size(), i});
        }
        setup.lap = route->lap;
        routes_.push_back(guide_motors<N>(route, nominal, knowledge, axes, c, setup));
        controllers_.push_back(make_controller<N>(c.law, setup));
      }
    }
  }

  [[nodiscard]] std::size_t size() const override { return controllers_.size(); }
  [[nodiscard]] const std::vector<Calmed>& calmed() const override { return calmed_; }

  [[nodiscard]] std::vector<RunsOfMachine> run(std::span<const MachineTrial> machines) const override {
    std::vector<RunsOfMachine> all(machines.size());
    std::vector<std::unique_ptr<JudgedRuns<N>>> drives;
    std::vector<typename JudgedRuns<N>::Member> members;
    std::vector<std::size_t> index;  // of each member among the machines
    for (std::size_t m = 0; m < machines.size(); ++m) {
      try {
        drives.push_back(std::make_unique<JudgedRuns<N>>(machines[m].machine, axes_, 1.05 * fastest_));
        members.push_back({drives.back().get(), machines[m].trial});
        index.push_back(m);
      } catch (const Refused&) {
        all[m].refused = std::current_exception();
      }
    }
    for (std::size_t i = 0; i < controllers_.size(); ++i) {
      const std::vector<RobustRun> runs =
          JudgedRuns<N>::run_together(members, controllers_[i], *routes_[i], seed_);
      for (std::size_t k = 0; k < runs.size(); ++k) all[index[k]].runs.push_back(runs[k]);
    }
    return all;
  }

 private:
  std::vector<std::size_t> axes_;
  std::uint64_t seed_;
  double fastest_ = 0.0;
  std::vector<std::shared_ptr<const Route<N>>> routes_;
  std::vector<AnyController<N>> controllers_;
  std::vector<Calmed> calmed_;  ///< on the first travel
};

MachineRuns::MachineRuns(const Machine& nominal, const std::vector<AxisKnowledge>& knowledge,
                         const std::vector<Travel>& travels, const std::vector<std::size_t>& axes,
                         const std::vector<ControllerSpec>& controllers, std::uint64_t seed) {
  const bool known = with_axes(axes.size(), [&](auto n) {
    loops_ = std::make_shared<LoopsOf<n>>(nominal, knowledge, travels, axes, controllers, seed);
  });
  if (!known) throw Refused("paths have 1, 2, 3 or 5 axes");
}

std::size_t MachineRuns::size() const { return loops_->size(); }

const std::vector<MachineRuns::Calmed>& MachineRuns::calmed() const { return loops_->calmed(); }

std::vector<RobustRun> MachineRuns::run(const Machine& machine, std::uint32_t trial) const {
  const MachineTrial one{machine, trial};
  RunsOfMachine result = std::move(loops_->run({&one, 1}).front());
  if (result.refused) std::rethrow_exception(result.refused);
  return std::move(result.runs);
}

std::vector<RunsOfMachine> MachineRuns::run_together(std::span<const MachineTrial> machines) const {
  return loops_->run(machines);
}

}  // namespace stribeck::sim
