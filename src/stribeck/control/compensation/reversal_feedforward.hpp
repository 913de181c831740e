#pragma once
/// Friction feed-forward whose change after a reversal is a function of distance, as in commercial controls.
///
///   F = g(v, x)·h + viscous + additive, mean over the hold that begins `lead` later     h: share of the level, −1 … 1
///   exponential  h' = (ς − h)·ς/d                d [m] distance, ς = ±1 direction of motion, ' by position
///   table        h = Σ w_i·q_i,  q_i' = 2/s_i, held within ±1     knots p(s_i), w_i = s_i·(slope of p before − after s_i)
///
///   p(s): share of the reversal that is done after a distance s; after a full reversal h = −1 + 2·p(s). The q_i are the stops
///   of Prandtl and Ishlinskii: from rest h = p(2s) (Masing), a partial reversal starts from the present h, closed loops are
///   forgotten. If the levels of the directions differ, h is rescaled at the reversal, so that the force does not jump.
///
/// Defaults come from the model: LuGre gives d = g/σ0; GMS its elements, s_i = 2·α_i·g/k_i, w_i = α_i; where friction differs from
/// place to place, with g and stiffness of the place (friction/places.hpp). At rest the start is h = 0,
/// in motion h = ς. h depends on distance, not on time: it keeps its value in dwell. A move of length s < short_move changes h by
/// s/short_move of that; rate_limit bounds the change of g·h. Scales of adaptation as in friction_feedforward.hpp.
/// Sign: positive for v > 0, as friction. Source: Prandtl 1928, doi:10.1002/zamm.19280080202; Masing 1926; the manuals listed in
/// docs/theory/reversal.md.
/// Not modelled: damping σ1 and attraction C of the dynamics; LuGre's lag of the level; dwell time. A stop with a step of
/// acceleration looks like a reversal until it happens, by v̇·(lead + T)²/2 of travel.
/// Real time: safe, 1 to 9 evaluations of the map; the constructor configure only.
/// Errors: an input that is not finite gives the last force.

#include <optional>
#include <stribeck/control/compensation/friction_feedforward.hpp>
#include <stribeck/core/fields.hpp>

namespace stribeck::control {

/// One point of a build-up: share of the reversal that is completed after a distance.
struct BuildUpPoint {
  double distance = 0.0;
  double share = 1.0;

  static constexpr auto fields() {
    return std::tuple{
        field("distance", &BuildUpPoint::distance, quantity("m", "um").not_negative(),
              "distance since the reversal; 0 with a share: that share changes at once"),
        field("share", &BuildUpPoint::share, pure_number().not_negative().at_most(2.0),
              "share of the change of friction that is done; above 1 it overshoots, the last one is 1")};
  }
};

struct ReversalParams {
  static constexpr std::size_t kMostPoints = 8;
  /// d = g/σ0 is 2.9 to 5 µm in machines/, 4 µm in the middle; manuals give a few µm.
  static constexpr double kUsualDistance = 4e-6;

  std::optional<double> distance;
  FixedVector<BuildUpPoint, kMostPoints> build_up;
  double lead = 0.0;
  std::optional<double> rate_limit;
  std::optional<double> short_move;

  static constexpr auto fields() {
    using P = ReversalParams;
    return std::tuple{
        field("distance", &P::distance, quantity("m", "um").positive(),
              "distance in which friction builds up to 1 − 1/e of its change; left out: that of the "
              "model's pre-sliding, 4 um for a model without")
            .or_default(),
        field("build_up", &P::build_up, "build-up as a table, at most eight points, in place of distance")
            .or_default(),
        field("lead", &P::lead, quantity("s", "ms").not_negative().at_most(0.02),
              "how much earlier friction is given, for the lag of the current loop")
            .or_default(),
        field("rate_limit", &P::rate_limit, quantity("N/s", "N/s").positive(),
              "fastest change of the part that reverses; left out: any")
            .or_default(),
        field("short_move", &P::short_move, quantity("m", "um").positive(),
              "moves shorter than this get a smaller change of friction; left out: none do")
            .or_default()};
  }

  /// ∫(1 − p) ds of a build-up that is given or assumed: d of the exponential that leaves the same impulse at constant speed [m].
  [[nodiscard]] double mean_distance() const noexcept {
    if (build_up.empty()) return distance.value_or(kUsualDistance);
    double sum = 0.0;
    BuildUpPoint before{0.0, 0.0};
    for (const auto& point : build_up) {
      sum += (point.distance - before.distance) * (1.0 - 0.5 * (before.share + point.share));
      before = point;
    }
    return sum;
  }

  template <class Report>
  void validate(Report&& report) const {
    if (build_up.empty()) return;
    if (distance) report("distance", "leave out this or build_up: both define how friction builds up");
    double before = -1.0;
    for (const auto& point : build_up) {
      if (!(point.distance > before)) {
        report("build_up", "distances must rise from point to point");
        return;
      }
      before = point.distance;
    }
    if (build_up[build_up.size() - 1].share != 1.0)
      report("build_up", "the share of the last point must be 1: friction is then fully reversed");
  }
};

class ReversalFeedforward {
 public:
  static constexpr std::size_t kMostElements = friction::kMostStops;
  static_assert(kMostElements >= ReversalParams::kMostPoints);

  /// Hysteresis at one point of the motion.
  struct Memory {
    double direction = 0.0;  ///< ς of the last motion; 0: none yet
    double share = 0.0;      ///< h, exponential
    std::array<double, kMostElements> element{};
    double travel = 0.0;   ///< since the last turn [m]
    double at_turn = 0.0;  ///< h at that turn, corrected for a short move
  };

  struct State {
    Memory memory;
    double position = 0.0;  ///< of the reference for which this memory holds [m]
    double velocity = 0.0;  ///< [m/s]
    bool started = false;
    double share = 0.0;                ///< h at the end of the last hold
    FrictionFeedforward::Force force;  ///< last output; its `bristle` is g·h
  };

  ReversalFeedforward() = default;
  ReversalFeedforward(const ReversalParams& params, const friction::Model& model, double period) noexcept
      : params_(params), model_(model), period_(period) {
    const auto level_of = [&](double v) noexcept {
      return std::visit([&](const auto& map) noexcept { return map.parts(v, 0.0).level; }, model.steady);
    };
    const std::array<double, 2> levels{level_of(-kBarelyMoving), level_of(kBarelyMoving)};
    if (!params_.build_up.empty()) {
      from_table();
    } else if (params_.distance) {
      distance_ = *params_.distance;
    } else if (const auto own = friction::build_up_of(model_.dynamics)) {
      stretch_ = levels;
      own_ = true;
      distance_ = own->distance;
      elements_ = own->stops;
    }
  }

  /// One period; returns the mean over the hold [N]. `moving` [m/s] is the reference velocity at the sample; at the first step it
  /// tells whether the axis moves.
  FrictionFeedforward::Force step(State& s, const MotionAhead& r, double moving,
                                  const FrictionScales& scales = {}) const noexcept {
    State next = s;
    follow(next, r, moving, scales);
    Memory ahead = next.memory;
    if (params_.lead > 0.0) along(ahead, r, 0.0, params_.lead, scales, nullptr);
    const MotionAhead hold = r.later(params_.lead);
    FrictionFeedforward::Force mean;
    if (steady(ahead, hold)) {
      add(mean, ahead, hold, 0.5 * period_, 1.0, scales);
    } else {
      along(ahead, hold, 0.0, period_, scales, &mean);
    }
    if (params_.rate_limit && s.started) {
      const double most = *params_.rate_limit * period_;
      mean.bristle = clamp_to(mean.bristle, s.force.bristle - most, s.force.bristle + most);
    }
    next.share = given(ahead);
    next.force = mean;
    const double sum =
        mean.sum() + next.share + next.memory.travel + next.memory.share + next.position + next.velocity;
    if (isfinite(sum)) s = next;
    return s.force;
  }

  [[nodiscard]] const friction::Model& model() const noexcept { return model_; }

 private:
  /// Replaces a velocity of 0 when the level of a direction is needed [m/s].
  static constexpr double kBarelyMoving = 1e-12;
  /// Remaining change at which the exponential counts as complete.
  static constexpr double kBuiltUp = 1e-9;

  void from_table() noexcept {
    const auto& p = params_.build_up;
    double slope = 0.0;
    for (std::size_t k = p.size(); k-- > 0;) {
      const double s = p[k].distance;
      if (s == 0.0) {
        elements_.push_back({p[k].share, 0.0});
        continue;
      }
      const double s0 = k > 0 ? p[k - 1].distance : 0.0;
      const double p0 = k > 0 ? p[k - 1].share : 0.0;
      const double steeper = (p[k].share - p0) / (s - s0);
      elements_.push_back({(steeper - slope) * s, s});
      slope = steeper;
    }
  }

  [[nodiscard]] double level(double direction, double x, const FrictionScales& scales) const noexcept {
    const double v = direction * kBarelyMoving;
    return model_.parts(v, x).level * scales.level(v);
  }

  /// h without the correction for short moves.
  [[nodiscard]] double built(const Memory& m) const noexcept {
    if (elements_.empty()) return m.share;
    double sum = 0.0;
    for (std::size_t i = 0; i < elements_.size(); ++i) sum += elements_[i].weight * m.element[i];
    return sum;
  }
  /// h with that correction: a short move changes it less.
  [[nodiscard]] double given(const Memory& m) const noexcept {
    const double h = built(m);
    if (!params_.short_move || m.travel >= *params_.short_move) return h;
    return m.at_turn + (h - m.at_turn) * (m.travel / *params_.short_move);
  }
  [[nodiscard]] bool fully_built(const Memory& m) const noexcept {
    if (params_.short_move && m.travel < *params_.short_move) return false;
    if (elements_.empty()) return m.share == m.direction;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      if (m.element[i] != m.direction) return false;
    }
    return true;
  }

  /// Moves the hysteresis by `distance` ≥ 0 in a direction ±1, from position x.
  void move(Memory& m, double direction, double distance, double x,
            const FrictionScales& scales) const noexcept {
    if (direction != m.direction) turn(m, direction, x, scales);
    if (!(distance > 0.0)) return;
    double stretch = stretch_[direction < 0.0 ? 0 : 1] * scales.level(direction) / scales.stiffness;
    if (own_ && !model_.places.empty()) {
      const friction::Shares here = friction::shares_at(model_.places, x);
      stretch *= here.level / here.stiffness;
    }
    m.travel += distance;
    if (elements_.empty()) {
      m.share = direction - (direction - m.share) * exp(-distance / (distance_ * stretch));
      if (abs(direction - m.share) < kBuiltUp) m.share = direction;
      return;
    }
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      const double reach = elements_[i].reach * stretch;
      const double q = reach > 0.0 ? m.element[i] + direction * 2.0 * distance / reach : direction;
      m.element[i] = direction > 0.0 ? min_of(q, 1.0) : max_of(q, -1.0);
    }
  }
  void turn(Memory& m, double direction, double x, const FrictionScales& scales) const noexcept {
    // The force must not jump: the same force is a different share of a different level.
    const double to = level(direction, x, scales);
    const double ratio = m.direction == 0.0 || !(to > 0.0) ? 1.0 : level(m.direction, x, scales) / to;
    m.at_turn = given(m) * ratio;
    m.share *= ratio;
    for (double& q : m.element) q *= ratio;
    m.travel = 0.0;
    m.direction = direction;
  }

  /// Advances the memory from the beginning of the last hold to that of this one.
  void follow(State& s, const MotionAhead& r, double moving, const FrictionScales& scales) const noexcept {
    if (!s.started) {
      s.started = true;
      s.memory.direction = sign(moving);
      s.memory.share = s.memory.at_turn = s.memory.direction;
      s.memory.element.fill(s.memory.direction);
      if (params_.short_move && moving != 0.0) s.memory.travel = *params_.short_move;
    } else {
      double begin = s.position;
      if (s.velocity * r.velocity < 0.0) {
        // The turn lies where the velocity, taken as linear, is zero.
        const double reach = 0.5 * period_ * s.velocity * s.velocity / abs(s.velocity - r.velocity);
        const double farthest = s.position + sign(s.velocity) * reach;
        if ((r.position - farthest) * r.velocity >= 0.0) {
          move(s.memory, sign(s.velocity), reach, begin, scales);
          begin = farthest;
        }
      }
      if (r.position != begin)
        move(s.memory, sign(r.position - begin), abs(r.position - begin), begin, scales);
    }
    s.position = r.position;
    s.velocity = r.velocity;
  }

  /// True when the build-up is complete and the axis does not turn within the hold.
  [[nodiscard]] bool steady(const Memory& m, const MotionAhead& r) const noexcept {
    if (!turns_within(r, 0.0, period_).empty()) return false;
    const double direction = sign(r.velocity_at(0.5 * period_));
    return direction == 0.0 || (direction == m.direction && fully_built(m));
  }

  /// Instants within (from, to) at which the velocity changes its sign, in order.
  static FixedVector<double, 2> turns_within(const MotionAhead& r, double from, double to) noexcept {
    FixedVector<double, 2> turns;
    const auto keep = [&](double t) noexcept {
      if (t > from && t < to) turns.push_back(t);
    };
    if (r.jerk == 0.0) {
      if (r.acceleration != 0.0) keep(-r.velocity / r.acceleration);
      return turns;
    }
    const double inside = r.acceleration * r.acceleration - 2.0 * r.jerk * r.velocity;
    if (!(inside > 0.0)) return turns;  // a double root touches 0 and is no turn
    const double q = -(r.acceleration + (r.acceleration < 0.0 ? -1.0 : 1.0) * sqrt(inside));
    const double one = q / r.jerk;
    const double other = 2.0 * r.velocity / q;
    keep(min_of(one, other));
    keep(max_of(one, other));
    return turns;
  }

  /// Advances the memory along r between two instants. With `mean`, adds the mean of the friction between them to it; without (null),
  /// the memory alone moves on. Each part between two turns has one direction of motion.
  void along(Memory& m, const MotionAhead& r, double from, double to, const FrictionScales& scales,
             FrictionFeedforward::Force* mean) const noexcept {
    // Gauss's rule with three points: exact for polynomials up to τ⁵ on each part without a turn.
    constexpr std::array kNode{0.11270166537925831, 0.5, 0.88729833462074169};
    constexpr std::array kWeight{5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0};
    const auto turns = turns_within(r, from, to);
    double begin = from;
    for (std::size_t part = 0; part <= turns.size(); ++part) {
      const double end = part < turns.size() ? turns[part] : to;
      const double direction = sign(r.velocity_at(0.5 * (begin + end)));
      double reached = begin;  // instant to which the memory has moved
      const auto move_to = [&](double until) {
        if (direction == 0.0) return;
        const double moved = (r.position_at(until) - r.position_at(reached)) * direction;
        move(m, direction, max_of(moved, 0.0), r.position_at(reached), scales);
        reached = until;
      };
      for (std::size_t i = 0; i < kNode.size() && mean != nullptr; ++i) {
        const double node = begin + kNode[i] * (end - begin);
        move_to(node);
        add(*mean, m, r, node, kWeight[i] * (end - begin) / (to - from), scales);
      }
      move_to(end);
      begin = end;
    }
  }

  /// Adds the friction at the instant t of r with the memory there.
  void add(FrictionFeedforward::Force& mean, const Memory& m, const MotionAhead& r, double t, double weight,
           const FrictionScales& scales) const noexcept {
    const double direction = m.direction < 0.0 ? -1.0 : 1.0;
    const double v = direction * max_of(direction * r.velocity_at(t), kBarelyMoving);
    const auto p = model_.parts(v, r.position_at(t));
    mean.bristle += weight * p.level * scales.level(v) * given(m);
    mean.viscous += weight * scales.viscous * p.viscous;
    mean.additive += weight * p.additive;
  }

  ReversalParams params_;
  friction::Model model_;
  double period_ = 1e-3;
  double distance_ = ReversalParams::kUsualDistance;  ///< [m], or [m/N] of level
  std::array<double, 2> stretch_{1.0, 1.0};  ///< of distances, backward and forward [-], or level [N]
  FixedVector<friction::Stop, kMostElements> elements_;  ///< reach in [m], or [m/N] of level
  bool own_ = false;  ///< the build-up is that of the model's dynamics, and per level
};

}  // namespace stribeck::control
