#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/shown.hpp>
#include <stribeck/workflow/judge/missed_force.hpp>
#include <vector>

namespace stribeck::workflow {
namespace {

/// A column that explains a part of the residual: coefficient, and share of the squares.
struct Alone {
  double by = 0.0;
  double share = 0.0;
};

template <class Column>
Alone alone(const std::vector<double>& residual, Column&& column) {
  double cc = 0.0, cd = 0.0, dd = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const double c = column(k), d = residual[k];
    cc += c * c, cd += c * d, dd += d * d;
  }
  if (!(cc > 0.0) || !(dd > 0.0)) return {};
  return {cd / cc, cd * cd / (cc * dd)};
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace

std::string missed_in_words(const std::string& file, const friction::AxisModel& model,
                            const ident::replay::ForceError& e, const ident::log::Record& record) {
  constexpr double kMuch = 0.05;    // of the force
  constexpr double kShare = 0.5;    // of what is missed
  constexpr double kNearly = 0.05;  // of it: a spring is as likely
  if (!(e.own_relative > kMuch) || e.row.size() < 3) return {};
  const std::size_t n = e.row.size();
  std::vector<double> missed(n), place(n);
  double top = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    missed[k] = e.measured[k] - e.modelled[k];
    place[k] = record.x[e.row[k]];
    top = std::max(top, std::abs(e.velocity[k]));
  }
  constexpr double kMoves = 0.01;  // of the top speed
  const Alone load = alone(missed, [](std::size_t) { return 1.0; });
  const Alone mass = alone(missed, [&](std::size_t k) { return e.acceleration[k]; });
  const Alone viscous = alone(missed, [&](std::size_t k) { return e.velocity[k]; });
  const Alone coulomb = alone(missed, [&](std::size_t k) {
    return std::abs(e.velocity[k]) > kMoves * top ? std::copysign(1.0, e.velocity[k]) : 0.0;
  });
  // A spring's zero is anywhere.
  const double middle = mean_of(place), level = mean_of(missed);
  std::vector<double> varying = missed;
  for (double& d : varying) d -= level;
  Alone spring = alone(varying, [&](std::size_t k) { return place[k] - middle; });
  spring.share *= 1.0 - load.share;  // of all that is missed; its zero explains the share of the load
  const ident::Shown shown(record);
  const double best = std::max({load.share, mass.share, viscous.share, coulomb.share});
  if (spring.share > kShare && spring.share > best - kNearly) {
    return fmt::format(
        "{}: {:.0f} % of what the model misses grows with position, by {}: a spring, a cable chain or a balance{} (identify this log); or a "
        "wrong mass, where the motion is a sine",
        file, 100.0 * (load.share + spring.share), shown.force_per_length(spring.by),
        model.friction.spring ? ", which is another one than that of the file" : "");
  }
  if (!(best > kShare)) return {};
  const auto sentence = [&](const Alone& part, const std::string& what) {
    return fmt::format("{}: {:.0f} % of what the model misses is {}", file, 100.0 * part.share, what);
  };
  const auto more = [](double by) { return by > 0.0 ? "more" : "less"; };
  if (best == load.share)
    return sentence(
        load,
        fmt::format(
            "a constant force of {}: another weight or counterbalance than that of the file (identify this log), or an offset of the sensor",
            shown.force(load.by)));
  if (best == mass.share)
    return sentence(
        mass,
        fmt::format("a mass that is {:.3g} % {} than that of the file (identify this log), or a wrong --gain",
                    100.0 * std::abs(mass.by) / model.mass, mass.by > 0.0 ? "larger" : "smaller"));
  if (best == coulomb.share)
    return sentence(
        coulomb,
        fmt::format(
            "friction that does not depend on the speed, {} {} in both directions: another lubrication or preload than when the file was identified",
            shown.force(std::abs(coulomb.by)), more(coulomb.by)));
  return sentence(
      viscous,
      fmt::format(
          "friction that grows with the speed, {} {} at {}: another temperature or lubricant than when the file was identified",
          shown.force(std::abs(viscous.by) * top), more(viscous.by), shown.speed(top)));
}

}  // namespace stribeck::workflow
