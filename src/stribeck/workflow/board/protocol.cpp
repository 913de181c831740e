#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <stribeck/workflow/board/protocol.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::string_view kFirstLine = "stribeck-board 1";

/// The next word of a line, which gets shorter; empty at its end.
std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = line.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  const std::size_t end = std::min(line.find_first_of(kBlank, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

bool as_number(std::string_view word, double& out) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  return error == std::errc() && end == word.data() + word.size() && !word.empty() && std::isfinite(out);
}

[[noreturn]] void refuse_line(std::string_view line) {
  throw std::runtime_error("not a line of the board's protocol: " + std::string(line.substr(0, 80)));
}

double number_of(std::string_view& rest, std::string_view line) {
  double x = 0.0;
  if (!as_number(next_word(rest), x)) refuse_line(line);
  return x;
}

BoardAxis& axis_of(std::string_view& rest, std::string_view line, BoardSetup& setup) {
  const double i = number_of(rest, line);
  if (!(i >= 0.0 && i < static_cast<double>(setup.axes.size()))) refuse_line(line);
  return setup.axes[static_cast<std::size_t>(i)];
}

}  // namespace

std::string setup_lines(const BoardSetup& setup) {
  std::string text = fmt::format("{}\naxes {}\nperiod {}\n", kFirstLine, setup.axes.size(), setup.period);
  for (std::size_t i = 0; i < setup.axes.size(); ++i) {
    const BoardAxis& a = setup.axes[i];
    text +=
        fmt::format("axis {} mass {} load {} delay {} force_limit {} resolution {} stiffness {} damping {}\n",
                    i, a.mass, a.load, a.delay, a.force_limit, a.resolution, a.stiffness, a.damping);
    text += fmt::format("friction {} {}", i, a.speed.size());
    for (std::size_t k = 0; k < a.speed.size(); ++k) text += fmt::format(" {} {}", a.speed[k], a.friction[k]);
    text += fmt::format("\nmodel {} {}\n", i, a.model_file);
  }
  return text + "start\n";
}

bool read_setup_line(std::string_view line, BoardSetup& setup) {
  std::string_view rest = line;
  const std::string_view key = next_word(rest);
  if (key == "start") return false;
  if (key == "stribeck-board") {
    if (line != kFirstLine) refuse_line(line);
  } else if (key == "axes") {
    const double n = number_of(rest, line);
    if (!(n >= 1.0 && n <= 6.0)) refuse_line(line);
    setup.axes.resize(static_cast<std::size_t>(n));
  } else if (key == "period") {
    setup.period = number_of(rest, line);
  } else if (key == "axis") {
    BoardAxis& a = axis_of(rest, line, setup);
    for (std::string_view name = next_word(rest); !name.empty(); name = next_word(rest)) {
      double* const out = name == "mass"          ? &a.mass
                          : name == "load"        ? &a.load
                          : name == "delay"       ? &a.delay
                          : name == "force_limit" ? &a.force_limit
                          : name == "resolution"  ? &a.resolution
                          : name == "stiffness"   ? &a.stiffness
                          : name == "damping"     ? &a.damping
                                                  : nullptr;
      if (out == nullptr) refuse_line(line);
      *out = number_of(rest, line);
    }
  } else if (key == "friction") {
    BoardAxis& a = axis_of(rest, line, setup);
    const double n = number_of(rest, line);
    for (double k = 0.0; k < n; k += 1.0) {
      a.speed.push_back(number_of(rest, line));
      a.friction.push_back(number_of(rest, line));
    }
  } else if (key == "model") {
    BoardAxis& a = axis_of(rest, line, setup);
    if (!rest.empty()) a.model_file = rest.substr(1);
  } else {
    refuse_line(line);
  }
  return true;
}

bool read_numbers(std::string_view line, double* out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!as_number(next_word(line), out[i])) return false;
  }
  return next_word(line).empty();
}

}  // namespace stribeck::workflow
