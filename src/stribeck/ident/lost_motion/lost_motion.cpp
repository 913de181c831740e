#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/lost_motion/lost_motion_parts.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::lost_motion {
namespace {

/// With 8 of a circle the fit found another minimum than the truth, 14 % away and sure of it.
constexpr int kFewestReversals = 12;
/// A quantity whose 95 % interval is wider than this share of it, either way, is not determined.
constexpr double kTooWide = 0.5;
/// Steps of an encoder that a difference may be wrong by, however many rows agree.
constexpr double kOfStep = 0.05;
/// What other friction on the motor's side than the fit's may change, beyond the scatter: share of the wind-up, and of the stiffness.
constexpr double kOfWindUp = 0.03;
/// Steps of the encoders are an error of the wind-up that does not average out while the table stands. They may change the stiffness by
/// this share of step over wind-up; with fewer steps than these in both, nothing is told apart.
constexpr double kOfSteps = 0.6;
constexpr double kFewestSteps = 4.0;

int groups_of(std::size_t reversals) { return std::clamp(static_cast<int>(reversals) / 2, 2, 8); }

Fit refined(const std::vector<Stretch>& stretches, const Sliding& sliding, bool slope, const Fit& from) {
  Fit f = from;
  for (int i = 0; i < 2 && f.good; ++i) f = fit(stretches, sliding, slope, &f);
  return f;
}

/// The best of the fits from several starts, each with the weights of its own.
Fit best_fit(const std::vector<Stretch>& stretches, const Sliding& sliding, bool slope) {
  Fit best;
  for (const Fit& start : starts_for(sliding)) {
    const Fit f = refined(stretches, sliding, slope, fit(stretches, sliding, slope, start));
    if (f.good && f.stiffness > 0.0 && (!best.good || f.noise < best.noise)) best = f;
  }
  return best;
}

/// A fit, and those without each group of reversals.
struct Fits {
  Fit all;
  std::vector<Fit> without;

  [[nodiscard]] Estimate of(double Fit::*member, double floor) const {
    std::vector<double> values;
    for (const Fit& f : without) values.push_back(f.*member);
    return {all.*member, std::hypot(jackknife_half_width(values), floor)};
  }
};

std::optional<Fits> fits_of(const std::vector<Stretch>& stretches, const Sliding& sliding, bool slope,
                            const Fit& from) {
  Fits fits;
  fits.all = from;
  if (!fits.all.good) return {};
  const int groups = groups_of(stretches.size());
  for (int g = 0; g < groups; ++g) {
    const Fit one = fit(stretches, sliding, slope, &fits.all, {groups, g});
    if (!one.good) return {};
    fits.without.push_back(one);
  }
  return fits;
}

/// Mean force before the reversals of either side.
std::array<double, 2> forces_before(const std::vector<Stretch>& stretches) {
  std::array<double, 2> sum{};
  std::array<double, 2> n{};
  for (const Stretch& s : stretches) {
    const std::size_t side = s.direction < 0 ? 0 : 1;
    sum[side] += s.force.head(std::max<Eigen::Index>(4, s.force.size() / 10)).mean();
    n[side] += 1.0;
  }
  return {sum[0] / n[0], sum[1] / n[1]};
}

/// The load where it is larger than the friction of the whole axis, and so holds the table on one side of the play [N]; else 0.
double holding_load(const std::vector<Stretch>& stretches) {
  constexpr double kLarger = 1.1;
  const auto [up, down] = forces_before(stretches);
  const double load = 0.5 * (up + down);
  return std::abs(load) > kLarger * 0.5 * std::abs(up - down) ? load : 0.0;
}

/// Whether the drive pulls until the axis reverses. Where it coasts, as after a pulse of force, friction brakes motor and table each
/// for itself, and the spring between them carries little.
bool pulled(const std::vector<Stretch>& stretches, const Sliding& sliding) {
  constexpr double kPulled = 0.5;
  const auto [up, down] = forces_before(stretches);
  return 0.5 * (up - down) > kPulled * sliding.friction;
}

/// The lost motion while the table slides slowly, just before it reverses: between both directions.
std::optional<Estimate> total_of(const std::vector<Stretch>& stretches, const Sliding& sliding, double step) {
  std::array<double, 2> sum{};
  std::array<double, 2> squares{};
  std::array<double, 2> n{};
  for (const Stretch& s : stretches) {
    // The motor comes to the turning point from `before` away; the first tenth of the rows is before it.
    const auto rows = std::max<Eigen::Index>(4, s.difference.size() / 10);
    const double mean =
        (s.difference.head(rows) - sliding.scale_error * s.position.head(rows)).mean() - sliding.offset;
    const std::size_t side = s.direction < 0 ? 0 : 1;
    sum[side] += mean;
    squares[side] += mean * mean;
    n[side] += 1.0;
  }
  if (!(std::min(n[0], n[1]) >= 2.0)) return {};
  double variance = 0.0;
  for (const std::size_t side : {0U, 1U})
    variance += std::max(0.0, squares[side] - sum[side] * sum[side] / n[side]) / (n[side] * (n[side] - 1.0));
  const double width = stats::student_factor(std::min(n[0], n[1]) - 1.0) * std::sqrt(variance);
  return Estimate{sum[0] / n[0] - sum[1] / n[1], std::hypot(width, kOfStep * step)};
}

void keep_determined(LostMotion& out, const Fits& fits, double step) {
  const double wind_up = std::max(0.0, out.total->value - fits.all.backlash);
  if (wind_up < 2.0 * kFewestSteps * step && fits.all.backlash < kFewestSteps * step) {
    out.words.emplace_back(
        "the encoders are too coarse to tell backlash and wind-up apart: only their sum is known (both are a few steps of the "
        "encoders)");
    return;
  }
  const double coarse = kOfSteps * step / std::max(0.5 * wind_up, step);
  const Estimate stiffness = fits.of(&Fit::stiffness, std::hypot(kOfWindUp, coarse) * fits.all.stiffness);
  const Estimate backlash = fits.of(&Fit::backlash, std::hypot(kOfStep * step, kOfWindUp * wind_up));
  if (stiffness.value > 0.0 && stiffness.half_width < kTooWide * stiffness.value) {
    out.stiffness = stiffness;
  } else {
    out.words.emplace_back(
        "the wind-up is not determined: the force that passes to the table changes too little, or the encoders are too "
        "coarse for it (record slower reversals, or more of them)");
  }
  if (backlash.low() > 0.0) {
    out.backlash = backlash;
  } else if (backlash.half_width < out.total->value) {
    out.words.push_back(fmt::format("no backlash was found; it is at most {} um",
                                    digits(1e6 * std::max(0.0, backlash.high()), 2)));
  } else {
    out.words.emplace_back(
        "the backlash is not determined: wind-up explains the difference of the encoders as well (record slower reversals, or "
        "more of them)");
  }
  out.delay = fits.all.delay;
  out.offset += fits.all.offset;
  if (!out.stiffness) return;
  out.table_friction =
      out.stiffness->value * 0.5 * std::max(0.0, out.total->value - std::max(0.0, backlash.value));
  out.motor_mass = std::max(0.0, fits.all.motor_mass);
  out.build_up = fits.all.distance;
}

/// Both, where the force tells them apart.
void separate(LostMotion& out, const std::vector<Stretch>& stretches, const Sliding& sliding, double step) {
  const std::optional<Fits> even = fits_of(stretches, sliding, false, best_fit(stretches, sliding, false));
  if (!even) {
    out.words.emplace_back(
        "the reversals do not fit a play with a spring: force and positions do not belong together");
    return;
  }
  const std::optional<Fits> sloped = fits_of(stretches, sliding, true, best_fit(stretches, sliding, true));
  constexpr double kClearly = 3.0;  // half widths
  constexpr double kBetter = 0.95;
  if (sloped) {
    const Estimate slope = sloped->of(&Fit::backlash_slope, 0.0);
    if (std::abs(slope.value) > kClearly * slope.half_width &&
        sloped->all.noise < kBetter * even->all.noise) {
      out.backlash_slope = slope;
      keep_determined(out, *sloped, step);
      return;
    }
  }
  keep_determined(out, *even, step);
}

/// Whether the reversals leave it open how much is lost. Then strokes of constant speed may tell the sum of backlash and wind-up: `coasts`,
/// no usable reversals, or an axis that brakes so hard that the table pushes the motor through the play before it reverses.
bool is_open(const std::optional<Estimate>& total, bool coasts) {
  return !total || coasts || !(total->low() > 0.0);
}

bool take_sliding(LostMotion& out, std::optional<WhileSliding> sliding, bool coasts, double step) {
  constexpr double kBetter = 0.5;
  if (!sliding) return false;
  Estimate& total = sliding->total;
  total.half_width = std::hypot(total.half_width, kOfStep * step);
  const bool better = !out.total || coasts || total.half_width < kBetter * out.total->half_width;
  if (!better || !(total.low() > 0.0)) return false;
  out.total = total;
  out.scale_error = sliding->scale_error;
  out.words.emplace_back(
      "backlash and wind-up cannot be distinguished: the reversals of this log do not show the lost motion, so their sum is measured on "
      "strokes of constant speed (to distinguish them, record slow reversals in closed loop: excite --method sine)");
  return true;
}

bool has_force(const std::vector<Positions>& runs) {
  return std::all_of(runs.begin(), runs.end(), [](const Positions& p) { return !p.force.empty(); });
}

}  // namespace

double jackknife_half_width(const std::vector<double>& without) {
  const auto g = static_cast<double>(without.size());
  double mean = 0.0;
  for (const double v : without) mean += v / g;
  double sum = 0.0;
  for (const double v : without) sum += (v - mean) * (v - mean);
  return stats::student_factor(g - 1.0) * std::sqrt((g - 1.0) / g * sum);
}

LostMotion identify(const std::vector<Positions>& runs) {
  LostMotion out;
  Sliding sliding = find_sliding(runs);
  if (!sliding.known) {
    out.words.emplace_back(
        "lost motion is not determined: the log needs strokes in both directions, of some hundred micrometres at least");
    return out;
  }
  out.offset = sliding.offset;
  out.scale_error = sliding.scale_error;
  const double step = 1e-6 * std::sqrt(12.0 * sliding.rounding_difference);
  const bool force = has_force(runs);
  if (force) find_shape(runs, sliding);
  const std::vector<Stretch> stretches = find_stretches(runs, sliding);
  out.reversals = static_cast<int>(stretches.size());
  out.total = total_of(stretches, sliding, step);
  const bool coasts = out.total && force && sliding.friction > 0.0 && !pulled(stretches, sliding);
  if (is_open(out.total, coasts) && take_sliding(out, total_while_sliding(runs, sliding), coasts, step))
    return out;
  if (!out.total) {
    out.words.push_back(fmt::format(
        "lost motion is not determined: {} usable reversals, expected two or more at either end, slow ones with strokes of some "
        "hundred micrometres on both sides (excite --method sine)",
        out.reversals));
    return out;
  }
  if (coasts) {
    out.total.reset();
    out.words.emplace_back(
        "lost motion is not determined: the axis coasts to its reversals, so that the wind-up is not loaded there (record slow "
        "reversals in closed loop: excite --method sine)");
    return out;
  }
  if (!(out.total->low() > 0.0)) {
    out.none = true;
    out.words.push_back(fmt::format("no lost motion was found; it is at most {} um",
                                    digits(1e6 * std::max(0.0, out.total->high()), 2)));
    return out;
  }
  if (!force) {
    out.words.emplace_back(
        "without a force, backlash and wind-up cannot be distinguished: only their sum is known (record the force, torque or current "
        "too)");
  } else if (out.reversals < kFewestReversals || !(sliding.friction > 0.0)) {
    out.words.push_back(fmt::format(
        "backlash and wind-up cannot be distinguished: {} usable reversals, expected at least {}, slow ones with strokes of some "
        "hundred micrometres on both sides (excite --method sine)",
        out.reversals, kFewestReversals));
  } else if (const double load = holding_load(stretches); load != 0.0) {
    out.words.push_back(fmt::format(
        "backlash and wind-up cannot be distinguished: a load of {} N holds the table on one side of the play, which it never crosses in "
        "these logs; what is lost between the directions is known as long as it does (to see the play, take the load off: balance, or "
        "the axis unloaded)",
        digits(std::abs(load), 2)));
  } else {
    separate(out, stretches, sliding, step);
  }
  return out;
}

}  // namespace stribeck::ident::lost_motion
