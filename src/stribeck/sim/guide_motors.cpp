#include <fmt/core.h>

#include <stribeck/control/compensation/lost_motion_move.hpp>
#include <stribeck/sim/compare.hpp>

namespace stribeck::sim {

bool guides(const MachineAxis& axis, const AxisKnowledge& knowledge, const ControllerSpec& which) {
  return which.lost_motion && knowledge.lost_motion && axis.plant.encoder.side == plant::EncoderSide::kDrive;
}

template <std::size_t N>
std::shared_ptr<const Route<N>> guide_motors(const std::shared_ptr<const Route<N>>& as_it_is,
                                             const Machine& machine,
                                             const std::vector<AxisKnowledge>& knowledge,
                                             const std::vector<std::size_t>& axes,
                                             const ControllerSpec& which, const control::Setup<N>& setup) {
  std::shared_ptr<Route<N>> route;
  for (std::size_t i = 0; i < N; ++i) {
    const auto& [name, axis] = machine.axes[axes[i]];
    if (!guides(axis, knowledge[axes[i]], which)) continue;
    const control::LostMotionParams& lost = *knowledge[axes[i]].lost_motion;
    const AxisLimits& l = axis.limits;
    const control::LostMotionBounds bounds{l.speed, l.acceleration, l.jerk_or_default(), l.travel_min,
                                           l.travel_max};
    if (!control::lost_motion_move_fits(lost, bounds, setup.period))
      throw Refused(fmt::format(
          "axis {}: compensation of lost motion would take more than {} control periods (raise lost_motion.move.speed, "
          "acceleration or jerk, or lower its cycles)",
          name, control::LostMotionMove::kMostFirst));
    if (!route) {
      route = std::make_shared<Route<N>>(*as_it_is);
      route->motors = route->points;
      route->added.assign(route->points.size(), {});
    }
    const control::LostMotionMove move(lost, setup.compensation[i], bounds, setup.period);
    // On the heap: the state has the boxes of the longest move.
    const auto state = std::make_unique<control::LostMotionMove::State>();
    for (std::size_t k = 0; k < route->points.size(); ++k) {
      path::PathPoint<N>& r = route->motors[k];
      const auto out = move.step(*state, r.position[i], r.velocity[i], r.acceleration[i]);
      r.position[i] += out.position;
      r.velocity[i] += out.velocity;
      r.acceleration[i] += out.acceleration;
      route->added[k][i] = out.force;
    }
  }
  if (route) return route;
  return as_it_is;
}

#define STRIBECK_INSTANTIATE(N)                                                                  \
  template std::shared_ptr<const Route<N>> guide_motors<N>(                                      \
      const std::shared_ptr<const Route<N>>&, const Machine&, const std::vector<AxisKnowledge>&, \
      const std::vector<std::size_t>&, const ControllerSpec&, const control::Setup<N>&);
STRIBECK_INSTANTIATE(1)
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
STRIBECK_INSTANTIATE(5)
#undef STRIBECK_INSTANTIATE

}  // namespace stribeck::sim
