#include <ceres/jet.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/bristle/bristle_parts.hpp>
#include <utility>

namespace stribeck::ident::bristle {
namespace {

/// Pre-sliding is not determined beyond these limits.
constexpr double kWidestInterval = 0.35;  ///< of ln σ0
constexpr double kFades = 1.2;            ///< of ln v_d
constexpr double kMostLevel = 1.6;        ///< factor on the level of the steady map
constexpr double kLeastQuanta = 4.0;      ///< encoder steps within the break-away distance
constexpr double kLeastRows = 2.5;        ///< rows within three break-away distances

VectorXd unit_vector(Index n, Index at, double value = 1.0) {
  VectorXd g = VectorXd::Zero(n);
  g(at) = value;
  return g;
}

Interval log_interval(double value, double half) { return {value * std::exp(-half), value * std::exp(half)}; }

/// g/σ0 or g/Σk; `slope` holds the derivatives of the logarithm of the stiffness.
void set_break_away(const Given& given, double stiffness, const VectorXd& slope, Fitted& f) {
  const VectorXd& p = f.solution.p;
  const double rise = given.options.unseen_below > 0.0 ? given.level * std::exp(p(f.own + kRise)) : 0.0;
  const double to[2] = {1.0 + p(f.own + kForward), 1.0 + p(f.own + kBackward)};
  const double forward = 0.5 * (given.data.level[0] + rise) * to[0];
  const double backward = 0.5 * (given.data.level[1] + rise) * to[1];
  VectorXd g = -slope;
  g(f.own + kForward) += forward / to[0] / (forward + backward);
  g(f.own + kBackward) += backward / to[1] / (forward + backward);
  g(f.own + kRise) += 0.5 * rise * (to[0] + to[1]) / (forward + backward);
  f.half = f.spread.half_width(g);
  f.break_away = (forward + backward) / stiffness;
}

void add(std::vector<Parameter>& to, std::string name, double value, std::string si, std::string people,
         Interval i, bool identifiable) {
  to.push_back({std::move(name), value, std::move(si), std::move(people), i.low, i.high, identifiable});
}

/// σ and v_d of either law; returns true when the damping is above zero.
bool add_damping(const Given& given, const Rows& rows, const Fitted& f, Index at, const std::string& name,
                 double damping, double fading, std::vector<Parameter>& to) {
  const Index n = f.solution.p.size();
  const double half = f.spread.half_width(unit_vector(n, at, rows.setting.scales.damping));
  const double fade = f.spread.half_width(unit_vector(n, at + 1));
  const bool damped = has_damping(f, at) && damping > half;
  add(to, name, damping, given.units.force + " s/" + given.units.length,
      given.units.force + " s/" + given.units.shown_length(), {std::max(0.0, damping - half), damping + half},
      damped);
  add(to, "damping_velocity", fading, given.units.length + "/s", given.units.shown_length() + "/s",
      has_damping(f, at) ? log_interval(fading, fade) : Interval{}, damped && fade < kFades);
  return damped;
}

/// Why this log does not determine pre-sliding; empty: it does.
std::string objection(const Given& given, const Fitted& f, std::size_t best, std::size_t chosen,
                      const BristleFit& out) {
  const auto& [low, high] = out.break_away_interval;
  const auto& level = out.level_factor;
  // Between rows that lie far apart the motion itself looks like noise of the position.
  if (out.rows_per_reversal < kLeastRows)
    return fmt::format(
        "the axis passes the break-away distance in {:.0f} samples; sample faster or reverse more slowly",
        out.rows_per_reversal);
  if (out.too_coarse)
    return "the position, with steps or noise as of an encoder of " + given.shown.length(given.quantum) +
           ", is too coarse for a break-away distance of at most " +
           given.shown.length(std::max(high, kLeastQuanta * given.quantum));
  if (given.data.reversals < 2)
    return "it has only one reversal, so that a result cannot be checked on another one";
  if (!std::isfinite(out.models[best].held_out_rms)) return "too few rows follow its reversals";
  if (chosen == 0)
    return fmt::format("the static model predicts reversals that were left out as well ({:.3g} against ",
                       out.models[0].held_out_rms) +
           given.shown.force(out.models[best].held_out_rms) + ")";
  if (std::min(level[0], level[1]) < 1.0 / kMostLevel || std::max(level[0], level[1]) > kMostLevel)
    return fmt::format(
        "its reversals need {:.2f} and {:.2f} times the given level of friction; either {}the axis never slides, or the steady map was measured on another day",
        level[0], level[1],
        (level[0] - 1.0) * (level[1] - 1.0) < 0.0 ? "a load is in the friction of the two directions, " : "");
  if (!(f.half < kWidestInterval))
    return "its reversals allow any break-away distance from " + given.shown.length(low) + " to " +
           given.shown.length(high);
  return "";
}

}  // namespace

bool beyond_any_law(const Given& given, const Fitted& lugre, const BristleFit& out) {
  return lugre.break_away < kLeastQuanta * given.quantum || out.rows_per_reversal < kLeastRows ||
         given.data.reversals < 2;
}

void report_lugre(const Given& given, const Rows& rows, Fitted& lugre, BristleFit& out) {
  const Index n = lugre.solution.p.size();
  out.lugre = LuGreCase::make<double>(lugre.solution.p.data(), lugre.own, rows.setting.scales).law;
  const double half = lugre.spread.half_width(unit_vector(n, 0));
  add(out.lugre_parameters, "sigma0", out.lugre->sigma0, given.units.force + "/" + given.units.length,
      given.units.force + "/" + given.units.shown_length(), log_interval(out.lugre->sigma0, half),
      half < kWidestInterval);
  if (!add_damping(given, rows, lugre, 1, "sigma1", out.lugre->sigma1, *out.lugre->damping_velocity,
                   out.lugre_parameters)) {
    out.lugre->sigma1 = 0.0;
    out.lugre->damping_velocity.reset();
  }
  set_break_away(given, out.lugre->sigma0, unit_vector(n, 0), lugre);
}

void report_gms(const Given& given, const Rows& rows, Fitted& gms, BristleFit& out) {
  using Jet = ceres::Jet<double, GmsCase::kMostOwn>;
  const VectorXd& p = gms.solution.p;
  std::array<Jet, GmsCase::kMostOwn> jets;
  for (int i = 0; i < gms.own; ++i) jets[static_cast<std::size_t>(i)] = Jet(p(i), i);
  const auto law = GmsCase::make<Jet>(jets.data(), gms.own, rows.setting.scales).law;
  const auto slope = [&](const Jet& x) {
    VectorXd g = VectorXd::Zero(p.size());
    g.head(gms.own) = ceres::log(x).v.head(gms.own);
    return g;
  };
  const auto positive = [&](const std::string& name, const Jet& x, const std::string& si,
                            const std::string& people) {
    const double half = gms.spread.half_width(slope(x));
    add(out.gms_parameters, name, x.a, si, people, log_interval(x.a, half), half < kWidestInterval);
  };
  const std::string si = given.units.force + "/" + given.units.length;
  const std::string people = given.units.force + "/" + given.units.shown_length();
  positive("stiffness", law.stiffness(), si, people);
  for (std::size_t i = 0; i < law.elements.size(); ++i) {
    positive("stiffness_" + std::to_string(i + 1), law.elements[i].stiffness, si, people);
    positive("share_" + std::to_string(i + 1), law.elements[i].share, "1", "1");
  }
  positive("attraction", law.attraction, given.units.force + "/s", given.units.force + "/s");
  out.gms = GmsCase::make<double>(p.data(), gms.own, rows.setting.scales).law;
  if (!add_damping(given, rows, gms, gms_damping(given.options.elements), "damping",
                   out.gms->damping_coefficient, *out.gms->damping_velocity, out.gms_parameters)) {
    out.gms->damping_coefficient = 0.0;
    out.gms->damping_velocity.reset();
  }
  set_break_away(given, out.gms->stiffness(), slope(law.stiffness()), gms);
}

void answer(const Given& given, const Rows& rows, const Fitted& f, std::size_t best, std::size_t chosen,
            BristleFit& out) {
  const VectorXd& p = f.solution.p;
  out.mass = given.known->mass * (1.0 + p(f.own + kMass));
  const double half = f.spread.half_width(unit_vector(p.size(), f.own + kMass, given.known->mass));
  out.mass_interval = {out.mass - half, out.mass + half};
  out.load = given.known->load + rows.setting.scales.level * p(f.own + kLoad);
  const double load_half =
      f.spread.half_width(unit_vector(p.size(), f.own + kLoad, rows.setting.scales.level));
  out.load_interval = {out.load - load_half, out.load + load_half};
  out.level_factor = {1.0 + p(f.own + kForward), 1.0 + p(f.own + kBackward)};
  out.break_away = f.break_away;
  out.break_away_interval = log_interval(f.break_away, f.half);
  out.too_coarse = f.break_away < kLeastQuanta * given.quantum && out.rows_per_reversal >= kLeastRows;
  const std::string why_not = objection(given, f, best, chosen, out);
  out.determinable = why_not.empty();
  if (!out.determinable) {
    out.reason = kNotDeterminable + why_not;
    return;
  }
  if (chosen == 2) {
    out.best = *out.gms;
  } else {
    out.best = *out.lugre;
  }
  out.reason = "break-away distance " + given.shown.length(out.break_away) + " (" +
               given.shown.length(out.break_away_interval.low) + " to " +
               given.shown.length(out.break_away_interval.high) + ") from " + std::to_string(out.reversals) +
               " reversals";
}

}  // namespace stribeck::ident::bristle
