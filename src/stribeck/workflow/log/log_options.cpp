#include <fmt/format.h>
#include <algorithm>
#include <charconv>

#include <stribeck/core/fields.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <stribeck/workflow/option.hpp>
#include <tuple>
#include <utility>

namespace stribeck::workflow {
namespace {

/// The map file: any of the options, so that they need not be typed again.
struct MapFile {
  std::string axis;
  std::vector<std::string> map;
  std::string gain;
  std::string lead;
  std::vector<std::string> where;
  std::vector<std::string> runs;
  std::string sample_time;
  std::vector<std::string> keep;

  static constexpr auto fields() {
    return std::tuple{
        field("axis", &MapFile::axis, "name of the axis in the log").or_default(),
        field("map", &MapFile::map, "which column is what, each quantity=column unit").or_default(),
        field("gain", &MapFile::gain, "force per volt, ampere, newton metre or percent, with its unit")
            .or_default(),
        field("lead", &MapFile::lead, "travel per turn, with its unit").or_default(),
        field("where", &MapFile::where, "rows that count, each COLUMN=VALUE").or_default(),
        field("runs", &MapFile::runs, "columns whose change begins a new run").or_default(),
        field("sample_time", &MapFile::sample_time,
              "time between rows, with its unit, for logs without times")
            .or_default(),
        field("keep", &MapFile::keep, "kinds of findings that are left alone").or_default()};
  }
};

std::string without_last_word(const std::string& text) {
  const auto blank = text.rfind(' ');
  return blank == std::string::npos ? text : text.substr(0, blank);
}

bool is_number(const std::string& word) {
  double value = 0.0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  return read.ec == std::errc() && read.ptr == word.data() + word.size();
}

}  // namespace

std::vector<io::KeyInfo> map_file_keys() { return io::keys_of<MapFile>(); }

LogOptions with_map_file(LogOptions o, const std::string& map_file) {
  if (map_file.empty()) return o;
  const auto file = io::read_toml<MapFile>(map_file);
  const auto one = [](std::string& mine, const std::string& theirs) {
    if (mine.empty()) mine = theirs;
  };
  const auto both = [](std::vector<std::string>& mine, const std::vector<std::string>& theirs) {
    mine.insert(mine.end(), theirs.begin(), theirs.end());
  };
  one(o.axis, file.axis);
  one(o.gain, file.gain);
  one(o.lead, file.lead);
  one(o.sample_time, file.sample_time);
  both(o.maps, file.map);  // after those on the command line, because the first one of a quantity counts
  both(o.where, file.where);
  both(o.keep, file.keep);
  if (o.runs.empty()) o.runs = file.runs;
  return o;
}

std::string six_digits(const std::string& quantity) {
  const auto blank = quantity.find(' ');
  double value = 0.0;
  const auto read =
      std::from_chars(quantity.data(), quantity.data() + std::min(blank, quantity.size()), value);
  if (read.ec != std::errc() || blank == std::string::npos) return quantity;
  return fmt::format("{:.6g}{}", value, quantity.substr(blank));
}

double control_period(const LogOptions& options) {
  if (options.drive.sample_time.empty()) return 0.0;
  return io::to_si(options.drive.sample_time, quantity("s", "ms"));
}

io::Log read_log(const std::string& path, const LogOptions& options) {
  io::ReadOptions read;
  if (!options.sample_time.empty())
    read.sample_time = option_si("--sample-time", options.sample_time, quantity("s", "ms").positive());
  if (!options.drive.sample_time.empty()) read.machine_period = control_period(options);
  for (const std::string& text : options.maps) {
    if (text.rfind("t=", 0) != 0) continue;
    // Only the name as it is written; a unit after it, with a factor or without, is handled later.
    std::string name = without_last_word(text.substr(2));
    const auto blank = name.rfind(' ');
    if (blank != std::string::npos && is_number(name.substr(blank + 1))) name = without_last_word(name);
    read.time_column = std::move(name);
  }
  io::Log log = io::read_log(path, read);
  for (const std::string& text : options.maps) {
    if (!text.starts_with(kNotUsed)) continue;
    const io::Column& left_out = log.at(text.substr(kNotUsed.size()));
    std::erase_if(log.columns, [&left_out](const io::Column& c) { return &c == &left_out; });
  }
  return log;
}

}  // namespace stribeck::workflow
