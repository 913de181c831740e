#pragma once
/// On-line correction of the friction model of one axis by recursive least squares.
///
///   ε = G·[ f − F(x, θ) ]             residual: force that the model, driven by the measured motion, does not explain [N]
///   φ = G·∂F/∂θ                       sensitivities, by differences of four models in parallel
///   K = Pφ/(r + φᵀPφ)    θ ← θ + Kε, within bounds    P ← P − KφᵀP + P₀·T/T_m, no variance above P₀
///
///   θ = (ψ₊, ψ₋, χ, ρ, μ, c, s, δ): scale of the level in each direction, of viscous friction, of stiffness; error of the mass
///   as a share; periodic correction c·sin + s·cos at the first eccentric term, as shares of its amplitude; additional delay
///   [periods]. f force on the axis [N], x measured position. G: an observer outside the loop; its lag cancels. r: variance of ε
///   times its correlation (residual_noise.hpp). P₀: variance at the start. T_m: memory [s].
///
///   used   θ·(1 − (σ/θ)⁴) where |θ| > σ, else 0       σ: standard deviation of θ, from P; of ρ at least 0.3/√(reversals)
///
/// Without evidence nothing is corrected. A parameter that is not excited keeps its estimate, and P cannot wind up. Adaptation
/// pauses at rest, at the limit of the drive and while freeze is set; stiffness waits for the first reversal, because the state of the
/// bristles before the first motion is unknown. The model follows the measured motion, because in pre-sliding
/// the missing force shows in the position only. Steps of θ in the feed-forward are removed from φ_δ; otherwise noise looks like a delay.
/// To change: bounds and memory are in AdaptationParams; reasons and measurements in docs/theory/feedforward.md.
/// Source: Ljung, System Identification, 1999, ch. 11.
/// Not modelled: shape of the friction curve beyond level and slope; a period that drifts.
/// Real time: safe, about four steps of the model; the constructor configure only.

#include <stribeck/control/compensation/friction_feedforward.hpp>
#include <stribeck/control/observers/kalman_observer.hpp>
#include <stribeck/control/observers/residual_noise.hpp>
#include <stribeck/core/fields.hpp>
#include <stribeck/friction/axis_model.hpp>

namespace stribeck::control {

struct AdaptationParams {
  /// In a file `adaptation = "on"` stands for the whole table.
  static constexpr std::string_view kShortForm = "enabled";

  bool enabled = false;
  double memory = 20.0;           ///< T_m [s]
  double level_spread = 0.25;     ///< standard deviation of what ψ may be off
  double viscous_spread = 0.25;   ///< of χ
  double stiffness_spread = 0.4;  ///< of ρ
  double mass_spread = 0.15;      ///< of μ
  double delay_spread = 0.5;      ///< of δ [periods]
  double noise_share = 0.05;  ///< least standard deviation of the residual, as a share of the level at rest
  double correlation = 0.05;  ///< correlation time of the residual then [s]

  static constexpr auto fields() {
    using P = AdaptationParams;
    constexpr auto kSpread = pure_number().not_negative();
    const auto when_on = [](auto one) {
      return one.or_default().when([](const P& p) { return p.enabled; }, "goes with enabled = true");
    };
    return std::tuple{
        field("enabled", &P::enabled, "correct the friction model on line").or_default(),
        when_on(field("memory", &P::memory, quantity("s", "s").positive(), "time over which it forgets")),
        when_on(field("level_spread", &P::level_spread, kSpread, "how far the level may be off, as a share")),
        when_on(field("viscous_spread", &P::viscous_spread, kSpread, "the same of viscous friction")),
        when_on(field("stiffness_spread", &P::stiffness_spread, kSpread, "the same of bristle stiffness")),
        when_on(field("mass_spread", &P::mass_spread, kSpread, "the same of the mass")),
        when_on(field("delay_spread", &P::delay_spread, kSpread, "how far the delay may be off, in periods")),
        when_on(field("noise_share", &P::noise_share, pure_number().positive(),
                      "least noise, as a share of the level at rest")),
        when_on(field("correlation", &P::correlation, quantity("s", "ms").positive(),
                      "correlation time of that noise"))};
  }
};

class FrictionRls {
 public:
  static constexpr std::size_t kCount = 8;
  enum Index : std::size_t { kPositive, kNegative, kViscous, kStiffness, kMass, kSine, kCosine, kDelay };
  using Vector = Vec<double, kCount>;

  struct State {
    Vector theta;                              ///< deviations from 1, or from 0 for μ, c and s
    Vector deviation;                          ///< standard deviations of θ
    double residual = 0.0;                     ///< ε of the last step [N]
    double feedforward_change_by_theta = 0.0;  ///< change of the feed-forward by the last step of θ [N]
    ResidualNoise::State noise;
    std::array<FrictionFeedforward::Bristle, 4> bristles;
    bool started = false;
    bool informed = false;   ///< P holds its start
    bool recalled = false;   ///< θ and P come from an earlier run
    double direction = 0.0;  ///< of the motion
    double reversals = 0.0;  ///< seen in all, at most kMostReversals
    bool turned = false;     ///< since this state was made
    double position = 0.0;   ///< where the axis is, within the encoder's step [m]
    double reading = 0.0;    ///< of the encoder [m]
    double jump = 0.0;       ///< least that the encoder has made while the axis hardly moved [m]
    int jumps = 0;
    KalmanObserver::State observer;
    std::array<Vec<double, 3>, kCount> answers;
    Mat<double, kCount> p;
  };

  /// What a run has found out, to be kept over a fault.
  struct Learned {
    Vector theta;
    Vector deviation;
    Mat<double, kCount> p;
    ResidualNoise::State noise;
    bool known = false;
    double reversals = 0.0;
  };
  [[nodiscard]] static Learned learned(const State& s) noexcept {
    return {s.theta, s.deviation, s.p, s.noise, s.informed, s.reversals};
  }
  /// A state that has just been made goes on with that.
  static void recall(State& s, const Learned& l) noexcept {
    s.theta = l.theta;
    s.deviation = l.deviation;
    s.p = l.p;
    s.noise = l.noise;
    s.reversals = l.reversals;
    s.recalled = true;
  }

  FrictionRls() = default;
  /// `delay` [s]: what is assumed of it.
  FrictionRls(const AdaptationParams& params, const friction::AxisModel& model, double encoder_resolution,
              double delay, double period) noexcept
      : params_(params),
        model_(model.friction, period),
        mass_(model.mass),
        period_(period),
        resolution_(encoder_resolution),
        noise_(params.memory, period) {
    if (!params.enabled) return;
    const double level = model.friction.parts(0.0, 0.0).level;
    const double noise = params.noise_share * level;
    // The observer only has to be much faster than the changes that it shall see: it is not in the loop.
    const double bandwidth = min_of(kBandwidth, 0.7 / period);
    // The rounding of the encoder, seen through the observer, is added.
    const double rounding = model.mass * bandwidth * bandwidth / sqrt(12.0);
    const double samples = max_of(1.0, 2.0 * params.correlation / period);
    variance_ = noise * noise * samples;
    rounding_ = rounding * rounding * samples;
    observer_ = KalmanObserver(KalmanObserver::density(bandwidth, encoder_resolution, model.mass),
                               encoder_resolution * encoder_resolution / 12.0, model.mass, period);
    spread_ = {{params.level_spread, params.level_spread, params.viscous_spread, params.stiffness_spread,
                params.mass_spread, 1.0, 1.0, params.delay_spread}};
    // No force acts before it is put out.
    bounds_[kDelay][0] = min_of(bounds_[kDelay][0], delay / period);
    if (model.friction.eccentric.empty()) spread_[kSine] = spread_[kCosine] = 0.0;
    if (!friction::has_pre_sliding(model.friction.dynamics)) spread_[kStiffness] = 0.0;
  }

  /// One period: force [N] that acted on the axis over it, encoder position now [m], velocity [m/s] and acceleration [m/s²] of the
  /// reference in the middle of it. `learn` is false where the force is not what drove the axis.
  /// `change` is that of what was fed forward, over the period, but for what steps of θ changed in it [N]. `bridged`: the position
  /// is a prediction, and nothing is learned from it.
  void step(State& s, double force, double change, double position, double v, double acceleration, bool learn,
            bool bridged = false) const noexcept {
    if (!params_.enabled) return;
    s.feedforward_change_by_theta = 0.0;
    if (!s.informed) {
      s.informed = true;
      s.position = s.reading = position;
      if (!s.recalled) forget(s);
      return;
    }
    // Somewhere within the encoder's step: as far as the reference went, unless the encoder says otherwise. Its own steps would
    // make bristles creep.
    if (bridged) s.reading = position;
    const double resolution = resolution_of(s, position, v);
    const double before = s.position;
    s.position = clamp_to(before + period_ * v, position - 0.5 * resolution, position + 0.5 * resolution);
    const double travel = s.position - before;
    constexpr double kStep = 1e-3;
    std::array<FrictionScales, 4> scales;
    scales.fill(estimated(s));
    scales[1].positive += kStep;
    scales[2].negative += kStep;
    scales[3].stiffness += kStep;
    const auto f = model_.follow(s.bristles.data(), scales.data(), 4, s.started, travel, v, position);
    // What the force of the model changes by, for each parameter, before and behind the filter G.
    Vector force_by_theta;
    force_by_theta[kPositive] = (f[1].bristle - f[0].bristle) / kStep;
    force_by_theta[kNegative] = (f[2].bristle - f[0].bristle) / kStep;
    force_by_theta[kViscous] = f[0].viscous / scales[0].viscous;
    force_by_theta[kStiffness] = turned(s, v) ? (f[3].bristle - f[0].bristle) / kStep : 0.0;
    force_by_theta[kMass] = mass_ * acceleration;
    const auto wave = periodic(position - 0.5 * travel);
    force_by_theta[kSine] = wave[0];
    force_by_theta[kCosine] = wave[1];
    force_by_theta[kDelay] = change;
    const double model = f[0].sum() + s.theta[kMass] * force_by_theta[kMass] + s.theta[kSine] * wave[0] +
                         s.theta[kCosine] * wave[1] + s.theta[kDelay] * force_by_theta[kDelay];
    if (bridged) {
      observer_.predict(s.observer, force - model);
      for (std::size_t i = 0; i < kCount; ++i) observer_.predicted_answer(s.answers[i], force_by_theta[i]);
      return;
    }
    s.residual = observer_.step(s.observer, force - model, s.position);
    Vector phi;
    for (std::size_t i = 0; i < kCount; ++i) phi[i] = observer_.answer(s.answers[i], force_by_theta[i]);
    if (v == 0.0) settle(s, position, scales);
    if (!learn || v == 0.0) return;
    // P·φ and the gain
    Vector pf;
    for (std::size_t i = 0; i < kCount; ++i) pf[i] = dot(s.p[i], phi);
    const double predicted_variance = max_of(dot(phi, pf), 0.0);
    const double least = variance_ + rounding_ * resolution * resolution;
    const double sum = noise_.step(s.noise, s.residual, predicted_variance, least) + predicted_variance;
    const double share = s.residual / sum;
    Vector used;
    for (std::size_t i = 0; i < kCount; ++i) used[i] = evident(s, i);
    for (std::size_t i = 0; i < kCount; ++i) {
      s.theta[i] = clamp_to(s.theta[i] + share * pf[i], -bounds_[i][0], bounds_[i][1]);
      for (std::size_t k = 0; k < kCount; ++k) s.p[i][k] -= pf[i] * pf[k] / sum;
    }
    for (std::size_t i = 0; i < kCount; ++i) {
      const double most = spread_[i] * spread_[i];
      s.p[i][i] += most * period_ / params_.memory;
      if (s.p[i][i] > most) {
        // Scaled with its row and column, so that P stays positive.
        const double shrink = sqrt(most / s.p[i][i]);
        for (std::size_t k = 0; k < kCount; ++k) {
          s.p[i][k] *= shrink;
          s.p[k][i] *= shrink;
        }
      }
      s.deviation[i] = sqrt(max_of(s.p[i][i], 0.0));
      s.feedforward_change_by_theta += (evident(s, i) - used[i]) * force_by_theta[i];
    }
  }

  /// Corrections of the feed-forward, as far as there is evidence for them.
  [[nodiscard]] FrictionScales scales(const State& s) const noexcept {
    return {1.0 + evident(s, kPositive), 1.0 + evident(s, kNegative), 1.0 + evident(s, kViscous),
            1.0 + evident(s, kStiffness)};
  }
  /// What to add to the force for the mass and the periodic term [N], for a reference there and with that acceleration.
  [[nodiscard]] double extra(const State& s, double position, double acceleration) const noexcept {
    const auto wave = periodic(position);
    return evident(s, kMass) * mass_ * acceleration + evident(s, kSine) * wave[0] +
           evident(s, kCosine) * wave[1];
  }
  /// By how much more the force acts late than assumed [s].
  [[nodiscard]] double delay(const State& s) const noexcept { return evident(s, kDelay) * period_; }
  /// Begins again without corrections.
  void forget(State& s) const noexcept {
    s.theta = {};
    s.reversals = 0.0;
    s.p = {};
    for (std::size_t i = 0; i < kCount; ++i) s.p[i][i] = spread_[i] * spread_[i];
    s.deviation = spread_;
  }
  /// Takes back half of the corrections.
  void halve(State& s) const noexcept { s.theta = 0.5 * s.theta; }

  [[nodiscard]] bool enabled() const noexcept { return params_.enabled; }

 private:
  /// Whether the motion has reversed since it began. How far the bristles were deflected before the first motion is not known, so the
  /// force at its start says nothing of their stiffness.
  static bool turned(State& s, double v) noexcept {
    if (v * s.direction < 0.0) {
      s.reversals = min_of(s.reversals + 1.0, kMostReversals);
      s.turned = true;
    }
    if (v != 0.0) s.direction = sign(v);
    return s.turned;
  }
  static constexpr double kMostReversals = 100.0;
  /// What one reversal may say too much or too little of the stiffness: no law of bristles is exact, and stiffness differs from place to
  /// place. All rows of a reversal share that error, which P does not know.
  static constexpr double kOneReversal = 0.3;

  /// The part of a correction that the data support: none below one standard deviation, 94 % at two.
  [[nodiscard]] static double evident(const State& s, std::size_t i) noexcept {
    const double theta = s.theta[i];
    double deviation = s.deviation[i];
    if (i == kStiffness) deviation = max_of(deviation, kOneReversal / sqrt(max_of(s.reversals, 1.0)));
    if (!(abs(theta) > deviation)) return 0.0;
    const double share = deviation * deviation / (theta * theta);
    return theta * (1.0 - share * share);
  }

  /// The model as estimated, for the residual.
  [[nodiscard]] static FrictionScales estimated(const State& s) noexcept {
    return {1.0 + s.theta[kPositive], 1.0 + s.theta[kNegative], 1.0 + s.theta[kViscous],
            1.0 + s.theta[kStiffness]};
  }

  /// At rest friction holds whatever the axis is left with. What the observer sees of that goes into the bristles, or the next start
  /// would take it for friction that has changed.
  void settle(State& s, double position, const std::array<FrictionScales, 4>& scales) const noexcept {
    const double share = period_ / (period_ + kSettle);
    for (std::size_t i = 0; i < scales.size(); ++i)
      model_.shift(s.bristles[i], share * s.residual, position, scales[i]);
  }
  static constexpr double kSettle = 0.1;  ///< time constant of that [s]

  [[nodiscard]] std::array<double, 2> periodic(double x) const noexcept {
    const auto& terms = model_.model().eccentric;
    if (terms.empty()) return {};
    const double angle = 2.0 * kPi * x / terms[0].period - terms[0].phase;
    return {terms[0].amplitude * sin(angle), terms[0].amplitude * cos(angle)};
  }

  /// Step of the encoder: as declared, or coarser if it jumps farther than that while the axis hardly moves [m].
  double resolution_of(State& s, double reading, double v) const noexcept {
    const double jump = abs(reading - s.reading);
    s.reading = reading;
    // A part of the declared step is rounding of the numbers themselves.
    if (jump > 0.5 * resolution_ && jump > 2.0 * abs(v) * period_) {
      s.jump = s.jumps == 0 ? jump : min_of(s.jump, jump);
      if (s.jumps < kEnough) ++s.jumps;
    }
    return s.jumps < kEnough ? resolution_ : max_of(resolution_, s.jump);
  }
  static constexpr int kEnough = 2;

  static constexpr double kBandwidth = 140.0;  ///< of the observer G [1/s]
  /// How far θ may go, downwards and upwards.
  static constexpr std::array<std::array<double, 2>, kCount> kBounds{
      {{0.6, 1.0}, {0.6, 1.0}, {0.9, 1.0}, {0.7, 2.0}, {0.4, 0.4}, {2.0, 2.0}, {2.0, 2.0}, {1.0, 2.0}}};

  AdaptationParams params_;
  FrictionFeedforward model_;
  KalmanObserver observer_;
  Vector spread_;
  std::array<std::array<double, 2>, kCount> bounds_ = kBounds;
  double mass_ = 1.0;
  double period_ = 1e-3;
  double resolution_ = 0.0;
  ResidualNoise noise_;
  double variance_ = 1.0;  ///< least r [N²]
  double rounding_ = 0.0;  ///< variance over square of the encoder's step [N²/m²]
};

}  // namespace stribeck::control
