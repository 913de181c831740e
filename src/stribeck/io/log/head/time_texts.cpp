// Times as texts: those of IEC 61131-3, hours beyond a day, milliseconds without leading zeros.
#include <algorithm>
#include <array>
#include <cctype>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>

namespace stribeck::io::detail {
namespace {

/// Removes one of these words and `#` at the begin of a text.
template <std::size_t N>
bool take_type(std::string_view& text, const std::array<std::string_view, N>& types) {
  const auto mark = text.find('#');
  if (mark == std::string_view::npos) return false;
  const bool known = std::any_of(types.begin(), types.end(), [&](std::string_view type) {
    return type.size() == mark && begins_with(text, type);
  });
  if (known) text.remove_prefix(mark + 1);
  return known;
}

bool all_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Digits behind `;` or behind a third colon at the end of a time; "" for other texts.
std::string_view milliseconds_of(std::string_view text) {
  text = trimmed(text);
  const auto mark = text.find_last_of(":;");
  if (mark == std::string_view::npos) return {};
  if (text[mark] == ':' && std::count(text.begin(), text.end(), ':') != 3) return {};
  const std::string_view digits = text.substr(mark + 1);
  return all_digits(digits) ? digits : std::string_view();
}

}  // namespace

std::optional<double> iec_duration(std::string_view text) {
  constexpr std::array<std::string_view, 4> kTypes{"T", "TIME", "LT", "LTIME"};
  if (!take_type(text, kTypes)) return std::nullopt;
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  constexpr std::array<std::pair<std::string_view, double>, 7> kUnits{
      {{"d", 86400.0}, {"h", 3600.0}, {"ms", 1e-3}, {"m", 60.0}, {"s", 1.0}, {"us", 1e-6}, {"ns", 1e-9}}};
  double seconds = 0.0;
  if (text.empty()) return std::nullopt;
  while (!text.empty()) {
    if (text.front() == '_') text.remove_prefix(1);
    const auto end = std::min(text.find_first_not_of("0123456789."), text.size());
    const auto number = cell_number(text.substr(0, end), '.');
    text.remove_prefix(end);
    const auto* const unit =
        std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) { return begins_with(text, u.first); });
    if (!number || unit == kUnits.end()) return std::nullopt;
    text.remove_prefix(unit->first.size());
    seconds += *number * unit->second;
  }
  return negative ? -seconds : seconds;
}

std::string_view without_iec_date(std::string_view text) {
  constexpr std::array<std::string_view, 4> kClocks{"TOD", "TIME_OF_DAY", "LTOD", "LTIME_OF_DAY"};
  constexpr std::array<std::string_view, 4> kDates{"DT", "DATE_AND_TIME", "LDT", "LDATE_AND_TIME"};
  if (take_type(text, kClocks) || !take_type(text, kDates)) return text;
  const auto behind = text.rfind('-');
  return behind == std::string_view::npos ? text : text.substr(behind + 1);
}

std::optional<double> hours_minutes_and_seconds(std::string_view text) {
  text = trimmed(text);
  const auto colon = text.find(':');
  constexpr std::size_t kMostDigits = 4;
  if (colon == std::string_view::npos || colon > kMostDigits || !all_digits(text.substr(0, colon)))
    return std::nullopt;
  const auto rest = text.substr(colon + 1);
  const auto second = rest.find(':');
  if (second != 2 || !all_digits(rest.substr(0, 2))) return std::nullopt;
  const std::string_view seconds = rest.substr(3);
  if (seconds.size() < 2 || !all_digits(seconds.substr(0, 2))) return std::nullopt;
  const bool comma = seconds.find(',') != std::string_view::npos;
  const auto h = cell_number(text.substr(0, colon), '.');
  const auto m = cell_number(rest.substr(0, 2), '.');
  const auto s = cell_number(seconds, comma ? ',' : '.');
  if (!h || !m || !s || !(*m < 60.0) || !(*s < 61.0)) return std::nullopt;
  return 3600.0 * *h + 60.0 * *m + *s;
}

bool is_time_text(std::string_view text) {
  return time_of_day(text) || minutes_and_seconds(text) || duration(text) || hours_minutes_and_seconds(text);
}

void fill_milliseconds(std::vector<std::string>& texts) {
  constexpr std::size_t kDigits = 3;
  std::size_t most = 0, least = kDigits;
  for (const std::string& text : texts) {
    const std::size_t digits = milliseconds_of(text).size();
    if (digits == 0) return;
    most = std::max(most, digits);
    least = std::min(least, digits);
  }
  if (most != kDigits || least == kDigits) return;
  for (std::string& text : texts) {
    const std::string_view digits = milliseconds_of(text);
    const auto at = static_cast<std::size_t>(digits.data() - text.data());
    text.insert(at, kDigits - digits.size(), '0');
  }
}

}  // namespace stribeck::io::detail
