// The C interface: parameters of any kind, and steps with any numbers. No force that is not finite or above the limit, and no result
// but those that are declared.
#include <stribeck/stribeck.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <tests/fuzz/targets/fuzz.hpp>

namespace stribeck::fuzz {
namespace {

constexpr std::uint32_t kMostAxes = 3;
constexpr int kMostSteps = 400;
constexpr std::uint8_t kName = 255;  ///< a parameter's index that stands for a name as text

/// Numbers and choices out of the bytes; zeros behind their end.
class Bytes {
 public:
  explicit Bytes(std::string_view text) : text_(text) {}

  [[nodiscard]] bool more() const { return !text_.empty(); }
  std::uint8_t byte() { return mode_of(text_); }
  /// The bytes up to the next NUL, at most 255.
  std::string text() {
    const std::string_view all = text_.substr(0, byte());
    const std::string_view part = all.substr(0, all.find('\0'));
    text_.remove_prefix(std::min(part.size() + 1, text_.size()));
    return std::string(part);
  }
  double number() {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInf = std::numeric_limits<double>::infinity();
    constexpr double kOdd[] = {kNan, kInf, -kInf, 0.0, -0.0, 1e300, -1e300, 5e-324, 1e-310, 1.0, -1.0, 1e15};
    const std::uint8_t kind = byte();
    if (kind < 12) return kOdd[kind];
    if (kind < 40) {
      std::uint64_t bits = 0;
      for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
      double x = 0.0;
      std::memcpy(&x, &bits, sizeof x);
      return x;
    }
    // What an axis has: millimetres, newtons, kilograms, times.
    return (byte() - 128) * std::pow(10.0, kind % 12 - 7.0);
  }

 private:
  std::string_view text_;
};

std::size_t memory_for(std::uint32_t axes) {
  std::size_t most = stribeck_controller_size(axes);
  for (std::uint32_t i = 0; const char* law = stribeck_controller_parameter_word("law", i); ++i)
    most = std::max(most, stribeck_controller_size_for(axes, law));
  return most;
}

void demand_declared(stribeck_result r) {
  demand(std::strcmp(stribeck_describe(r), stribeck_describe(static_cast<stribeck_result>(-12345))) != 0,
         "a result that is not declared");
}

struct Run {
  Bytes bytes;
  std::uint32_t axes;
  stribeck_controller* controller;
  double limit[kMostAxes];   ///< set last
  double active[kMostAxes];  ///< that the controller was configured with
  bool configured = false;
  int steps = 0;

  void set() {
    const std::uint32_t axis = bytes.byte() % (axes + 1);
    stribeck_parameter p{};
    const std::uint8_t index = bytes.byte();
    if (index == kName) return set_by_name(axis);
    if (stribeck_controller_parameter(index, &p) != STRIBECK_OK) return;
    const double value = p.kind == STRIBECK_NUMBER ? bytes.number() : static_cast<double>(bytes.byte() % 8);
    const stribeck_result r = stribeck_controller_set(controller, axis, p.name, value);
    demand_declared(r);
    if (r == STRIBECK_OK && std::strcmp(p.name, "force_limit") == 0 && axis < axes) limit[axis] = value;
  }

  /// Names and words of any bytes; the longest are longer than any that there is.
  void set_by_name(std::uint32_t axis) {
    const std::string name = bytes.text();
    const bool chooses = bytes.byte() % 2 == 0;
    const double value = chooses ? 0.0 : bytes.number();
    const std::string word = chooses ? bytes.text() : std::string();
    const stribeck_result r = chooses
                                  ? stribeck_controller_choose(controller, axis, name.c_str(), word.c_str())
                                  : stribeck_controller_set(controller, axis, name.c_str(), value);
    demand_declared(r);
    demand(stribeck_controller_problem(controller) != nullptr, "no problem text");
    static_cast<void>(stribeck_controller_parameter_word(name.c_str(), axis));
    demand(stribeck_controller_size_for(axes, word.c_str()) <= memory_for(axes),
           "a law that needs more memory than all");
    if (r == STRIBECK_OK && !chooses && name == "force_limit" && axis < axes) limit[axis] = value;
  }

  void configure() {
    const stribeck_result r =
        stribeck_controller_configure(controller, bytes.byte() % 8 == 0 ? bytes.number() : 1e-3);
    demand_declared(r);
    demand(stribeck_controller_problem(controller) != nullptr, "no problem text");
    if (r != STRIBECK_OK) return;
    configured = true;
    std::copy(limit, limit + kMostAxes, active);
  }

  void step() {
    stribeck_axis_input in[kMostAxes];
    double force[kMostAxes] = {};
    for (std::uint32_t i = 0; i < axes; ++i)
      in[i] = {bytes.number(), bytes.number(), bytes.number(), bytes.number()};
    for (std::uint8_t again = bytes.byte() % 16; steps < kMostSteps; --again) {
      const stribeck_result r = stribeck_controller_step(controller, in, force);
      demand_declared(r);
      ++steps;
      for (std::uint32_t i = 0; i < axes && configured; ++i) {
        demand(std::isfinite(force[i]), "a force that is not finite");
        demand(!(std::abs(force[i]) > active[i]), "a force above the limit");
      }
      if (again == 0) break;
      for (std::uint32_t i = 0; i < axes; ++i) in[i].measured += 1e-6 * again;
    }
    stribeck_axis_signals signals{};
    demand_declared(
        stribeck_controller_signals(controller, bytes.byte() % (axes + 1), &signals, sizeof signals));
    stribeck_supervision why{};
    demand_declared(stribeck_controller_supervision(controller, &why, sizeof why));
    demand(stribeck_fault_describe(why.fault) != nullptr, "no text of a fault");
  }
};

}  // namespace

std::vector<std::string> seeds() {
  // One and two axes; 200 is the number of a byte that stands for a plain number.
  std::string one_axis;
  std::string two_axes(1, '\1');
  for (std::string* s : {&one_axis, &two_axes}) {
    if (s->empty()) *s += '\0';
    for (int i = 0; i < 6; ++i) *s += std::string("\0\0", 2) + static_cast<char>(i) + "\xc8\x90";
    *s += "\4\1";
    for (int i = 0; i < 12; ++i)
      *s += std::string("\5\x3c\x82\x3d\x83\x3e\x84\x3c\x85\x3c\x82\x3d\x83\x3e\x84\x3c\x85\3", 18) + '\0';
  }
  std::string by_name = one_axis.substr(0, one_axis.size() / 2);
  const std::string zero(1, '\0');
  for (const char* name : {"mass", "friction.conventional.alpha0", "force_limit", "reversal.rise.0"})
    by_name += zero + zero + "\xff\xff" + name + zero + "\1\xc8\x90";
  by_name += zero + zero + "\xff\xfflaw" + zero + zero + "\xffsliding-mode" + zero + "\4\1\5";
  return {one_axis, two_axes, by_name};
}

std::vector<std::string> words() {
  return {"mass",
          "friction.lugre.sigma0",
          "adaptive_gain.1",
          "predictive",
          "supervision.checks",
          "\xff\xff",
          "\4\1",
          "\5",
          std::string(1, '\0'),
          "\6",
          "\7",
          "\x3c\x80",
          "\xc8\xff"};
}

void one(std::string_view input) {
  Bytes bytes(input);
  const std::uint32_t axes = 1 + bytes.byte() % kMostAxes;
  const std::size_t size = memory_for(axes);
  const std::size_t alignment = stribeck_alignment();
  const std::unique_ptr<void, decltype(&std::free)> memory(
      std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment), &std::free);
  stribeck_controller* const controller = stribeck_controller_init(memory.get(), size, axes);
  demand(controller != nullptr, "no controller");
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Run run{bytes, axes, controller, {kInf, kInf, kInf}, {kInf, kInf, kInf}};
  while (run.bytes.more()) {
    switch (run.bytes.byte() % 8) {
      case 4:
        run.configure();
        break;
      case 5:
        run.step();
        break;
      case 6:
        demand_declared(stribeck_controller_reset(controller));
        break;
      case 7:
        demand_declared(stribeck_controller_set_phase(controller, run.bytes.number()));
        demand_declared(stribeck_controller_set_elapsed(controller, run.bytes.number()));
        break;
      default:
        run.set();
        break;
    }
  }
}

}  // namespace stribeck::fuzz
