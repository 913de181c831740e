#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::detail {

namespace {

/// SIGNAL|n: the signal and the axis number; axis 0 where the name has another form.
struct Signal {
  std::string_view name;
  std::size_t axis = 0;
};

Signal signal_of(std::string_view header) {
  const auto bar = header.rfind('|');
  if (bar == std::string_view::npos || bar + 1 == header.size() || header.size() - bar > 4) return {header};
  std::size_t axis = 0;
  for (const char c : header.substr(bar + 1)) {
    if (c < '0' || c > '9') return {header};
    axis = 10 * axis + static_cast<std::size_t>(c - '0');
  }
  return {header.substr(0, bar), axis};
}

enum class Moves { kAlong, kAround, kUnknown };

/// Whether an axis turns, by its name: X1, MX1 (of the machine) and an axis without a name move along, C1, MC1, S1, SP1 and MSP1 turn.
/// AX1 may be any axis.
Moves moves_of(std::string_view axis_name) {
  if (axis_name.empty()) return Moves::kAlong;
  std::string letters;
  for (const char c : axis_name) {
    if (std::isalpha(static_cast<unsigned char>(c)) == 0) break;
    letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  if (letters.size() > 1 && letters.front() == 'M') letters.erase(0, 1);
  constexpr std::array<std::string_view, 7> kTurn{"A", "B", "C", "S", "SP", "SPINDLE", "SPINDEL"};
  if (std::find(kTurn.begin(), kTurn.end(), letters) != kTurn.end()) return Moves::kAround;
  return !letters.empty() && std::string_view("UVWXYZ").find(letters.front()) != std::string_view::npos
             ? Moves::kAlong
             : Moves::kUnknown;
}

/// Units that a recording of a real 840D sl has shown: the rate of ENC_POS is 1.000 times VEL_FFW in mm/s. The units of the others
/// are not known.
std::string unit_of(std::string_view signal, Moves moves) {
  if (signal == "ENC_POS" || signal == "DES_POS")
    return moves == Moves::kAround ? "deg" : moves == Moves::kAlong ? "mm" : "";
  if (signal == "VEL_FFW" && moves == Moves::kAlong) return "mm/s";
  if (signal == "CURRENT") return "A";
  return {};
}

void note_units(Log& log, bool axes_known) {
  log.notes.push_back(
      std::string("units are not in the file; from recordings of this format ENC_POS and DES_POS are in "
                  "mm, VEL_FFW in mm/s, CURRENT in A") +
      (axes_known ? "; axes called A, B, C and S (C1, MC1, SP1) turn, their positions are in deg"
                  : "; that holds for linear axes"));
}

/// Notes how often the cycle counter jumps, and how many samples are missing.
void note_jumps(Log& log, const std::vector<double>& cycle, double cycle_time_ms) {
  std::size_t jumps = 0;
  std::size_t first = 0;
  double lost = 0.0;
  for (std::size_t i = 1; i < cycle.size(); ++i) {
    if (cycle[i] <= cycle[i - 1] + 1.0) continue;
    if (jumps++ == 0) first = i;
    lost += cycle[i] - cycle[i - 1] - 1.0;
  }
  if (jumps == 0) return;
  log.notes.push_back("CYCLE jumps " + (jumps == 1 ? std::string("once") : std::to_string(jumps) + " times") +
                      ", first from " + number_text(cycle[first - 1]) + " to " + number_text(cycle[first]) +
                      " after row " + std::to_string(first) + ": " + number_text(lost) + " samples" +
                      (cycle_time_ms > 0.0 ? " (" + number_text(lost * cycle_time_ms * 1e-3) + " s)" : "") +
                      " are missing");
}

/// Counts lines while the parser reads.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, std::size_t* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_ == '\n') ++*line_;
    ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    const CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  std::size_t* line_;
};

/// Receives events of the parser; the file is never stored as a tree.
class CaptureReader : Reader {
 public:
  using Json = nlohmann::json;
  using number_integer_t = Json::number_integer_t;
  using number_unsigned_t = Json::number_unsigned_t;
  using number_float_t = Json::number_float_t;
  using string_t = Json::string_t;
  using binary_t = Json::binary_t;

  CaptureReader(std::string_view text, const std::string& source, const ReadOptions& options)
      : Reader(text, source, "SINUMERIK Edge JSON"), text_(text), options_(options) {}

  Log read() {
    Json::sax_parse(CountingIterator(text_.data(), &line_),
                    CountingIterator(text_.data() + text_.size(), &line_), this);
    build();
    finish();
    return std::move(log_);
  }

  bool null() { return scalar("null", nullptr); }
  bool boolean(bool value) { return scalar(value ? "true" : "false", nullptr); }
  bool number_integer(number_integer_t value) { return value_of(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) { return value_of(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) { return value_of(value); }
  bool string(string_t& value) { return scalar(value, &value); }
  bool binary(binary_t&) { return true; }
  bool key(string_t& name) {
    path_.back() = name;
    return true;
  }
  bool start_object(std::size_t) {
    if (in_row_) bad_cell("an object");
    open("");
    if (at({"Header", "SignalListHFData", "[]"}, 1)) signals_.emplace_back();
    if (signals_.size() > kMaxColumns) fail(line_, "has too many signals");
    return true;
  }
  bool end_object() {
    path_.pop_back();
    return true;
  }
  bool start_array(std::size_t) {
    if (in_row_) bad_cell("a list");
    if (at({"Payload", "[]", "HFData", "[]"}, 0)) {
      in_row_ = true;
      cell_ = 0;
    }
    open("[]");
    return true;
  }
  bool end_array() {
    path_.pop_back();
    if (!in_row_) return true;
    in_row_ = false;
    if (rows_ == 0) width_ = cell_;
    if (cell_ != width_) {
      fail(line_, "row " + std::to_string(rows_ + 1) + " of HFData: got " + std::to_string(cell_) +
                      " values, expected " + std::to_string(width_) +
                      " (damaged? record or export it again)");
    }
    ++rows_;
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& error) {
    // Up to this point the iterator has counted.
    if (error.id == 406) fail(line_, "holds a number that is too large, expected finite numbers");
    const bool end = trimmed(text_.substr(std::min(position, text_.size()))).empty();
    fail(line_, end ? "is cut off: the JSON text ends too early (copy or export it again)"
                    : "is not valid JSON near byte " + std::to_string(position) +
                          " (damaged? copy or export it again)");
  }

 private:
  struct Declared {
    std::string name;
    std::string axis;
  };

  void open(const char* key) {
    constexpr std::size_t kDeepest = 64;
    if (path_.size() >= kDeepest) fail(line_, "is nested deeper than 64 levels: not a capture");
    path_.emplace_back(key);
  }

  /// Whether the innermost keys of `path_`, without the last `skip`, are these keys under the root object.
  [[nodiscard]] bool at(std::initializer_list<std::string_view> keys, std::size_t skip) const {
    if (path_.size() != keys.size() + skip) return false;
    return std::equal(keys.begin(), keys.end(), path_.begin());
  }

  [[noreturn]] void bad_cell(const std::string& what) const {
    const std::string name = cell_ < signals_.size() ? signals_[cell_].name : std::to_string(cell_ + 1);
    fail(line_, "row " + std::to_string(rows_ + 1) + " of HFData, column " + in_quotes(name) + ": got " +
                    what + ", expected a number");
  }

  bool value_of(double value) {
    if (!std::isfinite(value)) fail(line_, "holds a number that is too large, expected finite numbers");
    if (!in_row_) {
      if (at({"Header", "CycleTimeMs"}, 0)) cycle_time_ms_ = value;
      return true;
    }
    if (cell_ >= columns_.size()) {
      if (rows_ > 0 || cell_ >= kMaxColumns) bad_cell("more values than in the first row");
      columns_.emplace_back();
    }
    columns_[cell_++].push_back(value);
    return true;
  }

  bool scalar(const std::string& shown, const std::string* text) {
    if (in_row_) bad_cell(text != nullptr ? in_quotes(shown) : shown);
    if (text == nullptr) return true;
    if (at({"Header", "SignalListHFData", "[]", "Name"}, 0) && !signals_.empty())
      signals_.back().name = *text;
    if (at({"Header", "SignalListHFData", "[]", "Axis"}, 0) && !signals_.empty())
      signals_.back().axis = *text;
    if (at({"Header", "MachineInfo", "MachineName"}, 0)) add_metadata("MachineName", *text);
    if (at({"Header", "TimeStamp"}, 0)) add_metadata("TimeStamp", *text);
    if (at({"Header", "Initial", "Time"}, 0)) add_metadata("Initial Time", *text);
    if (at({"Header", "Version", "RecorderVersion"}, 0)) add_metadata("RecorderVersion", *text);
    return true;
  }

  void build() {
    if (rows_ == 0 || signals_.empty()) {
      fail(
          0,
          "is JSON, but no SINUMERIK capture with samples (Header.SignalListHFData, and rows in Payload[].HFData) and "
          "no table, expected one object in each line, a list of objects or a list for each column");
    }
    if (width_ != signals_.size()) {
      fail(0, "has rows of " + std::to_string(width_) + " values, expected " +
                  std::to_string(signals_.size()) + " as in SignalListHFData (export it again)");
    }
    log_.rows = rows_;
    std::size_t cycle = signals_.size();
    std::string unknown;
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      const Declared& s = signals_[i];
      if (s.name.empty()) fail(0, "signal " + std::to_string(i + 1) + " of SignalListHFData has no Name");
      if (s.name == "CYCLE") cycle = i;
      const Signal signal = signal_of(s.name);
      const Moves moves = moves_of(s.axis);
      Column c{s.name, unit_of(signal.name, moves), std::move(columns_[i]), s.name};
      if (moves == Moves::kUnknown && !unit_of(signal.name, Moves::kAround).empty() && c.unit_text.empty())
        unknown += (unknown.empty() ? "" : ", ") + in_quotes(s.name) + " of axis " + s.axis;
      if (s.name == "CYCLE") c.unit_text = "1";
      c.unit_assumed = true;
      log_.columns.push_back(std::move(c));
      const std::string key = "axis " + std::to_string(signal.axis);
      const auto same = [&](const auto& entry) { return entry.first == key; };
      if (signal.axis > 0 && !s.axis.empty() &&
          std::none_of(log_.metadata.begin(), log_.metadata.end(), same)) {
        add_metadata(key, s.axis);
      }
    }
    if (cycle == signals_.size())
      fail(0, "has no signal CYCLE, which counts the samples (record it as well)");
    if (!cycle_time_ms_ && options_.sample_time) cycle_time_ms_ = 1e3 * *options_.sample_time;
    if (!cycle_time_ms_ || !(*cycle_time_ms_ > 0.0)) {
      fail(0,
           "has no CycleTimeMs in its header (give the cycle with --sample-time \"2 ms\", or put "
           "sample_time = \"2 ms\" into " +
               log_.source + ".toml)");
    }
    note_units(log_, true);
    if (!unknown.empty()) {
      note("the name of the axis does not say whether it turns, so these columns have no unit: " + unknown +
           " (give it with --map, such as --map x=\"ENC_POS|1 mm\")");
    }
    const auto& n = log_.columns[cycle].values;
    note_jumps(log_, n, *cycle_time_ms_);
    std::vector<double> t(n.size());
    for (std::size_t i = 0; i < n.size(); ++i) t[i] = (n[i] - n[0]) * *cycle_time_ms_;
    if (!std::all_of(t.begin(), t.end(), [](double x) { return std::isfinite(x); }))
      fail(0, "has values of CYCLE or CycleTimeMs that are too large");
    add_time(log_, std::move(t), "ms");
    add_metadata("sample time", number_text(*cycle_time_ms_) + " ms");
  }

  std::string_view text_;
  const ReadOptions& options_;
  std::size_t line_ = 1;
  std::vector<std::string> path_;
  std::vector<Declared> signals_;
  std::vector<std::vector<double>> columns_;
  std::size_t width_ = 0;
  std::size_t rows_ = 0;
  std::size_t cell_ = 0;
  bool in_row_ = false;
  std::optional<double> cycle_time_ms_;
};

}  // namespace

Log read_sinumerik_json(std::string_view text, const std::string& source, const ReadOptions& options) {
  return CaptureReader(text, source, options).read();
}

bool name_sinumerik_signals(Log& log, const ReadOptions& options) {
  bool any = false;
  Column* cycle = nullptr;
  for (Column& c : log.columns) {
    if (!c.texts.empty()) continue;
    if (c.name == "CYCLE") cycle = &c;
    const Signal signal = signal_of(c.name);
    if (signal.axis == 0 || !c.unit_text.empty()) continue;
    const std::string unit = unit_of(signal.name, Moves::kAlong);
    if (unit.empty()) continue;
    c.unit_text = unit;
    c.unit_assumed = true;
    any = true;
  }
  if (!any) return false;
  log.format = "SINUMERIK Edge CSV";
  note_units(log, false);
  if (cycle == nullptr) return true;
  if (cycle->unit_text.empty()) cycle->unit_text = "1";
  const double period = options.sample_time.value_or(0.0);
  note_jumps(log, cycle->values, 1e3 * period);
  if (time_column(log) >= 0) return true;
  if (!options.sample_time) {
    throw InputError(
        Problem{log.source, 0, "",
                "has no time, only the counter CYCLE (give the cycle with --sample-time \"2 ms\", or put "
                "sample_time = \"2 ms\" into " +
                    log.source + ".toml)"});
  }
  std::vector<double> t(cycle->values);
  for (double& x : t) x = (x - cycle->values.front()) * period;
  add_time(log, std::move(t), "s");
  return true;
}

}  // namespace stribeck::io::detail
