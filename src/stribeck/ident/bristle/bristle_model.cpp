#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stribeck/ident/bristle/bristle_model.hpp>
#include <type_traits>

namespace stribeck::ident::bristle {
namespace {

constexpr double kFarFromRest =
    12.0;  ///< times the speed below which the map was not measured: no rise is left

template <class Case>
class ModelOf final : public Model {
 public:
  ModelOf(const Setting& setting, int own) : Model(setting, own) {}

  void evaluate(const VectorXd& p, VectorXd& e, MatrixXd* jacobian, bool white) const override {
    const BristlePath& path = *setting_->path;
    e.resize(static_cast<Index>(path.rows.size()));
    if (jacobian != nullptr) {
      jacobian->resize(e.size(), parameters());
      jacobian->rightCols(path.starts)
          .setZero();  // a piece writes every column but those of the other starts
    }
    Index row = 0;
    int start = 0;
    for (const PathPiece& piece : path.pieces) {
      const int my_start = piece.unknown_start ? own_ + kCommon + start++ : -1;
      if (jacobian != nullptr) {
        using Jet = ceres::Jet<double, Case::kMostOwn + kSimulated>;
        this->template simulate<Jet>(piece, p, my_start);
      } else {
        this->template simulate<double>(piece, p, my_start);
      }
      const Index columns = jacobian != nullptr ? columns_of_raw() : 1;
      const std::size_t ticks = piece.force.size();
      if (filtered_.size() < static_cast<Index>(ticks)) filtered_.resize(static_cast<Index>(ticks));
      for (Index c = 0; c < columns; ++c) {
        const Index to = c == 0 ? 0 : column_of(c - 1, my_start);
        if (to < 0) continue;
        filter_like(path, white, ticks, raw_.data() + c * static_cast<Index>(ticks), filtered_.data(), work_);
        double* out = c == 0 ? e.data() + row : jacobian->col(to).data() + row;
        for (std::size_t i = 0; i < piece.rows.size(); ++i)
          out[i] = filtered_(static_cast<Index>(piece.rows[i]));
      }
      row += static_cast<Index>(piece.rows.size());
    }
  }

  void follow(const VectorXd& p, const friction::AxisModel& known, BristlePath& path) const override {
    int start = 0;
    for (PathPiece& piece : path.pieces) {
      const int my_start = piece.unknown_start ? own_ + kCommon + start++ : -1;
      std::fill(piece.given.begin(), piece.given.end(), 0.0);
      std::fill(piece.speed.begin(), piece.speed.end(), 0.0);
      auto law = Case::template make<double>(p.data(), own_, setting_->scales);
      if (my_start >= 0) law.start(p(my_start), setting_->scales.level);
      bool running = my_start >= 0;
      double v = path.steps[piece.samples.front().first].v;
      for (std::size_t i = 0; i < piece.samples.size(); ++i) {
        const PathSample& sample = piece.samples[i];
        PathStep* steps = &path.steps[sample.first];
        if (sample.settled || !running) {
          running = true;
          for (std::size_t j = 0; j < sample.count; ++j) {
            lay_step(known, steps[j].x, steps[j].v, i, piece, steps[j]);
            law.settle(level_after(p, steps[j], steps[j].level), steps[j].direction);
          }
          v = velocity_after(piece, path, i);
        } else {
          law = follow_sample(Swing{p, known, piece, i, steps, sample.count}, law, v);
          for (std::size_t j = 0; j < sample.count; ++j)
            lay_step(known, steps[j].x, steps[j].v, i, piece, steps[j]);
        }
      }
    }
  }

 private:
  /// One sample in which the mass swings on its bristles.
  struct Swing {
    const VectorXd& p;
    const friction::AxisModel& known;
    const PathPiece& piece;
    std::size_t at;
    PathStep* steps;
    std::size_t count;
  };

  /// Velocity at the end of a sample, from the travel of its neighbours.
  static double velocity_after(const PathPiece& piece, const BristlePath& path, std::size_t i) {
    const double T = path.steps[piece.samples[i].first].dt * static_cast<double>(piece.samples[i].count);
    const std::size_t next = std::min(i + 2, piece.at.size() - 1);
    return (piece.at[next] - piece.at[i]) / (static_cast<double>(next - i) * T);
  }

  [[nodiscard]] double level_after(const VectorXd& p, const PathStep& step, double map_level) const {
    return level_of(map_level, step.v, 1.0 + p(own_ + (step.direction > 0.0 ? kForward : kBackward)),
                    p(own_ + kRise), p(own_ + kWidth));
  }

  /// Runs through the sample from the velocity v on, and returns its travel.
  template <class L>
  double shoot(const Swing& s, double& v, double disturbance, L& law, std::vector<PathStep>& steps) const {
    const double mass = setting_->mass * (1.0 + s.p(own_ + kMass));
    const double load = setting_->load + setting_->scales.level * s.p(own_ + kLoad);
    const double viscous = setting_->scales.level / setting_->fastest * s.p(own_ + kViscous);
    double travel = 0.0;
    for (std::size_t j = 0; j < s.count; ++j) {
      PathStep& step = steps[j];
      const double from = static_cast<double>(j) / static_cast<double>(s.count);
      const double width = 1.0 / static_cast<double>(s.count);
      const double late = std::clamp((s.piece.late - from) / width, 0.0, 1.0);
      const double held = late * s.piece.held[s.at] + (1.0 - late) * s.piece.held[s.at + 1] + disturbance;
      const auto before = law.state;
      double mean = v, acceleration = 0.0;
      for (int pass = 0; pass < 3; ++pass) {  // friction at the mean velocity of the step
        law.state = before;
        if (mean != 0.0) step.direction = mean > 0.0 ? 1.0 : -1.0;
        step.v = mean;
        step.x = s.piece.at[s.at] + travel + 0.5 * mean * step.dt;
        const auto parts = s.known.friction.parts(step.direction * std::max(std::abs(mean), 1e-9), step.x);
        const double force = law.advance(step, level_after(s.p, step, parts.level));
        acceleration = (held - force - parts.viscous - parts.additive - load - viscous * mean) / mass;
        mean = v + 0.5 * acceleration * step.dt;
      }
      v += acceleration * step.dt;
      travel += step.v * step.dt;
    }
    return travel;
  }

  /// The law after the sample, whose steps are laid; `v` is the velocity before and then after it. A difference
  /// between measured and simulated travel is split: half corrects this velocity, half becomes a constant force. So its error fades.
  template <class L>
  L follow_sample(const Swing& s, const L& law, double& v) const {
    constexpr int kShots = 40;
    constexpr double kNearEnough = 1e-4;  ///< of the break-away distance
    const double goal = s.piece.at[s.at + 1] - s.piece.at[s.at];
    const double duration = s.steps[0].dt * static_cast<double>(s.count);
    std::vector<PathStep> steps(s.steps, s.steps + s.count);
    double begin = v, disturbance = 0.0;
    for (int shot = 0; shot < kShots; ++shot) {
      L end = law;
      v = begin;
      const double miss = goal - shoot(s, v, disturbance, end, steps);
      if (std::abs(miss) < kNearEnough * setting_->scales.break_away) {
        std::copy(steps.begin(), steps.end(), s.steps);
        return end;
      }
      begin += 0.5 * miss / duration;
      disturbance += setting_->mass * miss / (duration * duration);
    }
    L end = law;
    for (std::size_t j = 0; j < s.count; ++j)
      end.advance(s.steps[j], level_after(s.p, s.steps[j], s.steps[j].level));
    v = s.steps[s.count - 1].v;
    return end;
  }

  /// Simulated beside the own parameters: the two levels, rise, width, start.
  static constexpr int kSimulated = 5;

  [[nodiscard]] Index columns_of_raw() const { return own_ + kSimulated + 4; }

  /// Columns of raw_: force, own parameters, the simulated ones, mass, load, viscous.
  [[nodiscard]] Index column_of(Index c, int my_start) const {
    if (c < own_ + 2) return c;
    if (c < own_ + 4) return c - 2 + kRise;
    if (c == own_ + 4) return my_start;
    return c - kSimulated + kMass;
  }

  /// The level of a step: that of the map, with the rise that the map has not seen.
  template <class T>
  [[nodiscard]] T level_of(double map_level, double v, const T& factor, const T& rise, const T& width) const {
    const double unseen = setting_->unseen;
    if (unseen <= 0.0 || std::abs(v) > kFarFromRest * unseen) return T(map_level) * factor;
    using std::exp;
    const T share = T(v / unseen) * exp(-width);
    return (T(map_level) + T(setting_->scales.level) * exp(rise) * exp(-share * share)) * factor;
  }

  template <class T>
  static T variable(double value, int at) {
    if constexpr (std::is_same_v<T, double>) {
      return value;
    } else {
      return T(value, at);
    }
  }

  template <class T>
  void simulate(const PathPiece& piece, const VectorXd& p, int my_start) const {
    const Setting& s = *setting_;
    constexpr bool kJets = !std::is_same_v<T, double>;
    const auto ticks = static_cast<Index>(piece.force.size());
    // The memory stays from piece to piece: a new one for each costs more than the law.
    const Index columns = kJets ? columns_of_raw() : 1;
    if (static_cast<Index>(raw_.size()) < ticks * columns)
      raw_.resize(static_cast<std::size_t>(ticks * columns));
    Eigen::Map<MatrixXd> raw(raw_.data(), ticks, columns);
    raw.setZero();
    std::array<T, static_cast<std::size_t>(Case::kMostOwn) + 1> own;
    for (int i = 0; i < own_; ++i) own[static_cast<std::size_t>(i)] = variable<T>(p(i), i);
    auto law = Case::template make<T>(own.data(), own_, s.scales);
    const T forward = variable<T>(1.0 + p(own_ + kForward), own_);
    const T backward = variable<T>(1.0 + p(own_ + kBackward), own_ + 1);
    const T rise = variable<T>(p(own_ + kRise), own_ + 2);
    const T width = variable<T>(p(own_ + kWidth), own_ + 3);
    if (my_start >= 0) {
      law.start(variable<T>(p(my_start), own_ + 4), s.scales.level);
    }
    bool running = my_start >= 0;
    for (Index i = 0; i + 1 < ticks; ++i) {
      const PathSample& sample = piece.samples[static_cast<std::size_t>(i)];
      for (std::size_t j = sample.first; j < sample.first + sample.count; ++j) {
        const PathStep& step = s.path->steps[j];
        const T level = level_of(step.level, step.v, step.direction > 0.0 ? forward : backward, rise, width);
        T force;
        if (sample.settled || !running) {
          law.settle(level, step.direction);
          running = true;
          force = level * T(step.direction);
        } else {
          force = law.advance(step, level);
        }
        if constexpr (kJets) {
          raw(i, 0) += step.early * force.a;
          raw(i + 1, 0) += step.late * force.a;
          for (int c = 0; c < own_ + kSimulated; ++c) {
            raw(i, 1 + c) += step.early * force.v[c];
            raw(i + 1, 1 + c) += step.late * force.v[c];
          }
        } else {
          raw(i, 0) += step.early * force;
          raw(i + 1, 0) += step.late * force;
        }
      }
    }
    const double mass = s.mass * (1.0 + p(own_ + kMass));
    const double load = s.load + s.scales.level * p(own_ + kLoad);
    const double per_speed = s.scales.level / s.fastest;
    for (Index i = 0; i < ticks; ++i) {
      const auto k = static_cast<std::size_t>(i);
      raw(i, 0) += mass * piece.acceleration[k] + load + piece.given[k] +
                   per_speed * p(own_ + kViscous) * piece.speed[k] - piece.force[k];
      if constexpr (kJets) {
        raw(i, 1 + own_ + kSimulated) = s.mass * piece.acceleration[k];
        raw(i, 2 + own_ + kSimulated) = s.scales.level;
        raw(i, 3 + own_ + kSimulated) = per_speed * piece.speed[k];
      }
    }
  }

  mutable std::vector<double> raw_;  ///< see column_of(); a column for each, of the ticks of a piece
  mutable VectorXd filtered_;
  mutable std::vector<double> work_;
};

}  // namespace

VectorXd Model::force() const {
  VectorXd filtered;
  std::vector<double> work;
  VectorXd out(static_cast<Index>(path().rows.size()));
  Index row = 0;
  for (const PathPiece& piece : path().pieces) {
    filtered.resize(static_cast<Index>(piece.force.size()));
    filter_like(path(), true, piece.force.size(), piece.force.data(), filtered.data(), work);
    for (const std::size_t i : piece.rows) out(row++) = filtered(static_cast<Index>(i));
  }
  return out;
}

std::unique_ptr<Model> static_model(const Setting& setting) {
  return std::make_unique<ModelOf<StaticCase>>(setting, 0);
}
std::unique_ptr<Model> lugre_model(const Setting& setting) {
  return std::make_unique<ModelOf<LuGreCase>>(setting, LuGreCase::kMostOwn);
}
std::unique_ptr<Model> gms_model(const Setting& setting, int own) {
  // Up to four elements a jet has sixteen derivatives, which fill whole registers: a third less time than with nineteen.
  constexpr int kUsual = 11;
  if (own <= kUsual) return std::make_unique<ModelOf<GmsOfAtMost<kUsual>>>(setting, own);
  return std::make_unique<ModelOf<GmsCase>>(setting, own);
}

}  // namespace stribeck::ident::bristle
