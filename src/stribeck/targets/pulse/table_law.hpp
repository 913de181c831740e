#pragma once
/// A cascade with a table of friction over the commanded velocity, added to the force.
///
///   u ← u + w·F(ṙ)     w = |r − r0|/d      after a reversal at r0, 1 from the distance d on; without d it is 1
///                      w = t/t_a           before the next one, where it is less than t_a away; t = −ṙ/r̈
///
///   F force of the table [N], d build-up [m], t_a look-ahead [s]
///
/// With bristles the force is that of pre_sliding.hpp, which stays at rest.
///
/// Source of the weights: ISG kernel, friction compensation (axis/352387467): in time before the reversal, in distance after it. That
/// they are straight lines is assumed.
/// Real time: no.

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/targets/pulse/around_cascade.hpp>
#include <stribeck/targets/pulse/pre_sliding.hpp>
#include <stribeck/targets/pulse/table_force.hpp>

namespace stribeck::targets {

class TableCascade final : public AroundCascade {
 public:
  TableCascade(const sim::AnyController<2>& cascade, std::array<TableForce, 2> tables)
      : AroundCascade(cascade), tables_(std::move(tables)) {}

  [[nodiscard]] std::unique_ptr<LawRunner> copy() const override {
    return std::make_unique<TableCascade>(*this);
  }
  Vec<double, 2> step(const Point& now, const Vec<double, 2>& measured) override {
    Vec<double, 2> u = cascade_step(now, measured);
    for (std::size_t i = 0; i < 2; ++i) {
      const double v = now.velocity[i];
      u[i] += tables_[i].bristles ? built_up(i, now.position[i], v)
                                  : weight(i, now.position[i], v, now.acceleration[i]) * tables_[i].force(v);
    }
    return u;
  }

 private:
  struct Axis {
    double direction = 0.0;
    bool reversed = false;
    double from = 0.0;  ///< position of the last reversal, with bristles that of the last period [m]
    bool begun = false;
    PreSliding bristles{};
  };

  double built_up(std::size_t i, double position, double v) {
    const TableForce& table = tables_[i];
    Axis& a = axes_[i];
    if (v != 0.0) a.direction = sign(v);
    const double change = position - a.from;
    const double travel = a.begun && change * v > 0.0 ? change : 0.0;
    a.from = position;
    a.begun = true;
    constexpr double kSlow = 1e-12;  // of the last direction [m/s]
    const double level = std::abs(table.force(v != 0.0 ? v : a.direction * kSlow));
    return a.bristles.step(*table.bristles, travel, level);
  }

  double weight(std::size_t i, double position, double v, double acceleration) {
    const TableForce& table = tables_[i];
    Axis& a = axes_[i];
    const double direction = sign(v);
    if (direction != 0.0 && direction != a.direction) {
      a.reversed = a.direction != 0.0;
      a.from = position;
      a.direction = direction;
    }
    double w = 1.0;
    if (a.reversed && table.build_up > 0.0) w = std::min(std::abs(position - a.from) / table.build_up, 1.0);
    if (v * acceleration < 0.0 && table.look_ahead > 0.0)
      w = std::min(w, std::abs(v / acceleration) / table.look_ahead);
    return w;
  }

  std::array<TableForce, 2> tables_;
  std::array<Axis, 2> axes_;
};

}  // namespace stribeck::targets
