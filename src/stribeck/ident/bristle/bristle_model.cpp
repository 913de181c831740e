#include <ceres/jet.h>

#include <array>
#include <cstddef>
#include <stribeck/ident/bristle/bristle_model.hpp>
#include <type_traits>

namespace stribeck::ident::bristle {
namespace {

template <class Case>
class ModelOf final : public Model {
 public:
  ModelOf(const Setting& setting, int own) : Model(setting, own) {}

  void evaluate(const VectorXd& p, VectorXd& e, MatrixXd* jacobian, bool white) const override {
    const BristlePath& path = *setting_->path;
    e.resize(static_cast<Index>(path.rows.size()));
    if (jacobian != nullptr) jacobian->setZero(e.size(), parameters());
    Index row = 0;
    int start = 0;
    for (const PathPiece& piece : path.pieces) {
      const int my_start = piece.unknown_start ? own_ + kCommon + start++ : -1;
      if (jacobian != nullptr) {
        using Jet = ceres::Jet<double, Case::kMostOwn + 3>;
        this->template simulate<Jet>(piece, p, my_start);
      } else {
        this->template simulate<double>(piece, p, my_start);
      }
      const Index columns = jacobian != nullptr ? raw_.cols() : 1;
      const auto ticks = static_cast<std::size_t>(raw_.rows());
      filtered_.resize(raw_.rows());
      for (Index c = 0; c < columns; ++c) {
        const Index to = c == 0 ? 0 : column_of(c - 1, my_start);
        if (to < 0) continue;
        filter_like(path, white, ticks, raw_.col(c).data(), filtered_.data(), work_);
        double* out = c == 0 ? e.data() + row : jacobian->col(to).data() + row;
        for (std::size_t i = 0; i < piece.rows.size(); ++i)
          out[i] = filtered_(static_cast<Index>(piece.rows[i]));
      }
      row += static_cast<Index>(piece.rows.size());
    }
  }

 private:
  /// Columns of raw_: force, own parameters, the two levels, start, mass, load, viscous.
  [[nodiscard]] Index column_of(Index c, int my_start) const {
    if (c < own_ + 2) return c;
    if (c == own_ + 2) return my_start;
    return c - 1;
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
    raw_.setZero(ticks, kJets ? own_ + kCommon + 2 : 1);
    std::array<T, static_cast<std::size_t>(Case::kMostOwn) + 1> own;
    for (int i = 0; i < own_; ++i) own[static_cast<std::size_t>(i)] = variable<T>(p(i), i);
    auto law = Case::template make<T>(own.data(), own_, s.scales);
    const T forward = variable<T>(1.0 + p(own_ + kForward), own_);
    const T backward = variable<T>(1.0 + p(own_ + kBackward), own_ + 1);
    if (my_start >= 0) {
      law.start(variable<T>(p(my_start), own_ + 2), s.scales.level);
    }
    bool running = my_start >= 0;
    for (Index i = 0; i + 1 < ticks; ++i) {
      const PathSample& sample = piece.samples[static_cast<std::size_t>(i)];
      for (std::size_t j = sample.first; j < sample.first + sample.count; ++j) {
        const PathStep& step = s.path->steps[j];
        const T level = T(step.level) * (step.direction > 0.0 ? forward : backward);
        T force;
        if (sample.settled || !running) {
          law.settle(level, step.direction);
          running = true;
          force = level * T(step.direction);
        } else {
          force = law.advance(step, level);
        }
        if constexpr (kJets) {
          raw_(i, 0) += step.early * force.a;
          raw_(i + 1, 0) += step.late * force.a;
          for (int c = 0; c < own_ + 3; ++c) {
            raw_(i, 1 + c) += step.early * force.v[c];
            raw_(i + 1, 1 + c) += step.late * force.v[c];
          }
        } else {
          raw_(i, 0) += step.early * force;
          raw_(i + 1, 0) += step.late * force;
        }
      }
    }
    const double mass = s.mass * (1.0 + p(own_ + kMass));
    const double load = s.load + s.scales.level * p(own_ + kLoad);
    const double per_speed = s.scales.level / s.fastest;
    for (Index i = 0; i < ticks; ++i) {
      const auto k = static_cast<std::size_t>(i);
      raw_(i, 0) += mass * piece.acceleration[k] + load + piece.given[k] +
                    per_speed * p(own_ + kViscous) * piece.speed[k] - piece.force[k];
      if constexpr (kJets) {
        raw_(i, 1 + own_ + 3) = s.mass * piece.acceleration[k];
        raw_(i, 1 + own_ + 4) = s.scales.level;
        raw_(i, 1 + own_ + 5) = per_speed * piece.speed[k];
      }
    }
  }

  mutable MatrixXd raw_;
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
  return std::make_unique<ModelOf<GmsCase>>(setting, own);
}

}  // namespace stribeck::ident::bristle
