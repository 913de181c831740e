#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include <stribeck/core/fields.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log_record.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Names of one signal, lower case. A family is one notation in order of preference; columns of two families
/// are two candidates.
using Family = std::vector<std::string_view>;

struct Known {
  std::string_view name;
  Quantity quantity;
  std::vector<Family> families;
};

const std::vector<Known>& known_quantities() {
  static const std::vector<Known> all{
      {"t", quantity("s", "s"), {{"t", "time", "zeit"}}},
      {"r",
       quantity("m", "mm"),
       {{"r"},
        {"ref", "reference"},
        {"q_ref", "q_cmd", "q_des"},
        {"x_ref", "x_cmd", "x_soll"},
        {"pos_ref", "position_ref", "pos_cmd", "pos_soll", "lagesollwert", "sollposition"},
        {"des_pos"},
        {"commandposition"},
        {"s soll", "s nominal", "s nom"},
        {"setpos", "position demand value"}}},
      {"x",
       quantity("m", "mm"),
       {{"x"},
        {"q"},
        {"pos", "position"},
        {"pos_act", "position_act", "x_act", "q_act", "pos_ist", "lageistwert", "istposition"},
        {"enc_pos", "enc1_pos", "enc2_pos"},
        {"actualposition"},
        {"s ist", "s actual", "s act"},
        {"actpos", "position actual value"}}},
      {"v",
       quantity("m/s", "mm/s"),
       {{"v"},
        {"dq", "qd", "q_dot"},
        {"vel", "velocity", "speed"},
        {"vel_act", "velocity_act", "v_act", "vel_ist"},
        {"actualvelocity"},
        {"v ist", "v actual", "v act"},
        {"actvelo", "velocity actual value averaged", "velocity actual value"},
        {"servo motor speed", "motor speed"}}},
      {"v_ref",
       quantity("m/s", "mm/s"),
       {{"vel_ref", "velocity_ref", "v_ref", "vel_cmd"},
        {"commandvelocity"},
        {"v soll", "v nominal", "v nom"},
        {"setvelo", "velocity demand value"},
        {"speed command"},
        {"vel_ffw"}}},
      {"a", quantity("m/s2", "mm/s2"), {{"a", "acc", "acceleration"}, {"actualacceleration"}}},
      {"force", quantity("N", "N"), {{"f", "force", "kraft"}}},
      {"torque",
       quantity("N m", "N m"),
       {{"torque", "moment", "drehmoment", "tau"},
        {"acttorque", "torque actual value averaged", "torque actual value"}}},
      {"current",
       quantity("A", "A"),
       {{"i", "current", "strom", "iq"},
        {"i_act", "current_act", "iq_act"},
        {"current_ref", "i_ref", "iq_ref"},
        {"current_abs"},
        {"currentfeedback"},
        {"i ist", "i actual", "i act"},
        {"actcurrent", "current actual value averaged", "current actual value"}}},
      {"voltage", quantity("V", "V"), {{"u", "voltage", "spannung"}, {"outputvoltage"}}},
      {"percent", quantity("", ""), {{"percent", "load"}}}};
  return all;
}

/// Where no gain says otherwise, the first of these that a log has is the force.
constexpr std::array<std::string_view, 5> kForces{"force", "current", "torque", "percent", "voltage"};

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

const std::string& header_of(const io::Column& c) { return c.header.empty() ? c.name : c.header; }

std::string column_names(const io::Log& log) {
  std::string names;
  constexpr std::size_t kMost = 60;
  for (std::size_t i = 0; i < log.columns.size() && i < kMost; ++i)
    names += (names.empty() ? "" : ", ") + io::in_quotes(header_of(log.columns[i]));
  if (log.columns.size() > kMost) names += fmt::format(", and {} more", log.columns.size() - kMost);
  return names;
}

/// A unit given for a column may scale the file's own, but not make another quantity of it.
void check_same_dimension(const io::Column& column, const std::string& unit) {
  if (unit.empty() || column.unit_assumed || column.unit_text == "1") return;
  if (!io::is_unit(column.unit_text) || !io::is_unit(unit)) return;
  try {
    static_cast<void>(io::conversion(unit, column.unit_text));
  } catch (const io::InputError&) {
    refuse_option(
        "--map",
        fmt::format(
            "column {} has the unit {} in the file, which is not a unit of a {}; leave the unit out or "
            "map another column (to scale a force, use --gain)",
            io::in_quotes(header_of(column)), column.unit_text, unit));
  }
}

/// quantity=column [unit]
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
  NamedColumn named = named_column(log, text.substr(equals + 1));
  map.column = named.column;
  map.unit = std::move(named.unit);
  return map;
}

/// What a column's name says: the signal and the axis that stands in it.
struct Label {
  std::string base;
  std::string axis;
};

std::vector<Label> labels_of(const io::Column& c, const std::string& axis) {
  const std::string name = lower(c.name);
  std::vector<Label> out{{name, {}}};
  for (const char mark : {'|', '/'}) {
    const auto at = name.rfind(mark);
    if (at != std::string::npos && at > 0 && at + 1 < name.size())
      out.push_back({name.substr(0, at), name.substr(at + 1)});
  }
  const auto bar = name.find('_');
  if (bar != std::string::npos && bar > 0 && bar <= 3 && bar + 1 < name.size()) {
    const std::string prefix = name.substr(0, bar);
    const bool is_axis =
        std::string_view("xyzabcuvws").find(prefix[0]) != std::string_view::npos &&
        std::all_of(prefix.begin() + 1, prefix.end(), [](unsigned char d) { return std::isdigit(d); });
    if (is_axis) out.push_back({name.substr(bar + 1), prefix});
  }
  const auto digit = name.find_last_not_of("0123456789");
  if (digit != std::string::npos && digit + 1 < name.size())
    out.push_back({name.substr(0, digit + 1), name.substr(digit + 1)});
  const auto last = name.rfind('_');
  if (!axis.empty() && last != std::string::npos && name.substr(last + 1) == lower(axis))
    out.push_back({name.substr(0, last), lower(axis)});
  return out;
}

/// "x" is the axis X1 of a log that calls its axes so; "X1" may stand in the metadata for the axis 1.
bool same_axis(const io::Log& log, const std::string& wanted, const std::string& found) {
  const std::string w = lower(wanted);
  if (w == found) return true;
  const auto is_first = [](const std::string& name, const std::string& short_name) {
    return name.size() == short_name.size() + 1 && name.compare(0, short_name.size(), short_name) == 0 &&
           name.back() == '1';
  };
  if (is_first(found, w)) return true;
  for (const auto& [key, value] : log.metadata) {
    if (lower(key) != "axis " + found) continue;
    const std::string v = lower(value);
    if (v == w || is_first(v, w)) return true;
  }
  return false;
}

struct Candidate {
  const io::Column* column = nullptr;
  std::string axis;
  std::size_t family = 0;
  std::size_t rank = 0;
};

std::vector<Candidate> candidates(const io::Log& log, const Known& k, const std::string& axis) {
  std::vector<Candidate> out;
  for (const io::Column& c : log.columns) {
    if (c.values.empty()) continue;
    for (const Label& label : labels_of(c, axis)) {
      bool done = false;
      for (std::size_t f = 0; f < k.families.size() && !done; ++f) {
        const auto at = std::find(k.families[f].begin(), k.families[f].end(), label.base);
        if (at == k.families[f].end()) continue;
        out.push_back({&c, label.axis, f, static_cast<std::size_t>(at - k.families[f].begin())});
        done = true;
      }
      if (done) break;
    }
  }
  return out;
}

/// The column of a quantity by its name, or none. Throws when several could be it.
const io::Column* find_by_name(const io::Log& log, const Known& k, const std::string& axis) {
  std::vector<Candidate> all = candidates(log, k, axis);
  if (all.empty()) return nullptr;
  const auto keep = [&](auto&& good) {
    std::vector<Candidate> some;
    std::copy_if(all.begin(), all.end(), std::back_inserter(some), good);
    return some;
  };
  if (!axis.empty()) {
    std::vector<Candidate> of_axis =
        keep([&](const Candidate& c) { return !c.axis.empty() && lower(axis) == c.axis; });
    if (of_axis.empty())
      of_axis = keep([&](const Candidate& c) { return !c.axis.empty() && same_axis(log, axis, c.axis); });
    if (of_axis.empty()) of_axis = keep([](const Candidate& c) { return c.axis.empty(); });
    all = std::move(of_axis);
    if (all.empty()) return nullptr;
  }
  std::vector<std::string> axes;
  for (const Candidate& c : all) {
    if (std::find(axes.begin(), axes.end(), c.axis) == axes.end()) axes.push_back(c.axis);
  }
  if (axes.size() > 1 && axis.empty()) {
    // A column without an axis in its name goes before those with one.
    const std::vector<Candidate> plain = keep([](const Candidate& c) { return c.axis.empty(); });
    if (plain.empty()) {
      std::string list;
      for (const std::string& a : axes) list += (list.empty() ? "" : ", ") + a;
      throw io::InputError({log.source, 0, std::string(k.name),
                            fmt::format("a log of several axes: {} (choose one with --axis NAME)", list)});
    }
    all = plain;
  }
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    return std::pair{a.family, a.rank} < std::pair{b.family, b.rank};
  });
  const auto rivals =
      keep([&](const Candidate& c) { return c.family != all.front().family || c.rank == all.front().rank; });
  if (rivals.size() > 1) {
    std::string list;
    for (const Candidate& c : all) list += (list.empty() ? "" : ", ") + io::in_quotes(header_of(*c.column));
    throw io::InputError(
        {log.source, 0, std::string(k.name),
         fmt::format("{} columns could be this quantity: {} (choose one with --map {}=\"COLUMN UNIT\")",
                     all.size(), list, k.name)});
  }
  return all.front().column;
}

/// A column chosen for a quantity.
using Chosen = NamedColumn;

std::optional<io::Conversion> converts(const std::string& unit, std::string_view si) {
  if (unit.empty()) return std::nullopt;
  try {
    return io::conversion(unit, si);
  } catch (const io::InputError&) {
    return std::nullopt;
  }
}

std::vector<double> converted(const std::vector<double>& values, const io::Conversion& c,
                              double factor = 1.0) {
  std::vector<double> out(values.size());
  // The divisor outside the loop: the same value as c(x), without a power per sample.
  const double divisor = c.decimal && c.power < 0 ? std::pow(10.0, -c.power) : 0.0;
  for (std::size_t k = 0; k < values.size(); ++k)
    out[k] = (divisor > 0.0 ? values[k] / divisor : values[k] * c.factor) * factor;
  return out;
}

/// Throws, naming the file, where the column in this unit is not the quantity.
void check_unit(const io::Log& log, const io::Column& column, const std::string& unit, const Quantity& q) {
  io::Column empty;
  empty.name = column.name;
  empty.unit_text = unit;
  empty.header = column.header;
  try {
    static_cast<void>(io::in_si(empty, q));
  } catch (const io::InputError& e) {
    io::Problem p = e.problems().front();
    p.file = log.source;
    if (unit.empty())
      p.message += fmt::format("; or give it with --map QUANTITY=\"{} {}\"", column.name,
                               q.shown.empty() ? q.unit : q.shown);
    throw io::InputError(p);
  }
}

[[noreturn]] void refuse_column(const io::Log& log, const Chosen& c, const std::string& message) {
  throw io::InputError({log.source, 0, "column " + io::in_quotes(header_of(*c.column)), message});
}

/// The map file: any of the options, so that nothing is typed twice.
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

/// Rows that count, and the row after which each run ends.
struct Selection {
  bool all = true;
  std::vector<std::vector<std::size_t>> runs;  ///< rows, from 0
};

const io::Column& column_for(const io::Log& log, const std::string& option, const std::string& name) {
  const io::Column* c = log.find(name);
  if (c == nullptr) {
    std::string message;
    try {
      static_cast<void>(log.at(name));
    } catch (const io::InputError& e) {
      message = e.problems().front().message;
    }
    refuse_option(option, message);
  }
  const std::size_t rows = c->texts.empty() ? c->values.size() : c->texts.size();
  if (rows != log.rows)
    refuse_option(option, fmt::format("column {} has {} rows of {}, expected all", io::in_quotes(name), rows,
                                      log.rows));
  return *c;
}

std::optional<double> as_number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0') return std::nullopt;
  return value;
}

Selection select(const io::Log& log, const LogOptions& options) {
  Selection s;
  if (options.where.empty() && options.runs.empty()) return s;
  s.all = false;
  std::vector<std::uint8_t> counts(log.rows, 1);
  for (const std::string& text : options.where) {
    const std::vector<std::uint8_t> has = rows_with(log, text);
    for (std::size_t k = 0; k < log.rows; ++k) counts[k] = counts[k] != 0 && has[k] != 0 ? 1 : 0;
  }
  std::vector<const io::Column*> marks;
  for (const std::string& name : options.runs) marks.push_back(&column_for(log, "--runs", name));
  std::size_t last = 0;
  for (std::size_t k = 0; k < log.rows; ++k) {
    if (counts[k] == 0) continue;
    bool begins = s.runs.empty();
    for (const io::Column* c : marks) {
      if (begins) break;
      begins = c->texts.empty() ? c->values[k] != c->values[last] : c->texts[k] != c->texts[last];
    }
    if (begins) s.runs.emplace_back();
    s.runs.back().push_back(k);
    last = k;
  }
  if (s.runs.empty()) refuse_option("--where", "no row is left");
  return s;
}

std::string run_name(const io::Log& log, const LogOptions& options, std::size_t row) {
  std::string name;
  for (const std::string& column : options.runs) {
    const io::Column& c = *log.find(column);
    name += (name.empty() ? "" : ", ") + column + "=" +
            (c.texts.empty() ? io::number_text(c.values[row]) : c.texts[row]);
  }
  return name.empty() ? log.source : log.source + " (" + name + ")";
}

/// Columns that change where time begins anew, and only there: they tell runs apart.
std::string marks_of_runs(const io::Log& log, const std::vector<double>& t) {
  std::vector<std::size_t> starts;
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (t[k] < t[k - 1]) starts.push_back(k);
  }
  if (starts.empty() || t.size() != log.rows) return {};
  std::string names;
  for (const io::Column& c : log.columns) {
    const bool text = !c.texts.empty();
    if ((text ? c.texts.size() : c.values.size()) != log.rows) continue;
    std::size_t inside = 0;
    std::size_t at_start = 0;
    std::size_t next = 0;
    for (std::size_t k = 1; k < log.rows && inside == 0; ++k) {
      const bool start = next < starts.size() && starts[next] == k;
      if (start) ++next;
      if (!(text ? c.texts[k] != c.texts[k - 1] : c.values[k] != c.values[k - 1])) continue;
      ++(start ? at_start : inside);
    }
    if (inside == 0 && at_start > 0)
      names += (names.empty() ? "" : ", ") + io::in_quotes(c.header.empty() ? c.name : c.header);
  }
  return names;
}

/// Effort of the drive → force.
struct Effort {
  Chosen chosen;
  std::string kind;  ///< force, torque, …
  double factor = 1.0;
  std::string unit = "N";
  bool by_lead = false;  ///< a torque made a force
  io::Conversion conversion;
};

/// Kind of an effort by its unit: a torque in percent is a percentage.
std::string kind_by_unit(const std::string& unit, std::string_view by_name) {
  for (const std::string_view name : kForces) {
    const Quantity q = known(name).quantity;
    if (name == "percent" ? (unit == "%" || unit == "pct" || unit == "percent")
                          : converts(unit, q.unit).has_value())
      return std::string(name);
  }
  return std::string(by_name);
}

}  // namespace

LogOptions with_map_file(const LogOptions& options) {
  if (options.map_file.empty()) return options;
  const auto file = io::read_toml<MapFile>(options.map_file);
  LogOptions o = options;
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
  both(o.maps, file.map);  // behind those of the command line: the first of a quantity counts
  both(o.where, file.where);
  both(o.keep, file.keep);
  if (o.runs.empty()) o.runs = file.runs;
  o.map_file.clear();
  return o;
}

NamedColumn named_column(const io::Log& log, const std::string& text) {
  NamedColumn named{log.find(text), {}};
  // Try shorter and shorter names: a unit may itself hold blanks ("N s/mm").
  for (auto blank = text.rfind(' '); named.column == nullptr && blank != std::string::npos && blank > 0;
       blank = text.rfind(' ', blank - 1)) {
    if (const io::Column* c = log.find(text.substr(0, blank))) {
      named.column = c;
      named.unit = text.substr(blank + 1);
    }
  }
  if (named.column == nullptr) static_cast<void>(log.at(text));  // throws with the columns there are
  if (named.column->values.empty()) {
    refuse_option("--map", fmt::format("column {} holds text, expected numbers",
                                       io::in_quotes(header_of(*named.column))));
  }
  check_same_dimension(*named.column, named.unit);
  if (named.unit.empty()) named.unit = named.column->unit_text;
  return named;
}

NamedColumn position_column(const io::Log& log, const std::string& axis) {
  const io::Column* c = log.find(axis);
  if (c == nullptr || c->values.empty()) {
    // A column without an axis in its name could be any axis's.
    const std::vector<Candidate> all = candidates(log, known("x"), axis);
    const bool any = std::any_of(all.begin(), all.end(), [&](const Candidate& some) {
      return !some.axis.empty() && same_axis(log, axis, some.axis);
    });
    c = any ? find_by_name(log, known("x"), axis) : nullptr;
  }
  if (c != nullptr) return {c, c->unit_text};
  throw io::InputError(
      {log.source, 0, axis,
       fmt::format(
           "no column for the position of this axis; the log has {} (name it with --map {}=\"COLUMN UNIT\")",
           column_names(log), axis)});
}

std::vector<double> positions(const io::Log& log, const NamedColumn& named) {
  const Quantity q = known("x").quantity;
  check_unit(log, *named.column, named.unit, q);
  return converted(named.column->values, io::conversion(named.unit, q.unit));
}

std::vector<std::uint8_t> rows_with(const io::Log& log, const std::string& where) {
  const auto equals = where.rfind('=');
  if (equals == std::string::npos || equals == 0)
    refuse_option("--where", fmt::format("got {}, expected COLUMN=VALUE", io::in_quotes(where)));
  const std::string value = where.substr(equals + 1);
  const io::Column& c = column_for(log, "--where", where.substr(0, equals));
  const auto number = as_number(value);
  const auto refuse = [&](std::string message) {
    throw io::InputError({log.source, 0, "--where", std::move(message)});
  };
  if (c.texts.empty() && !number)
    refuse(fmt::format("got {}, expected a number as in column {}", io::in_quotes(value),
                       io::in_quotes(c.name)));
  std::vector<std::uint8_t> has(log.rows);
  for (std::size_t k = 0; k < log.rows; ++k)
    has[k] = (c.texts.empty() ? c.values[k] == *number : c.texts[k] == value) ? 1 : 0;
  if (std::find(has.begin(), has.end(), 1) == has.end())
    refuse(fmt::format("no row has {}", io::in_quotes(where)));
  return has;
}

io::Log read_log(const std::string& path, const LogOptions& given) {
  const LogOptions options = with_map_file(given);
  io::ReadOptions read;
  if (!options.sample_time.empty())
    read.sample_time = option_si("--sample-time", options.sample_time, quantity("s", "ms").positive());
  for (const std::string& text : options.maps) {
    if (text.rfind("t=", 0) != 0) continue;
    // Only a name that stands there as it is; a unit behind it is for later.
    read.time_column =
        text.substr(2, text.rfind(' ') == std::string::npos ? std::string::npos : text.rfind(' ') - 2);
  }
  return io::read_log(path, read);
}

LoggedAxis logged_axis(const io::Log& log, const LogOptions& given) {
  const LogOptions options = with_map_file(given);
  LoggedAxis out;
  std::vector<Map> maps;
  for (const std::string& text : options.maps) {
    Map map = parse_map(text, log);
    for (const Map& other : maps) {
      if (other.quantity == map.quantity) {
        refuse_option("--map",
                      fmt::format("{} is given twice, expected one column for it", map.quantity->name));
      }
      if (other.column == map.column) {
        refuse_option("--map", fmt::format("column {} is given for {} and {}, expected one quantity for it",
                                           io::in_quotes(map.column->header), other.quantity->name,
                                           map.quantity->name));
      }
    }
    maps.push_back(std::move(map));
  }
  const auto mapped = [&](const Known& k) -> std::optional<Chosen> {
    for (const Map& m : maps) {
      if (m.quantity == &k) return Chosen{m.column, m.unit};
    }
    return std::nullopt;
  };
  const auto find = [&](std::string_view name) -> std::optional<Chosen> {
    const Known& k = known(name);
    if (auto m = mapped(k)) return m;
    const io::Column* c = find_by_name(log, k, options.axis);
    if (c == nullptr) return std::nullopt;
    return Chosen{c, c->unit_text};
  };

  double per_radian = 0.0;  // [m/rad]
  if (!options.lead.empty()) {
    const double lead = option_si("--lead", options.lead, quantity("m", "mm"));
    if (lead == 0.0) refuse_option("--lead", "got 0, expected the travel per turn");
    per_radian = lead / (2.0 * kPi);
  }

  // Position and velocity decide whether the axis is one of metres or of angles.
  std::optional<Chosen> x = find("x");
  std::optional<Chosen> v = find("v");
  if (!x && !v) {
    throw io::InputError(
        {log.source, 0, "x",
         fmt::format("no column for the position, nor for the velocity; the log has {} (name it with --map "
                     "x=\"COLUMN UNIT\")",
                     column_names(log))});
  }
  struct Motion {
    std::optional<Chosen> chosen;
    int order;
    std::string_view name;
    io::Conversion conversion{};
    bool angle = false;
    std::vector<double> values{};
  };
  std::array<Motion, 4> motion{{{x, 0, "x"}, {find("r"), 0, "r"}, {v, 1, "v"}, {std::nullopt, 1, "v_ref"}}};
  if (!motion[1].chosen) motion[3].chosen = find("v_ref");
  bool angle = false;
  for (Motion& m : motion) {
    if (!m.chosen) continue;
    const std::string& unit = m.chosen->unit;
    const bool first = &m == &motion[0] || (&m == &motion[2] && !x);
    if (unit.empty() && !first && !mapped(known(m.name))) {
      out.notes.push_back(
          fmt::format("column {} has no unit and is not used (give it with --map {}=\"COLUMN UNIT\")",
                      io::in_quotes(header_of(*m.chosen->column)), m.name));
      m.chosen.reset();
      continue;
    }
    const auto linear = converts(unit, m.order == 0 ? "m" : "m/s");
    const auto turning = converts(unit, m.order == 0 ? "rad" : "rad/s");
    if (!linear && !turning) {
      const Quantity q = m.order == 0 ? quantity("m", "mm") : quantity("m/s", "mm/s");
      check_unit(log, *m.chosen->column, unit, q);
      refuse_column(log, *m.chosen,
                    fmt::format("{} is not a unit of a {}", io::in_quotes(unit),
                                m.order == 0 ? "position" : "velocity"));
    }
    m.angle = !linear;
    m.conversion = linear ? *linear : *turning;
    if (first) angle = m.angle && per_radian == 0.0;
    if (m.angle && per_radian == 0.0 && !angle) {
      refuse_column(
          log, *m.chosen,
          fmt::format("turns ({}), the position does not; give the travel per turn (--lead \"5 mm\")", unit));
    }
    if (!m.angle && angle) {
      refuse_column(
          log, *m.chosen,
          fmt::format(
              "is a length ({}), the position is an angle; give the travel per turn (--lead \"5 mm\")",
              unit));
    }
  }

  // The force: mapped first, then by the unit of the gain, then by preference.
  std::vector<Effort> efforts;
  std::optional<io::InputError> ambiguous;
  for (const bool by_map : {true, false}) {
    for (const std::string_view name : kForces) {
      std::optional<Chosen> c = mapped(known(name));
      if (by_map != c.has_value()) continue;
      try {
        if (!by_map) c = find(name);
      } catch (const io::InputError& e) {
        // With a gain another quantity may still be meant.
        if (options.gain.empty()) throw;
        if (!ambiguous) ambiguous = e;
      }
      if (!c) continue;
      Effort e;
      e.chosen = *c;
      e.kind = by_map || c->unit.empty() ? std::string(name) : kind_by_unit(c->unit, name);
      efforts.push_back(e);
      if (options.gain.empty()) break;
    }
    if (!efforts.empty()) break;
  }
  if (efforts.empty()) {
    if (ambiguous) throw *ambiguous;
    throw io::InputError(
        {log.source, 0, "force",
         fmt::format("no column for the force, nor for torque, current, voltage or percent; the log has {} "
                     "(name it with --map force=\"COLUMN UNIT\")",
                     column_names(log))});
  }
  Effort effort = efforts.front();
  const auto to_force = [&](Effort& e, double factor, bool is_torque) {
    e.factor = factor;
    e.unit = "N";
    if (!is_torque) return;
    if (per_radian != 0.0) {
      e.factor /= per_radian;
      e.by_lead = true;
    } else {
      e.unit = "N m";
    }
  };
  if (!options.gain.empty()) {
    bool fits = false;
    for (Effort& e : efforts) {
      if (e.kind == "force") continue;  // has its scale
      const Quantity q = known(e.kind).quantity;
      const std::string per = e.kind == "percent" ? "" : "/(" + std::string(q.unit) + ")";
      struct Target {
        std::string unit;
        bool torque;
      };
      for (const Target& t :
           {Target{e.kind == "torque" ? "1/m" : "N" + per, false}, Target{"N m" + per, true}}) {
        double gain = 0.0;
        try {
          gain = io::to_si(options.gain, Quantity{t.unit, t.unit});
        } catch (const io::InputError&) {
          continue;
        }
        if (gain == 0.0) refuse_option("--gain", "got 0, expected the force per unit of the column");
        to_force(e, gain, t.torque);
        if (e.unit != "N" && !angle) {
          refuse_option("--gain",
                        fmt::format("got {}, a torque; give the travel per turn too (--lead \"5 mm\")",
                                    io::in_quotes(options.gain)));
        }
        effort = e;
        fits = true;
        break;
      }
      if (fits) break;
    }
    if (!fits) {
      if (ambiguous) throw *ambiguous;
      if (efforts.size() == 1 && efforts.front().kind == "force") {
        refuse_option(
            "--gain",
            fmt::format(
                "got {}, but the force of this log, column {}, has a scale already: leave the gain out, or map the column that it belongs to (--map voltage=\"COLUMN V\")",
                io::in_quotes(options.gain), io::in_quotes(header_of(*efforts.front().chosen.column))));
      }
      std::string kinds;
      for (const Effort& e : efforts) kinds += (kinds.empty() ? "" : ", ") + e.kind;
      refuse_option("--gain",
                    fmt::format("got {}, expected a number with a unit like {} for the {} of this log",
                                io::in_quotes(options.gain),
                                efforts.front().kind == "voltage"   ? "N/V"
                                : efforts.front().kind == "current" ? "N/A"
                                : efforts.front().kind == "percent" ? "N (at 100 %)"
                                : efforts.front().kind == "torque"  ? "1/mm"
                                                                    : "N/V, N/A",
                                kinds));
    }
  } else if (effort.kind == "torque" && !effort.chosen.unit.empty()) {
    to_force(effort, 1.0, true);
    if (effort.unit != "N") {
      out.notes.push_back(
          angle
              ? "the force is a torque in N m about an angle in rad"
              : "the force is given as a torque and is identified in N m; with --lead \"5 mm\" it becomes N");
    }
  } else if (effort.kind != "force") {
    const std::string& unit = effort.chosen.unit;
    const auto said = [&](const char* si) { return unit.empty() ? std::string("units") : std::string(si); };
    effort.unit = effort.kind == "current"   ? said("A")
                  : effort.kind == "voltage" ? said("V")
                  : effort.kind == "percent" ? "%"
                                             : said("N m");
    out.notes.push_back(
        fmt::format("the scale of the force is not known: {} is identified in its own unit, {} (with "
                    "--gain \"1048 {}\" it becomes newton)",
                    io::in_quotes(header_of(*effort.chosen.column)), effort.unit,
                    effort.kind == "current"   ? "N/A"
                    : effort.kind == "voltage" ? "N/V"
                    : effort.kind == "percent" ? "N"
                                               : "1/mm"));
  }
  {
    const Quantity q = known(effort.kind).quantity;
    const std::string& unit = effort.chosen.unit;
    if (effort.unit == "units" || (effort.unit == "%" && unit.empty())) {
      effort.conversion = {};
    } else if (const auto c = converts(unit, q.unit)) {
      effort.conversion = *c;
      if (effort.unit == "%") effort.factor = 100.0;
    } else {
      check_unit(log, *effort.chosen.column, unit, q);
    }
  }

  const bool turns =
      std::any_of(motion.begin(), motion.end(), [](const Motion& m) { return m.chosen && m.angle; });
  if (per_radian != 0.0 && !turns && !effort.by_lead)
    refuse_option(
        "--lead",
        "no column of this log is an angle and the force is not a torque: the option has no effect, leave it out");

  // Time.
  const auto time_of = [&](const io::Column& c) -> int {
    if (const auto m = mapped(known("t"))) return static_cast<int>(m->column - log.columns.data());
    if (c.time >= 0) return c.time;
    return io::time_column(log);
  };
  const std::string time_unit = [&] {
    const auto m = mapped(known("t"));
    return m ? m->unit : std::string();
  }();
  const auto seconds = [&](int index) {
    const io::Column& c = log.columns[static_cast<std::size_t>(index)];
    io::Column copy = c;
    if (!time_unit.empty()) copy.unit_text = time_unit;
    try {
      return io::in_si(copy, quantity("s", "s"));
    } catch (const io::InputError& e) {
      io::Problem p = e.problems().front();
      p.file = log.source;
      throw io::InputError(p);
    }
  };
  const double sample_time = options.sample_time.empty() ? 0.0
                                                         : option_si("--sample-time", options.sample_time,
                                                                     quantity("s", "ms").positive());

  const Chosen& base = x ? *x : *v;
  const int base_time = time_of(*base.column);
  if (base_time < 0 && sample_time == 0.0) {
    throw io::InputError(
        {log.source, 0, "t",
         fmt::format("no column for the time; the log has {} (name it with --map t=\"COLUMN UNIT\", or "
                     "give the time between rows with --sample-time \"1 ms\")",
                     column_names(log))});
  }
  if (base_time >= 0 && &log.columns[static_cast<std::size_t>(base_time)] == base.column)
    refuse_column(log, base, "is the time itself, expected a position");
  std::vector<std::pair<int, std::vector<double>>> times;
  const auto time_values = [&](int index) -> const std::vector<double>& {
    for (const auto& [i, values] : times) {
      if (i == index) return values;
    }
    times.emplace_back(index, seconds(index));
    return times.back().second;
  };
  times.reserve(log.columns.size() + 1);

  const Selection selection = select(log, options);
  if (selection.all && base_time >= 0) {
    const std::string marks = marks_of_runs(log, log.columns[static_cast<std::size_t>(base_time)].values);
    if (!marks.empty()) {
      out.notes.push_back(fmt::format(
          "several runs in one file, distinguished by {}: choose those that belong together with --where COLUMN=VALUE, and separate them with --runs COLUMN",
          marks));
    }
  }
  const auto pick = [](const std::vector<double>& values, const std::vector<std::size_t>& rows) {
    std::vector<double> some(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) some[i] = values[rows[i]];
    return some;
  };
  for (Motion& m : motion) {
    if (!m.chosen) continue;
    m.values = converted(m.chosen->column->values, m.conversion, m.angle && !angle ? per_radian : 1.0);
    out.columns.emplace_back(
        m.name, header_of(*m.chosen->column) + (m.chosen->unit.empty() ? "" : " [" + m.chosen->unit + "]"));
  }
  std::vector<double> force = converted(effort.chosen.column->values, effort.conversion, effort.factor);
  out.columns.emplace_back(
      effort.kind,
      header_of(*effort.chosen.column) + (effort.chosen.unit.empty() ? "" : " [" + effort.chosen.unit + "]"));
  const std::size_t runs = selection.all ? 1 : selection.runs.size();
  for (std::size_t i = 0; i < runs; ++i) {
    ident::log::RawLog raw;
    raw.source = selection.all ? log.source : run_name(log, options, selection.runs[i].front());
    raw.force_unit = effort.unit;
    raw.position_unit = angle ? "rad" : "m";
    raw.sample_time = sample_time;
    const auto signal = [&](std::vector<double>& values, const io::Column& column, bool is_base) {
      ident::log::Signal s;
      const int index = time_of(column);
      const bool own = index >= 0 && (is_base || index != base_time);
      if (selection.all) {
        s.y = std::move(values);
        if (own) s.t = time_values(index);
        return s;
      }
      if (column.values.size() != log.rows)
        refuse_option("--where",
                      fmt::format("column {} has rows of its own", io::in_quotes(header_of(column))));
      s.y = pick(values, selection.runs[i]);
      if (own) s.t = pick(time_values(index), selection.runs[i]);
      return s;
    };
    for (Motion& m : motion) {
      if (!m.chosen) continue;
      ident::log::Signal& s = m.name == "x"   ? raw.x
                              : m.name == "r" ? raw.r
                              : m.name == "v" ? raw.v
                                              : raw.v_ref;
      s = signal(m.values, *m.chosen->column, m.chosen->column == base.column);
    }
    raw.f = signal(force, *effort.chosen.column, false);
    if (!selection.all) {
      raw.row = selection.runs[i];
      for (std::size_t& k : raw.row) ++k;
    }
    out.runs.push_back(std::move(raw));
  }
  return out;
}

ident::log::Conditioned condition_log(const io::Log& log, const LogOptions& given,
                                      std::vector<std::string>* notes) {
  const LogOptions options = with_map_file(given);
  LoggedAxis axis = logged_axis(log, options);
  if (notes != nullptr) notes->insert(notes->end(), axis.notes.begin(), axis.notes.end());
  const ident::log::ConditionOptions condition{options.keep};
  ident::log::Conditioned clean;
  try {
    clean = ident::log::condition(std::move(axis.runs), condition);
  } catch (const ident::Refused& why) {
    // The log itself is at fault, not what it can tell.
    throw io::InputError(io::Problem{"", 0, "", why.what()});
  }
  const bool look = std::find(options.keep.begin(), options.keep.end(), "mixed-runs") == options.keep.end();
  if (look) {
    std::vector<ident::log::Finding> mixed = ident::log::warn_of_mixed_runs(clean.records);
    for (ident::log::Finding& f : mixed) {
      f.text = log.source + ": " + f.text;
      clean.findings.push_back(std::move(f));
    }
  }
  return clean;
}

ident::log::Record make_record(const io::Log& log, const LogOptions& options) {
  const LoggedAxis axis = logged_axis(log, options);
  if (axis.runs.size() != 1) {
    throw io::InputError(
        {log.source, 0, {}, fmt::format("{} runs, expected one (choose it with --where)", axis.runs.size())});
  }
  const ident::log::RawLog& raw = axis.runs.front();
  if (raw.force_unit != "N" || raw.position_unit != "m") {
    const bool voltage = raw.force_unit == "V";
    throw io::InputError({log.source, 0,
                          voltage                 ? "voltage"
                          : raw.force_unit == "A" ? "current"
                                                  : "force",
                          fmt::format("the force is given as {}; give its scale (--gain \"1048 N/{}\")",
                                      voltage ? "voltage" : raw.force_unit, voltage ? "V" : raw.force_unit)});
  }
  ident::log::Record record;
  record.source = log.source;
  record.t = raw.x.t.empty() ? raw.v.t : raw.x.t;
  record.x = raw.x.y;
  record.r = raw.r.y;
  record.v = raw.v.y;
  record.f = raw.f.y;
  if (record.t.empty()) {
    for (std::size_t k = 0; k < record.x.size(); ++k)
      record.t.push_back(raw.sample_time * static_cast<double>(k));
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
  for (std::string& text : ident::log::problems(record)) {
    const std::string prefix = log.source + ": ";
    if (text.rfind(prefix, 0) == 0) text.erase(0, prefix.size());
    found.push_back({log.source, 0, {}, std::move(text)});
  }
  if (!found.empty()) throw io::InputError(std::move(found));
  return record;
}

}  // namespace stribeck::workflow
