// Constant speeds forward and back.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>

namespace stribeck::ident::excitation {
namespace {

constexpr double kShortestJog = 1.0;  // of constant speed, without the settling time [s]
constexpr double kLongestJog = 60.0;  // limit for rounding up to whole periods [s]
constexpr double kLongestWay = 10.0;  // for the way of the fastest speed [s]
constexpr double kSettle = 0.5;       // left out by the identification [s]

double room_of(const Limits& limits, const JogDesign& design) {
  const double above = limits.travel_max - design.start, below = design.start - limits.travel_min;
  if (design.both_sides) return std::min(above, below);
  return design.direction > 0 ? above : below;
}

/// Whether two rows of the fastest speed fit into the period, and the period into the travel.
void check_period(const JogDesign& design, const Shown& u, double room, double sample_time) {
  if (!(design.period > 0.0)) return;
  const double fastest = *std::max_element(design.speeds.begin(), design.speeds.end());
  const double least = 2.0 * fastest * sample_time;
  if (design.period < least || design.period > room) {
    throw BadDesign(
        "period",
        fmt::format("got {:g} {}, expected between {:g} {} (two rows at the fastest speed) and {:g} {} (the "
                    "available travel)",
                    design.period * u.per_metre, u.travel, least * u.per_metre, u.travel, room * u.per_metre,
                    u.travel));
  }
}

/// One speed out and back.
struct Jog {
  double ramp = 0.0;   ///< [s]
  double flat = 0.0;   ///< at constant speed [s]
  bool whole = false;  ///< over whole periods
};
Jog jog_of(const Limits& limits, double sample_time, const JogDesign& design, double v) {
  const auto [ramp, longest] = profile_of(limits, sample_time, room_of(limits, design), v);
  Jog jog{ramp, std::min(std::max(2.0, 0.2e-3 / v), longest)};
  const double fastest = *std::max_element(design.speeds.begin(), design.speeds.end());
  if (v >= fastest && !(design.period > 0.0))
    jog.flat = std::max(jog.flat, std::min({longest, design.way / v, kLongestWay}));
  if (design.period > 0.0) {
    // The settling time is added to the whole periods.
    const double settled = jog.flat - std::min(kSettle, 0.3 * jog.flat);
    const double whole = std::ceil(v * settled / design.period - 1e-9) * design.period / v + kSettle;
    if (whole <= std::min(longest, kLongestJog)) {
      jog.flat = whole;
      jog.whole = true;
    }
  }
  return jog;
}

double rows_of(double ramp, double flat, double sample_time) {
  return 2.0 * (std::ceil(flat / sample_time) + 2.0 * ramp / sample_time);
}

}  // namespace

Profile profile_of(const Limits& limits, double sample_time, double room, double speed) {
  const double a = limits.acceleration > 0.0 ? 0.5 * limits.acceleration : 10.0 * limits.speed;
  const double ramp = std::max(4.0 * sample_time, speed / a);
  return {ramp, (0.95 * room - speed * ramp) / speed};
}

void append(const Strokes& strokes, Excitation& e) {
  double r = strokes.start;
  const auto flank = static_cast<std::size_t>(std::ceil(strokes.ramp / e.sample_time));
  const auto rows = static_cast<std::size_t>(std::ceil(strokes.flat / e.sample_time));
  for (const double direction : {strokes.direction, -strokes.direction}) {
    // Speed in the middle of each sample: the flanks then sum up exactly, and the stroke back ends at the start.
    for (std::size_t k = 0; k < rows + 2 * flank; ++k) {
      const double up = (static_cast<double>(k) + 0.5) / static_cast<double>(flank);
      const double down = (static_cast<double>(rows + 2 * flank - k) - 0.5) / static_cast<double>(flank);
      r += direction * strokes.speed * std::min({1.0, up, down}) * e.sample_time;
      e.r.push_back(r);
    }
    for (int k = 0; k < 20; ++k) e.r.push_back(r);
  }
}

std::vector<double> in_mixed_order(std::vector<double> speeds) {
  std::sort(speeds.begin(), speeds.end());
  const std::size_t n = speeds.size();
  if (n < 4) return speeds;
  // Multiples of the golden ratio: any run of consecutive ones is spread over the whole range.
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [](std::size_t i) {
    const double turns = static_cast<double>(i + 1) * (std::sqrt(5.0) - 1.0) / 2.0;
    return turns - std::floor(turns);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  std::vector<double> mixed;
  for (const std::size_t i : order) mixed.push_back(speeds[i]);
  for (const std::size_t quarter : {4, 3, 2}) {
    const double again = speeds[quarter * (n - 1) / 4];
    if (again != mixed.back()) mixed.push_back(again);
  }
  return mixed;
}

std::vector<double> jog_speeds(double fastest) {
  std::vector<double> speeds;
  for (const double mm : {0.01, 0.04, 0.08, 0.15, 0.2, 0.4, 0.5, 1.0, 1.5,  2.5,  3.0,  3.5,  4.0,  4.5, 5.0,
                          5.5,  6.0,  6.5,  7.0,  7.5, 8.0, 8.5, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0}) {
    if (mm * 1e-3 <= fastest * (1.0 + 1e-9)) speeds.push_back(mm * 1e-3);
  }
  // For faster axes the speeds continue in equal ratios.
  constexpr double kFaster = 1.25, kClose = 1.1;
  for (double v = 15e-3 * kFaster; std::isfinite(fastest) && v * kClose < fastest; v *= kFaster)
    speeds.push_back(v);
  // The end of the curve matters most, so the last gap must not leave it open there.
  constexpr double kGap = 1.02;
  if (!speeds.empty() && fastest > kGap * speeds.back() && std::isfinite(fastest)) speeds.push_back(fastest);
  return speeds;
}

double fastest_jog(const Limits& limits, double sample_time, const JogDesign& design) {
  const double room = room_of(limits, design);
  double low = 0.0;
  double high = kReserve * limits.speed;
  if (profile_of(limits, sample_time, room, high).longest >= kShortestJog) return high;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (profile_of(limits, sample_time, room, middle).longest >= kShortestJog ? low : high) = middle;
  }
  return low;
}

bool leave_out_slowest(const Limits& limits, double sample_time, JogDesign& design) {
  constexpr std::size_t kFewest = 8;
  const auto rows = [&] {
    double sum = 0.0;
    for (const double v : design.speeds) {
      const Jog jog = jog_of(limits, sample_time, design, v);
      sum += rows_of(jog.ramp, jog.flat, sample_time);
    }
    return sum;
  };
  bool left_out = false;
  // The rests between the strokes are a small part.
  constexpr double kOfMost = 0.95;
  while (design.speeds.size() > kFewest && rows() > kOfMost * static_cast<double>(kMostRows)) {
    const double slowest = *std::min_element(design.speeds.begin(), design.speeds.end());
    std::erase(design.speeds, slowest);
    left_out = true;
  }
  return left_out;
}

Excitation design_jog(const Limits& limits, double sample_time, const JogDesign& design) {
  check(limits, sample_time, design.start);
  if (design.speeds.empty()) throw Refused("jog: no speed is below the limit; give slower ones");
  const double room = room_of(limits, design);
  const Shown u = shown(limits);
  Excitation e;
  e.method = ExcitationMethod::kJog;
  e.sample_time = sample_time;
  e.r.push_back(design.start);
  check_period(design, u, room, sample_time);
  std::size_t whole_strokes = 0;
  double direction = design.direction;
  for (const double v : design.speeds) {
    if (!(v > 0.0) || v > limits.speed) {
      throw BadDesign(
          "speeds",
          fmt::format("jog: speed of {:g} {}/s, expected above 0 and at most the limit of {:g} {}/s",
                      v * u.per_metre, u.travel, limits.speed * u.per_metre, u.travel));
    }
    // Long enough for the bristle to settle (some tens of micrometres) and to average noise.
    const auto [ramp, flat, whole] = jog_of(limits, sample_time, design, v);
    whole_strokes += whole ? 1 : 0;
    if (flat < kShortestJog) {
      throw Refused(fmt::format(
          "jog: {:g} {}/s has only {:.3g} s of constant speed in the travel from the start of the motion; leave it out",
          v * u.per_metre, u.travel, flat));
    }
    check_rows("speeds", static_cast<double>(e.r.size()) + rows_of(ramp, flat, sample_time), sample_time,
               fmt::format("jog: {:g} {}/s, with the speeds before it,", v * u.per_metre, u.travel),
               "leave out the slowest");
    append({design.start, direction, v, ramp, flat}, e);
    if (design.both_sides) direction = -direction;
  }
  stamp(e, e.r.size());
  check_positions(e, limits);
  e.says = fmt::format(
      "jog: {:.1f} s, {} speed{} in both directions, up to {} {}/s. Determines friction at these speeds, "
      "the slowest included; the mass is told by the ramps between them alone.",
      e.t.back(), design.speeds.size(), design.speeds.size() == 1 ? "" : "s",
      digits(u.per_metre * *std::max_element(design.speeds.begin(), design.speeds.end())), u.travel);
  if (design.period > 0.0) {
    e.says += fmt::format(" At {} of them the travel is a whole number of turns of {:g} {}.", whole_strokes,
                          design.period * u.per_metre, u.travel);
  }
  return e;
}

}  // namespace stribeck::ident::excitation
