#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/residual/residual_parts.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::residual {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSure = 2.0;          // half widths of 95 %
constexpr double kWorthForce = 0.05;   // of friction
constexpr double kLeastForce = 0.003;  // of friction, where it counts for the mass
constexpr double kWorthLevel = 0.08;   // of friction, change along the travel
constexpr double kTold = 0.05;         // share of a column that the other columns do not explain
// Sine and cosine of a part of a turn are mostly a constant and a straight line, which friction and mass have too; the half width
// says what is left. A sine of position leaves 1e-5, with strokes of constant acceleration 2e-2.
constexpr double kToldOfAngle = 0.005;
constexpr double kLeastTurn = 0.7;   // rad of travel, to tell sine and cosine from a straight line
constexpr double kStraighter = 0.8;  // of the square that is left, for a straight line in place of a sine
constexpr std::size_t kPlaces = 60;  // along the travel
constexpr double kTight = 0.15;      // of friction
constexpr double kWidestSpot = 0.2;  // of the travel
constexpr std::size_t kFewestRows = 200;

/// How much mass a force along the travel looks like on this motion: kg for 1 N/m [s²].
double mass_of_spring(const Rows& rows) {
  double ax = 0.0, aa = 0.0;
  for (const Row& r : rows.rows) ax += r.a * (r.x - rows.middle()), aa += r.a * r.a;
  return aa > 0.0 ? ax / aa : 0.0;
}

/// The fit of the residual, or that of the whole force where it leaves less: what is not in the map may have bent it. Without such a
/// bend both leave the same but for rounding.
std::pair<Fit, double Row::*> fit_better(const Rows& rows, const Columns& columns) {
  constexpr double kLess = 1.0 - 1e-6;
  Fit f = fit(rows, columns);
  Fit whole = fit(rows, columns, &Row::f);
  if (whole.square < kLess * f.square) return {std::move(whole), &Row::f};
  return {std::move(f), &Row::e};
}

/// Whether the axis turns so far that sine and cosine of its angle are no straight line.
bool may_be_unbalanced(const Rows& rows) {
  return rows.turns() && !rows.unbalanced && rows.high - rows.low >= kLeastTurn;
}

/// The columns of the model, then sine and cosine of the angle.
Columns unbalance_columns(const Rows& rows) {
  Columns columns = model_columns(rows);
  columns.emplace_back([](const Row& r) { return std::sin(r.x); });
  columns.emplace_back([](const Row& r) { return std::cos(r.x); });
  return columns;
}

/// Half width of column `at`, at least how far its coefficient moves where only the slower or the faster half of the rows counts, or one
/// half of the travel, or what is farther behind a reversal: a wrong shape of friction, pre-sliding after reversals and a force that is no
/// straight line look the same in every stroke and show in no residual.
double half_width_by_halves(const Rows& rows, const Columns& columns, std::size_t at, const Fit& whole,
                            double Row::*target) {
  std::vector<double> speeds;
  for (const Row& r : rows.rows) speeds.push_back(std::abs(r.v));
  const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  constexpr double kFarther = 0.2;  // of the travel
  const double farther = kFarther * (rows.high - rows.low);
  const std::array<std::function<bool(const Row&)>, 5> halves{
      [&](const Row& r) { return std::abs(r.v) >= *middle; },
      [&](const Row& r) { return std::abs(r.v) < *middle; },
      [&](const Row& r) { return rows.along(r) >= 0.0; }, [&](const Row& r) { return rows.along(r) < 0.0; },
      [&](const Row& r) { return r.travelled >= farther; }};
  double half = whole.half[at];
  for (const auto& belongs : halves) {
    Rows some = rows;
    std::erase_if(some.rows, [&](const Row& r) { return !belongs(r); });
    if (some.rows.size() < kFewestRows) continue;
    const Fit f = fit(some, columns, target);
    if (f.told[at] < kTold) continue;
    const auto j = static_cast<Index>(at);
    half = std::max(half, std::abs(f.theta(j) - whole.theta(j)) - f.half[at]);
  }
  return half;
}

void find_spring(const Rows& rows, Diagnosis& out) {
  Columns columns = model_columns(rows);
  const std::size_t at = columns.size();
  columns.emplace_back([&](const Row& r) { return rows.along(r); });
  // A strong one bends the map that was fitted without it; then the whole force on the same columns leaves less.
  auto [f, target] = fit_better(rows, columns);
  const double scale = 2.0 / (rows.high - rows.low);
  if (f.told[at] < kTold) {
    const double seconds = mass_of_spring(rows);
    if (seconds == 0.0) return;
    const bool newtons = rows.force_unit == "N" && rows.position_unit == "m";
    const Shown shown(rows);
    const std::string much =
        newtons ? fmt::format("{:.3g} {} for each {}/{}", seconds * shown.scale(),
                              rows.rotary ? "kg m2" : "kg", shown.force_unit(), shown.length_unit())
                : fmt::format("{:.3g} s² times its stiffness", seconds);
    out.cannot_tell.push_back(fmt::format(
        "a force that grows with position (spring, cable chain): this motion cannot separate it from mass, {}; add strokes at constant speed, or a sine of another frequency",
        much));
    return;
  }
  const double force = f.theta(static_cast<Index>(at));
  if (std::abs(force) < std::max(kSure * f.half[at], kLeastForce * rows.friction)) return;
  const double half = scale * half_width_by_halves(rows, columns, at, f, target);
  // A force that is small beside friction may be large beside that of the acceleration: then it counts for the mass.
  if (std::abs(force) < kWorthForce * rows.friction) {
    const double moved = std::abs(fit(rows, model_columns(rows), target).theta(0) - f.theta(0));
    if (std::abs(force) * scale < kSure * half || moved < f.half.front()) return;
  }
  out.spring = Spring{
      force * scale, half, rows.middle(), rows.low, rows.high, half * std::abs(mass_of_spring(rows)), false};
  if (!may_be_unbalanced(rows)) return;
  // Part of a sine beside a straight line is another mass.
  const Fit weight = fit(rows, unbalance_columns(rows), target);
  out.spring->may_be_weight = true;
  out.spring->mass_half_width += std::abs(weight.theta(0) - f.theta(0)) + weight.half.front();
}

void find_unbalance(const Rows& rows, Diagnosis& out) {
  if (!may_be_unbalanced(rows)) return;
  const Columns columns = unbalance_columns(rows);
  const std::size_t at = columns.size() - 2;
  // A large one bends the map that was fitted without it, and no free friction takes its Gaussians back; then the whole force
  // on the same columns leaves less.
  const Fit f = fit_better(rows, columns).first;
  // A spring over part of a turn follows a sine, too, and leaves less beside a straight line.
  Columns line = model_columns(rows);
  line.emplace_back([&](const Row& r) { return rows.along(r); });
  if (std::min(fit(rows, line).square, fit(rows, line, &Row::f).square) < kStraighter * f.square) return;
  const double sine = f.theta(static_cast<Index>(at)), cosine = f.theta(static_cast<Index>(at) + 1);
  const double size = std::hypot(sine, cosine);
  const double half = std::max(f.half[at], f.half[at + 1]);
  if (size < kSure * half || size < kWorthForce * rows.friction) return;
  if (std::min(f.told[at], f.told[at + 1]) < kToldOfAngle) return;
  out.unbalance = Unbalance{sine, cosine, half, f.half.front()};
}

/// A drive that gives way between motor and load: on the motor's side the force for an acceleration grows with its frequency,
/// F = m·a − (m2/ωa²)·d²a/dt² below the anti-resonance ωa, and a mass without the second term is too large.
void find_elastic(const Rows& rows, Diagnosis& out) {
  constexpr double kWorthMass = 0.02;
  constexpr double kToldOfSnap = 0.1;
  if (!(rows.mass > 0.0) || out.unbalance) return;
  Rows some = rows;
  std::erase_if(some.rows, [](const Row& r) { return !std::isfinite(r.snap); });
  if (some.rows.size() < kFewestRows) return;
  Columns columns = model_columns(some);
  const double without = fit(some, columns).theta(0);
  const std::size_t at = columns.size();
  columns.emplace_back([](const Row& r) { return r.snap; });
  const Fit f = fit(some, columns);
  const double coefficient = f.theta(static_cast<Index>(at));
  const double too_large = -f.theta(0);
  if (f.told[at] < kToldOfSnap || !(coefficient < 0.0)) return;
  const double taken = std::min(too_large, without - f.theta(0));
  if (taken < std::max(kWorthMass * rows.mass, kSure * f.half.front())) return;
  if (-coefficient < kSure * half_width_by_halves(some, columns, at, f, &Row::e)) return;
  // On one frequency both look alike.
  if (out.spring) {
    columns.back() = [&](const Row& r) { return rows.along(r); };
    if (fit(some, columns).square < f.square) return;
    out.spring.reset();
  }
  out.elastic_mass = too_large;
  const char* unit = rows.rotary ? "kg m2" : "kg";
  out.warnings.push_back(fmt::format(
      "the force for an acceleration grows with its frequency, as of a drive that gives way between motor and load (belt, coupling, long "
      "screw): at low frequency the mass would be {} {} and not {} {}, and its interval holds both; accelerate less sharply (stribeck "
      "excite --method constant-acceleration), and look at the resonance (stribeck frequency)",
      digits(rows.mass - too_large), unit, digits(rows.mass), unit));
}

/// Friction that differs along the travel, and no period; takes it off.
void find_level(Rows& rows, Diagnosis& out) {
  Columns columns = model_columns(rows);
  const std::size_t at = columns.size();
  columns.emplace_back([&](const Row& r) { return rows.along(r) * r.sign; });
  columns.emplace_back([&](const Row& r) { return (rows.along(r) * rows.along(r) - 1.0 / 3.0) * r.sign; });
  const Fit f = fit(rows, columns);
  const double slope = f.theta(static_cast<Index>(at)), bend = f.theta(static_cast<Index>(at) + 1);
  const auto level = [&](double s) { return slope * s + bend * (s * s - 1.0 / 3.0); };
  double least = 0.0, most = 0.0, at_least = -1.0, at_most = -1.0;
  for (int i = 0; i <= 20; ++i) {
    const double s = -1.0 + 0.1 * i;
    if (i == 0 || level(s) < least) least = level(s), at_least = s;
    if (i == 0 || level(s) > most) most = level(s), at_most = s;
  }
  const bool sure = std::abs(slope) > kSure * f.half[at] || std::abs(bend) > kSure * f.half[at + 1];
  if (sure && most - least > kWorthLevel * rows.friction && std::min(f.told[at], f.told[at + 1]) > kTold) {
    const auto place = [&](double s) {
      return rows.shown().length(rows.middle() + 0.5 * s * (rows.high - rows.low));
    };
    out.warnings.push_back(fmt::format(
        "friction differs along the travel: {} ({} % of it) more at {} than at {}, without a period (preload, lubrication or alignment); the result is the mean over the travel: identify shorter strokes at each end where the difference counts",
        rows.shown().force(most - least), digits(100.0 * (most - least) / rows.friction, 2), place(at_most),
        place(at_least)));
  }
  for (Index i = 0; i < f.left.size(); ++i) rows.rows[static_cast<std::size_t>(i)].e = f.left(i);
}

/// A short piece of the travel on which friction is higher in whatever direction and stroke.
void find_tight_spot(const Rows& rows, Diagnosis& out) {
  std::array<std::array<double, kPlaces>, 2> sum{}, count{};
  for (const Row& r : rows.rows) {
    const auto i = static_cast<std::size_t>(
        std::clamp(0.5 * (rows.along(r) + 1.0) * kPlaces, 0.0, static_cast<double>(kPlaces) - 1.0));
    const std::size_t side = r.sign > 0.0 ? 0 : 1;
    sum[side][i] += r.sign * r.e;
    count[side][i] += 1.0;
  }
  std::vector<double> seen;
  std::array<double, kPlaces> mean{}, lesser{};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double n = count[0][i] + count[1][i];
    if (n < 4.0) continue;
    mean[i] = (sum[0][i] + sum[1][i]) / n;
    lesser[i] = mean[i];
    for (std::size_t s = 0; s < 2; ++s) {
      if (count[s][i] > 2.0) lesser[i] = std::min(lesser[i], sum[s][i] / count[s][i]);
    }
    seen.push_back(mean[i]);
  }
  if (seen.size() < kPlaces / 2) return;
  const double middle = stats::median(seen);
  for (double& s : seen) s = std::abs(s - middle);
  const double spread = 1.4826 * stats::median(seen);
  const double least = std::max(6.0 * spread, kTight * rows.friction);
  std::size_t first = kPlaces, last = 0;
  double most = 0.0;
  std::array<bool, 2> passed{true, true};  // all of these places
  for (std::size_t i = 0; i < kPlaces; ++i) {
    // Both directions feel it, or the only one that came here.
    if (mean[i] - middle < least || lesser[i] - middle < 0.5 * least) continue;
    first = std::min(first, i), last = i;
    for (std::size_t s = 0; s < 2; ++s) passed[s] = passed[s] && count[s][i] > 2.0;
    most = std::max(most, mean[i] - middle);
  }
  if (first == kPlaces || static_cast<double>(last + 1 - first) > kWidestSpot * kPlaces) return;
  // A stroke of a cold axis, which alone came here, looks the same.
  if (rows.drifts && !(passed[0] && passed[1])) return;
  const auto place = [&](std::size_t i) {
    return rows.shown().length(rows.low + (rows.high - rows.low) * static_cast<double>(i) / kPlaces);
  };
  out.warnings.push_back(fmt::format(
      "friction is {} ({} % of it) higher between {} and {}, {}: a tight spot (dirt, damage, a cover that drags); the result contains it, perhaps as a shift of the force: identify on a travel without it",
      rows.shown().force(most), digits(100.0 * most / rows.friction, 2), place(first), place(last + 1),
      passed[0] && passed[1] ? "in both directions"
      : passed[0]            ? "in positive direction (there was no motion there in the other one)"
      : passed[1]            ? "in negative direction (there was no motion there in the other one)"
                             : "in the direction that moved there"));
}

}  // namespace

void find_causes(const std::vector<Left>& left, const Rows& given, Diagnosis& out) {
  if (given.rows.size() < kFewestRows) return;
  Rows rows = given;
  if (rows.mass > 0.0) {
    const auto [f, target] = fit_better(rows, model_columns(rows));
    out.elastic = find_table(left, rows, f.X, f.left, f.theta(0) + (target == &Row::e ? rows.mass : 0.0));
  }
  find_unbalance(rows, out);
  if (!out.unbalance) find_spring(rows, out);
  if (out.spring && rows.turns() && !rows.unbalanced) {
    out.cannot_tell.emplace_back(
        "whether the force that grows with the angle is a spring or the unbalance of the axis: add a position-sine and "
        "strokes of constant acceleration");
  }
  find_elastic(rows, out);
  find_level(rows, out);
  find_tight_spot(rows, out);
}

}  // namespace stribeck::ident::residual
