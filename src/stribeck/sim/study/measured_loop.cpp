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
constexpr double kHighGain = 20.0;  ///< |L| above which noise of the phase decides nothing

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

/// Whether what lies above the last line cannot matter: the loop is below the gain margin there, or has met −180° before.
bool ends_inside(const std::vector<Response>& loop, const MeasuredMargins& m) {
  if (loop.size() < 2 || m.crossover == 0.0 || std::abs(loop.front()) <= 1.0 || std::abs(loop.back()) >= 1.0)
    return false;
  return std::isfinite(m.gain_up) || std::abs(loop.back()) < 0.5;
}

MeasuredMargins finished(Judged judged, const std::vector<Response>& loop) {
  MeasuredMargins& m = judged.m;
  m.stable = judged.crossings == 0 && m.crossover > 0.0;
  if (!m.stable && std::isfinite(m.phase)) m.phase = -m.phase, m.sure_phase = m.phase;
  m.inside = ends_inside(loop, m);
  if (!std::isfinite(m.gain_up) && !loop.empty()) {
    // No crossing of −180°: the gain may rise at least until the last line crosses 1.
    m.sure_gain = std::min(m.sure_gain, 1.0 / std::abs(loop.back()));
  }
  return m;
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
  return finished(judge_measured(plant, loop), loop);
}

LoopProposal propose_loop(const MeasuredPlant& plant, double mass, const MarginRule& rule,
                          const std::optional<Notch>& notch) {
  LoopProposal out;
  out.notch = notch;
  double begin = 0.0;  // of the range that keeps the rule
  for (double omega = kSlowest; omega < kPi / plant.period; omega *= kFiner) {
    const MeasuredGains gains{mass, omega, notch};
    const std::vector<Response> loop = measured_loop(plant, gains);
    const Judged judged = judge_measured(plant, loop);
    const MeasuredMargins m = finished(judged, loop);
    if (m.stable && m.inside && m.sure_phase >= rule.phase && m.sure_gain >= rule.gain) {
      if (begin == 0.0) begin = omega;
      out.omega = omega;
      out.margins = m;
      continue;
    }
    if (begin == 0.0) continue;
    out.limit = !m.inside                   ? LoopLimit::kMeasured
                : m.sure_gain < rule.gain   ? LoopLimit::kGain
                : m.sure_phase < rule.phase ? LoopLimit::kPhase
                                            : LoopLimit::kUnstable;
    out.limit_at = out.limit == LoopLimit::kGain       ? m.critical
                   : out.limit == LoopLimit::kMeasured ? plant.omega.back()
                                                       : judged.phase_at;
    break;
  }
  return out;
}

std::optional<LoopProposal> propose_notch(const MeasuredPlant& plant, double mass, const MarginRule& rule,
                                          double resonance, double drift, double without) {
  std::optional<LoopProposal> best;
  double fastest = kFasterBy * without;
  for (const double depth : {0.5, 0.3, 0.2, 0.1, 0.05}) {
    for (const double damping : {0.1, 0.2, 0.35, 0.5, 0.7, 1.0}) {
      const auto keeps = [&](double off) {
        const MeasuredMargins m =
            measured_margins(plant, {mass, 1.02 * fastest, Notch{resonance * (1.0 + off), depth, damping}});
        return m.stable && m.inside && m.sure_phase >= rule.phase && m.sure_gain >= rule.gain;
      };
      if (!keeps(0.0) || !keeps(-drift) || !keeps(drift)) continue;
      LoopProposal slowest;
      slowest.omega = kInfinite;
      for (const double off : {0.0, -drift, drift}) {
        const LoopProposal p =
            propose_loop(plant, mass, rule, Notch{resonance * (1.0 + off), depth, damping});
        if (p.omega < slowest.omega) slowest = p;
      }
      // A deeper and wider notch costs phase below it: it must earn 2 %.
      if (!(slowest.omega > 1.02 * fastest)) continue;
      fastest = slowest.omega;
      best = propose_loop(plant, mass, rule, Notch{resonance, depth, damping});
      if (best->omega > slowest.omega) {
        best->omega = slowest.omega;
        best->margins = measured_margins(plant, {mass, slowest.omega, best->notch});
      }
      best->limit = slowest.limit;
      best->limit_at = slowest.limit_at;
    }
  }
  return best;
}

}  // namespace stribeck::sim
