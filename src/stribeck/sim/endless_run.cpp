#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <stribeck/sim/endless_run.hpp>
#include <type_traits>
#include <utility>

namespace stribeck::sim {
namespace {

/// Points ahead that a law may see, and points behind, where a law that slows down may be.
constexpr std::size_t kAhead = 256;
constexpr std::size_t kBehind = 256;
constexpr std::ptrdiff_t kBlock = 2048;  ///< old points that are forgotten at once
constexpr double kNoEnd = 1e12;          ///< laps of the law of motion; no run comes so far

template <std::size_t N>
class EndlessRunOf final : public EndlessRun {
 public:
  EndlessRunOf(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const CompareSpec& spec,
               const std::vector<std::size_t>& axes, const Route<N>& route, double fastest)
      : drives_(machine, axes, 1.05 * fastest), path_(spec.travels.front().path) {
    period_ = machine.sample_time;
    for (const std::size_t i : axes) axes_.push_back(machine.axes[i].first);
    const ControllerSpec& controller = spec.controllers.front();
    auto setup = make_setup<N>(machine, knowledge, axes, controller);
    calm<N>(setup, controller);
    setup.lap = route.lap;
    const int substeps = substeps_for<N>(drives_, setup, controller, route, spec.accuracy);
    law_ = make_controller<N>(controller.law, setup)->copy();
    set_source(spec.travels.front());
    while (points_.size() <= kAhead) points_.push_back(next_());
    drives_.start<N>(points_[0].position, {substeps, true, true}, spec.seed, 0);
  }

  ContourSample step() override {
    const std::span<const path::PathPoint<N>> ahead(&points_[at_], kAhead + 1);
    const ContourSample sample = drives_.tick<N>(*law_, path_, ahead, time(), near());
    points_.push_back(next_());
    if (++at_ >= kBehind + static_cast<std::size_t>(kBlock)) {
      points_.erase(points_.begin(), points_.begin() + kBlock);
      at_ -= static_cast<std::size_t>(kBlock);
    }
    ++ticks_;
    return sample;
  }

  [[nodiscard]] std::vector<control::Drift> drift() const override { return law_->drift(period_); }

 private:
  [[nodiscard]] double time() const { return static_cast<double>(ticks_) * period_; }

  /// Parameter of the reference, less the lag of a controller that slows down.
  [[nodiscard]] double near() const {
    const auto late = static_cast<std::size_t>(law_->lag() / period_ + 0.5);
    return points_[at_ - std::min(late, at_)].phi;
  }

  void set_source(const Travel& travel) {
    std::visit(
        [&](const auto& curve) {
          using C = std::decay_t<decltype(curve)>;
          if constexpr (C::kAxes == N && !requires { curve.part; }) {
            path::SpeedLaw law = travel.law();
            law.cruise_distance = kNoEnd * travel.lap();
            next_ = [reference = path::Reference<C>(curve, law, travel.pace, travel.frame),
                     period = period_]() mutable {
              const path::PathPoint<N> point = reference.point();
              reference.advance(period);
              return point;
            };
          }
        },
        path_);
  }

  Drives drives_;
  AnyPath path_;
  std::unique_ptr<LawRunner<N>> law_;
  std::function<path::PathPoint<N>()> next_;
  std::vector<path::PathPoint<N>> points_;  ///< the last ones, the present one, those ahead
  std::size_t at_ = 0;
  std::uint64_t ticks_ = 0;
};

}  // namespace

std::unique_ptr<EndlessRun> EndlessRun::make(const Machine& machine,
                                             const std::vector<AxisKnowledge>& knowledge,
                                             const CompareSpec& spec) {
  CompareSpec once = spec;
  Travel& travel = once.travels.front();
  if (travel.part() != nullptr || travel.cutting)
    throw Refused("a part program and a cutting force have an end (choose a closed path without a cut)");
  travel.settle_laps = 0.0;
  travel.laps = 1.0;
  const std::vector<std::size_t> axes = chosen_axes(machine, once);
  once.axes = axes;
  std::unique_ptr<EndlessRun> run;
  const bool known = with_axes(axes.size(), [&](auto n) {
    constexpr std::size_t kAxes = n;
    const Route<kAxes> route = sample<kAxes>(travel, machine.sample_time);
    if (!std::isfinite(route.lap)) throw Refused("the path is not closed (choose one that is)");
    double fastest = 0.0;
    for (const auto& p : route.points) fastest = std::max(fastest, norm(p.velocity));
    run = std::make_unique<EndlessRunOf<kAxes>>(machine, knowledge, once, axes, route, fastest);
  });
  if (!known) throw Refused("paths have 1, 2, 3 or 5 axes");
  return run;
}

}  // namespace stribeck::sim
