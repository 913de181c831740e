#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::detail {

namespace {

constexpr std::string_view kOverrun = "overrun";

/// Layout: src/hal/components/sampler_usr.c of LinuxCNC. Its sample number counts the samples that were kept,
/// so that an overrun need not show in it.
class HalReader : Reader {
 public:
  HalReader(std::string_view text, const std::string& source, const ReadOptions& options)
      : Reader(text, source, "LinuxCNC halsampler"), options_(options) {}

  Log read() {
    set_columns();
    read_rows();
    make_time();
    finish();
    return std::move(log_);
  }

 private:
  void set_columns() {
    if (options_.names.size() > kMaxColumns) fail(0, "has too many names");
    for (const auto& given : options_.names) {
      Column c = column_of(header_of(given), log_.notes);
      c.header = given;
      log_.columns.push_back(std::move(c));
    }
    note("names and units are those given, the file has none", Note::About::kGivenNames);
  }

  void read_rows() {
    const std::size_t n = log_.columns.size();
    std::vector<double> row(n + 1);
    bool first = true;
    while (lines_.next()) {
      const auto line = trimmed(lines_.text());
      if (line.empty()) continue;
      if (line == kOverrun) {
        if (log_.rows > 0 && (overruns_.empty() || overruns_.back() != log_.rows))
          overruns_.push_back(log_.rows);
        continue;
      }
      const std::string where = "row " + std::to_string(log_.rows + 1);
      if (cut(log_.rows + 1)) break;
      const auto cells = split(line, ' ');
      if (first) {
        if (cells.size() != n && cells.size() != n + 1) {
          fail(lines_.number(), "got " + std::to_string(cells.size()) + " columns, expected " +
                                    std::to_string(n) + " as named (or one more, the sample number)");
        }
        tagged_ = cells.size() == n + 1;
        first = false;
      }
      const std::size_t extra = tagged_ ? 1 : 0;
      if (cells.size() < n + extra && lines_.last()) {
        note("the last row (" + where + ", line " + std::to_string(lines_.number()) +
             ") was left out: it has " + std::to_string(cells.size()) + " of " + std::to_string(n + extra) +
             " cells");
        break;
      }
      if (cells.size() != n + extra) {
        fail(lines_.number(), where + ": got " + std::to_string(cells.size()) + " cells, expected " +
                                  std::to_string(n + extra) + " as in the first row");
      }
      for (std::size_t c = 0; c < cells.size(); ++c) {
        const bool tag = tagged_ && c == 0;
        row[c] = number(cells[c], log_.rows + 1, c, tag ? "sample number" : log_.columns[c - extra].name);
      }
      if (tagged_) {
        if (row[0] != std::round(row[0]))
          fail(lines_.number(), where + ": got " + in_quotes(cells[0]) + ", expected a sample number");
        if (!tags_.empty() && row[0] <= tags_.back()) {
          fail(lines_.number(), where + ": the sample number goes from " + number_text(tags_.back()) +
                                    " to " + number_text(row[0]) +
                                    " (two recordings in one file? cut it there)");
        }
        tags_.push_back(row[0]);
      }
      for (std::size_t c = 0; c < n; ++c) log_.columns[c].values.push_back(row[c + extra]);
      ++log_.rows;
    }
    if (first) fail(0, "has no rows");
  }

  /// Rows before which samples are missing for an unknown time.
  std::vector<bool> note_losses() {
    std::vector<bool> overrun(log_.rows, false);
    for (const std::size_t row : overruns_) {
      if (row < log_.rows) overrun[row] = true;
    }
    constexpr std::size_t kShown = 10;
    std::size_t found = 0;
    for (std::size_t i = 1; i < log_.rows; ++i) {
      const double missing = tagged_ ? tags_[i] - tags_[i - 1] - 1.0 : 0.0;
      if (!overrun[i] && missing == 0.0) continue;
      if (++found > kShown) continue;
      note((overrun[i] ? "overrun before row " : "the sample number jumps before row ") +
           std::to_string(i + 1) + ": " +
           (missing > 0.0
                ? number_text(missing) + " samples are missing"
                : "samples were lost, how many is not in the file; the time from there on is too early"));
    }
    if (found > kShown) note("samples are missing in " + std::to_string(found - kShown) + " further places");
    return overrun;
  }

  void make_time() {
    const std::vector<bool> lost = note_losses();
    if (time_column(log_) >= 0 || !options_.time_column.empty()) return;
    if (!options_.times_needed && !options_.sample_time) return;
    if (!options_.sample_time) {
      fail(0,
           "has no time (give the period of the sampling thread with --sample-time \"1 ms\", or put "
           "sample_time = \"1 ms\" into " +
               log_.source + ".toml)");
    }
    std::vector<double> t(log_.rows);
    double samples = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (i > 0) {
        double step = tagged_ ? tags_[i] - tags_[i - 1] : 1.0;
        // At least one sample is missing: this gap must not be bridged.
        if (lost[i] && step < 2.0) step = 2.0;
        samples += step;
      }
      t[i] = samples * *options_.sample_time;
      if (!std::isfinite(t[i])) fail(0, "row " + std::to_string(i + 1) + ": the sample number is too large");
    }
    add_time(log_, std::move(t), "s");
    add_metadata("sample time", number_text(*options_.sample_time) + " s");
  }

  const ReadOptions& options_;
  bool tagged_ = false;
  std::vector<double> tags_;
  std::vector<std::size_t> overruns_;  ///< rows (from 0) before which samples are missing
};

}  // namespace

bool is_halsampler(std::string_view text) {
  Lines lines(text.substr(0, 1 << 16));
  for (int i = 0; i < 20 && lines.next(); ++i) {
    const auto line = trimmed(lines.text());
    if (line.empty() || line == kOverrun) continue;
    if (line.find_first_of(",;\t#%\"") != std::string_view::npos) return false;
    const auto cells = split(line, ' ');
    return std::all_of(cells.begin(), cells.end(),
                       [](std::string_view cell) { return cell_number(cell, '.').has_value(); });
  }
  return false;
}

Log read_halsampler(std::string_view text, const std::string& source, const ReadOptions& options) {
  if (options.names.empty()) {
    throw InputError(Problem{
        source, 1, "",
        "has no header: the first row holds numbers. For a log of LinuxCNC's halsampler write " + source +
            ".toml with columns = [\"x mm\", …] in the order of the pins and sample_time = \"1 ms\""});
  }
  return HalReader(text, source, options).read();
}

}  // namespace stribeck::io::detail
