#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <apps/cli/log_record.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::cli {
namespace {

/// A quantity that a log may hold: its SI unit, the unit people read, and the names that logs give it.
struct Known {
  std::string_view name;
  Quantity quantity;
  std::vector<std::string_view> names;
};

const std::vector<Known>& known_quantities() {
  static const std::vector<Known> all{
      {"t", quantity("s", "s"), {"t", "time", "zeit"}},
      {"r",
       quantity("m", "mm"),
       {"r", "ref", "reference", "q_ref", "x_ref", "pos_ref", "position_ref", "x_cmd", "pos_cmd"}},
      {"x", quantity("m", "mm"), {"x", "q", "pos", "position", "pos_act", "position_act", "x_act", "q_act"}},
      {"force", quantity("N", "N"), {"f", "force", "kraft"}},
      {"torque", quantity("N m", "N m"), {"torque", "moment", "drehmoment"}},
      {"current", quantity("A", "A"), {"i", "current", "strom", "iq"}},
      {"voltage", quantity("V", "V"), {"u", "voltage", "spannung"}},
      {"percent", quantity("", ""), {"percent", "load"}}};
  return all;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

const Known& known(std::string_view name) {
  std::string names;
  for (const Known& k : known_quantities()) {
    if (k.name == name) return k;
    names += (names.empty() ? "" : ", ") + std::string(k.name);
  }
  refuse_option("--map", fmt::format("unknown quantity {}, expected one of {}", io::in_quotes(name), names));
}

/// quantity=column [unit]; the unit is the last word where it is one and no column has the whole name.
struct Map {
  const Known* quantity = nullptr;
  const io::Column* column = nullptr;
  std::string unit;
};

Map parse_map(const std::string& text, const io::Log& log) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size()) {
    refuse_option("--map", fmt::format("got {}, expected quantity=\"column unit\", e.g. x=\"Istposition mm\"",
                                       io::in_quotes(text)));
  }
  Map map{&known(text.substr(0, equals)), nullptr, {}};
  const std::string rest = text.substr(equals + 1);
  map.column = log.find(rest);
  // Try shorter and shorter names: a unit may itself hold blanks ("N s/mm").
  for (auto blank = rest.rfind(' '); map.column == nullptr && blank != std::string::npos && blank > 0;
       blank = rest.rfind(' ', blank - 1)) {
    if (const io::Column* c = log.find(rest.substr(0, blank))) {
      map.column = c;
      map.unit = rest.substr(blank + 1);
    }
  }
  if (map.column == nullptr) static_cast<void>(log.at(rest));  // throws with the columns there are
  return map;
}

/// The column that holds the quantity for the axis by its name: r_x before r.
const io::Column* find_by_name(const io::Log& log, const Known& quantity, const std::string& axis) {
  for (const bool with_axis : {true, false}) {
    if (with_axis && axis.empty()) continue;
    for (const std::string_view name : quantity.names) {
      const std::string wanted = with_axis ? fmt::format("{}_{}", name, lower(axis)) : std::string(name);
      for (const io::Column& c : log.columns) {
        if (lower(c.name) == wanted) return &c;
      }
    }
  }
  return nullptr;
}

/// The column in SI; errors name the file.
std::vector<double> values_in_si(const io::Log& log, const io::Column& column, const Quantity& quantity) {
  try {
    return io::in_si(column, quantity);
  } catch (const io::InputError& e) {
    io::Problem problem = e.problems().front();
    problem.file = log.source;
    throw io::InputError(problem);
  }
}

std::string column_names(const io::Log& log) {
  std::string names;
  for (const io::Column& c : log.columns) names += (names.empty() ? "" : ", ") + io::in_quotes(c.header);
  return names;
}

}  // namespace

ident::Record make_record(const io::Log& log, const LogOptions& options) {
  std::vector<Map> maps;
  for (const std::string& text : options.maps) maps.push_back(parse_map(text, log));

  const auto find = [&](std::string_view name) -> std::optional<std::vector<double>> {
    const Known& k = known(name);
    for (const Map& m : maps) {
      if (m.quantity != &k) continue;
      io::Column copy = *m.column;
      if (!m.unit.empty()) copy.unit_text = m.unit;
      return values_in_si(log, copy, k.quantity);
    }
    const io::Column* c = find_by_name(log, k, options.axis);
    if (c == nullptr) return std::nullopt;
    return values_in_si(log, *c, k.quantity);
  };
  const auto need = [&](std::string_view name, std::string_view what) {
    auto values = find(name);
    if (!values) {
      throw io::InputError(
          {log.source, 0, std::string(name),
           fmt::format("no column for {}; the log has {} (name it with --map {}=\"COLUMN UNIT\")", what,
                       column_names(log), name)});
    }
    return std::move(*values);
  };

  ident::Record record;
  record.source = log.source;
  record.t = need("t", "the time");
  record.x = need("x", "the position");
  if (auto r = find("r")) record.r = std::move(*r);
  if (auto f = find("force")) {
    record.f = std::move(*f);
  } else {
    struct Source {
      std::string_view name;
      Quantity gain;
    };
    constexpr std::array kSources{Source{"voltage", {"N/V", "N/V"}}, Source{"current", {"N/A", "N/A"}},
                                  Source{"torque", {"1/m", "1/mm"}}, Source{"percent", {"N", "N"}}};
    for (const Source& s : kSources) {
      auto values = find(s.name);
      if (!values) continue;
      if (options.gain.empty()) {
        throw io::InputError(
            {log.source, 0, std::string(s.name),
             fmt::format("the force stands as {}; say how much force that is (--gain \"1048 {}\")", s.name,
                         s.gain.shown)});
      }
      const double gain = option_si("--gain", options.gain, s.gain);
      if (gain == 0.0) refuse_option("--gain", "got 0, expected the force per unit of the column");
      for (double& v : *values) v *= gain;
      record.f = std::move(*values);
      break;
    }
    if (record.f.empty()) record.f = need("force", "the force (or voltage, current, torque, percent)");
  }
  const io::TimeCheck time = io::check_time(record.t, log.source, "t");
  record.sample_time = (record.t.back() - record.t.front()) / static_cast<double>(record.t.size() - 1);
  if (!time.gaps.empty()) {
    throw io::InputError(
        {log.source, 0, "t",
         fmt::format("a gap of {:.4g} s before row {} (cut the log there and give both parts)",
                     time.gaps.front().duration, time.gaps.front().row)});
  }
  std::vector<io::Problem> found;
  for (std::string& text : ident::problems(record)) {
    const std::string prefix = log.source + ": ";
    if (text.rfind(prefix, 0) == 0) text.erase(0, prefix.size());
    found.push_back({log.source, 0, {}, std::move(text)});
  }
  if (!found.empty()) throw io::InputError(std::move(found));
  return record;
}

}  // namespace stribeck::cli
