#pragma once
/// Zero-phase-error tracking: a PD loop with a feed-forward that inverts the sampled loop. Only the zero that cannot be inverted
/// remains, and it leaves no phase.
///
///   mass under a held force    x(z)/a(z) = (T²/2)(z+1)/(z−1)²        the zero at −1 has no stable inverse
///   PD on the differenced e    C(z) = k_p + k_v(z−1)/(Tz)            its zero is inside the circle and is cancelled
///   ρ(k) = A(z⁻¹)(1+z) / {4·B(z⁻¹)} r(k+1)   (Tomizuka)      so that      x(k) = (1+z)(1+z⁻¹)/4 r(k) = y(k)
///   the same, worked out:   a(k) = ½{δ²r(k) + δ²r(k+1)}/T² − k_v ė − k_p e,   e = x − y,   y(k) = {r(k−1) + 2r(k) + r(k+1)}/4
///
///   r, x, y [m], a [m/s²], F = m·a + F_friction + load + d̂ [N], δ² second difference, T period [s]. From r to x: phase zero,
///   gain cos²(ωT/2) = 1 − (ωT/2)² + …. Loop and stability: PD, see sampled_loop.hpp; stable(period).
///
/// r(k+1) and r(k+2) lie ahead.
///   delayed        the law follows the reference two periods late, as a control with look-ahead may: exact, and the contour is
///                  the same, but a tracking error counted against r is 2Tṙ larger
///   extrapolated   from r, ṙ, r̈ of now and r̈ of before: y = r + T²r̈/4, feed-forward (3r̈(k) − r̈(k−1))/2; in time, phase and
///                  gain of x off by O((ωT)²·ω²/k_p), a millionth where the path is smooth
/// Source: Tomizuka 1987, doi:10.1115/1.3143822.
/// Not modelled: zeros of the drive (current loop, axial mode).
/// Real time: safe; the constructor configure only.

#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/control/setup.hpp>

namespace stribeck::control {

enum class Preview { kExtrapolated, kDelayed };

}  // namespace stribeck::control

template <>
struct stribeck::EnumNames<stribeck::control::Preview> {
  static constexpr std::array names{
      std::pair{stribeck::control::Preview::kExtrapolated, std::string_view{"extrapolated"}},
      std::pair{stribeck::control::Preview::kDelayed, std::string_view{"delayed"}}};
};

namespace stribeck::control {

template <std::size_t N>
class Zpetc;

struct ZpetcParams {
  template <std::size_t N>
  using Controller = Zpetc<N>;
  static constexpr std::string_view kKind = "zpetc";
  static constexpr std::string_view kLabel = "zero-phase-error tracking";

  PerAxis kp{1600.0};
  PerAxis kv{80.0};
  Preview preview = Preview::kExtrapolated;

  static constexpr auto fields() {
    return std::tuple{field("kp", &ZpetcParams::kp, quantity("1/s2", "1/s2").positive(),
                            "proportional gains, one per axis; the last one applies to the others too")
                          .or_default(),
                      field("kv", &ZpetcParams::kv, quantity("1/s", "1/s").positive(),
                            "derivative gains, in the same order")
                          .or_default(),
                      field("preview", &ZpetcParams::preview,
                            "reference ahead: extrapolated, or delayed (exact, two periods late)")
                          .or_default()};
  }

  /// Parameters for double poles [rad/s].
  static constexpr ZpetcParams critical(double omega) noexcept {
    ZpetcParams p;
    p.kp = {omega * omega};
    p.kv = {2.0 * omega};
    return p;
  }

  /// Whether it is stable when sampled with this period [s].
  [[nodiscard]] constexpr bool stable(double period) const noexcept {
    const auto p = spread<kMostAxes>(kp);
    const auto v = spread<kMostAxes>(kv);
    for (std::size_t n = 0; n < kMostAxes; ++n) {
      if (!sampled_loop_stable(p[n], v[n], 0.0, period)) return false;
    }
    return true;
  }
};

template <std::size_t N>
class Zpetc {
 public:
  using Params = ZpetcParams;
  /// A past sample of the reference.
  struct Past {
    Vec<double, N> position;      ///< [m]
    Vec<double, N> velocity;      ///< [m/s]
    Vec<double, N> acceleration;  ///< [m/s²]
  };
  struct State : Common<N>::State {
    std::array<Past, 3> past;  ///< newest first
    bool has_past = false;
    int missed = 0;  ///< periods since the newest one, but for this one
  };

  Zpetc(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, ErrorRate::kDifferenceOfError),
        kp_(spread<N>(params.kp)),
        kv_(spread<N>(params.kv)),
        delayed_(params.preview == Preview::kDelayed) {}

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  Vec<double, N> step(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    double sum = 0.0;  // sum of what will be stored
    for (std::size_t i = 0; i < N; ++i) sum += r.position[i] + r.velocity[i] + r.acceleration[i];
    miss(s, s.periods - 1);
    if (!isfinite(sum)) {
      miss(s, 1);
      common_.begin(s, r, measured);  // tells it
      return s.force;
    }
    const std::array<Past, 3> past = s.has_past ? until_now(s, r) : before(r);
    path::PathPoint<N> y = r;
    Vec<double, N> feedforward;
    const double t = common_.period();
    for (std::size_t i = 0; i < N; ++i) {
      if (delayed_) {
        const double r0 = past[2].position[i];
        const double r1 = past[1].position[i];
        const double r2 = past[0].position[i];
        const double r3 = r.position[i];
        y.position[i] = 0.25 * (r0 + 2.0 * r1 + r2);
        y.velocity[i] = past[1].velocity[i];
        y.acceleration[i] = past[1].acceleration[i];
        feedforward[i] = 0.5 * ((r2 - 2.0 * r1 + r0) + (r3 - 2.0 * r2 + r1)) / (t * t);
      } else {
        y.position[i] = r.position[i] + 0.25 * t * t * r.acceleration[i];
        feedforward[i] = 1.5 * r.acceleration[i] - 0.5 * past[0].acceleration[i];
      }
    }
    if (!common_.begin(s, y, measured)) {
      miss(s, 1);
      return s.force;
    }
    s.missed = 0;
    s.past = {Past{r.position, r.velocity, r.acceleration}, past[0], past[1]};
    s.has_past = true;
    const Vec<double, N> e = common_.error(s);
    const Vec<double, N> rate = common_.rate(s);
    Vec<double, N> wanted;
    for (std::size_t i = 0; i < N; ++i) wanted[i] = feedforward[i] - kv_[i] * rate[i] - kp_[i] * e[i];
    return common_.finish(s, y, wanted);
  }

 private:
  static void miss(State& s, int periods) noexcept {
    constexpr int kMany = 1000000;
    s.missed = s.missed + periods < kMany ? s.missed + periods : kMany;
  }

  /// The last three references. Those of periods without one lie on the straight line to r: taken for the newest ones, those before a
  /// missing period would say that the axis accelerates by speed over T.
  [[nodiscard]] std::array<Past, 3> until_now(const State& s, const path::PathPoint<N>& r) const noexcept {
    std::array<Past, 3> past = s.past;
    const int kept = s.missed < 3 ? s.missed : 3;
    for (int k = s.missed - kept + 1; k <= s.missed; ++k) {
      const double share = static_cast<double>(k) / (s.missed + 1);
      const Past& last = s.past[0];
      past = {Past{last.position + share * (r.position - last.position),
                   last.velocity + share * (r.velocity - last.velocity),
                   last.acceleration + share * (r.acceleration - last.acceleration)},
              past[0], past[1]};
    }
    return past;
  }

  /// The samples before the first one, at constant acceleration.
  [[nodiscard]] std::array<Past, 3> before(const path::PathPoint<N>& r) const noexcept {
    std::array<Past, 3> past;
    for (std::size_t k = 0; k < past.size(); ++k) {
      const double back = -common_.period() * static_cast<double>(k + 1);
      past[k] = {r.position + back * r.velocity + (0.5 * back * back) * r.acceleration,
                 r.velocity + back * r.acceleration, r.acceleration};
    }
    return past;
  }

  Common<N> common_;
  Vec<double, N> kp_;
  Vec<double, N> kv_;
  bool delayed_;
};

}  // namespace stribeck::control
