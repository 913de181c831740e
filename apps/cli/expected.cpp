#include <fmt/format.h>

#include <algorithm>
#include <apps/cli/expected.hpp>
#include <charconv>
#include <cstdint>
#include <limits>
#include <stribeck/io/error.hpp>
#include <stribeck/report/text.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace stribeck::cli {

CLI::Validator number_from(double low, double high) {
  const std::string range = fmt::format("{} to {}", low, high);
  return CLI::Validator(
      [low, high, range](const std::string& text) {
        double value = 0.0;
        const char* const end = text.data() + text.size();
        const auto read = std::from_chars(text.data(), end, value);
        const bool good = read.ec == std::errc() && read.ptr == end && value >= low && value <= high;
        return good ? std::string()
                    : fmt::format("got {}, expected a number from {}", io::in_quotes(text), range);
      },
      "from " + range);
}

CLI::Validator whole_from(std::uint64_t low, std::uint64_t high) {
  const std::string range = fmt::format("{} to {}", low, high);
  return CLI::Validator(
      [low, high, range](const std::string& text) {
        std::uint64_t value = 0;
        const char* const end = text.data() + text.size();
        const auto read = std::from_chars(text.data(), end, value);
        // The library would read "010" as eight.
        const bool plain = text.size() < 2 || text.front() != '0';
        const bool good = read.ec == std::errc() && read.ptr == end && plain && value >= low && value <= high;
        return good ? std::string()
                    : fmt::format("got {}, expected a whole number from {}", io::in_quotes(text), range);
      },
      high == std::numeric_limits<std::uint64_t>::max() ? fmt::format("from {}", low) : "from " + range);
}

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string all = report::joined(words, ",");
  return CLI::Validator(
      [words = std::move(words)](const std::string& text) {
        if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
        const std::string_view near = io::nearest(text, {words.begin(), words.end()});
        return fmt::format("got {}, expected {}{}", io::in_quotes(text),
                           words.size() == 1 ? words.front() : "one of " + report::listed(words),
                           near.empty() ? std::string() : fmt::format(", did you mean {}", near));
      },
      "{" + all + "}");
}

}  // namespace stribeck::cli
