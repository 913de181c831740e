#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/core/scalar.hpp>
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

/// A force that repeats with the position.
struct Repeats {
  double period = 0.0;     ///< [m]
  double amplitude = 0.0;  ///< [N]
  double share = 0.0;      ///< of the squares
};

/// Squares that a wave of this many periods for each metre explains over some rows.
struct Wave {
  double ss = 0.0, sc = 0.0, cc = 0.0, sd = 0.0, cd = 0.0, dd = 0.0;
  void add(double angle, double missed) {
    const double s = std::sin(angle), c = std::cos(angle);
    ss += s * s, sc += s * c, cc += c * c, sd += s * missed, cd += c * missed, dd += missed * missed;
  }
  /// Amplitudes of sine and cosine; 0 where the rows do not tell both.
  [[nodiscard]] std::array<double, 2> amplitudes() const {
    const double det = ss * cc - sc * sc;
    if (!(det > 0.1 * ss * cc)) return {};
    return {(cc * sd - sc * cd) / det, (ss * cd - sc * sd) / det};
  }
  /// Share of the squares that these amplitudes explain; below 0 where they make it worse.
  [[nodiscard]] double share(const std::array<double, 2>& a) const {
    const double left =
        a[0] * a[0] * ss + 2.0 * a[0] * a[1] * sc + a[1] * a[1] * cc - 2.0 * (a[0] * sd + a[1] * cd);
    return dd > 0.0 ? -left / dd : 0.0;
  }
};

/// The best period from half the travel to a three-hundredth of it, in moving rows. Both halves of the rows must have it.
Repeats repeats_with(const std::vector<double>& place, const std::vector<double>& missed,
                     const std::vector<double>& velocity, double slow) {
  constexpr double kLongest = 0.5, kMost = 300.0, kFiner = 4.0, kAgreed = 0.5;
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < place.size(); ++k) {
    if (std::abs(velocity[k]) > slow) rows.push_back(k);
  }
  const auto [low, high] = std::minmax_element(place.begin(), place.end());
  const double travel = *high - *low;
  Repeats best;
  if (!(travel > 0.0) || rows.size() < 100) return best;
  for (double per_travel = 1.0 / kLongest; per_travel <= kMost; per_travel += 1.0 / kFiner) {
    const double per_metre = 2.0 * kPi * per_travel / travel;
    std::array<Wave, 2> half;
    for (std::size_t j = 0; j < rows.size(); ++j)
      half[2 * j < rows.size() ? 0 : 1].add(per_metre * (place[rows[j]] - *low), missed[rows[j]]);
    Wave all = half[0];
    all.ss += half[1].ss, all.sc += half[1].sc, all.cc += half[1].cc;
    all.sd += half[1].sd, all.cd += half[1].cd, all.dd += half[1].dd;
    const std::array<double, 2> a = all.amplitudes();
    const double share = all.share(a);
    // What the first half tells holds in the second one.
    if (share > best.share && half[1].share(half[0].amplitudes()) > kAgreed * share)
      best = {travel / per_travel, std::hypot(a[0], a[1]), share};
  }
  return best;
}

constexpr double kShare = 0.5;  ///< of what is missed, that one quantity explains

/// Levels of both directions, fitted together: a log may be longer in one of them.
struct OfDirections {
  double forward = 0.0, backward = 0.0;  ///< against the motion [N]
  double share = 0.0;                    ///< of the squares
};
OfDirections directions(const std::vector<double>& missed, const std::vector<double>& velocity, double slow) {
  std::array<double, 2> sum{}, rows{};
  double all = 0.0;
  for (std::size_t k = 0; k < missed.size(); ++k) {
    all += missed[k] * missed[k];
    if (std::abs(velocity[k]) <= slow) continue;
    const std::size_t side = velocity[k] > 0.0 ? 0 : 1;
    sum[side] += missed[k], rows[side] += 1.0;
  }
  constexpr double kFewest = 0.1;  // of the rows, in either direction
  const double n = static_cast<double>(missed.size());
  if (!(all > 0.0) || !(std::min(rows[0], rows[1]) > kFewest * n)) return {};
  return {sum[0] / rows[0], -sum[1] / rows[1], (sum[0] * sum[0] / rows[0] + sum[1] * sum[1] / rows[1]) / all};
}

/// Friction of one direction alone, where both levels explain clearly more than any quantity alone.
std::string one_direction(const OfDirections& of, double others, const ident::Shown& shown) {
  constexpr double kOther = 0.35;    // of one direction, that the other one misses at most
  constexpr double kClearly = 0.85;  // of the share, that any other quantity explains at most
  const double most = std::max(std::abs(of.forward), std::abs(of.backward));
  if (!(of.share > kShare) || !(others < kClearly * of.share) ||
      !(std::min(std::abs(of.forward), std::abs(of.backward)) < kOther * most))
    return {};
  const bool ahead = std::abs(of.forward) > std::abs(of.backward);
  return fmt::format(
      "friction of one direction, {} {} {}: a gib, a cover or a weight that changed (identify this log)",
      shown.force(most), (ahead ? of.forward : of.backward) > 0.0 ? "more" : "less",
      ahead ? "forward" : "backward");
}

/// A wrong scale of the force is in every part of it: no part alone explains as much. Share 0: it is not that.
Alone wrong_scale(const std::vector<double>& missed, const std::vector<double>& modelled, double others) {
  constexpr double kNearlyAll = 0.9, kClearlyLess = 0.95;
  const Alone scale = alone(missed, [&](std::size_t k) { return modelled[k]; });
  return scale.share > kNearlyAll && others < kClearlyLess * scale.share ? scale : Alone{};
}

std::string scale_in_words(double by) {
  return fmt::format(
      "the same share of all its forces, {:.3g} % {} than in the file: a wrong --gain, or another scale of the force in the machine file",
      100.0 * std::abs(by), by > 0.0 ? "more" : "less");
}

}  // namespace

std::string missed_in_words(const std::string& file, const friction::AxisModel& model,
                            const ident::replay::ForceError& e, const ident::log::Record& record) {
  constexpr double kMuch = 0.05;    // of the force
  constexpr double kNearly = 0.05;  // of it: a spring is as likely
  if (e.row.size() < 3) return {};
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
  // What is little beside the whole force may be much of the mass.
  const bool wrong_mass = best == mass.share && best > kShare && std::abs(mass.by) > kMuch * model.mass;
  if (!(e.own_relative > kMuch) && !wrong_mass) return {};
  if (spring.share > kShare && spring.share > best - kNearly) {
    return fmt::format(
        "{}: {:.0f} % of what the model misses grows with position, by {}: a spring, a cable chain or a balance{} (identify this log); or a "
        "wrong mass, where the motion is a sine",
        file, 100.0 * (load.share + spring.share), shown.force_per_length(spring.by),
        model.friction.spring ? ", which is another one than that of the file" : "");
  }
  const auto sentence = [&](const Alone& part, const std::string& what) {
    return fmt::format("{}: {:.0f} % of what the model misses is {}", file, 100.0 * part.share, what);
  };
  const auto more = [](double by) { return by > 0.0 ? "more" : "less"; };
  const OfDirections of = directions(missed, e.velocity, kMoves * top);
  if (const std::string what = one_direction(of, best, shown); !what.empty())
    return sentence({0.0, of.share}, what);
  if (const Alone scale = wrong_scale(missed, e.modelled, best); scale.share > 0.0)
    return sentence(scale, scale_in_words(scale.by));
  if (!(best > kShare)) {
    Repeats r = repeats_with(place, varying, e.velocity, kMoves * top);
    r.share *= 1.0 - load.share;
    if (!(r.share > kShare)) return {};
    return fmt::format(
        "{}: {:.0f} % of what the model misses repeats with the position, {} every {}: a screw, a gear or cogging that the file does not "
        "hold, or holds with another phase (identify this log)",
        file, 100.0 * r.share, shown.force(r.amplitude), shown.length(r.period));
  }
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
