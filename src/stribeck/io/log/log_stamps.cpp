// Time stamps of tables: times since 1970 without a unit, what the head says of the sampling, stamps that are no use beside a given
// sample time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>
#include <utility>

namespace stribeck::io::detail {

void tell_indices(Log& log) {
  for (Column& c : log.columns) {
    if (c.unit_text != "1" || !c.header.ends_with("[1]")) continue;
    const std::string stem = c.header.substr(0, c.header.size() - 3);
    const bool beside = std::any_of(log.columns.begin(), log.columns.end(), [&](const Column& other) {
      return other.header == stem + "[0]" || other.header == stem + "[2]";
    });
    if (!beside) continue;
    c.name = c.header;
    c.unit_text.clear();
  }
}

namespace {

/// Half of the steps are longer [units of the column]; 0 where the times do not increase.
double usual_step(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (const double step = t[k] - t[k - 1]; step > 0.0) steps.push_back(step);
  }
  if (2 * steps.size() < t.size()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

void tell_epoch(Log& log) {
  const int at = time_column(log);
  if (at < 0) return;
  Column& c = log.columns[static_cast<std::size_t>(at)];
  if (!c.unit_text.empty() || c.values.empty()) return;
  const auto [low, high] = std::minmax_element(c.values.begin(), c.values.end());
  // From September 2001 to October 2096; the ranges of the units do not meet. A finer unit, counted since the power came on, has such
  // numbers too: its rows would be hours apart.
  constexpr double kLongestStep = 60.0;  // [s]
  const double step = usual_step(c.values);
  for (const auto& [unit, scale] : {std::pair{"s", 1.0}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}}) {
    if (*low < 1e9 * scale || *high > 4e9 * scale || step > kLongestStep * scale) continue;
    c.unit_text = unit;
    c.unit_assumed = true;
    log.notes.push_back("column " + in_quotes(c.header) +
                        " has no unit; its numbers are times since 1970 in " + unit);
    return;
  }
  // Days since 1899, as spreadsheets count them: from 1954 to 2173. Rows of 0.1 ms to 0.2 s are no seconds of a log then.
  constexpr double kEarliest = 2e4, kLatest = 1e5;  // [d]
  constexpr double kShortest = 1e-9, kLongest = 2.3e-6;
  const double between = (*high - *low) / static_cast<double>(c.values.size());
  if (!(*low >= kEarliest && *high <= kLatest && between > kShortest && between < kLongest)) return;
  c.unit_text = "d";
  c.unit_assumed = true;
  log.notes.push_back("column " + in_quotes(c.header) +
                      " has no unit; its numbers are days since 1899, as spreadsheets count them");
}

namespace {

/// 0, 1, 2, … or 7, 8, 9, …: perhaps numbers of rows.
bool counts_rows(const std::vector<double>& t) {
  if (t.empty() || t.front() != std::floor(t.front())) return false;
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (t[k] != t[k - 1] + 1.0) return false;
  }
  return true;
}

}  // namespace

namespace {

void tell_unit(Log& log, Column& c, std::optional<double> control_period) {
  // Of a log of a drive [s]. Between them the units mostly tell themselves apart.
  constexpr double kShortest = 15e-6, kLongest = 1.0;
  constexpr double kMostPeriods = 20.0;  // of the control from row to row
  if (!c.unit_text.empty() || !c.texts.empty() || counts_rows(c.values)) return;
  if (c.header.find_first_of("[(") != std::string::npos) return;  // a unit that is not known
  const double step = usual_step(c.values);
  const double shortest = control_period ? 0.9 * *control_period : kShortest;
  const double longest = control_period ? kMostPeriods * *control_period : kLongest;
  std::vector<std::pair<const char*, double>> units;
  // A ten-millionth of a second is the tick of Windows. No log has a unit of this name, but its rows could be ticks.
  for (const auto& [unit, scale] :
       {std::pair{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"", 1e-7}, {"ns", 1e-9}}) {
    if (step * scale >= shortest && step * scale <= longest) units.emplace_back(unit, scale);
  }
  if (units.size() != 1 || units.front().second == 1e-7) return;
  c.unit_text = units.front().first;
  c.unit_assumed = true;
  log.notes.push_back(
      "column " + in_quotes(c.header) + " has no unit; taken as " + c.unit_text +
      fmt::format(", in which the rows are {:.4g} ms apart; if that is wrong: --map t={}, with your unit",
                  1e3 * step * units.front().second, in_quotes(c.name + " ms")));
}

}  // namespace

void tell_unit_of_time(Log& log, std::optional<double> control_period) {
  const auto tell = [&](int at) {
    if (at >= 0) tell_unit(log, log.columns[static_cast<std::size_t>(at)], control_period);
  };
  tell(time_column(log));
  // Channels of other rates have times of their own.
  for (const Column& c : log.columns) tell(c.time);
}

namespace {

/// The time between rows in a text [s]: a number with a unit of time or of a rate behind it, or in brackets before it.
std::optional<double> period_in(const std::string& told) {
  const auto colon = told.find(": ");
  const auto first = told.find_first_of("0123456789", colon == std::string::npos ? 0 : colon);
  if (first == std::string::npos) return std::nullopt;
  const auto last = std::min(told.find_first_not_of("0123456789.", first), told.size());
  const auto number = cell_number(std::string_view(told).substr(first, last - first), '.');
  if (!number || !(*number > 0.0)) return std::nullopt;
  const auto letter = std::min(told.find_first_not_of(" \t,;[(\"", last), told.size());
  const auto end = std::min(told.find_first_of(" \t,;])\"", letter), told.size());
  std::string written = told.substr(letter, end - letter);
  const auto open = told.substr(0, first).find_last_of("[(");
  if (written.empty() && open != std::string::npos) {
    const auto close = std::min(told.find_first_of("])", open), first);
    written = told.substr(open + 1, close - open - 1);
  }
  Notes unused;
  const std::string unit = plain_unit(written, "", unused);
  if (!is_unit(unit)) return std::nullopt;
  for (const auto& [of, rate] : {std::pair{"s", false}, {"Hz", true}}) {
    try {
      const double value = *number * conversion(unit, of).factor;
      const double period = rate ? 1.0 / value : value;
      if (std::isfinite(period) && period > 0.0) return period;
    } catch (const InputError&) {  // of another quantity
    }
  }
  return std::nullopt;
}

bool has_one_of(const std::string& name, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return name.find(word) != std::string::npos; });
}

bool has_word(const std::string& name, std::initializer_list<std::string_view> words) {
  std::string word;
  for (std::size_t i = 0; i <= name.size(); ++i) {
    if (i < name.size() && std::isalpha(static_cast<unsigned char>(name[i])) != 0) {
      word += name[i];
      continue;
    }
    if (std::find(words.begin(), words.end(), word) != words.end()) return true;
    word.clear();
  }
  return false;
}

/// "4", "4 samples", "4th": a number of samples; a time has another unit.
std::optional<double> counted(const std::string& value) {
  const std::string text = lower_case(value);
  const auto end = text.find_first_not_of("0123456789");
  if (end == std::string::npos || end == 0) return cell_number(value, '.');
  constexpr std::array<std::string_view, 17> kCounts{"sample", "samples", "cycle",  "cycles", "row",   "rows",
                                                     "point",  "points",  "value",  "values", "th",    "nd",
                                                     "rd",     "zyklus",  "zyklen", "werte",  "punkte"};
  const std::string_view behind = trimmed(std::string_view(text).substr(end));
  if (std::find(kCounts.begin(), kCounts.end(), behind) == kCounts.end()) return cell_number(value, '.');
  return cell_number(text.substr(0, end), '.');
}

/// Whether a line of the head says that not each sample became a row: "Downsampling: 16", "Save every: 4", "Abtastfaktor: 4". Small
/// letters.
bool is_divider(const std::string& name, const std::string& value) {
  // More samples than rows inside the drive make no other rows.
  if (has_one_of(name, {"oversampl", "over-sampl", "\u00FCberabtast"})) return false;
  const auto number = counted(value);
  if (number && *number == 1.0) return false;
  if (has_one_of(name,
                 {"downsampl", "undersampl", "subsampl", "decimat", "dezim", "prescal", "teiler", "every n"}))
    return true;
  // "Individual axis" is none.
  if (const auto at = name.find("divi");
      at != std::string::npos && (at < 2 || name.substr(at - 2, 2) != "in"))
    return true;
  if (!number || !(*number > 1.0) || *number != std::floor(*number)) return false;
  const bool of_samples = has_one_of(name, {"sampl", "abtast"});
  const bool of_rows = has_one_of(name, {"save", "saving", "speicher", "record", "aufzeichn"}) ||
                       has_word(name, {"log", "logging", "logged", "store", "storage", "storing", "stored"});
  // The interval of the samples is a time whose unit is missing.
  const bool ratio = has_one_of(name, {"factor", "faktor", "multipl", "every", "jede", "skip", "ratio",
                                       "verh\u00E4ltnis"}) ||
                     (!of_samples && name.find("interval") != std::string::npos);
  return ((of_samples || of_rows) && ratio) || name == "every" || name == "skip";
}

}  // namespace

ToldSampling told_sampling(const Log& log) {
  ToldSampling told;
  bool differ = false;
  for (const auto& [key, value] : log.metadata) {
    const std::string name = lower_case(key);
    if (!has_one_of(name, {"sampl", "abtast", "time step", "zeitschritt", "cycle"})) continue;
    // The length of the record is a time as well, and a cycle may be that of the control.
    if (has_one_of(name, {"duration", "dauer", "length", "total", "number", "count", "points"})) continue;
    // A filter, an average or a trigger has a time of its own.
    if (has_one_of(name, {"filter", "window", "fenster", "delay", "verz", "trigger", "averag", "mittel"}))
      continue;
    const std::string text = key + ": " + value;
    const auto period = name.find("cycle") != std::string::npos && !has_one_of(name, {"sampl", "abtast"})
                            ? std::nullopt
                            : period_in(text);
    if (told.text.empty() || (period && !told.period && !differ)) told.text = text;
    // 1e-3: both a time and a rate, rounded.
    if (period && told.period && std::abs(*period - *told.period) > 1e-3 * *told.period) differ = true;
    if (period && !told.period) told.period = period;
  }
  // "Downsampling: 16": whether the time between rows is that of the head or 16 of it is not said.
  for (const auto& [key, value] : log.metadata) {
    if (!is_divider(lower_case(key), value)) continue;
    if (told.period) told.text += ", " + key + ": " + value;
    told.period.reset();
  }
  if (differ) told.period.reset();
  return told;
}

namespace {

/// Whole numbers that increase from the first row on; some may be absent.
bool counts_up(const std::vector<double>& values) {
  double before = -std::numeric_limits<double>::infinity();
  for (const double x : values) {
    if (std::isnan(x) && !std::isinf(before)) continue;
    if (!(x > before) || x != std::floor(x)) return false;
    before = x;
  }
  return true;
}

}  // namespace

CountedTimes times_of_counter(const Column& counter, double period, bool of_rows) {
  const std::vector<double>& n = counter.values;
  std::vector<double> steps;
  for (std::size_t i = 1; i < n.size(); ++i)
    if (n[i] > n[i - 1]) steps.push_back(n[i] - n[i - 1]);
  CountedTimes out;
  if (!steps.empty()) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    out.per_row = std::max(1.0, *middle);
  }
  const double per_row = of_rows ? out.per_row : 1.0, each = period / per_row;
  for (std::size_t i = 0; i < n.size(); ++i) {
    const double count = n[i] - n.front();
    out.even = out.even && count == static_cast<double>(i) * per_row;
    out.t.push_back(count * each);
  }
  out.text = "the time is " + in_quotes(counter.header) + " times " + number_text(each) + " s";
  if (out.per_row != 1.0) out.text += ", and it counts " + number_text(out.per_row) + " for each row";
  return out;
}

const Column* row_counter(const Log& log, bool of_control) {
  constexpr std::array<std::string_view, 14> kNames{"index", "sample",  "samples", "sample number", "no",
                                                    "no.",   "nr",      "nr.",     "number",        "cycle",
                                                    "count", "counter", "row",     "takt"};
  for (const Column& c : log.columns) {
    if (!c.texts.empty() || c.values.size() < 2 || (!c.unit_text.empty() && c.unit_text != "1")) continue;
    const std::string name = lower_case(c.name);
    const std::string last = name.substr(name.find_last_of(" _-") + 1);  // "IPO_Cycle"
    constexpr std::array<std::string_view, 3> kOfControl{"cycle", "cycles", "takt"};
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end() &&
        (!of_control || std::find(kOfControl.begin(), kOfControl.end(), last) == kOfControl.end()))
      continue;
    if (counts_up(c.values)) return &c;
  }
  return nullptr;
}

namespace {

/// "Time", "Time 2", "Zeit_2", "TIME in column 3"; with a unit of time also "Time A".
bool begins_with_time(const Column& c) {
  const std::string name = lower_case(c.name);
  constexpr std::array<std::string_view, 4> kUnits{"s", "ms", "us", "ns"};
  const bool unit = std::find(kUnits.begin(), kUnits.end(), c.unit_text) != kUnits.end();
  for (const std::string_view word : {"timestamp", "time", "zeit", "t"}) {
    if (!name.starts_with(word)) continue;
    const std::string_view rest = std::string_view(name).substr(word.size());
    if (rest.empty() || rest.find_first_not_of("0123456789 _#") == std::string_view::npos ||
        rest.starts_with(" in column ") || (unit && rest.find_first_of(" _-.") == 0))
      return true;
  }
  return false;
}

/// Whether the times that are there increase; there are at least two.
bool increases(const std::vector<double>& t) {
  std::size_t count = 0;
  double before = 0.0;
  for (const double x : t) {
    if (std::isnan(x)) continue;
    if (count++ > 0 && !(x > before)) return false;
    before = x;
  }
  return count >= 2;
}

bool same_stamps(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

}  // namespace

const Column* time_of_unknown_unit(const Log& log) {
  for (const Column& c : log.columns) {
    const std::string& header = c.header.empty() ? c.name : c.header;
    const auto bracket = header.find_first_of("[(");
    if (!c.texts.empty() || bracket == std::string::npos || bracket == 0) continue;
    std::string base = lower_case(header.substr(0, bracket));
    base.erase(base.find_last_not_of(" _") + 1);
    if (std::find(kTimeNames.begin(), kTimeNames.end(), base) != kTimeNames.end() && increases(c.values))
      return &c;
  }
  return nullptr;
}

bool pair_times(Log& log) {
  const auto is_time = [](const Column& c) {
    return begins_with_time(c) && c.texts.empty() && increases(c.values);
  };
  std::vector<std::size_t> times;
  for (std::size_t c = 0; c < log.columns.size(); ++c) {
    if (log.columns[c].time >= 0) return false;  // paired
    if (is_time(log.columns[c])) times.push_back(c);
  }
  if (times.size() < 2 || times.front() != 0) return false;
  const Column& first = log.columns.front();
  const auto other = [&](std::size_t c) { return !same_stamps(log.columns[c].values, first.values); };
  const auto behind = [&](std::size_t c) {
    return c + 1 < log.columns.size() && !is_time(log.columns[c + 1]);
  };
  if (std::none_of(times.begin(), times.end(), other) || !std::all_of(times.begin(), times.end(), behind) ||
      !std::all_of(times.begin(), times.end(),
                   [&](std::size_t c) { return log.columns[c].unit_text == first.unit_text; }))
    return false;
  const std::string unit = first.unit_text;
  if (unit.empty()) {
    log.notes.push_back(
        "columns " + in_quotes(first.header) + " and " + in_quotes(log.columns[times[1]].header) +
        " hold different times, and the first one is used for all columns: write a unit into both names, as in " +
        in_quotes(first.header + " [ms]") + ", where each is the time of the columns behind it");
    return false;
  }
  std::vector<Group> groups;
  std::vector<Column> texts;
  for (std::size_t c = 0; c < log.columns.size(); ++c) {
    Column& column = log.columns[c];
    if (std::find(times.begin(), times.end(), c) != times.end()) {
      groups.push_back({std::move(column.values), {}});
    } else if (column.texts.empty()) {
      groups.back().channels.push_back(std::move(column));
    } else {
      texts.push_back(std::move(column));
    }
  }
  for (Group& group : groups) {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < group.t.size(); ++k) {
      if (!std::isnan(group.t[k])) rows.push_back(k);
    }
    const auto keep = [&](std::vector<double>& values) {
      std::vector<double> kept;
      for (const std::size_t k : rows) kept.push_back(values[k]);
      values = std::move(kept);
    };
    if (rows.size() == group.t.size()) continue;
    for (Column& channel : group.channels) keep(channel.values);
    keep(group.t);
  }
  log.columns.clear();
  log.rows = 0;
  add_groups(log, std::move(groups), unit);
  log.notes.push_back("each column has the time that stands before it: the table has " +
                      std::to_string(times.size()) + " columns of times");
  for (const Column& text : texts)
    log.notes.push_back("column " + in_quotes(text.header) + " was left out: it holds text");
  return true;
}

bool leave_out_coarse_time(Log& log) {
  const int at = time_column(log);
  if (at < 0) return false;
  const Column& c = log.columns[static_cast<std::size_t>(at)];
  std::size_t same = 0;
  for (std::size_t k = 1; k < c.values.size(); ++k) same += c.values[k] == c.values[k - 1] ? 1 : 0;
  if (same * 20 <= c.values.size()) return false;
  log.notes.push_back("column " + in_quotes(c.header) + " was left out: its stamps stand still in " +
                      std::to_string(same) + " of " + std::to_string(c.values.size()) +
                      " rows, and the sample time is given");
  log.columns.erase(log.columns.begin() + at);
  return true;
}

}  // namespace stribeck::io::detail
