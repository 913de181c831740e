#include <algorithm>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::sim {
namespace {

/// Explicit steps of order three are stable below a rate of 1.7 (oscillating) to 2.5 (decaying) per step.
constexpr double kStableRate = 1.7;
/// An axis that is farther than this share of the path's size from it does not follow.
constexpr double kLost = 0.2;
constexpr int kLoopIsLost = 32;

}  // namespace

std::vector<path::PathPoint> sample_reference(const Travel& travel, double period) {
  path::Reference reference(travel.curve, travel.law());
  std::vector<path::PathPoint> points;
  points.reserve(static_cast<std::size_t>(travel.law().duration() / period) + 2);
  while (!reference.finished()) {
    points.push_back(reference.point());
    reference.advance(period);
  }
  return points;
}

Table2::Table2(const Machine& machine, double v_max)
    : axes_{plant::Axis(machine.axes[0].second.plant, machine.sample_time, v_max),
            plant::Axis(machine.axes[1].second.plant, machine.sample_time, v_max)},
      gain_{machine.axes[0].second.plant.force_gain(), machine.axes[1].second.plant.force_gain()},
      period_(machine.sample_time) {}

double Table2::rate_bound() const { return std::max(axes_[0].rate_bound(), axes_[1].rate_bound()); }

Metrics Table2::run(const control::Contouring& controller, const Travel& travel,
                    const std::vector<path::PathPoint>& reference, const plant::Fidelity& fidelity,
                    std::uint64_t seed, std::uint32_t trial, std::vector<ContourSample>* seen,
                    StatusCounter* status) {
  for (std::uint32_t i = 0; i < 2; ++i) axes_[i].start(reference[0].position[i], fidelity, {seed, trial, i});
  control::Contouring::State state;
  GlitchWindow glitch;
  MetricsCollector metrics;
  const double scored_from = travel.run_in;
  const double scored_to = travel.run_in + travel.law().cruise_time();
  if (seen != nullptr) seen->reserve(reference.size());
  for (std::size_t k = 0; k < reference.size(); ++k) {
    const path::PathPoint& r = reference[k];
    const double t = static_cast<double>(k) * period_;
    const Vec2 encoder{{axes_[0].encoder(), axes_[1].encoder()}};
    const Vec2 position{{axes_[0].position(), axes_[1].position()}};
    const double error = path::contour_error(travel.curve, position, r.phi);
    const Vec2 force = controller.step(state, r, encoder);
    const Vec2 voltage{{force[0] / gain_[0], force[1] / gain_[1]}};
    const bool in_glitch = glitch.step(r);
    const bool scored = t >= scored_from && t <= scored_to;
    if (seen != nullptr) {
      const Vec2 friction{{axes_[0].friction_force(), axes_[1].friction_force()}};
      seen->push_back({t, r, position, encoder, voltage, force, friction, error, scored});
    }
    plant::Axis::step_together(axes_[0], voltage[0], axes_[1], voltage[1]);
    if (scored) {
      metrics.add({error,
                   position - r.position,
                   {{axes_[0].voltage(), axes_[1].voltage()}},
                   {{axes_[0].current(), axes_[1].current()}},
                   {{axes_[0].power(), axes_[1].power()}},
                   in_glitch});
    }
  }
  if (status != nullptr) *status = state.status;
  return metrics.result();
}

int choose_substeps(Table2& table, const control::Contouring& controller, const Travel& travel,
                    const std::vector<path::PathPoint>& reference, double period, double accuracy) {
  // One lap and the run-in show every reversal there is.
  const auto lap =
      static_cast<std::size_t>((travel.run_in + travel.curve.lap_length() / travel.speed) / period) + 2;
  const std::vector<path::PathPoint> part(
      reference.begin(), reference.begin() + static_cast<std::ptrdiff_t>(std::min(lap, reference.size())));
  const auto trace = [&](int substeps) {
    std::vector<ContourSample> seen;
    table.run(controller, travel, part, {substeps, false, false}, 1, 0, &seen);
    return seen;
  };
  const double least = table.rate_bound() * period / kStableRate;
  if (!(least <= kMostSubsteps)) {
    throw Refused(
        "the machine needs more than 512 sub-steps per control period for its fastest rate (friction "
        "stiffness and damping over "
        "mass, armature or axial mode); a shorter sample_time or a softer machine can be simulated");
  }
  const auto follows = [&](const std::vector<ContourSample>& run) {
    for (const ContourSample& s : run) {
      if (!(std::abs(s.contour_error) <= kLost * travel.curve.size)) return false;
    }
    return true;
  };
  int n = std::max(2, static_cast<int>(std::ceil(least)));
  bool followed = false;
  for (; n <= kMostSubsteps; n += (n + 1) / 2) {
    const auto coarse = trace(n);
    const auto fine = trace(2 * n);
    const bool follows_now = follows(coarse) && follows(fine);
    // Too few sub-steps can lose the path; when many lose it too, it is the loop.
    if (!follows_now && n >= kLoopIsLost) break;
    followed = followed || follows_now;
    double worst = 0.0;
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      const double d = std::abs(fine[k].contour_error - coarse[k].contour_error);
      worst = std::isfinite(d) ? std::max(worst, d) : std::numeric_limits<double>::infinity();
    }
    // At a reversal the order falls to two: the coarse run is off by 4/3 of the difference.
    if (worst * 4.0 / 3.0 <= accuracy && follows_now) return n;
  }
  if (!followed) {
    throw Refused(
        "the loop does not follow the path (error above a fifth of its size): it is unstable or too slow "
        "with these gains, "
        "delay and sample_time");
  }
  throw Refused(
      "the contour error does not settle within the accuracy for up to 512 sub-steps: the loop is at the "
      "edge of "
      "stability, or the accuracy is finer than rounding allows");
}

}  // namespace stribeck::sim
