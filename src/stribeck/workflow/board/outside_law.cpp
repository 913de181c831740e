#include <fmt/format.h>

#include <algorithm>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/board/outside_law.hpp>

namespace stribeck::workflow {

OutsideLaw::OutsideLaw(OutsideProgram program)
    : program_(std::make_shared<const OutsideProgram>(std::move(program))) {}

OutsideLaw::OutsideLaw(const OutsideLaw& other)
    : sim::LawRunner<2>(other),
      program_(other.program_),
      talk_(std::make_unique<io::Conversation>(program_->words, program_->limits)) {
  talk_->say(setup_lines(program_->setup));
  if (const std::string_view said = talk_->answer(); said != "ready")
    throw io::ProgramFailed(fmt::format("answered {} to the setup, expected \"ready\"", io::in_quotes(said)));
}

std::unique_ptr<sim::LawRunner<2>> OutsideLaw::copy() const { return std::make_unique<OutsideLaw>(*this); }

Vec<double, 2> OutsideLaw::step(const Point& now, const Vec<double, 2>& measured) {
  std::string line = fmt::format("{}", program_->setup.period * static_cast<double>(ticks_));
  for (std::size_t i = 0; i < 2; ++i)
    line += fmt::format(" {} {} {} {}", now.position[i], now.velocity[i], now.acceleration[i], measured[i]);
  line += '\n';
  talk_->say(line);
  const std::string_view said = talk_->answer();
  std::array<double, 2> wanted{};
  if (!read_numbers(said, wanted.data(), wanted.size()))
    throw io::ProgramFailed(
        fmt::format("answered {} in period {}, expected two finite numbers", io::in_quotes(said), ticks_));
  ++ticks_;
  Vec<double, 2> force;
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit = program_->setup.axes[i].force_limit;
    force[i] = std::clamp(wanted[i], -limit, limit);
    if (force[i] != wanted[i]) status_.raise(Status::kOutputLimited);
  }
  return force;
}

std::optional<double> OutsideLaw::finish() {
  try {
    talk_->say("end\n");
    double seconds = 0.0;
    constexpr std::string_view kTold = "seconds per step ";
    const std::string_view said = talk_->answer();
    if (said.starts_with(kTold) && read_numbers(said.substr(kTold.size()), &seconds, 1)) return seconds;
  } catch (const io::ProgramFailed&) {
    // A program may end at "end" without a word.
  }
  return {};
}

}  // namespace stribeck::workflow
