// Times in two columns: the seconds in one, and their fraction in another.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>

namespace stribeck::io::detail {
namespace {

/// What the seconds and their fraction are called behind the same first letters.
struct SplitNames {
  std::string_view seconds;
  std::string_view fraction;
  double scale;  ///< of the fraction [s]
  bool stamp;    ///< always parts of one stamp: a fraction of more than a second is an error
};
/// ROS 1 and ROS 2, as their tools export them (header.stamp.secs and header.stamp.nsecs); C (tv_sec and tv_usec).
constexpr std::array<SplitNames, 17> kSplitNames{{{"secs", "nsecs", 1e-9, true},
                                                  {"sec", "nanosec", 1e-9, true},
                                                  {"sec", "nsec", 1e-9, true},
                                                  {"secs", "usecs", 1e-6, false},
                                                  {"sec", "usec", 1e-6, false},
                                                  {"secs", "msecs", 1e-3, false},
                                                  {"sec", "msec", 1e-3, false},
                                                  {"sec", "ms", 1e-3, false},
                                                  {"sec", "us", 1e-6, false},
                                                  {"seconds", "nanoseconds", 1e-9, false},
                                                  {"seconds", "microseconds", 1e-6, false},
                                                  {"seconds", "milliseconds", 1e-3, false},
                                                  {"sekunden", "nanosekunden", 1e-9, false},
                                                  {"sekunden", "mikrosekunden", 1e-6, false},
                                                  {"sekunden", "millisekunden", 1e-3, false},
                                                  {"s", "ms", 1e-3, false},
                                                  {"s", "us", 1e-6, false}}};

/// What the fraction of a second is called beside a clock.
constexpr std::array<std::pair<std::string_view, double>, 21> kFractions{{{"ms", 1e-3},
                                                                          {"msec", 1e-3},
                                                                          {"msecs", 1e-3},
                                                                          {"millis", 1e-3},
                                                                          {"millisec", 1e-3},
                                                                          {"millisecond", 1e-3},
                                                                          {"milliseconds", 1e-3},
                                                                          {"millisekunde", 1e-3},
                                                                          {"millisekunden", 1e-3},
                                                                          {"us", 1e-6},
                                                                          {"usec", 1e-6},
                                                                          {"usecs", 1e-6},
                                                                          {"micros", 1e-6},
                                                                          {"microsecond", 1e-6},
                                                                          {"microseconds", 1e-6},
                                                                          {"mikrosekunden", 1e-6},
                                                                          {"ns", 1e-9},
                                                                          {"nsec", 1e-9},
                                                                          {"nanosec", 1e-9},
                                                                          {"nanoseconds", 1e-9},
                                                                          {"nanosekunden", 1e-9}}};

bool is_called_time(std::string_view name) {
  return std::find(kTimeNames.begin(), kTimeNames.end(), name) != kTimeNames.end();
}

/// The header in small letters, without the unit in brackets. "tv_sec" stays whole, where the name of the column is "tv".
std::string whole_name(const Column& c) {
  std::string name = lower_case(c.header.empty() ? c.name : c.header);
  if (!name.ends_with(']') && !name.ends_with(')')) return name;
  const auto open = name.find_last_of("[(");
  if (open != std::string::npos && open > 0) name = std::string(trimmed(name.substr(0, open)));
  return name;
}

/// "Milliseconds", "Time_ms", "Zeit [us]": a part of a second of this size [s]; absent for other columns.
std::optional<double> size_of_fraction(const Column& c) {
  const std::string name = whole_name(c);
  std::string_view word = name;
  if (is_called_time(name)) word = c.unit_text;
  if (const auto mark = name.find_last_of(" ._-");
      mark != std::string::npos && is_called_time(std::string_view(name).substr(0, mark)))
    word.remove_prefix(mark + 1);
  const auto* const found =
      std::find_if(kFractions.begin(), kFractions.end(), [&](const auto& f) { return f.first == word; });
  return found == kFractions.end() ? std::nullopt : std::optional(found->second);
}

bool are_whole(const std::vector<double>& values) {
  return !values.empty() && std::all_of(values.begin(), values.end(),
                                        [](double x) { return std::isnan(x) || x == std::floor(x); });
}

/// Full seconds of a clock or of a column of seconds, in order; empty: the column is none of both.
std::vector<double> full_seconds(const Column& c) {
  std::vector<double> seconds;
  if (c.texts.empty()) {
    const bool named = c.unit_text == "s" || (c.unit_text.empty() && is_called_time(whole_name(c)));
    if (named) seconds = c.values;
  } else {
    constexpr double kDay = 86400.0;
    double before = 0.0;
    for (const std::string& text : c.texts) {
      const auto t = time_of_day(text);
      if (!t) return {};
      if (!seconds.empty() && *t + before < seconds.back() - 0.5 * kDay) before += kDay;
      seconds.push_back(*t + before);
    }
  }
  if (!are_whole(seconds)) return {};
  return seconds;
}

bool is_fraction(const std::vector<double>& values, double scale) {
  return std::all_of(values.begin(), values.end(),
                     [&](double x) { return std::isnan(x) || (x >= 0.0 && scale * x < 1.0 - 1e-12); });
}

/// Whether the fraction begins again with each second, and the sum increases. A second column may hold the same time in another unit.
bool fit_together(const std::vector<double>& seconds, const std::vector<double>& fraction, double scale) {
  if (seconds.size() != fraction.size() || !are_whole(seconds) || !is_fraction(fraction, scale)) return false;
  std::size_t still = 0, next = 0, again = 0, back = 0;
  for (std::size_t k = 1; k < seconds.size(); ++k) {
    const double step = seconds[k] - seconds[k - 1];
    const double part = fraction[k] - fraction[k - 1];
    if (step < 0.0) return false;
    still += step == 0.0 ? 1 : 0;
    next += step == 1.0 ? 1 : 0;
    again += step == 1.0 && part < 0.0 ? 1 : 0;
    back += step + scale * part > 0.0 ? 0 : 1;
  }
  return 2 * still >= seconds.size() - 1 && 20 * back <= seconds.size() && (next == 0 || 2 * again > next);
}

void add_sum(Log& log, const std::vector<double>& seconds, const Column& whole, const Column& part,
             double scale) {
  // Seconds since 1970 have too many digits for nanoseconds behind them.
  const auto first = std::find_if(seconds.begin(), seconds.end(), [](double x) { return !std::isnan(x); });
  const double start = first == seconds.end() ? 0.0 : *first;
  std::vector<double> t(seconds.size());
  for (std::size_t k = 0; k < t.size(); ++k) t[k] = (seconds[k] - start) + scale * part.values[k];
  log.notes.push_back("the time is the sum of columns " + in_quotes(whole.header) + " and " +
                      in_quotes(part.header) + ", counted from the whole second of the first row");
  if (whole.header == "t") log.columns.erase(log.columns.begin() + (&whole - log.columns.data()));
  add_time(log, std::move(t), "s");
}

void check_stamp(const Log& log, const Column& part) {
  for (std::size_t k = 0; k < part.values.size(); ++k) {
    if (std::isnan(part.values[k]) || (part.values[k] >= 0.0 && part.values[k] < 1e9)) continue;
    throw InputError(
        {log.source, 0, part.header,
         fmt::format("got {:.10g} in row {} of the table, expected nanoseconds from 0 to 999999999",
                     part.values[k], k + 1)});
  }
}

bool join_by_names(Log& log, const SplitNames& names) {
  for (const Column& whole : log.columns) {
    const std::string name = whole_name(whole);
    if (!whole.texts.empty() || !name.ends_with(names.seconds) || !are_whole(whole.values)) continue;
    const std::string stem = name.substr(0, name.size() - names.seconds.size());
    // "pos" ends with s too.
    if (names.seconds == "s" && !stem.empty() && std::isalpha(static_cast<unsigned char>(stem.back())) != 0)
      continue;
    const auto part = std::find_if(log.columns.begin(), log.columns.end(), [&](const Column& c) {
      return c.texts.empty() && whole_name(c) == stem + std::string(names.fraction);
    });
    if (part == log.columns.end() || part->values.size() != whole.values.size()) continue;
    if (names.stamp) {
      check_stamp(log, *part);
    } else if (!fit_together(whole.values, part->values, names.scale)) {
      continue;
    }
    add_sum(log, whole.values, whole, *part, names.scale);
    return true;
  }
  return false;
}

bool join_clock(Log& log) {
  for (const Column& part : log.columns) {
    const auto scale = part.texts.empty() ? size_of_fraction(part) : std::nullopt;
    if (!scale || part.values.empty()) continue;
    for (const Column& whole : log.columns) {
      if (&whole == &part) continue;
      const std::vector<double> seconds = full_seconds(whole);
      if (seconds.empty() || !fit_together(seconds, part.values, *scale)) continue;
      add_sum(log, seconds, whole, part, *scale);
      return true;
    }
  }
  return false;
}

}  // namespace

bool join_seconds(Log& log, bool given) {
  // Columns that have their times need no other.
  if (std::any_of(log.columns.begin(), log.columns.end(), [](const Column& c) { return c.time >= 0; }))
    return false;
  const bool joined = std::any_of(kSplitNames.begin(), kSplitNames.end(),
                                  [&](const SplitNames& names) { return join_by_names(log, names); }) ||
                      join_clock(log);
  if (joined && given) log.notes.emplace_back("the given sample time is not used: two columns hold the time");
  return joined;
}

}  // namespace stribeck::io::detail
