#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/keys.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/log/json/json_table.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <system_error>
#include <tuple>
#include <utility>

namespace stribeck::io {

namespace {

using detail::CsvDialect;

std::string csv_quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) out.append(c == '"' ? 2 : 1, c);
  return out + '"';
}

/// A header cell, in quotes where it needs them.
std::string header_text(const Column& c) {
  std::string text = c.name;
  if (!c.unit_text.empty()) text += " [" + c.unit_text + ']';
  if (text.find_first_of(",;\t\"") == std::string::npos && !text.empty() && text[0] != '#' && text[0] != '%')
    return text;
  return csv_quoted(text);
}

}  // namespace

const Column* Log::find(std::string_view name) const {
  for (const auto& c : columns) {
    if (c.header == name) return &c;
  }
  for (const auto& c : columns) {
    if (c.name == name) return &c;
  }
  return nullptr;
}

const Column& Log::at(std::string_view name) const {
  if (const Column* c = find(name)) return *c;
  std::vector<std::string_view> names;
  std::string list;
  for (const auto& c : columns) {
    names.push_back(c.name);
    list += (list.empty() ? "" : ", ") + c.name;
  }
  std::string message = "no column " + in_quotes(name) + ", there are: " + list;
  if (const auto near = nearest(name, names); !near.empty()) message += " (meant " + in_quotes(near) + "?)";
  throw InputError(Problem{source, 0, "", std::move(message)});
}

namespace {

/// Plain text of a file: inflated, in UTF-8 without its mark, checked to be text.
class Plain {
 public:
  Plain(std::string_view bytes, const std::string& source) : text_(bytes) {
    if (bytes.substr(0, 2) == "\x1f\x8b") {
      plain_ = detail::inflated(bytes, source);
      text_ = plain_;
    }
    if (detail::is_utf16(text_)) {
      plain_ = detail::from_utf16(text_, source);
      text_ = plain_;
    } else if (auto east = detail::from_east_asian(text_)) {
      encoding_ = std::move(east->encoding);
      plain_ = std::move(east->utf8);
      text_ = plain_;
    }
    detail::check_text(text_, source);
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") text_.remove_prefix(3);
  }
  Plain(const Plain&) = delete;
  Plain& operator=(const Plain&) = delete;

  [[nodiscard]] std::string_view text() const { return text_; }
  void note_encoding(Log& log) const {
    if (!encoding_.empty()) log.notes.push_back("the text is read as " + encoding_);
  }

 private:
  std::string encoding_;
  std::string plain_;
  std::string_view text_;
};

/// Keys of a side file: data that a log itself lacks.
struct SideFile {
  std::vector<std::string> columns;
  std::optional<double> sample_time;

  static constexpr auto fields() {
    return std::tuple{
        field("columns", &SideFile::columns, "names and units of the columns in their order, as \"x mm\"")
            .or_default(),
        field("sample_time", &SideFile::sample_time, quantity("s", "ms").positive(), "time between two rows")
            .or_default()};
  }
};

/// Names of the first columns, with what keeps one from being read.
std::string columns_of(const Log& log) {
  constexpr std::size_t kMost = 12;
  std::string all;
  for (std::size_t c = 0; c < log.columns.size() && c < kMost; ++c) {
    all += (c > 0 ? ", " : "") + in_quotes(log.columns[c].header);
    if (!log.columns[c].texts.empty())
      all += " (text, such as " + in_quotes(log.columns[c].texts.front()) + ")";
  }
  if (log.columns.size() > kMost) all += " and " + std::to_string(log.columns.size() - kMost) + " more";
  return all;
}

/// Time of a CSV table: found, or computed from the sample time.
void complete_times(Log& log, const ReadOptions& options) {
  if (!options.time_column.empty()) {
    static_cast<void>(log.at(options.time_column));
    return;
  }
  if (detail::name_sinumerik_signals(log, options) && time_column(log) >= 0) return;
  detail::tell_odrive_units(log);
  detail::tell_indices(log);
  if (detail::join_seconds(log, options.sample_time.has_value())) return;
  detail::tell_epoch(log);
  detail::tell_unit_of_time(log, options.machine_period);
  const bool replaced = options.sample_time && detail::leave_out_coarse_time(log);
  if (!replaced && time_column(log) >= 0) {
    if (options.sample_time) {
      log.notes.push_back("the given sample time is not used: column " +
                          in_quotes(log.columns[static_cast<std::size_t>(time_column(log))].header) +
                          " holds the time");
    }
    return;
  }
  const detail::ToldSampling told = detail::told_sampling(log);
  const std::optional<double> period = options.sample_time ? options.sample_time
                                       : told.period       ? told.period
                                                           : options.machine_period;
  const bool of_machine = !options.sample_time && !told.period;
  // Never where the times are not needed, and where no period would be taken in their place.
  const bool taken = of_machine && options.machine_period && options.times_needed;
  if (const Column* time = taken ? detail::time_of_unknown_unit(log) : nullptr; time != nullptr) {
    const std::string name = time->header.empty() ? time->name : time->header;
    throw InputError(Problem{
        log.source, 0, "",
        "column " + in_quotes(name) +
            " looks like the time, in a unit that is not known (say how long one count is: --map t=\"" +
            name +
            " 1e-7 s\", with your value; or --sample-time \"1 ms\" where rows follow each other at equal times)"});
  }
  constexpr const char* kOtherPeriod =
      " (where the log has every second or every tenth period alone, say so with --sample-time)";
  if (!period) {
    if (!options.times_needed) return;
    throw InputError(Problem{log.source, 0, "",
                             "has no time column; the columns are " + columns_of(log) +
                                 (told.text.empty() ? "" : ", its head says " + in_quotes(told.text)) +
                                 " (give the time between rows with --sample-time \"1 ms\", with your value, "
                                 "or put sample_time = \"1 ms\" into " +
                                 log.source +
                                 ".toml; a column that is the time is named with --map t=\"COLUMN UNIT\")"});
  }
  std::vector<double> t(log.rows);
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = static_cast<double>(i) * *period;
  if (const Column* counter = detail::row_counter(log, of_machine);
      counter != nullptr && counter->values.size() == t.size()) {
    // What is given is the time between rows, unless it is the period of the machine.
    const bool of_rows =
        !of_machine && !(options.machine_period && std::abs(*options.machine_period / *period - 1.0) < 1e-6);
    detail::CountedTimes counted = detail::times_of_counter(*counter, *period, of_rows);
    if (!counted.even) {
      const bool one = counted.per_row == 1.0;
      log.notes.push_back(
          counted.text +
          (of_machine            ? ", the sample time of the machine file"
           : options.sample_time ? of_rows && !one ? ", so that rows are the given sample time apart"
                                                   : ", the given sample time"
           : of_rows && !one
               ? ", so that rows are as far apart as the head of the file says: " + in_quotes(told.text)
               : ", as the head of the file says: " + in_quotes(told.text)) +
          "; rows that it does not count are missing" + (of_machine && one ? kOtherPeriod : ""));
      detail::add_time(log, std::move(counted.t), "s");
      return;
    }
  }
  detail::add_time(log, std::move(t), "s");
  log.notes.push_back(
      (options.sample_time ? "the time is made from the given sample time of "
       : of_machine ? "there is no time column; the time is made from the sample time of the machine file, "
                    : "there is no time column; the time is made from the head of the "
                      "file, which says " +
                          in_quotes(told.text) + ": one row each ") +
      number_text(*period) + " s; a gap would not be seen" + (of_machine ? kOtherPeriod : ""));
}

Log read_table(std::string_view text, const std::string& source, const ReadOptions& options) {
  detail::AbsentCells absent;
  detail::CsvDialect dialect{
      options.skip_lines, options.names, detail::TextColumns::kKeep, true, false, true};
  dialect.keep_blank_rows = options.time_column.empty() && (options.times_needed || options.sample_time);
  Log log = detail::read_csv_text(text, source, dialect, &absent);
  if (options.time_column.empty()) detail::pair_times(log);
  const bool paired =
      std::any_of(log.columns.begin(), log.columns.end(), [](const Column& c) { return c.time >= 0; });
  complete_times(log, options);
  const int time = options.time_column.empty()
                       ? time_column(log)
                       : static_cast<int>(&log.at(options.time_column) - log.columns.data());
  if (absent.first && !paired) detail::leave_out_absent(log, time, *absent.first);
  return log;
}

Log read_text_log(std::string_view text, const std::string& source, const ReadOptions& options) {
  using namespace detail;
  if (may_be_json(text)) {
    const auto table = csv_of_json(text, source);
    if (!table) return read_sinumerik_json(text, source, options);
    Log log = read_table(*table, source, options);
    log.format = "JSON";
    return log;
  }
  const auto start = trimmed(text.substr(0, 4096)).substr(0, 1);
  if (begins_with(trimmed(text), "<!doctype html") || begins_with(trimmed(text), "<html")) {
    throw InputError(
        Problem{source, 0, "",
                "is a page of HTML, not a log (open it in a browser: it may ask for a login, or report an "
                "error)"});
  }
  if (start == "<") return read_sinumerik_trace(text, source);
  if (is_tncscope(text)) return read_tncscope(text, source);
  if (is_twincat(text)) return read_twincat(text, source);
  if (is_epos(text)) return read_epos(text, source);
  if (is_mr_configurator(text)) return read_mr_configurator(text, source);
  if (is_ni_daq(text)) return read_ni_daq(text, source);
  if (is_halsampler(text)) return read_halsampler(text, source, options);
  return read_table(text, source, options);
}

CsvDialect dialect(const CsvOptions& options) {
  return {options.skip_lines,
          options.names,
          options.leave_out_text_columns ? detail::TextColumns::kLeaveOut : detail::TextColumns::kRefuse,
          false,
          options.unit_after_blank,
          false};
}

}  // namespace

Log parse_csv(std::string_view bytes, const std::string& source, const CsvOptions& options) {
  const Plain plain(bytes, source);
  Log log = detail::read_csv_text(plain.text(), source, dialect(options));
  plain.note_encoding(log);
  return log;
}

Log read_csv(const std::string& path, const CsvOptions& options) {
  const FileBytes bytes(path);
  return parse_csv(bytes.view(), path, options);
}

Log parse_log(std::string_view bytes, const std::string& source, const ReadOptions& options) {
  const Plain plain(bytes, source);
  Log log = read_text_log(plain.text(), source, options);
  plain.note_encoding(log);
  detail::note_times(log);
  return log;
}

std::vector<KeyInfo> side_file_keys() { return keys_of<SideFile>(); }

SideFileData read_side_file(const std::string& path) {
  const Node node = load_toml(path);
  if (const Node* old = node.find("period")) {
    throw InputError(
        {path, old->line, "period", "is called sample_time (write sample_time = \"1 ms\", with your value)"});
  }
  Problems problems(path);
  const auto given = read<SideFile>(node, problems);
  problems.throw_if_any();
  return {given.columns, given.sample_time};
}

std::vector<Column> named_columns(const std::vector<std::string>& names) {
  std::vector<Column> columns;
  Notes notes;
  for (const std::string& name : names) columns.push_back(detail::column_of(detail::header_of(name), notes));
  return columns;
}

Log read_log(const std::string& path, const ReadOptions& options) {
  ReadOptions all = options;
  const std::string side = path + ".toml";
  std::error_code ignored;
  if (std::filesystem::is_regular_file(side, ignored)) {
    const SideFileData given = read_side_file(side);
    if (all.names.empty()) all.names = given.columns;
    if (!all.sample_time) all.sample_time = given.sample_time;
  }
  const FileBytes bytes(path);
  return parse_log(bytes.view(), path, all);
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

namespace {

bool is_other_than_time(const std::string& unit) {
  try {
    return !(conversion(unit, "s").factor > 0.0);
  } catch (const InputError&) {
    return true;
  }
}

/// In all but one of twenty rows.
bool rises_mostly(const std::vector<double>& values) {
  std::size_t still = 0;
  for (std::size_t k = 1; k < values.size(); ++k) still += values[k] > values[k - 1] ? 0 : 1;
  return 20 * still <= values.size();
}

/// How surely a column is the time, by its name and unit; 0: it is none. "T" may be a torque or a temperature, and one with such a unit is.
int rank_as_time(const Column& c) {
  if (!c.texts.empty()) return 0;
  constexpr std::array kUnits{"s", "ms", "us", "µs", "ns", "min", "h", "sec"};
  const bool unit = std::find(kUnits.begin(), kUnits.end(), c.unit_text) != kUnits.end();
  if (std::find(kTimeNames.begin(), kTimeNames.end(), lower_case(c.name)) == kTimeNames.end())
    return unit ? 1 : 0;
  if (!unit && !c.unit_text.empty() && is_other_than_time(c.unit_text)) return 0;
  // A coarse clock may stand beside the time of the rows, and a unit beside neither. One stamp may be doubled.
  const bool rises = rises_mostly(c.values);
  const int sure = (rises ? 2 : 0) + (unit || !c.unit_text.empty() ? 1 : 0);
  return c.name == "T" ? 2 + sure : 6 + sure;
}

}  // namespace

int time_column(const Log& log) {
  int best = -1;
  int rank = 0;
  for (std::size_t i = 0; i < log.columns.size(); ++i) {
    const int own = rank_as_time(log.columns[i]);
    if (own > rank) best = static_cast<int>(i);
    rank = std::max(rank, own);
  }
  return best;
}

std::vector<double> in_si(const Column& column, const Quantity& quantity) {
  const std::string place = "column " + in_quotes(column.header.empty() ? column.name : column.header);
  const std::string_view wanted = quantity.shown.empty() ? quantity.unit : quantity.shown;
  if (column.unit_text.empty()) {
    throw InputError(Problem{"", 0, place,
                             "has no unit, expected one like " + std::string(wanted.empty() ? "1" : wanted) +
                                 " (name it in the header as " +
                                 in_quotes(column.name + " [" + std::string(wanted) + "]") + ")"});
  }
  Conversion convert;
  try {
    convert = conversion(column.unit_text, quantity.unit);
  } catch (const InputError& e) {
    throw InputError(Problem{"", 0, place, e.problems().front().message});
  }
  std::vector<double> values(column.values.size());
  // The divisor is taken out of the loop: the same value as convert(x), without a power per sample.
  const double divisor = convert.decimal && convert.power < 0 ? std::pow(10.0, -convert.power) : 0.0;
  std::transform(column.values.begin(), column.values.end(), values.begin(),
                 [&](double x) { return divisor > 0.0 ? x / divisor : x * convert.factor; });
  return values;
}

std::string csv_text(const Log& log) {
  for (const auto& c : log.columns) {
    if (std::max(c.values.size(), c.texts.size()) == log.rows) continue;
    throw InputError(Problem{log.source, 0, "column " + in_quotes(c.name),
                             "has " + std::to_string(c.values.size()) + " samples, expected " +
                                 std::to_string(log.rows) +
                                 " as in the longest (columns of different rates have no common table)"});
  }
  std::string out;
  for (const auto& [key, value] : log.metadata) {
    out += "# " + printable(key + ": " + value) + '\n';
  }
  for (std::size_t c = 0; c < log.columns.size(); ++c)
    out += (c > 0 ? "," : "") + header_text(log.columns[c]);
  out += '\n';
  out.reserve(out.size() + log.rows * log.columns.size() * 12);
  std::array<char, 40> buffer{};
  for (std::size_t r = 0; r < log.rows; ++r) {
    for (std::size_t c = 0; c < log.columns.size(); ++c) {
      if (c > 0) out += ',';
      if (!log.columns[c].texts.empty()) {
        out += csv_quoted(log.columns[c].texts[r]);
        continue;
      }
      out.append(buffer.data(), std::to_chars(buffer.begin(), buffer.end(), log.columns[c].values.at(r)).ptr);
    }
    out += '\n';
  }
  return out;
}

void write_csv(const std::string& path, const Log& log) { write_atomically(path, csv_text(log)); }

namespace {

/// Six digits, because differences of times contain rounding errors.
std::string rounded(double x) {
  std::array<char, 40> buffer{};
  const auto made = std::to_chars(buffer.begin(), buffer.end(), x, std::chars_format::general, 6);
  return {buffer.begin(), made.ptr};
}

}  // namespace

TimeCheck check_time(const std::vector<double>& values, const std::string& source, const std::string& name,
                     const std::string& unit) {
  const std::string place = "column " + in_quotes(name);
  if (values.size() < 2) {
    throw InputError(
        Problem{source, 0, place, "has " + std::to_string(values.size()) + " rows, expected at least two"});
  }
  std::vector<double> steps(values.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = values[i + 1] - values[i];
    if (!(steps[i] > 0.0)) {
      throw InputError(
          Problem{source, 0, place,
                  "row " + std::to_string(i + 2) + ": time " +
                      (steps[i] < 0.0    ? "goes back"
                       : steps[i] == 0.0 ? "stands still"
                                         : "is not a number") +
                      ", from " + number_text(values[i]) + " to " + number_text(values[i + 1]) +
                      ", expected it to increase (cut the log there, or repair the time column)"});
    }
  }
  TimeCheck result;
  auto sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  result.sample_time = *middle;
  if (sorted.size() % 2 == 0)
    result.sample_time = 0.5 * (*middle + *std::max_element(sorted.begin(), middle));

  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double ratio = steps[i] / result.sample_time;
    if (ratio > 1.5) {
      result.gaps.push_back({i + 2, steps[i]});
    } else if (std::abs(ratio - 1.0) > result.jitter) {
      result.jitter = std::abs(ratio - 1.0);
      result.jitter_row = i + 2;
    }
  }
  if (!result.gaps.empty()) {
    const auto& first = result.gaps.front();
    result.notes.emplace_back(
        "time has " + std::to_string(result.gaps.size()) + (result.gaps.size() == 1 ? " gap" : " gaps") +
            ", the first before row " + std::to_string(first.row) + ": " + rounded(first.duration) +
            " instead of " + rounded(result.sample_time) + (unit.empty() ? "" : " " + unit),
        Note::About::kGaps);
  }
  if (result.jitter > TimeCheck::kJitterTolerance) {
    result.notes.push_back("time jitters by up to " + number_text(std::round(1000.0 * result.jitter) / 10.0) +
                           " % of the sample time, most at row " + std::to_string(result.jitter_row));
  }
  return result;
}

}  // namespace stribeck::io
