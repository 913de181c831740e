#include <fmt/core.h>

#include <cmath>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/methods/position_map_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <utility>

namespace stribeck::ident::methods {
namespace {

using namespace position_map;

std::vector<Term> terms_of(const map::PeriodicResult& found) {
  std::vector<Term> terms;
  for (const map::PeriodicTerm& t : found.terms) {
    terms.push_back({1.0 / t.term.period, 0.0, 0.0, t.term.form == friction::EccentricForm::kProportional});
  }
  return terms;
}

/// Builds up the model: Stribeck rise and periodic terms are searched in turn.
Shape fit_all(const Rows& rows, const PositionMapOptions& options, Nonlinear& nonlinear,
              map::PeriodicResult& found) {
  const bool exact = options.turn.has_value();
  Shape full{!options.mass, rows.both, rows.both, true, false};
  nonlinear.v0 = find_rise(rows, full, nonlinear);
  Fit fit = solve(rows, full, nonlinear);
  // Twice, because the first fit has no periodic terms.
  for (int round = 0; round < 2; ++round) {
    map::PeriodicResult now = search(rows, fit, options);
    if (round == 0 || !now.terms.empty()) {
      nonlinear.terms = terms_of(now);
      found = std::move(now);
    }
    if (nonlinear.terms.empty()) break;
    full.periodic = true;
    refine(rows, full, exact, nonlinear);
    nonlinear.v0 = find_rise(rows, full, nonlinear);
    fit = refine(rows, full, exact, nonlinear);
  }
  return full;
}

Result identify_motion(const std::vector<log::Record>& records, const PositionMapOptions& options) {
  const bool exact = options.turn.has_value();
  Result result;
  const Rows rows = gather(records, options, result);
  Nonlinear nonlinear;
  map::PeriodicResult found;
  const Shape full = fit_all(rows, options, nonlinear, found);
  Shape best = choose(rows, full, nonlinear, result);
  Fit fit = refine(rows, best, exact, nonlinear);
  bool no_mass = false;
  if (best.mass) {
    const double half = Intervals(rows, fit, nonlinear, exact).half(0);
    if (!(fit.theta(0) > half)) {
      result.cannot_tell.push_back(
          "mass: this motion does not determine it" +
          (std::isfinite(half) ? fmt::format(" ({:.3g} ± {:.3g})", fit.theta(0), half) : std::string()) +
          "; accelerate more, or give the mass");
      no_mass = true;
      best.mass = false;
      fit = refine(rows, best, exact, nonlinear);
    }
  }
  const Intervals intervals(rows, fit, nonlinear, exact);
  describe({rows, fit, nonlinear, found, options, intervals}, no_mass, result);
  return result;
}

}  // namespace

Result identify_position_map(const std::vector<log::Record>& records, const PositionMapOptions& options) {
  if (records.empty()) throw Refused("position map: no record given");
  if (options.holding.value_or(held_at_standstill(records))) return identify_held(records, options);
  return identify_motion(records, options);
}

}  // namespace stribeck::ident::methods
