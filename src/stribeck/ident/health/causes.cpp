// Which causes fit how the numbers of an axis changed together.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/health/findings.hpp>

namespace stribeck::ident::health {
namespace {

/// The shifts that count, by what they are; 0 where one does not count.
struct Pattern {
  double forward = 0.0, backward = 0.0, coulomb = 0.0, viscous = 0.0, offset = 0.0, mass = 0.0, spring = 0.0;
  double unbalance = 0.0;
  double place = 0.0, periodic = 0.0, circle = 0.0;
  const Channel* where = nullptr;  ///< of the place with the largest rise
  const Channel* wave = nullptr;

  /// Mean of both directions.
  [[nodiscard]] double level() const { return 0.5 * (forward + backward); }
};

Pattern pattern_of(const std::vector<Channel>& channels, const std::vector<Shift>& shifts) {
  Pattern p;
  for (const Shift& s : shifts) {
    if (!s.counts) continue;
    const Channel& c = channels[s.channel];
    switch (c.number) {
      case Number::kForward:
        p.forward = s.share;
        break;
      case Number::kBackward:
        p.backward = s.share;
        break;
      case Number::kCoulomb:
        p.coulomb = s.share;
        break;
      case Number::kViscous:
        p.viscous = s.share;
        break;
      case Number::kOffset:
        p.offset = s.share;
        break;
      case Number::kMass:
        p.mass = s.share;
        break;
      case Number::kSpring:
        p.spring = s.share;
        break;
      case Number::kUnbalance:
        p.unbalance = s.share;
        break;
      case Number::kPlace:
        if (s.share > p.place) {
          p.place = s.share;
          p.where = &c;
        }
        break;
      case Number::kPeriodic:
        if (s.share > p.periodic) {
          p.periodic = s.share;
          p.wave = &c;
        }
        break;
      case Number::kCircularDeviation:
      case Number::kHysteresis:
        p.circle = std::max(p.circle, s.share);
        break;
    }
  }
  return p;
}

constexpr const char* kRepeat =
    "repeat the test tomorrow; if it stays, look for what was done to the machine on that day";

/// How people see a travel of this axis.
struct Travel {
  double factor;
  const char* unit;
  explicit Travel(const Channel& c) : factor(c.rotary ? 180.0 / kPi : 1e3), unit(c.rotary ? "deg" : "mm") {}
};

void add_place(const Pattern& p, std::vector<Cause>& out) {
  if (p.where == nullptr || p.place < 0.3 * std::max(std::abs(p.level()), p.place)) return;
  const Travel travel(*p.where);
  out.push_back(
      {fmt::format("wear or dirt between {:.4g} and {:.4g} {}", travel.factor * p.where->at[0],
                   travel.factor * p.where->at[1], travel.unit),
       "friction has risen there more than elsewhere",
       "look at guide and screw at this place, clean and lubricate; drive the test once more over another stretch"});
}

void add_friction(const Pattern& p, std::vector<Cause>& out) {
  const double c = p.coulomb, v = p.viscous;
  constexpr double kSmall = 0.4;  // of the other one
  const bool line = c != 0.0 || v != 0.0;
  if (!line && p.level() == 0.0) return;
  if (c > 0.0 && v < 0.0) {
    out.push_back({"lubricant missing or old",
                   "friction at low speed rises while it grows less with speed: the film is thin",
                   "lubricate, check the lubricator, and repeat the test after ten full strokes"});
  } else if (c < 0.0 && v > 0.0) {
    out.push_back(
        {"freshly lubricated", "friction at low speed falls while it grows more with speed",
         "nothing, if the axis was lubricated on that day; otherwise check which lubricant it gets"});
  } else if (c < 0.0 && std::abs(v) <= kSmall * std::abs(c)) {
    out.push_back(
        {"preload lost", "friction falls equally at all speeds and in both directions",
         "measure the reversal error (stribeck evaluate on a circle) and check preload of nut, bearings and guide"});
  } else if (c > 0.0 && std::abs(v) <= kSmall * c) {
    out.push_back({"tighter than before: preload, misalignment, wipers or chips",
                   "friction rises equally at all speeds and in both directions",
                   "look at wipers and covers, then at preload and alignment"});
  } else if (v > 0.0 && std::abs(c) <= kSmall * v) {
    out.push_back({"stiffer lubricant: cold, too much, or another grease", "friction rises with speed only",
                   "compare the temperature with that of the earlier tests; run the axis warm and repeat"});
  } else if (v < 0.0 && std::abs(c) <= kSmall * std::abs(v)) {
    out.push_back({"thinner lubricant: warm, or another oil", "friction falls with speed only",
                   "compare the temperature with that of the earlier tests"});
  } else if (line ? c < 0.0 : p.level() < 0.0) {
    out.push_back({"preload lost, or the axis was warmer", "friction falls at all speeds",
                   "give --temperature with the tests; check preload of nut, bearings and guide"});
  } else {
    out.push_back({"tighter than before, or the axis was colder", "friction rises at all speeds",
                   "look at wipers, covers and lubricant; give --temperature with the tests"});
  }
}

}  // namespace

std::vector<Cause> causes_of(const std::vector<Channel>& channels, const std::vector<Shift>& shifts) {
  const Pattern p = pattern_of(channels, shifts);
  std::vector<Cause> out;
  const double level = p.level();
  // Mass and friction by the same factor: not the axis, but the number of newtons per unit of the drive.
  if (p.mass != 0.0 && level * p.mass > 0.0 && std::abs(level - p.mass) <= 0.25 * std::abs(p.mass)) {
    out.push_back({"scale of the force: gain, current sensor or motor constant",
                   "mass and friction changed by the same factor",
                   "compare --gain and the drive's parameters with those of the earlier tests"});
    return out;
  }
  if (p.mass != 0.0)
    out.push_back({p.mass > 0.0 ? "more mass: workpiece, fixture or tool"
                                : "less mass: a part was taken off, or the coupling slips",
                   "the force for acceleration changed", "repeat the test with an empty table"});
  if (p.offset != 0.0 && std::abs(p.offset) >= 0.5 * std::max(std::abs(p.forward), std::abs(p.backward)))
    out.push_back({"load or counterbalance",
                   "the force changed by the same amount and sign in both directions of motion",
                   "check counterbalance, gas spring, brake and what lies on the axis"});
  if (p.spring != 0.0)
    out.push_back(
        {"cable chain, hose, bellows or balance", "the force that grows with position changed",
         "look at what is pulled along with the axis: a chain that jams, a hose that was tied, a gas spring"});
  if (p.unbalance != 0.0)
    out.push_back({p.unbalance > 0.0 ? "more weight away from the axis: workpiece, fixture or counterweight"
                                     : "less weight away from the axis: workpiece, fixture or counterweight",
                   "the torque that follows the sine of the angle changed",
                   "repeat the test with an empty table; a fixture that stays needs a new identification"});
  add_place(p, out);
  if (p.periodic > 0.0)
    out.push_back({fmt::format("screw, bearing or coupling out of true (period {:.4g} {})",
                               Travel(*p.wave).factor * p.wave->at[0], Travel(*p.wave).unit),
                   "the force periodic in position has grown",
                   "check run-out of screw and coupling, and the bearings"});
  const bool explained = !out.empty();
  if (!explained || std::abs(p.coulomb) + std::abs(p.viscous) >= 1.5 * (std::abs(p.offset) + 2.0 * p.place))
    add_friction(p, out);
  if (p.circle > 0.0)
    out.push_back({"lost motion, friction or servo gains of the two axes",
                   "the measured circle is less round",
                   "stribeck evaluate with the logs of both directions names the part of each cause"});
  if (out.empty()) out.push_back({"no known pattern", "the numbers did not change together", kRepeat});
  return out;
}

}  // namespace stribeck::ident::health
