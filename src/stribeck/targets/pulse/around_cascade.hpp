#pragma once
/// A cascade of two axes to which a control adds something of its own: what these laws have in common.
/// Real time: no.

#include <memory>
#include <stribeck/sim/law/law_runner.hpp>

namespace stribeck::targets {

class AroundCascade : public sim::LawRunner<2> {
 public:
  Vec<double, 2> step_ahead(std::span<const Point> points, const Vec<double, 2>& measured) override {
    return step(points.front(), measured);
  }
  [[nodiscard]] double lag() const override { return cascade_->lag(); }
  [[nodiscard]] const StatusCounter& status() const override { return cascade_->status(); }
  [[nodiscard]] std::vector<control::Drift> drift(double period) const override {
    return cascade_->drift(period);
  }

 protected:
  explicit AroundCascade(const sim::AnyController<2>& cascade) : cascade_(cascade->copy()) {}
  AroundCascade(const AroundCascade& other) : LawRunner(other), cascade_(other.cascade_->copy()) {}

  [[nodiscard]] Vec<double, 2> cascade_step(const Point& now, const Vec<double, 2>& measured) {
    return cascade_->step(now, measured);
  }

 private:
  std::unique_ptr<LawRunner> cascade_;
};

}  // namespace stribeck::targets
