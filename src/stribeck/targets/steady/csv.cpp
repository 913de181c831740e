#include <fmt/format.h>
#include <cmath>

#include <stribeck/targets/steady/steady_target.hpp>

namespace stribeck::targets {

namespace {

/// Speeds of one direction, in even steps of their logarithm.
constexpr int kRows = 1000;

Form write_csv(const Axis& axis) {
  Form form;
  form.mass = form.load = true;
  form.text = fmt::format("# mass: {:.9g} kg\n# load: {:.9g} N\n", axis.model.mass, axis.model.load);
  const auto row = [&](double v) {
    form.text += fmt::format("{},{:.9g},{:.9g}\n", axis.name, 1e3 * v, axis.friction(v));
  };
  const double ratio = std::log(axis.fastest / axis.slowest);
  const auto speed = [slowest = axis.slowest, ratio](int i) {
    return slowest * std::exp(ratio * i / (kRows - 1));
  };
  for (int i = kRows - 1; i >= 0; --i) row(-speed(i));
  for (int i = 0; i < kRows; ++i) row(speed(i));
  // Whoever reads the table interpolates.
  form.held = [axis, ratio, speed](double v) {
    const double at = std::log(std::abs(v) / axis.slowest) / ratio * (kRows - 1);
    const auto i = static_cast<int>(std::clamp(at, 0.0, kRows - 2.0));  // at rest `at` is −∞
    const double a = speed(i);
    const double b = speed(i + 1);
    const double sign = v < 0.0 ? -1.0 : 1.0;
    const double fa = axis.friction(sign * a);
    return fa + (axis.friction(sign * b) - fa) * (std::abs(v) - a) / (b - a);
  };
  form.to_do =
      "Any program reads the table. Between two rows interpolate linearly; friction changes its sign with the velocity.";
  return form;
}

}  // namespace

extern const SteadyTarget kCsv;
const SteadyTarget kCsv{.name = "csv",
                        .what = "friction over velocity as a table",
                        .comment = "#",
                        .write = write_csv,
                        .begin = "axis,velocity [mm/s],friction [N]\n"};

}  // namespace stribeck::targets
