#include <algorithm>
#include <cmath>
#include <map>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::detail {

namespace {

class TncScopeReader : Reader {
 public:
  TncScopeReader(std::string_view text, const std::string& source) : Reader(text, source, "TNCscope") {}

  Log read() {
    read_header();
    read_table(';');
    check_against_header();
    finish();
    return std::move(log_);
  }

 private:
  using Block = std::map<std::string, std::string, std::less<>>;

  void read_header() {
    Block* block = nullptr;
    std::map<std::size_t, Block> curves;  // by column
    std::vector<std::pair<std::size_t, Block>> blocks;
    blocks.reserve(kMaxColumns + 1);
    bool data = false;
    while (!data && lines_.next()) {
      const auto line = trimmed(lines_.text());
      if (line.empty() || line == "%") continue;
      if (line[0] != '%') fail(lines_.number(), "got data before %[DATA], expected header lines with %");
      const auto text = trimmed(line.substr(1));
      if (text == "[DATA]") {
        data = true;
      } else if (begins_with(text, "[CURVE")) {
        if (blocks.size() >= kMaxColumns) fail(lines_.number(), "has too many curves");
        block = &blocks.emplace_back(lines_.number(), Block()).second;
      } else if (text[0] == '[') {
        block = nullptr;
      } else if (const auto equals = text.find('='); equals != std::string_view::npos) {
        const auto key = trimmed(text.substr(0, equals));
        const auto value = trimmed(text.substr(equals + 1));
        if (block != nullptr) {
          if (key == "NAME" && !is_utf8(value))
            note("the names of the columns are not UTF-8 and are read as Latin-1");
          (*block)[std::string(key)] = as_utf8(value);
        } else {
          add_metadata(key, value);
          if (key == "SAMPLING") sampling_us_ = count(value);
        }
      }
    }
    if (!data) fail(lines_.number(), "has no %[DATA]: the file is cut off in its header (export it again)");
    for (auto& [line, b] : blocks) {
      const auto column = count(b["COLUMN"]);
      if (!column || *column == 0 || *column > kMaxColumns)
        fail(line, "curve without a %COLUMN number, expected one from 1 (export it again)");
      if (b["NAME"].empty()) fail(line, "curve without a %NAME (export it again)");
      if (!curves.emplace(*column, std::move(b)).second)
        fail(line, "%COLUMN=" + std::to_string(*column) + " stands twice (export it again)");
    }
    if (curves.empty()) fail(0, "has no %[CURVE]: no columns are named (export it again)");
    if (curves.rbegin()->first != curves.size()) {
      fail(0, "has " + std::to_string(curves.size()) + " curves but column " +
                  std::to_string(curves.rbegin()->first) + " (export it again)");
    }
    log_.columns.push_back({"t", "us", {}, "t"});
    for (auto& [column, b] : curves) {
      const std::string& name = b["NAME"];
      log_.columns.push_back({name, plain_unit(b["DIMENSION"], name, log_.notes), {}, name});
      if (b["DIMENSION"].empty()) note("column " + in_quotes(name) + " has no %DIMENSION");
      for (const char* key : {"CHANNELTYPE", "CHANNELID", "AXISTYPE", "CYCLETIME"}) {
        if (!b[key].empty()) add_metadata(name + " " + key, b[key]);
      }
      if (sampling_us_ && b["CYCLETIME"] != "" && count(b["CYCLETIME"]) != sampling_us_) {
        note("column " + in_quotes(name) + ": the control's own cycle is " + b["CYCLETIME"] +
             " us, the log has " + std::to_string(*sampling_us_) + " us");
      }
      curves_.push_back(std::move(b));
    }
    if (sampling_us_) add_metadata("sample time", std::to_string(*sampling_us_) + " us");
  }

  /// Checks the number of samples and the range of each curve against the header.
  void check_against_header() {
    for (std::size_t i = 0; i < curves_.size(); ++i) {
      const Column& c = log_.columns[i + 1];
      const auto expected = count(curves_[i]["COUNT"]);
      if (expected && *expected != c.values.size() && (i == 0 || *expected != count(curves_[0]["COUNT"]))) {
        note("the header says " + std::to_string(*expected) + " samples, the file has " +
             std::to_string(c.values.size()) + ": it is cut off or was edited");
      }
      if (c.values.empty()) continue;
      const auto [low, high] = std::minmax_element(c.values.begin(), c.values.end());
      const auto min = cell_number(curves_[i]["MINVAL"], '.');
      const auto max = cell_number(curves_[i]["MAXVAL"], '.');
      // %MINVAL and %MAXVAL have seven digits.
      const double slack = 1e-6 * std::max(std::abs(*low), std::abs(*high));
      if ((min && *low < *min - slack) || (max && *high > *max + slack)) {
        note("column " + in_quotes(c.name) + ": values from " + number_text(*low) + " to " +
             number_text(*high) + " leave the range of the header (" + curves_[i]["MINVAL"] + " to " +
             curves_[i]["MAXVAL"] + "): columns exchanged or values edited?");
      }
    }
    if (sampling_us_ && log_.rows > 1) {
      const double step = log_.columns[0].values[1] - log_.columns[0].values[0];
      if (std::abs(step - static_cast<double>(*sampling_us_)) > 0.5) {
        note("the rows are " + number_text(step) + " us apart, the header says " +
             std::to_string(*sampling_us_) + " us");
      }
    }
  }

  std::vector<Block> curves_;
  std::optional<std::size_t> sampling_us_;
};

}  // namespace

bool is_tncscope(std::string_view text) { return begins_with(text, "%TNCscope"); }

Log read_tncscope(std::string_view text, const std::string& source) {
  return TncScopeReader(text, source).read();
}

}  // namespace stribeck::io::detail
