#pragma once
/// The LawRunner of one law, and the choice among the laws. Only law_runner_plane.cpp and law_runner_space.cpp include this file.
/// Real time: no.

#include <algorithm>
#include <stribeck/sim/law/law_runner.hpp>
#include <type_traits>
#include <utility>

namespace stribeck::sim {

template <class Law, std::size_t N>
class LawRunnerOf final : public LawRunner<N> {
 public:
  using Point = typename LawRunner<N>::Point;

  explicit LawRunnerOf(Law law) : law_(std::make_shared<const Law>(std::move(law))) {}

  [[nodiscard]] std::unique_ptr<LawRunner<N>> copy() const override {
    return std::make_unique<LawRunnerOf>(*this);
  }
  Vec<double, N> step(const Point& now, const Vec<double, N>& measured) override {
    return law_->step(state_, now, measured);
  }
  Vec<double, N> step_ahead(std::span<const Point> points, const Vec<double, N>& measured) override {
    if constexpr (requires { Law::kPreview; }) {
      return law_->step(state_, points.first(std::min(Law::kPreview + 1, points.size())), measured);
    } else {
      return law_->step(state_, points.front(), measured);
    }
  }
  [[nodiscard]] double lag() const override {
    if constexpr (requires { state_.lag; }) {
      return state_.lag;
    } else {
      return 0.0;
    }
  }
  [[nodiscard]] const StatusCounter& status() const override { return state_.status; }
  [[nodiscard]] std::vector<control::Drift> drift(double period) const override {
    std::vector<control::Drift> all;
    for (const auto& c : state_.compensation) {
      if (c.adaptation.informed) all.push_back(control::DriftMonitor::report(c.drift, c.adaptation, period));
    }
    return all;
  }

 private:
  std::shared_ptr<const Law> law_;  ///< constant, and shared by all copies
  typename Law::State state_;
};

template <std::size_t N>
AnyController<N> make_controller(const control::LawParams& law, const control::Setup<N>& setup) {
  return std::visit(
      [&](const auto& params) -> AnyController<N> {
        using Law = typename std::decay_t<decltype(params)>::template Controller<N>;
        return std::make_shared<const LawRunnerOf<Law, N>>(Law(params, setup));
      },
      law);
}

}  // namespace stribeck::sim
