#include <dlfcn.h>
#include <fmt/format.h>
#include <stribeck/board.h>
#include <CLI/CLI.hpp>

#include <apps/cli/commands.hpp>
#include <array>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <stribeck/workflow/board/protocol.hpp>

/// Runs a controller that is a shared object, and speaks the protocol of programs for it. `bench` starts it, so that a crash is its own.
namespace stribeck::cli {
namespace {

class SharedController {
 public:
  explicit SharedController(const std::string& file)
      : library_(::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
    const auto abi = reinterpret_cast<decltype(&stribeck_board_abi)>(find("stribeck_board_abi"));
    if (abi() != STRIBECK_BOARD_ABI)
      throw std::runtime_error(fmt::format("{} was compiled for version {} of stribeck/board.h, expected {}",
                                           file, abi(), STRIBECK_BOARD_ABI));
    create_ = reinterpret_cast<decltype(create_)>(find("stribeck_board_create"));
    step_ = reinterpret_cast<decltype(step_)>(find("stribeck_board_step"));
    destroy_ = reinterpret_cast<decltype(destroy_)>(find("stribeck_board_destroy"));
  }
  ~SharedController() {
    if (controller_ != nullptr) destroy_(controller_);
  }
  SharedController(const SharedController&) = delete;
  SharedController& operator=(const SharedController&) = delete;

  void start(const workflow::BoardSetup& setup) {
    for (const workflow::BoardAxis& a : setup.axes)
      axes_.push_back({a.mass, a.load, a.delay, a.force_limit, a.resolution, a.stiffness, a.damping,
                       static_cast<std::uint32_t>(a.speed.size()), a.speed.data(), a.friction.data(),
                       a.model_file.c_str()});
    setup_ = {STRIBECK_BOARD_ABI, static_cast<std::uint32_t>(axes_.size()), setup.period, axes_.data()};
    controller_ = create_(&setup_);
    if (controller_ == nullptr) throw std::runtime_error("stribeck_board_create refuses the setup");
  }
  void step(double time, const stribeck_board_input* in, double* force) {
    step_(controller_, time, in, force);
  }

 private:
  void* find(const char* name) {
    void* const symbol = ::dlsym(library_, name);
    if (symbol == nullptr) throw std::runtime_error(fmt::format("the library has no function {}", name));
    return symbol;
  }

  void* library_;
  decltype(&stribeck_board_create) create_ = nullptr;
  decltype(&stribeck_board_step) step_ = nullptr;
  decltype(&stribeck_board_destroy) destroy_ = nullptr;
  std::vector<stribeck_board_axis> axes_;
  stribeck_board_setup setup_{};
  void* controller_ = nullptr;
};

void answer(const std::string& line) {
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

int host(const std::string& file) {
  SharedController controller(file);
  workflow::BoardSetup setup;
  std::string line;
  while (std::getline(std::cin, line) && workflow::read_setup_line(line, setup)) {
  }
  controller.start(setup);
  answer("ready");
  const std::size_t axes = setup.axes.size();
  std::vector<double> numbers(1 + 4 * axes);
  std::vector<stribeck_board_input> in(axes);
  std::vector<double> force(axes);
  double seconds = 0.0;
  double steps = 0.0;
  while (std::getline(std::cin, line) && line != "end") {
    if (!workflow::read_numbers(line, numbers.data(), numbers.size()))
      throw std::runtime_error("not a line of the board's protocol: " + line);
    for (std::size_t i = 0; i < axes; ++i)
      in[i] = {numbers[1 + 4 * i], numbers[2 + 4 * i], numbers[3 + 4 * i], numbers[4 + 4 * i]};
    const auto begin = std::chrono::steady_clock::now();
    controller.step(numbers[0], in.data(), force.data());
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    steps += 1.0;
    std::string forces;
    for (const double f : force) forces += fmt::format("{} ", f);
    answer(forces);
  }
  answer(fmt::format("seconds per step {}", seconds / std::max(steps, 1.0)));
  return 0;
}

}  // namespace

void add_board_host(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("board-host", "Run a shared object as a controller of the board");
  verb->group("");
  auto file = std::make_shared<std::string>();
  verb->add_option("file", *file, "Shared object")->required()->type_name("FILE.so");
  verb->callback([file, &action] { action = [file] { return host(*file); }; });
}

}  // namespace stribeck::cli
