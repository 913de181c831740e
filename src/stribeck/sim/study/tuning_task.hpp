#pragma once
/// One controller of tuning.hpp on its paths: margins of its loop, cost under simulation, and how far it is from the limits.
///
/// Inside sim/study only.
/// Real time: no. Errors: Refused of the loop (contour_run.hpp, loop_margins.hpp).

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <stribeck/sim/study/tuning.hpp>
#include <stribeck/sim/trials_together.hpp>
#include <vector>

namespace stribeck::sim::tuning {

/// Distance of a point from each limit; a value above 0 violates the limit.
struct Point {
  bool stable = false;
  double objective =
      std::numeric_limits<double>::infinity();  ///< [m]; infinite: not simulated, or the path was lost
  LoopMargins margins;
  std::vector<double> variation;  ///< per travel [V]; empty: not simulated
  std::vector<double> excess;
  double far = 0.0;          ///< the largest excess, without the cut-off
  std::size_t farthest = 0;  ///< index of its limit

  [[nodiscard]] double worst() const {
    double w = -std::numeric_limits<double>::infinity();
    for (const double e : excess) w = std::max(w, e);
    return w;
  }
};

/// Excesses are cut off here, so that points far from a limit do not dominate a linear model of them.
inline constexpr double kMostExcess = 2.0;
/// Noise of the confirmation.
inline constexpr std::uint32_t kCheckTrial = 2 * kSearchTrial;
inline constexpr std::uint32_t kCheckTrials = 10;

/// Noise under which points are simulated, and the variation of the reference under it.
struct Trials {
  std::uint32_t first = 0;
  std::uint32_t count = 0;              ///< on the given machine
  std::uint32_t nearby = 0;             ///< on each of the others
  std::vector<double> variation_limit;  ///< per travel [V]
};

/// Drives of each machine, the given one first.
using Fleet = std::deque<EqualDrives>;

/// What a run costs by the goal of the search [m].
inline double cost_of(const Metrics& m, TuneGoal goal, std::size_t axes) {
  switch (goal) {
    case TuneGoal::kSurface:
      // A path without a reversal has no glitch.
      return (std::isfinite(m.quadrant_glitch) ? m.quadrant_glitch : 0.0) + m.sd;
    case TuneGoal::kSpeed: {
      double lag = 0.0;
      for (std::size_t i = 0; i < axes; ++i) lag += m.mean_abs_tracking[i] / static_cast<double>(axes);
      return lag + m.rms;
    }
    default:
      return m.max_contour_error + m.rms;
  }
}

template <std::size_t N>
class Task {
 public:
  Task(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const TuneSpec& spec,
       const std::vector<std::size_t>& axes, const std::vector<std::shared_ptr<const Route<N>>>& routes,
       Fleet& fleet)
      : machine_(machine), knowledge_(knowledge), spec_(spec), axes_(axes), routes_(routes), fleet_(fleet) {
    for (std::size_t i = 0; i < N && i < spec.limits.axial_mode.size(); ++i)
      modes_[i] = spec.limits.axial_mode[i];
  }

  [[nodiscard]] LoopMargins margins(const ControllerSpec& c) const {
    return loop_margins<N>(c.law, make_setup<N>(machine_, knowledge_, axes_, c), modes_);
  }

  /// The loop of the axis that comes nearest to instability.
  [[nodiscard]] LoopResponse response(const ControllerSpec& c) const {
    auto all = loop_responses<N>(c.law, make_setup<N>(machine_, knowledge_, axes_, c), modes_);
    return *std::min_element(all.begin(), all.end(), [](const LoopResponse& a, const LoopResponse& b) {
      return a.nearest < b.nearest;
    });
  }

  /// Of every axis; empty where the loop is not stable.
  [[nodiscard]] std::vector<SmoothSpeed> smooth_speeds(const ControllerSpec& c) {
    const auto setup = make_setup<N>(machine_, knowledge_, axes_, c);
    if (!loop_margins<N>(c.law, setup, modes_).stable) return {};
    const auto loops = loop_responses<N>(c.law, setup, modes_);
    const AnyController<N> controller = make_controller<N>(c.law, setup);
    std::vector<SmoothSpeed> out;
    for (std::size_t i = 0; i < N; ++i) {
      const double fastest = machine_.axes[axes_[i]].second.limits.speed;
      SmoothSpeed one;
      if (const friction::AxisModel* model = knowledge_[axes_[i]].best()) {
        one.predicted = slowest_smooth(
            fastest, [&](double v) { return !oscillates(loops[i], model->mass, model->friction, v); });
      }
      one.simulated = slowest_smooth(
          fastest, [&](double v) { return !sticks<N>(fleet_[0][0], controller, *routes_.front(), i, v); });
      out.push_back(one);
    }
    return out;
  }

  void choose_substeps(const ControllerSpec& c) {
    substeps_.assign(fleet_.size(), {});
    for (std::size_t m = 0; m < fleet_.size(); ++m) {
      try {
        for (const auto& route : routes_) {
          substeps_[m].push_back(
              substeps_for<N>(fleet_[m][0], setup(c, *route), c, *guided(c, route), spec_.compare.accuracy));
        }
      } catch (const Refused&) {
        // At the edge of stability on that machine: its run says how far off it is.
        if (m == 0) throw;
        substeps_[m] = substeps_[0];
      }
    }
  }

  /// Variation of the input, on the given machine, and J on these trials.
  void run(const ControllerSpec& c, const Trials& trials, Point& p) {
    p.variation.assign(routes_.size(), 0.0);
    double sum = 0.0;
    for (std::size_t t = 0; t < routes_.size(); ++t) {
      const auto controller = make_controller<N>(c.law, setup(c, *routes_[t]));
      const auto route = guided(c, routes_[t]);
      std::vector<RunTogether<N>> runs;
      for (std::size_t m = 0; m < fleet_.size(); ++m) {
        for (std::uint32_t trial = 0; trial < on_machine(m, trials); ++trial)
          runs.push_back(
              {&fleet_[m][trial], controller, {substeps_[m][t], true, true}, trials.first + trial});
      }
      const std::vector<RunResult> results = Drives::run_together<N>(runs, *route, spec_.compare.seed);
      std::size_t run = 0;
      for (std::size_t m = 0; m < fleet_.size(); ++m) {
        const std::uint32_t count = on_machine(m, trials);
        const double weight = static_cast<double>(trials.count) / count;  // machines count alike
        for (std::uint32_t trial = 0; trial < count; ++trial) {
          const Metrics& figures = results[run++].metrics;
          sum += weight * cost_of(figures, spec_.goal, N);
          if (m == 0) p.variation[t] += figures.input_variation / count;
          if (!(figures.max_contour_error <= kLost * route->size))
            sum = std::numeric_limits<double>::infinity();
        }
      }
    }
    p.objective = sum / static_cast<double>(routes_.size() * fleet_.size() * trials.count);
  }

  /// Computes margins, then runs the point unless its loop is unstable.
  Point evaluate(const ControllerSpec& c, const Trials& trials) {
    Point p;
    try {
      p = only_margins(margins(c));
    } catch (const Refused&) {
      // A law that has no margins counts as unstable; this also keeps exceptions out of the optimiser's stack frames.
      for (int i = 0; i < 3; ++i) add(p, kMostExcess);
    }
    if (p.stable) run(c, trials, p);
    for (std::size_t t = 0; t < routes_.size(); ++t) {
      add(p, p.stable ? p.variation[t] / ((1.0 - kKeptBack) * trials.variation_limit[t]) - 1.0 : kMostExcess);
    }
    return p;
  }

  /// A point of which only the margins are known.
  [[nodiscard]] Point only_margins(const LoopMargins& m) const {
    Point p;
    p.margins = m;
    p.stable = m.stable;
    const TuneLimits& l = spec_.limits;
    add(p, 1.0 - m.phase / l.phase_margin);
    add(p, std::log2(l.gain_margin / m.gain));
    add(p, l.delay_margin - m.delay / machine_.sample_time);
    return p;
  }
  /// Excesses of a point that may have been simulated.
  [[nodiscard]] static bool keeps_margins(const Point& p) {
    return p.stable && std::all_of(p.excess.begin(), p.excess.begin() + 3, [](double e) { return e <= 0.0; });
  }

  /// The limit that is violated most.
  [[nodiscard]] Miss broken(const Point& p, const Trials& trials) const {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const TuneLimits& l = spec_.limits;
    if (!p.stable) return {Limit::kStability, kNone, kNone};
    const std::size_t i = p.farthest;
    if (p.worst() <= 0.0) return {Limit::kPath, kNone, kNone};
    if (i == 0) return {Limit::kPhaseMargin, p.margins.phase, l.phase_margin};
    if (i == 1) return {Limit::kGainMargin, p.margins.gain, l.gain_margin};
    if (i == 2) return {Limit::kDelayMargin, p.margins.delay / machine_.sample_time, l.delay_margin};
    return {Limit::kInputVariation, p.variation[i - 3], trials.variation_limit[i - 3], i - 3};
  }

 private:
  static std::uint32_t on_machine(std::size_t m, const Trials& trials) {
    return m == 0 ? trials.count : trials.nearby;
  }
  /// Adds one more limit of a point.
  static void add(Point& p, double e) {
    if (std::isnan(e)) e = std::numeric_limits<double>::infinity();
    if (p.excess.empty() || e > p.far) {
      p.far = e;
      p.farthest = p.excess.size();
    }
    p.excess.push_back(std::clamp(e, -kMostExcess, kMostExcess));
  }

  [[nodiscard]] control::Setup<N> setup(const ControllerSpec& c, const Route<N>& route) const {
    auto s = make_setup<N>(machine_, knowledge_, axes_, c);
    s.lap = route.lap;
    return s;
  }

  [[nodiscard]] std::shared_ptr<const Route<N>> guided(const ControllerSpec& c,
                                                       const std::shared_ptr<const Route<N>>& route) const {
    return guide_motors<N>(route, machine_, knowledge_, axes_, c, setup(c, *route));
  }

  const Machine& machine_;
  const std::vector<AxisKnowledge>& knowledge_;
  const TuneSpec& spec_;
  const std::vector<std::size_t>& axes_;
  const std::vector<std::shared_ptr<const Route<N>>>& routes_;
  Fleet& fleet_;
  DeclaredModes<N> modes_;
  std::vector<std::vector<int>> substeps_;  ///< per machine and route
};

}  // namespace stribeck::sim::tuning
