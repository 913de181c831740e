#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/own_motion.hpp>

namespace stribeck::workflow {

std::vector<std::size_t> named_axes(const sim::Machine& machine, const std::string& machine_file,
                                    const PathOptions& o) {
  std::vector<std::size_t> axes;
  for (const std::string& name : o.axes) {
    const std::size_t i = axis_index(machine, machine_file, name);
    if (std::find(axes.begin(), axes.end(), i) != axes.end())
      refuse_option("--axes", fmt::format("axis {} stands there twice", io::in_quotes(name)));
    axes.push_back(i);
  }
  return axes;
}

namespace {

/// Two digits, not more than x.
double rounded_down(double x) {
  const double step = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  return std::floor(x / step + 1e-9) * step;
}

/// A path in the middle of the travel of each axis, still without its harmonics.
template <std::size_t N>
path::Fourier<N> middle_of(const sim::Machine& machine, const std::vector<std::size_t>& axes) {
  path::Fourier<N> p;
  for (std::size_t i = 0; i < N; ++i) {
    const sim::AxisLimits& l = machine.axes[axes[i]].second.limits;
    p.axis[i].offset = 0.5 * (l.travel_min + l.travel_max);
  }
  return p;
}

constexpr double kSine = -0.5 * kPi;  // phase of a cosine
constexpr double kShareOfSpeed = 0.5;
constexpr double kSlow = 0.1;  // of the fast one

/// cos on the first axis, sin on the others: on three axes an ellipse in space, as the thesis's circle.
template <std::size_t N>
path::Fourier<N> circle_through(const sim::Machine& machine, const std::vector<std::size_t>& axes,
                                double radius) {
  path::Fourier<N> p = middle_of<N>(machine, axes);
  for (std::size_t i = 0; i < N; ++i) p.axis[i].terms = {path::Harmonic{radius, 1.0, i == 0 ? 0.0 : kSine}};
  return p;
}

/// The shape of path/curve.hpp about the middle of the travel; one lap is 2π here.
path::Fourier<2> shape_through(const sim::Machine& machine, const std::vector<std::size_t>& axes,
                               path::Shape shape, double size) {
  path::Fourier<2> p = middle_of<2>(machine, axes);
  const double half = 0.5 * size;
  switch (shape) {
    case path::Shape::kCircle:
      return circle_through<2>(machine, axes, size);
    case path::Shape::kEight:  // sin φ·cos φ = sin(2φ)/2
      p.axis[0].terms = {path::Harmonic{size, 1.0, kSine}};
      p.axis[1].terms = {path::Harmonic{half, 2.0, kSine}};
      break;
    case path::Shape::kTrifolium:  // cos φ·(4·sin²φ − 1) = −cos 3φ
      p.axis[0].terms = {path::Harmonic{half, 1.0, kPi}, path::Harmonic{half, 2.0, kPi}};
      p.axis[1].terms = {path::Harmonic{half, 1.0, kSine}, path::Harmonic{half, 2.0, -kSine}};
      break;
  }
  return p;
}

/// Smallest radius of curvature [m].
double tightest_radius(const path::Fourier<2>& p) {
  constexpr int kPlaces = 720;
  double curvature = 0.0;
  for (int i = 0; i < kPlaces; ++i) {
    const auto d = path::derivatives<2>(p, p.period() * i / kPlaces);
    curvature =
        std::max(curvature, std::abs(d[1][0] * d[2][1] - d[1][1] * d[2][0]) / std::pow(norm(d[1]), 3));
  }
  return 1.0 / curvature;
}

/// Axes of the motion of a machine of one's own: those that were named, else the first three that do not turn, else the first that
/// turn. A circle through an axis that turns and one that does not is one of millimetres and milliradians.
std::vector<std::size_t> own_axes(const sim::Machine& machine, const std::string& machine_file,
                                  const PathOptions& o) {
  const bool circle = *enum_value<path::Shape>(o.path) == path::Shape::kCircle;
  const std::size_t most = circle ? 3 : 2;
  std::vector<std::size_t> axes = named_axes(machine, machine_file, o);
  if (axes.size() > most || (!circle && axes.size() == 1))
    refuse_option("--axes", fmt::format("got {} axes, expected {}", axes.size(),
                                        circle ? "at most 3" : "2 for this shape, e.g. --axes x,z"));
  for (const bool rotary : {false, true}) {
    if (!axes.empty()) break;
    for (std::size_t i = 0; i < machine.axes.size() && axes.size() < most; ++i)
      if (machine.axes[i].second.rotary == rotary) axes.push_back(i);
    // An axis that turns and one that does not have no shape in common.
    if (!circle && axes.size() < most) axes.clear();
  }
  if (axes.empty())
    refuse_option("--path", fmt::format("{} needs two axes that both turn or both do not", o.path));
  return axes;
}

/// Radius and speeds that every axis can do, with something in hand.
std::vector<sim::Travel> own_travels(const sim::Machine& machine, const std::vector<std::size_t>& axes,
                                     const PathOptions& o, const std::vector<std::string>& speeds) {
  constexpr double kMostRadius = 20e-3;  // [m]
  constexpr double kShareOfTravel = 0.2;
  constexpr double kShareOfAcceleration = 0.3;
  double radius = kMostRadius;
  double speed = kInfinity;
  double acceleration = kInfinity;
  for (const std::size_t i : axes) {
    const sim::AxisLimits& l = machine.axes[i].second.limits;
    radius = std::min(radius, kShareOfTravel * (l.travel_max - l.travel_min));
    speed = std::min(speed, kShareOfSpeed * l.speed);
    acceleration = std::min(acceleration, kShareOfAcceleration * l.acceleration);
  }
  const bool turns =
      std::all_of(axes.begin(), axes.end(), [&](std::size_t i) { return machine.axes[i].second.rotary; });
  radius = o.size.empty() ? rounded_down(radius)
                          : travel_si("--size", o.size, quantity("m", "mm").positive(), turns);
  const auto shape = *enum_value<path::Shape>(o.path);
  const double tightest =
      shape == path::Shape::kCircle ? radius : tightest_radius(shape_through(machine, axes, shape, radius));
  // The run-in of a second reaches the speed with at most 1.875 times its mean acceleration.
  const double fast = rounded_down(std::min({speed, std::sqrt(acceleration * tightest), acceleration}));
  std::vector<double> all{rounded_down(kSlow * fast), fast};
  if (!speeds.empty()) all.clear();
  for (const std::string& text : speeds)
    all.push_back(travel_si("--speed", text, quantity("m/s", "mm/s").positive(), turns));
  std::vector<sim::Travel> travels;
  for (const double v : all) {
    sim::Travel t;
    t.laps = o.laps;
    t.speed = v;
    t.name = fmt::format("{} of {:.6g} mm through {} axes", o.path, radius * 1e3, axes.size());
    if (axes.size() == 1) {
      t.path = circle_through<1>(machine, axes, radius);
      t.pace = path::Pace::kRate;
      t.speed = v / radius;
      t.name = fmt::format("sine of {:.6g} mm, up to {:.6g} mm/s", radius * 1e3, v * 1e3);
    } else if (axes.size() == 2) {
      t.path = shape_through(machine, axes, shape, radius);
    } else {
      t.path = circle_through<3>(machine, axes, radius);
    }
    travels.push_back(std::move(t));
  }
  return travels;
}

}  // namespace

std::vector<double> own_speeds(const sim::Machine& machine, const std::vector<std::size_t>& axes) {
  double fast = kInfinity;
  for (const std::size_t i : axes) {
    const sim::MachineAxis& axis = machine.axes[i].second;
    if (!axis.rotary) fast = std::min(fast, kShareOfSpeed * axis.limits.speed);
  }
  if (!std::isfinite(fast)) return {};
  return {rounded_down(kSlow * fast), rounded_down(fast)};
}

sim::CompareSpec own_motion(const sim::Machine& machine, const std::string& machine_file,
                            const PathOptions& options, const std::vector<std::string>& speeds) {
  if (source_of(options) != PathSource::kShape)
    refuse_option(
        "--path",
        fmt::format("--experiment {} takes circle, eight or trifolium (take --experiment {} for a file)",
                    kOwn, kVaried));
  sim::CompareSpec motion;
  motion.axes = own_axes(machine, machine_file, options);
  motion.travels = own_travels(machine, motion.axes, options, speeds);
  return motion;
}

}  // namespace stribeck::workflow
