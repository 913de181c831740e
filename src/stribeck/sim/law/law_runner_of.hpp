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

  LawRunnerOf(Law law, const control::Setup<N>& setup)
      : parts_(std::make_shared<const Parts>(Parts{std::move(law), control::DriveInterface<N>(setup)})) {}

  [[nodiscard]] std::unique_ptr<LawRunner<N>> copy() const override {
    return std::make_unique<LawRunnerOf>(*this);
  }
  Vec<double, N> step(const Point& now, const Vec<double, N>& measured) override {
    return commanded(now, measured, parts_->law.step(state_, now, measured));
  }
  Vec<double, N> step_ahead(std::span<const Point> points, const Vec<double, N>& measured) override {
    if constexpr (requires { Law::kPreview; }) {
      const auto seen = points.first(std::min(Law::kPreview + 1, points.size()));
      return commanded(points.front(), measured, parts_->law.step(state_, seen, measured));
    } else {
      return step(points.front(), measured);
    }
  }
  void acted(const Vec<double, N>& force) override { parts_->drives.admit(drives_, state_, force); }
  [[nodiscard]] Vec<double, N> command() const override {
    return each([](const auto& s) { return s.command; });
  }
  [[nodiscard]] Vec<double, N> offset() const override {
    return each([](const auto& s) { return s.offset; });
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
  struct Parts {
    Law law;
    control::DriveInterface<N> drives;
  };

  Vec<double, N> commanded(const Point& now, const Vec<double, N>& measured, const Vec<double, N>& force) {
    parts_->drives.command(drives_, state_, now, measured, force);
    return force;
  }
  template <class F>
  [[nodiscard]] Vec<double, N> each(F&& of) const {
    Vec<double, N> v;
    for (std::size_t i = 0; i < N; ++i) v[i] = of(drives_[i]);
    return v;
  }

  std::shared_ptr<const Parts> parts_;  ///< constant, and shared by all copies
  typename Law::State state_;
  typename control::DriveInterface<N>::State drives_{};
};

template <std::size_t N>
AnyController<N> make_controller(const control::LawParams& law, const control::Setup<N>& setup) {
  return std::visit(
      [&](const auto& params) -> AnyController<N> {
        using Law = typename std::decay_t<decltype(params)>::template Controller<N>;
        return std::make_shared<const LawRunnerOf<Law, N>>(Law(params, setup), setup);
      },
      law);
}

}  // namespace stribeck::sim
