#include <fmt/core.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <stribeck/ident/health/date.hpp>

namespace stribeck::ident::health {
namespace {

std::optional<int> digits(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.front() == '-') return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> day_of(std::string_view date) {
  if (date.size() != 10 || date[4] != '-' || date[7] != '-') return std::nullopt;
  const auto year = digits(date.substr(0, 4)), month = digits(date.substr(5, 2)),
             day = digits(date.substr(8, 2));
  if (!year || !month || !day) return std::nullopt;
  const std::chrono::year_month_day found{std::chrono::year{*year},
                                          std::chrono::month{static_cast<unsigned>(*month)},
                                          std::chrono::day{static_cast<unsigned>(*day)}};
  if (!found.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days{found}.time_since_epoch().count());
}

std::string date_of(double day) {
  const std::chrono::sys_days days{std::chrono::days{static_cast<int>(std::floor(day))}};
  const std::chrono::year_month_day found{days};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(found.year()),
                     static_cast<unsigned>(found.month()), static_cast<unsigned>(found.day()));
}

}  // namespace stribeck::ident::health
