#pragma once
/// A controller that is a program of somebody else, as a law that the closed loop can run. Each run starts the program anew.
/// Real time: no.
/// Errors: io::ProgramFailed from copy() and from steps.

#include <memory>
#include <optional>
#include <stribeck/io/process/outside_program.hpp>
#include <stribeck/sim/law/law_runner.hpp>
#include <stribeck/workflow/board/protocol.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct OutsideProgram {
  std::vector<std::string> words;
  io::ProgramLimits limits;
  BoardSetup setup;
};

class OutsideLaw final : public sim::LawRunner<2> {
 public:
  explicit OutsideLaw(OutsideProgram program);
  OutsideLaw(const OutsideLaw& other);

  [[nodiscard]] std::unique_ptr<LawRunner> copy() const override;
  Vec<double, 2> step(const Point& now, const Vec<double, 2>& measured) override;
  Vec<double, 2> step_ahead(std::span<const Point> points, const Vec<double, 2>& measured) override {
    return step(points.front(), measured);
  }
  [[nodiscard]] double lag() const override { return 0.0; }
  [[nodiscard]] const StatusCounter& status() const override { return status_; }
  [[nodiscard]] std::vector<control::Drift> drift(double) const override { return {}; }

  /// Ends the run; the time of a step that the host of a shared object has measured itself [s].
  std::optional<double> finish();

 private:
  std::shared_ptr<const OutsideProgram> program_;
  std::unique_ptr<io::Conversation> talk_;
  std::size_t ticks_ = 0;
  StatusCounter status_;
};

}  // namespace stribeck::workflow
