#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <stribeck/core/number_text.hpp>
#include <stribeck/io/gcode/short_arcs.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::io {
namespace {

using Words = std::vector<std::pair<char, double>>;

/// The words of a line without its comments; nothing where one is no plain number.
std::optional<Words> plain_words(std::string_view line) {
  std::string text;
  bool comment = false;
  for (const char c : line) {
    if (!comment && c == ';') break;
    if (c == '(') comment = true;
    if (!comment && std::isspace(static_cast<unsigned char>(c)) == 0)
      text += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (c == ')') comment = false;
  }
  Words words;
  std::string_view rest = text;
  while (!rest.empty()) {
    const char letter = rest.front();
    rest.remove_prefix(1);
    if (letter < 'A' || letter > 'Z' || letter == 'O') return std::nullopt;
    if (rest.starts_with('+')) rest.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] =
        std::from_chars(rest.data(), rest.data() + rest.size(), value, std::chars_format::fixed);
    if (error != std::errc()) return std::nullopt;
    words.emplace_back(letter, value);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  }
  return words;
}

std::optional<double> value_of(const Words& words, char letter) {
  const auto found =
      std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.first == letter; });
  return found == words.end() ? std::nullopt : std::optional(found->second);
}

/// Follows a program as far as its words are plain numbers.
class Follower {
 public:
  /// The distance from start to end of an arc in this line that is too short to be printed.
  std::optional<double> take(std::string_view line) {
    const auto words = plain_words(line);
    if (!words || !take_modes(*words)) {
      place_ = {};
      return std::nullopt;
    }
    Place end = place_;
    for (std::size_t k = 0; k < 3; ++k) {
      if (const auto value = value_of(*words, kAxes[k])) end[k] = value;
    }
    const auto distance = motion_ >= 2 ? short_arc(*words, end) : std::nullopt;
    place_ = end;
    return distance;
  }

 private:
  using Place = std::array<std::optional<double>, 3>;
  static constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};
  static constexpr std::array<char, 3> kCentre{'I', 'J', 'K'};

  /// False where the words of the line are not the place at which it ends.
  bool take_modes(const Words& words) {
    bool known = true;
    for (const auto& [letter, value] : words) {
      if (letter == 'M' && (value == 98.0 || value == 99.0)) known = false;
      if (letter != 'G') continue;
      const int code = static_cast<int>(std::lround(10.0 * value));
      // Ten times the number. Those of units, offsets and tools change the coordinates of the place.
      constexpr std::array<int, 9> kOthers{40, 400, 610, 611, 640, 800, 911, 930, 940};
      if (code == 0 || code == 10 || code == 20 || code == 30) {
        motion_ = code / 10;
      } else if (code == 170 || code == 180 || code == 190) {
        plane_ = static_cast<std::size_t>(code / 10 - 17);
      } else if (code == 900 || code == 910) {
        absolute_ = code == 900;
      } else {
        known = known && std::find(kOthers.begin(), kOthers.end(), code) != kOthers.end();
      }
    }
    return known && absolute_;
  }

  [[nodiscard]] std::optional<double> short_arc(const Words& words, const Place& end) const {
    // First and second axis of the plane, as in G17, G18 and G19.
    constexpr std::array<std::pair<std::size_t, std::size_t>, 3> kPlanes{{{0, 1}, {2, 0}, {1, 2}}};
    const auto [a, b] = kPlanes.at(plane_);
    if (!place_[a] || !place_[b] || !end[a] || !end[b]) return std::nullopt;
    const double da = *end[a] - *place_[a];
    const double db = *end[b] - *place_[b];
    if ((da == 0.0 && db == 0.0) || !printed_equal(*place_[a], *end[a]) ||
        !printed_equal(*place_[b], *end[b]))
      return std::nullopt;
    if (value_of(words, 'P').value_or(1.0) != 1.0) return std::nullopt;
    // An arc that ends a little before its start goes nearly around, and a full circle stands for it well.
    if (const auto radius = value_of(words, 'R')) {
      if (*radius < 0.0) return std::nullopt;
    } else {
      const double across =
          value_of(words, kCentre[b]).value_or(0.0) * da - value_of(words, kCentre[a]).value_or(0.0) * db;
      if ((motion_ == 3 ? across : -across) <= 0.0) return std::nullopt;
    }
    return std::hypot(da, db);
  }

  static bool printed_equal(double a, double b) {
    // "-0.0000" and "0.0000" are read as equal.
    const auto printed = [](double x) { return number_in(fmt::format("{:.4f}", x)); };
    return printed(a) == printed(b);
  }

  Place place_{};
  std::size_t plane_ = 0;  ///< 0: G17, 1: G18, 2: G19
  int motion_ = 1;
  bool absolute_ = true;
};

}  // namespace

std::optional<ShortArc> arc_too_short_to_print(std::string_view program) {
  Follower follower;
  for (std::size_t line = 1; !program.empty(); ++line) {
    const std::size_t end = std::min(program.find('\n'), program.size());
    if (const auto distance = follower.take(program.substr(0, end))) return ShortArc{line, *distance};
    program.remove_prefix(std::min(end + 1, program.size()));
  }
  return std::nullopt;
}

}  // namespace stribeck::io
