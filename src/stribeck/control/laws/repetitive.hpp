#pragma once
/// Repetitive control: PD with feed-forward, and a memory of the feedback at each place of the lap, added in the next lap.
///
///   a = r̈ − k_v ė − k_p e + u_j(φ)                    F = m·a + F_friction + load + d̂
///   u_{j+1}(φ) = Q{ u_j(φ) + γ·a_fb(φ, d periods later) },   a_fb = −k_v ė − k_p e,   u_1 = 0       j: lap
///
///   γ [1] learning, d lead of the learning [periods], φ parameter of the path, u [m/s²]. Q: low-pass without phase of
///   lap_memory.hpp, ½ at the cut-off ω_q [rad/s].
///   From lap to lap at frequency ω: factor |Q(ω)|·|1 − γ z^d T(z)|, z = e^{iωT}, T = CP/(1 + CP) of the sampled PD loop. It
///   converges where the factor is below 1 at every frequency (factor(), converges()); for a double pole with ωT ≤ 0.35 and d = 2
///   it does, even without Q. The share (1 − Q)/(1 − factor) of a periodic error remains.
///
/// The memory has kBins places per lap, so that laps may have any duration and speed; a place holds the mean over its width.
/// Without a lap (Setup::lap NaN), with a φ that jumps or runs back, or with a lap shorter than 50/ω_q it is PD. The memory adds no
/// more than force_limit.
/// Source: Tomizuka, Tsao, Chew 1989, doi:10.1115/1.3153060; Kawato et al. 1987, doi:10.1007/BF00364149 (learning from the
/// feedback).
/// Not modelled: observers beside it (factor() does not count them); changes of speed from lap to lap.
/// Real time: safe, a tick reads 11 to 364 places of the memory (11 σ of G); the constructor configure only. The state holds
/// 16 KiB per axis.

#include <cmath>
#include <complex>
#include <stribeck/control/laws/lap_memory.hpp>
#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/control/setup.hpp>

namespace stribeck::control {

template <std::size_t N>
class Repetitive;

struct RepetitiveParams {
  template <std::size_t N>
  using Controller = Repetitive<N>;
  static constexpr std::string_view kKind = "repetitive";
  static constexpr std::string_view kLabel = "repetitive control";
  static constexpr int kMostLead = 7;

  PerAxis kp{1600.0};
  PerAxis kv{80.0};
  double learning = 0.7;
  double cutoff = 100.0;
  int lead = 2;

  static constexpr auto fields() {
    using P = RepetitiveParams;
    return std::tuple{
        field("kp", &P::kp, quantity("1/s2", "1/s2").positive(),
              "proportional gains, one per axis; the last one applies to the others too")
            .or_default(),
        field("kv", &P::kv, quantity("1/s", "1/s").positive(), "derivative gains, in the same order")
            .or_default(),
        field("learning", &P::learning, pure_number().not_negative().at_most(1.0),
              "share of the feedback that is learned in a lap")
            .or_default(),
        field("cutoff", &P::cutoff, quantity("rad/s", "rad/s").positive(),
              "frequency above which nothing is learned (half)")
            .or_default(),
        field("lead", &P::lead, pure_number().not_negative().at_most(kMostLead),
              "control periods by which the feedback answers late")
            .or_default()};
  }

  /// Remaining share of an error of frequency ω [rad/s] after a lap, for one axis, sampled with this period [s].
  [[nodiscard]] double factor(std::size_t axis, double omega, double period) const noexcept {
    const double p = spread<kMostAxes>(kp)[axis];
    const double v = spread<kMostAxes>(kv)[axis] / period;
    const std::complex<double> z(cos(omega * period), sin(omega * period));
    // CP = n/m over the common denominator z(z−1)².
    const std::complex<double> n = 0.5 * period * period * (z + 1.0) * ((p + v) * z - v);
    const std::complex<double> m = z * (z - 1.0) * (z - 1.0);
    std::complex<double> ahead = learning;
    for (int k = 0; k < lead; ++k) ahead *= z;
    return low_pass(omega) * std::abs((m + n - ahead * n) / (m + n));
  }
  /// Q at ω [rad/s], without the width of the memory's places.
  [[nodiscard]] double low_pass(double omega) const noexcept {
    const double x = omega * width();
    const double missing = 1.0 - exp(-0.5 * x * x);
    return 1.0 - missing * missing;
  }
  /// Standard deviation of G in time [s].
  [[nodiscard]] double width() const noexcept { return kHalfOfQ / cutoff; }

  /// Whether the loop is stable and every frequency is learned, sampled with this period [s]. Configure only.
  [[nodiscard]] bool converges(double period) const noexcept {
    constexpr int kFrequencies = 512;
    const auto p = spread<kMostAxes>(kp);
    const auto v = spread<kMostAxes>(kv);
    for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
      if (!sampled_loop_stable(p[axis], v[axis], 0.0, period)) return false;
      for (int k = 1; k <= kFrequencies; ++k) {
        if (!(factor(axis, k * kPi / (kFrequencies * period), period) < 1.0)) return false;
      }
    }
    return learning > 0.0;
  }
};

template <std::size_t N>
class Repetitive {
 public:
  using Params = RepetitiveParams;
  using V = Vec<double, N>;

  static constexpr std::int64_t kBins = 1024;  ///< places per lap
  /// Two laps of u + γ·a_fb [m/s²]: the last lap is read while the present one is written.
  using Memory = LapMemory<N, kBins, 2 * kBins>;

  /// Feedback of a past tick, and its place.
  struct Given {
    double place = 0.0;
    V learned;
  };
  struct State : Common<N>::State {
    typename Memory::State memory;
    std::array<Given, Params::kMostLead + 1> given{};  ///< newest first
    int known = 0;                                     ///< number of valid entries
    V learned;                                         ///< u of the last step [m/s²]
  };

  Repetitive(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, ErrorRate::kDifferenceOfError),
        kp_(spread<N>(params.kp)),
        kv_(spread<N>(params.kv)),
        learning_(params.learning),
        width_(params.width() / setup.period),
        lead_(params.lead),
        bins_per_phi_(static_cast<double>(kBins) / setup.lap) {
    for (std::size_t i = 0; i < N; ++i) most_[i] = setup.force_limit[i] / common_.mass(i);
  }

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  V step(State& s, const path::PathPoint<N>& r, const V& measured) const noexcept {
    if (s.periods > 1) s.known = 0;
    if (!common_.begin(s, r, measured)) {
      s.known = 0;  // the feedback of `lead` ticks ago would be that of another time
      return s.force;
    }
    const V e = common_.error(s);
    const V rate = common_.rate(s);
    V feedback;
    for (std::size_t i = 0; i < N; ++i) feedback[i] = -kv_[i] * rate[i] - kp_[i] * e[i];
    s.learned = {};
    if (isfinite(r.phi * bins_per_phi_)) {
      const double moved = Memory::advance(s.memory, r.phi, bins_per_phi_);
      if (Memory::breaks(moved)) {
        Memory::interrupt(s.memory);
        s.known = 0;
      }
      const double width = max_of(width_ * abs(moved), Memory::kLeastWidth);
      const double place = s.memory.place;
      if (width < kMostWidth) s.learned = Memory::read(s.memory, place - static_cast<double>(kBins), width);
      remember(s);
      if (s.known > lead_ && width < kMostWidth) {
        const Given& then = s.given[static_cast<std::size_t>(lead_)];
        V value = then.learned + learning_ * feedback;
        for (std::size_t i = 0; i < N; ++i) value[i] = clamp_to(value[i], -most_[i], most_[i]);
        Memory::write(s.memory, then.place, value);
      }
    }
    return common_.finish(s, r, r.acceleration + feedback + s.learned);
  }

 private:
  /// Largest σ; with a wider one a lap is too short to be learned [bins].
  static constexpr double kMostWidth = 32.0;

  void remember(State& s) const noexcept {
    for (std::size_t k = s.given.size() - 1; k > 0; --k) s.given[k] = s.given[k - 1];
    s.given[0] = {s.memory.place, s.learned};
    if (s.known <= Params::kMostLead) ++s.known;
  }

  Common<N> common_;
  V kp_;
  V kv_;
  double learning_;
  double width_;  ///< σ of G [periods]
  int lead_;
  double bins_per_phi_;
  V most_;
};

}  // namespace stribeck::control
