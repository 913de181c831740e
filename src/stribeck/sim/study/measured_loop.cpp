#include <algorithm>
#include <cmath>
#include <limits>

#include <stribeck/core/scalar.hpp>
#include <stribeck/sim/study/measured_loop.hpp>

namespace stribeck::sim {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kSlowest = 0.5;  ///< of the ω0 that are tried [rad/s]
constexpr double kFiner = 1.01;   ///< ratio of neighbouring ω0
constexpr double kFasterBy = 7.0 / 6.0;
constexpr double kWorthMore = 1.02;  ///< a deeper and wider notch costs phase below it: it must earn this
constexpr double kHighGain = 20.0;   ///< |L| above which noise of the phase decides nothing
constexpr double kFallen = 0.5;      ///< |L| at the last line below which what lies above it cannot matter

using Response = std::complex<double>;

/// The point of the segment from a to b at a share, logarithmic in size, straight in phase.
struct Between {
  Response a, b;
  double omega_a, omega_b;
  double half_a, half_b;

  [[nodiscard]] Response at(double share) const {
    const double size = std::exp((1.0 - share) * std::log(std::abs(a)) + share * std::log(std::abs(b)));
    return std::polar(size, std::arg(a) + share * std::arg(b / a));
  }
  [[nodiscard]] double omega(double share) const { return omega_a * std::pow(omega_b / omega_a, share); }
  [[nodiscard]] double half(double share) const { return (1.0 - share) * half_a + share * half_b; }
};

double sure_angle(double half) { return std::asin(std::min(1.0, half)); }

/// Share of the segment where |L| = 1.
double unity(const Between& s) {
  const double la = std::log(std::abs(s.a));
  const double lb = std::log(std::abs(s.b));
  return la / (la - lb);
}

/// Share where L meets the negative real axis; absent: it does not.
std::optional<double> real_axis(const Between& s) {
  const double from = std::arg(-s.a);
  const double turn = std::arg(s.b / s.a);
  const double to = from + turn;
  if ((from > 0.0) == (to > 0.0) || turn == 0.0) return std::nullopt;
  const double share = -from / turn;
  if (share < 0.0 || share > 1.0) return std::nullopt;
  return share;
}

struct Judged {
  MeasuredMargins m;
  int crossings = 0;  ///< left of −1, upwards less downwards
  double phase_at = 0.0;

  void phase_of(const Between& s) {
    const double share = unity(s);
    // How far the point is from −1, on either side: a resonance may cross 1 with lead, far beyond −180°, in a stable loop.
    const double angle = std::abs(std::arg(-s.at(share)));
    const double sure = angle - sure_angle(s.half(share));
    m.crossover = std::max(m.crossover, s.omega(share));
    if (sure < m.sure_phase) {
      m.sure_phase = sure;
      phase_at = s.omega(share);
    }
    m.phase = std::min(m.phase, angle);
  }
  void gain_of(const Between& s, double share) {
    const double size = std::abs(s.at(share));
    const double half = s.half(share);
    if (size < 1.0) {
      if (1.0 / size < m.gain_up) m.critical = s.omega(share);
      m.gain_up = std::min(m.gain_up, 1.0 / size);
      m.sure_gain = std::min(m.sure_gain, 1.0 / (size * (1.0 + half)));
      return;
    }
    m.gain_down = std::min(m.gain_down, size);
    if (size < kHighGain) m.sure_gain = std::min(m.sure_gain, std::max(1.0, size * (1.0 - half)));
    crossings += std::arg(-s.b) > std::arg(-s.a) ? 1 : -1;
  }
};

Judged judge_measured(const MeasuredPlant& plant, const std::vector<Response>& loop) {
  Judged out;
  out.m.phase = out.m.sure_phase = out.m.gain_up = out.m.gain_down = out.m.sure_gain = kInfinite;
  // Above a high gain the phase of a double integrator lies within its noise of −180°.
  std::size_t first = 0;
  while (first + 1 < loop.size() && std::abs(loop[first + 1]) > kHighGain) ++first;
  if (!loop.empty() && std::arg(-loop[first]) < 0.0) out.crossings = -1;
  for (std::size_t k = first; k + 1 < loop.size(); ++k) {
    const Between s{loop[k],
                    loop[k + 1],
                    plant.omega[k],
                    plant.omega[k + 1],
                    plant.half_width[k],
                    plant.half_width[k + 1]};
    if ((std::abs(s.a) > 1.0) != (std::abs(s.b) > 1.0)) out.phase_of(s);
    if (const auto share = real_axis(s)) out.gain_of(s, *share);
  }
  return out;
}

/// Whether what lies above the last line cannot matter: the loop is below a half there, or has met −180° before.
bool ends_inside(const std::vector<Response>& loop, const MeasuredMargins& m) {
  if (loop.size() < 2 || m.crossover == 0.0 || std::abs(loop.front()) <= 1.0 || std::abs(loop.back()) >= 1.0)
    return false;
  return std::isfinite(m.gain_up) || std::abs(loop.back()) < kFallen;
}

MeasuredMargins finished(Judged judged, const MeasuredPlant& plant, const std::vector<Response>& loop) {
  MeasuredMargins& m = judged.m;
  m.stable = judged.crossings == 0 && m.crossover > 0.0;
  if (!m.stable && std::isfinite(m.phase)) m.phase = -m.phase, m.sure_phase = m.phase;
  m.inside = ends_inside(loop, m);
  if (!std::isfinite(m.gain_up) && !loop.empty()) {
    // No crossing of −180°: the gain may rise at least until the last line crosses 1.
    m.sure_gain = std::min(m.sure_gain, 1.0 / (std::abs(loop.back()) * (1.0 + plant.half_width.back())));
  }
  return m;
}

bool keeps(const MeasuredMargins& m, const MarginRule& rule) {
  return m.stable && m.inside && m.sure_phase >= rule.phase && m.sure_gain >= rule.gain;
}

/// Whether the margins themselves keep the rule, and only their intervals do not.
bool keeps_nominally(const MeasuredMargins& m, const MarginRule& rule) {
  return m.stable && m.inside && m.phase >= rule.phase && std::min(m.gain_up, m.gain_down) >= rule.gain;
}

/// The first line that may be at −1 within its interval [rad/s]; 0: none. Margins look only at the lines where the loop crosses 1 or the
/// real axis.
double may_be_minus_one(const MeasuredPlant& plant, const std::vector<Response>& loop) {
  constexpr double kClear = 0.1;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const double size = std::abs(loop[k]);
    if (size < kHighGain && !(std::abs(1.0 + loop[k]) - plant.half_width[k] * size > kClear))
      return plant.omega[k];
  }
  return 0.0;
}

/// What a loop violates, and where.
void say_limit(const MeasuredPlant& plant, const Judged& judged, const MeasuredMargins& m,
               const MarginRule& rule, LoopProposal& out) {
  out.limit = !m.inside                   ? LoopLimit::kMeasured
              : m.sure_gain < rule.gain   ? LoopLimit::kGain
              : m.sure_phase < rule.phase ? LoopLimit::kPhase
                                          : LoopLimit::kUnstable;
  out.unsure = keeps_nominally(m, rule);
  out.limit_at = out.limit == LoopLimit::kGain       ? m.critical
                 : out.limit == LoopLimit::kMeasured ? plant.omega.back()
                                                     : judged.phase_at;
}

}  // namespace

std::complex<double> Notch::at(double omega, double period) const {
  // Tustin's variable, scaled so that the middle stays where it is.
  const double warp = std::tan(0.5 * omega * period) / std::tan(0.5 * frequency * period);
  const Response s(0.0, warp);
  return (s * s + 2.0 * depth * damping * s + 1.0) / (s * s + 2.0 * damping * s + 1.0);
}

std::vector<std::complex<double>> measured_loop(const MeasuredPlant& plant, const MeasuredGains& gains) {
  std::vector<Response> loop;
  for (std::size_t k = 0; k < plant.omega.size(); ++k) {
    const double omega = plant.omega[k];
    const Response rate = (1.0 - std::polar(1.0, -omega * plant.period)) / plant.period;
    Response c = gains.mass * gains.omega * (gains.omega + 2.0 * rate);
    if (gains.notch) c *= gains.notch->at(omega, plant.period);
    loop.push_back(c * plant.response[k]);
  }
  return loop;
}

MeasuredMargins measured_margins(const MeasuredPlant& plant, const MeasuredGains& gains) {
  const std::vector<Response> loop = measured_loop(plant, gains);
  return finished(judge_measured(plant, loop), plant, loop);
}

LoopProposal propose_loop(const MeasuredPlant& plant, double mass, const MarginRule& rule,
                          const std::optional<Notch>& notch) {
  LoopProposal out;
  out.notch = notch;
  double begin = 0.0;    // of the range that keeps the rule
  double inside = 0.0;   // slowest loop whose crossings were measured
  bool limited = false;  // since the fastest loop that keeps it
  bool passed_over = false;
  for (double omega = kSlowest; omega < kPi / plant.period; omega *= kFiner) {
    const std::vector<Response> loop = measured_loop(plant, {mass, omega, notch});
    const Judged judged = judge_measured(plant, loop);
    const MeasuredMargins m = finished(judged, plant, loop);
    if (m.inside && inside == 0.0) inside = omega;
    if (keeps(m, rule)) {
      // A loop that is faster than one that was passed over must not be at −1 within the interval of any line.
      const double unsure_at = passed_over ? may_be_minus_one(plant, loop) : 0.0;
      if (unsure_at > 0.0) {
        if (!limited) out.limit = LoopLimit::kPhase, out.unsure = true, out.limit_at = unsure_at;
        limited = true;
        continue;
      }
      if (begin == 0.0) begin = omega;
      out = {.omega = omega, .margins = m, .notch = notch};
      limited = false;
      continue;
    }
    const bool wide = begin > 0.0 && (begin <= 0.5 * omega || begin == inside);
    LoopProposal said = out;
    if (wide || (m.inside && out.limit_at == 0.0)) say_limit(plant, judged, m, rule, said);
    if (!limited || !wide) out = said;
    limited = limited || wide;
    // A line that is poorly known, at a ripple of the screw, is no reason to stay below it: faster loops may be sure again.
    passed_over = passed_over || (wide && said.unsure);
    if (wide && said.unsure) continue;
    if (wide) break;
    // A narrow range between two that violate the rule is no place for a loop.
    begin = out.omega = 0.0;
    out.margins = {};
  }
  return out;
}

namespace {

/// The same for a resonance that is off by `drift` either way: the slowest of the three.
LoopProposal slowest_proposal(const MeasuredPlant& plant, double mass, const MarginRule& rule,
                              const Notch& notch, double drift) {
  LoopProposal slowest;
  slowest.omega = kInfinite;
  for (const double off : {0.0, -drift, drift}) {
    Notch moved = notch;
    moved.frequency *= 1.0 + off;
    const LoopProposal p = propose_loop(plant, mass, rule, moved);
    if (p.omega < slowest.omega) slowest = p;
  }
  return slowest;
}

}  // namespace

std::optional<LoopProposal> propose_notch(const MeasuredPlant& plant, double mass, const MarginRule& rule,
                                          double resonance, double drift, double without) {
  std::optional<LoopProposal> best;
  if (!(without > 0.0)) return best;
  double fastest = kFasterBy * without;
  for (const double depth : {0.5, 0.3, 0.2, 0.1, 0.05}) {
    for (const double damping : {0.1, 0.2, 0.35, 0.5, 0.7, 1.0}) {
      const Notch notch{resonance, depth, damping};
      const double wanted = best ? kWorthMore * fastest : fastest;
      const auto keeps_with = [&](double off) {
        const Notch moved{resonance * (1.0 + off), depth, damping};
        return keeps(measured_margins(plant, {mass, wanted, moved}), rule);
      };
      if (!keeps_with(0.0) || !keeps_with(-drift) || !keeps_with(drift)) continue;
      const LoopProposal slowest = slowest_proposal(plant, mass, rule, notch, drift);
      if (!(slowest.omega > wanted)) continue;
      fastest = slowest.omega;
      best = propose_loop(plant, mass, rule, notch);
      if (best->omega > slowest.omega) {
        best->omega = slowest.omega;
        best->margins = measured_margins(plant, {mass, slowest.omega, best->notch});
      }
      best->limit = slowest.limit;
      best->limit_at = slowest.limit_at;
      best->unsure = slowest.unsure;
    }
  }
  return best;
}

}  // namespace stribeck::sim
