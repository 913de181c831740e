// Writes in sentences what a log can determine and what not.
#include <fmt/core.h>

#include <algorithm>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/log/condition_parts.hpp>

namespace stribeck::ident::log::parts {
namespace {

/// Unit in which lengths are shown.
struct LengthUnit {
  bool turning = false;
  std::string length;  ///< "mm", "rad", or "deg" of a rotary axis
  double scale = 1.0;  ///< factor from SI
};

LengthUnit length_unit_of(const std::string& unit, bool rotary) {
  if (rotary) return {true, "deg", 180.0 / kPi};
  if (turning(unit)) return {true, "rad", 1.0};
  return {false, "mm", 1e3};
}

struct Verdict {
  std::vector<std::string>& can;
  std::vector<std::string>& cannot;
};

void judge_mass_and_load(const Coverage& c, const RoughFit& r, const LengthUnit& u, const Verdict& out) {
  if (!r.good || c.moving <= 0.0) {
    out.cannot.push_back("mass and friction: the axis hardly moves in this log");
  } else if (r.mass_shows) {
    out.can.push_back(fmt::format("mass: acceleration up to {} {}/s2 shows in the force",
                                  digits(u.scale * c.a_max), u.length));
  } else if (r.mass_shows_without_spring) {
    // identify has no spring in its model, and finds this mass.
    out.can.push_back(fmt::format(
        "mass, if no spring acts on the axis: acceleration up to {} {}/s2 shows in the force, but in this "
        "motion a spring would look like a mass; a log of another frequency tells them apart",
        digits(u.scale * c.a_max), u.length));
  } else {
    out.cannot.push_back(fmt::format(
        "a narrow interval of the mass: the acceleration (up to {} {}/s2) takes less than a tenth of the "
        "force beside friction; add a log of pulses or of a faster reversal",
        digits(u.scale * c.a_max), u.length));
  }
  if (c.forward > 0.03 && c.forward < 0.97) {
    out.can.push_back(
        fmt::format("friction by direction, and load apart from it: {:.0f} % of the moving rows go forward",
                    100.0 * c.forward));
  } else if (c.moving > 0.0) {
    out.cannot.push_back(
        "load (weight) apart from friction: it moves in one direction only; add the motion back at "
        "the same speeds");
  }
}

void judge_speeds(const Coverage& c, const LengthUnit& u, const Verdict& out) {
  const double fastest = std::max(c.v_max, -c.v_min);
  if (fastest > 0.0 && c.slowest < 0.4 * fastest) {
    out.can.push_back(fmt::format("friction over speed, from {} to {} {}/s", digits(u.scale * c.slowest),
                                  digits(u.scale * fastest), u.length));
  } else if (fastest > 0.0) {
    out.cannot.push_back(
        fmt::format("viscous friction and its low-speed part: all speeds lie between {} and {} {}/s; add "
                    "slower and faster motion",
                    digits(u.scale * c.slowest), digits(u.scale * fastest), u.length));
  }
}

void judge_periods(const Coverage& c, const Sampling& s, double resolution, const LengthUnit& u,
                   const Verdict& out) {
  const double fastest = std::max(c.v_max, -c.v_min);
  const double finest_period = std::max(8.0 * resolution, 4.0 * fastest * s.sample_time);
  const double travel = c.x_max - c.x_min;
  if (travel > 0.0 && finest_period < 0.25 * travel) {
    out.can.push_back(fmt::format("terms periodic in position, periods from {} to {} {}",
                                  digits(u.scale * finest_period), digits(u.scale * travel / 3.0), u.length));
  } else {
    out.cannot.push_back(fmt::format(
        "terms periodic in position: the travel of {:.4g} {} holds too few periods that this sampling "
        "can see",
        u.scale * travel, u.length));
  }
}

void judge_presliding(const Coverage& c, const Sampling& s, double resolution, const LengthUnit& u,
                      const Verdict& out) {
  // Break-away of guides and screws lies at 1 to 100 µm; five steps are needed to see a stiffness. From `fine` to `coarse` the
  // axis must be one of the softer ones.
  const double fine = u.turning ? 0.2e-3 : 9e-6;
  const double coarse = 2.2 * fine;
  constexpr std::size_t kFewestInside = 4;
  const char* const soon = u.turning ? "1 mrad" : "50 um";
  constexpr double kLeastTravel = 5.0;  // of the resolution
  if (c.x_max - c.x_min < kLeastTravel * resolution) {
    out.cannot.push_back("pre-sliding: the axis hardly moves in this log");
  } else if (resolution > coarse) {
    const bool steps = s.x_quantum_large > coarse;
    const bool finer = s.x_quantum_large > 1.5 * s.x_quantum && s.x_quantum > 0.0;
    out.cannot.push_back(fmt::format(
        "pre-sliding: the position is too coarse, {:.3g} {} {}{} (break-away lies at {}, and five steps "
        "within it are the least)",
        u.scale * (steps ? s.x_quantum_large : resolution), u.length,
        steps ? "between its values" : "of noise (3 sigma)",
        finer
            ? fmt::format(" where the numbers are large, {:.3g} where they are small", u.scale * s.x_quantum)
            : "",
        u.turning ? "0.1 to 10 mrad" : "1 to 100 um"));
  } else if (c.reversals == 0) {
    out.cannot.push_back(
        "pre-sliding (stiffness, break-away distance): no reversal in this log; add slow reversals");
  } else if (c.rows_presliding < kFewestInside) {
    out.cannot.push_back(fmt::format(
        "pre-sliding: after a reversal only {} rows (of {:.3g} s) lie within the first {}; reverse "
        "more slowly or sample faster",
        c.rows_presliding, s.sample_time, soon));
  } else {
    const std::string softer = resolution > fine
                                   ? fmt::format(", if the axis breaks away after more than {} {}",
                                                 digits(5.0 * u.scale * resolution), u.length)
                                   : "";
    out.can.push_back(fmt::format(
        "pre-sliding{}: {} reversals, {} rows within the first {} after each, position resolution {} {}",
        softer, c.reversals, c.rows_presliding, soon, digits(u.scale * resolution), u.length));
  }
  if (resolution > coarse && s.sample_time > 0.02) {
    out.cannot.back() +=
        fmt::format("; besides, {:.3g} s between rows is longer than a reversal takes", s.sample_time);
  }
}

}  // namespace

void judge(Conditioned& out, const std::string& unit, bool rotary) {
  const LengthUnit u = length_unit_of(unit, rotary);
  const Verdict verdict{out.determinable, out.cannot_tell};
  const Sampling& s = out.sampling;
  const double resolution = std::max(s.x_quantum_large, 3.0 * s.x_noise);
  judge_mass_and_load(out.coverage, out.rough, u, verdict);
  judge_speeds(out.coverage, u, verdict);
  judge_periods(out.coverage, s, resolution, u, verdict);
  judge_presliding(out.coverage, s, resolution, u, verdict);
}

}  // namespace stribeck::ident::log::parts
