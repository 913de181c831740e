#pragma once
/// Judges each sample of an encoder before a controller sees it, and replaces an impossible one by a prediction.
///
///   p₁ = r + ê + T·ê'                 the tracking error continues as before: ê, ê' by an α-β filter
///   p₂ = x + T·v                      the axis continues as over the last period
///   good    x_k finite, within jump + j·A·T² of p₁ or p₂, and no farther from the last good one than three times the speed limit
///   else    p₁ replaces it (p₂ where p₁ has been off twice), j ← j + 1, counted; more than n in a row are a fault
///
///   j samples bridged so far, A T² see limits.hpp. Two predictions, because an axis that is accelerated fully leaves p₁, and p₂ is
///   off after a small wild sample that was let through. A is larger while a large force acts (limits.hpp). A sample equal to the one
///   before is not good either where p₁ and p₂ both lie a quarter of the gate away, and 1.5 times the greatest of the last second differences:
///   no axis stops like that, and dropped samples are bridged. p₁ alone says nothing: a reference may leave an axis that friction holds.
///   Nor do samples beside the turning point of an axis that vibrates.
///   doubt ← doubt + 1 for a bridged sample, doubt − 1/4 for a good one: above 20, more than a fifth are bad.
/// A good sample is passed on unchanged, bit for bit. It is doubtful when it is the first one that lies farther from p₁ than a quarter
/// of the gate, because a small wild sample looks like that. A second one shows that the axis has left p₁.
/// Source: validation gates of tracking filters, Bar-Shalom, Li, Kirubarajan 2001, Estimation with Applications to Tracking and
/// Navigation, ch. 2; the two gates are Stribeck's own.
/// Not modelled: the first two samples, which cannot be compared with anything; wild samples within a quarter of the gate.
/// Real time: safe.

#include <array>
#include <cstdint>
#include <stribeck/control/supervision/fault.hpp>
#include <stribeck/control/supervision/limits.hpp>

namespace stribeck::control {

class EncoderCheck {
 public:
  struct State {
    double used = 0.0;        ///< value that was passed on last [m]
    double good = 0.0;        ///< last sample that was accepted [m]
    double raw = 0.0;         ///< last sample [m]
    double velocity = 0.0;    ///< over the last period [m/s]
    double smooth = 0.0;      ///< the same under a low-pass of two periods [m/s]
    double error = 0.0;       ///< ê [m]
    double error_rate = 0.0;  ///< ê' [m/s]
    double reference = 0.0;   ///< prediction of the reference with constant acceleration [m]
    double doubt = 0.0;
    int off = 0;       ///< good samples in a row for which p₁ was off by more than a quarter of the gate
    int known = 0;     ///< good samples, up to 2
    int in_a_row = 0;  ///< bridged samples in a row
    int same = 0;      ///< samples equal to the one before, in a row
    // Greatest ones of this window of periods and of the last window.
    std::array<double, 2> pushed{};  ///< |f − load| [N]
    std::array<double, 2> bent{};    ///< second difference of good samples [m]
    int window = 0;                  ///< periods of this window
    bool finite = true;              ///< whether the last sample was finite
    std::uint32_t bridged = 0;
  };

  /// One sample of the encoder [m]; reference [m], [m/s], [m/s²]; `periods` since the last sample. Returns the value to use.
  ///
  /// Three distances decide: `gate`, how far a sample may lie from a prediction that supervision believes; `reach`, the same after the
  /// largest force of the last periods, which may have moved the axis farther; `moves`, how far both predictions say that the axis went.
  static double step(State& s, const SupervisionLimits& l, double sample, double r, double rate,
                     double acceleration, int periods = 1) noexcept {
    const double t = l.period * periods;
    turn_window(s, l);
    // A reference that is no number must not enter the prediction: no later sample would agree with it.
    if (!isfinite(r + rate + acceleration)) r = s.reference, rate = acceleration = 0.0;
    // Where the reference jumps (a new programme), the axis does not: ê changes by the jump, so that the first prediction, r + ê + T·ê',
    // equals the second one, x + T·v.
    if (s.known == 2 && periods == 1 && !(abs(r - s.reference) <= l.noise + kJumps * l.growth))
      s.error = s.used + l.period * s.velocity - l.period * s.error_rate - r;
    s.reference = r + l.period * (rate + 0.5 * l.period * acceleration);
    // p₁ and p₂ of the header.
    const double by_error = r + s.error + t * s.error_rate;
    const double by_speed = s.used + t * s.velocity;
    const double prediction = s.known == 0 ? r : s.off < kLeaves ? by_error : by_speed;
    const double growth = l.growth * periods * periods;
    const double gate = l.noise + growth * (1.0 + s.in_a_row);
    const double reach =
        l.noise + l.growth_after(max_of(s.pushed[0], s.pushed[1])) * periods * periods * (1.0 + s.in_a_row);
    s.finite = isfinite(sample);
    // An axis may stand still for months.
    s.same = sample == s.raw ? s.same + (s.same < kEnough ? 1 : 0) : 0;
    s.raw = sample;
    const double far = abs(sample - s.good);
    const bool near = abs(sample - by_error) <= reach || abs(sample - by_speed) <= reach;
    const double moves = min_of(abs(by_error - s.used), abs(by_speed - s.used));
    const bool repeated = s.known == 2 && s.same > 0 && moves > kTrusted * (l.noise + growth) &&
                          moves > kBent * max_of(s.bent[0], s.bent[1]);
    const bool slow = s.known == 0 || far <= l.noise + kFaster * t * l.speed * (1.0 + s.in_a_row);
    if (s.finite && slow && !repeated && (near || s.known < 2)) {
      believe(s, sample, r, rate, sample - by_error, gate, t);
      s.doubt = max_of(s.doubt - kRelief, 0.0);
    } else {
      bridge(s, prediction, r, t);
      s.doubt += 1.0;
    }
    return s.used;
  }

  /// The force of the coming period less the load [N].
  static void push(State& s, double net) noexcept { s.pushed[0] = max_of(s.pushed[0], abs(net)); }

  /// Whether the last sample was bridged.
  [[nodiscard]] static bool bridges(const State& s) noexcept { return s.in_a_row > 0; }

  /// Whether the last sample is good but must not be learned from.
  [[nodiscard]] static bool doubts(const State& s) noexcept {
    return s.known == 2 && s.in_a_row == 0 && s.off == 1;
  }

  [[nodiscard]] static Fault judge(const State& s, const SupervisionLimits& l) noexcept {
    if (s.in_a_row > l.samples) {
      if (!s.finite) return Fault::kEncoderLost;
      return s.same >= l.samples ? Fault::kEncoderFrozen : Fault::kEncoderImplausible;
    }
    return s.doubt > kDoubt ? Fault::kEncoderUnreliable : Fault::kNone;
  }

 private:
  static constexpr double kAlpha = 0.6;
  static constexpr double kBeta = 0.25;
  static constexpr double kSmooth = 0.5;
  static constexpr double kTrusted = 0.25;  ///< share of the gate within which a sample corrects p₁
  static constexpr double kBent = 1.5;      ///< room for a second difference that grows
  static constexpr int kLeaves = 2;         ///< samples beyond that in a row, after which p₁ is not used
  static constexpr double kJumps = 4.0;     ///< size of a jump of the reference, in A·T²
  static constexpr double kFaster = 2.0;    ///< than overspeed, which motion_check.hpp reports: impossible
  static constexpr double kRelief = 0.25;
  static constexpr double kDoubt = 20.0;
  static constexpr int kEnough = 1000000;

  /// A force shows in the second difference of samples until two periods after its delay; at 50 Hz and above a vibration turns within
  /// n periods, 10 ms.
  static void turn_window(State& s, const SupervisionLimits& l) noexcept {
    if (s.window++ < l.late_periods + l.samples) return;
    s.window = 1;
    s.pushed = {0.0, s.pushed[0]};
    s.bent = {0.0, s.bent[0]};
  }

  static void believe(State& s, double sample, double r, double rate, double miss, double gate,
                      double t) noexcept {
    if (s.known > 0) {
      const double before = s.velocity;
      // After a bridge the last period is not observed alone, but the mean since the last good sample is.
      s.velocity = (sample - s.good) / (t * (1.0 + s.in_a_row));
      s.smooth = s.known == 1 ? s.velocity : s.smooth + kSmooth * (s.velocity - s.smooth);
      if (s.known == 2) s.bent[0] = max_of(s.bent[0], t * abs(s.velocity - before));
    }
    // A sample that was only just accepted tells nothing about the motion; two do.
    if (s.known < 2 || (!(abs(miss) <= gate) && s.off >= kLeaves) || !isfinite(miss)) {
      s.error = sample - r;
      s.error_rate = s.known > 0 ? s.velocity - rate : 0.0;
    } else {
      const double pull = clamp_to(miss, -kTrusted * gate, kTrusted * gate);
      s.error += t * s.error_rate + kAlpha * pull;
      s.error_rate += kBeta * pull / t;
    }
    s.off = abs(miss) <= kTrusted * gate ? 0 : s.off + 1;
    s.used = s.good = sample;
    s.in_a_row = 0;
    if (s.known < 2) ++s.known;
  }

  static void bridge(State& s, double prediction, double r, double t) noexcept {
    if (s.known > 0) {
      s.velocity = (prediction - s.used) / t;
      s.smooth += kSmooth * (s.velocity - s.smooth);
      s.error = prediction - r;
    }
    s.used = prediction;
    ++s.in_a_row;
    if (s.bridged != UINT32_MAX) ++s.bridged;
  }
};

}  // namespace stribeck::control
