#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/names/column_labels.hpp>
#include <stribeck/workflow/log/names/column_sums.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/log/names/proposed_maps.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

LogQuantity quantity_called(std::string_view name) {
  if (const auto known = enum_value<LogQuantity>(name)) return *known;
  std::string names;
  for (const auto& [value, word] : EnumNames<LogQuantity>::names)
    names += (names.empty() ? "" : ", ") + std::string(word);
  refuse_option("--map",
                fmt::format("unknown quantity {}, expected one of {}, or none", io::in_quotes(name), names));
}

/// "1/s", "Hz", "1/min": per time, but not of what.
bool is_bare_rate(const std::string& unit) { return conversion_between(unit, "Hz").has_value(); }

/// Whether --map names the unit behind a bare rate (1/s): turns, radians or degrees.
bool tells_rate(const std::string& unit, const std::string& own) {
  return is_bare_rate(own) && conversion_between(unit, "rad/s").has_value();
}

/// A unit given for a column may replace the file's own, but not change the quantity. Counts and bare rates have none.
void check_same_dimension(const io::Column& column, const std::string& unit) {
  const std::string& own = column.unit_text;
  if (unit.empty() || column.unit_assumed || own == "1" || is_count(own) || tells_rate(unit, own)) return;
  if (!io::is_unit(column.unit_text) || !io::is_unit(unit)) return;
  try {
    static_cast<void>(io::conversion(unit, column.unit_text));
  } catch (const io::InputError&) {
    refuse_option(
        "--map",
        fmt::format(
            "column {} has the unit {} in the file, which cannot be converted to {}; leave the unit out "
            "or map another column (to scale a force, use --gain)",
            io::in_quotes(header_of(column)), column.unit_text, unit));
  }
}

/// "1" of "axis1", "axis 1" and "joint_1".
std::string without_word_axis(const std::string& name) {
  for (const std::string_view word : {"axis", "achse", "joint"}) {
    if (!name.starts_with(word)) continue;
    const auto at = name.find_first_not_of(" _-", word.size());
    if (at != std::string::npos) return name.substr(at);
  }
  return name;
}

/// In a log that calls its axes X1, X2, … "x" is the axis X1; in the metadata "X1" may stand for the axis 1.
bool same_axis(const io::Log& log, const std::string& wanted, const std::string& found) {
  const std::string w = lower_case(wanted);
  if (w == found || without_word_axis(w) == without_word_axis(found)) return true;
  const auto is_first = [](const std::string& name, const std::string& short_name) {
    return name.size() == short_name.size() + 1 && name.compare(0, short_name.size(), short_name) == 0 &&
           name.back() == '1';
  };
  if (is_first(found, w)) return true;
  for (const auto& [key, value] : log.metadata) {
    if (lower_case(key) != "axis " + found) continue;
    const std::string v = lower_case(value);
    if (v == w || is_first(v, w)) return true;
  }
  return false;
}

/// Several logs share one --map, but need not share their columns.
[[noreturn]] void refuse_unknown_column(const io::Log& log, const std::string& text) {
  try {
    static_cast<void>(log.at(text));  // throws with the columns there are
  } catch (const io::InputError& e) {
    io::Problem p = e.problems().front();
    p.message += fmt::format(
        "; where logs of one command have different columns, name those of each in a side file of its own: {}.toml "
        "with columns = [\"t s\", \"x mm\", \u2026] in the order of the file",
        log.source);
    throw io::InputError(p);
  }
  std::abort();
}

/// The name; where two columns differ in their units alone, the unit stands in it: "Z act (N)".
std::string without_unit(const io::Column& c) {
  const auto open = c.name.find_last_of("([");
  if (open == std::string::npos || !(c.name.ends_with(')') || c.name.ends_with(']'))) return c.name;
  const auto same = conversion_between(c.name.substr(open + 1, c.name.size() - open - 2), c.unit_text);
  return same && same->factor == 1.0 ? c.name.substr(0, open) : c.name;
}

/// "axis_z" and "joint z" have the word z.
bool has_word(const std::string& name, const std::string& wanted) {
  const std::vector<std::string> words = words_of_name(name);
  return std::find(words.begin(), words.end(), lower_case(wanted)) != words.end();
}

struct Candidate {
  const io::Column* column = nullptr;
  std::string axis;
  std::size_t family = 0;
  std::size_t rank = 0;
};

/// Axes of the columns that are a position by their name, not only by their unit; "" for one without an axis.
std::vector<std::string> axes_of_positions(const io::Log& log, const std::string& axis) {
  const KnownColumn& position = known_column(LogQuantity::kPosition);
  std::vector<std::string> axes;
  const AxisWords words = axis_words(log);
  for (const io::Column& c : log.columns) {
    if (c.values.empty()) continue;
    for (const Label& label : labels_in(log, c, axis, words)) {
      for (const auto& family : position.families) {
        if (std::find(family.begin(), family.end(), label.base) != family.end()) axes.push_back(label.axis);
      }
    }
    const auto meaning = meaning_of(without_unit(c), c.unit_text);
    if (meaning && meaning->what == LogQuantity::kPosition && !meaning->by_unit)
      axes.push_back(meaning->axis);
  }
  return axes;
}

std::vector<Candidate> candidates(const io::Log& log, const KnownColumn& k, const std::string& axis) {
  std::vector<Candidate> out;
  const AxisWords words = axis_words(log);
  for (const io::Column& c : log.columns) {
    if (c.values.empty()) continue;
    for (const Label& label : labels_in(log, c, axis, words)) {
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
  if (!out.empty()) return out;
  // Names that no notation has are read word by word. Those that tell a quantity by their units alone count in a log that calls no
  // position by its name, and as the reference where there is one.
  std::vector<Candidate> by_unit;
  for (const io::Column& c : log.columns) {
    if (c.values.empty()) continue;
    auto meaning = meaning_of(without_unit(c), c.unit_text);
    // "Hub_ist" beside "Hub_Kraft": the word is the axis, and "ist" is told by its unit.
    if (const std::optional<Label> named = apart(c, words); !meaning && named) {
      meaning = meaning_of(named->base, c.unit_text);
      if (meaning) meaning->axis = named->axis, meaning->by_unit = false;
    }
    if (!meaning || meaning->what != k.what) continue;
    (meaning->by_unit ? by_unit : out).push_back({&c, std::move(meaning->axis), 0, meaning->rank});
  }
  if (!out.empty() || by_unit.empty()) return out;
  const std::vector<std::string> positions = axes_of_positions(log, axis);
  if (positions.empty()) return by_unit;
  // "cmd [um]" beside "pos [um]" can be nothing else, nor "X cmd" beside "X pos" and "Y cmd".
  if (k.what != LogQuantity::kReference) return out;
  std::erase_if(by_unit, [&](const Candidate& c) {
    if (c.axis.empty()) return false;
    if (!axis.empty()) return !same_axis(log, axis, c.axis);
    return std::find(positions.begin(), positions.end(), c.axis) == positions.end();
  });
  return by_unit.size() == 1 ? by_unit : out;
}

/// The position of an axis whose column has the name of the axis: x, y and c of one log. Null: there is none.
const io::Column* called_as_axis(const io::Log& log, const std::string& axis) {
  const auto found = std::find_if(log.columns.begin(), log.columns.end(), [&](const io::Column& c) {
    if (c.values.empty() || lower_case(c.name) != lower_case(axis)) return false;
    return conversion_between(c.unit_text, "m") || conversion_between(c.unit_text, "rad");
  });
  return found == log.columns.end() ? nullptr : &*found;
}

/// The column of a quantity, found by its name; absent where there is none. Throws where several could be it.
const io::Column* find_by_name(const io::Log& log, const KnownColumn& k, const std::string& axis) {
  if (k.what == LogQuantity::kPosition && !axis.empty()) {
    if (const io::Column* own = called_as_axis(log, axis)) return own;
  }
  std::vector<Candidate> all = candidates(log, k, axis);
  if (all.empty()) return nullptr;
  const auto keep = [&](auto&& good) {
    std::vector<Candidate> some;
    std::copy_if(all.begin(), all.end(), std::back_inserter(some), good);
    return some;
  };
  if (!axis.empty()) {
    std::vector<Candidate> of_axis =
        keep([&](const Candidate& c) { return !c.axis.empty() && lower_case(axis) == c.axis; });
    if (of_axis.empty())
      of_axis = keep([&](const Candidate& c) { return !c.axis.empty() && same_axis(log, axis, c.axis); });
    if (of_axis.empty()) of_axis = keep([&](const Candidate& c) { return has_word(c.axis, axis); });
    if (of_axis.empty()) of_axis = keep([](const Candidate& c) { return c.axis.empty(); });
    all = std::move(of_axis);
    if (all.empty()) return nullptr;
  }
  std::vector<std::string> axes;
  for (const Candidate& c : all) {
    if (std::find(axes.begin(), axes.end(), c.axis) == axes.end()) axes.push_back(c.axis);
  }
  if (axes.size() > 1 && axis.empty()) {
    // A column without an axis in its name is preferred.
    const std::vector<Candidate> plain = keep([](const Candidate& c) { return c.axis.empty(); });
    if (plain.empty()) {
      std::string list;
      for (const std::string& a : axes) list += (list.empty() ? "" : ", ") + a;
      throw io::InputError({log.source, 0, std::string(enum_name(k.what)),
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
        {log.source, 0, std::string(enum_name(k.what)),
         fmt::format("{} columns could be this quantity: {} (choose one with --map {}=\"COLUMN UNIT\")",
                     all.size(), list, enum_name(k.what))});
  }
  return all.front().column;
}

bool is_place(LogQuantity what) {
  return what == LogQuantity::kPosition || what == LogQuantity::kReference || what == LogQuantity::kMotor ||
         what == LogQuantity::kScale;
}

bool is_force(LogQuantity what) { return std::find(kForces.begin(), kForces.end(), what) != kForces.end(); }

}  // namespace

const std::string& header_of(const io::Column& c) { return c.header.empty() ? c.name : c.header; }

std::string column_names(const io::Log& log) {
  std::string names;
  constexpr std::size_t kMost = 60;
  for (std::size_t i = 0; i < log.columns.size() && i < kMost; ++i) {
    const io::Column& c = log.columns[i];
    names += (names.empty() ? "" : ", ") + io::in_quotes(header_of(c));
    // Thousands separators, units beside the numbers, …: the column is there, but holds no numbers.
    if (!c.texts.empty()) names += fmt::format(" (text, such as {})", io::in_quotes(c.texts.front()));
  }
  if (log.columns.size() > kMost) names += fmt::format(", and {} more", log.columns.size() - kMost);
  return names;
}

std::string header_with_unit(const NamedColumn& named) {
  std::string name = header_of(*named.column);
  for (const io::Column* other : named.beside) name += " + " + header_of(*other);
  for (const io::Column* other : named.against) name += " - " + header_of(*other);
  return name + (named.unit.empty() ? "" : " [" + named.unit + "]");
}

AxisColumns::AxisColumns(const io::Log& log, const LogOptions& options) : log_(log), axis_(options.axis) {
  for (const std::string& text : options.maps) {
    if (text.starts_with(kNotUsed)) continue;  // read_log() left it out
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals + 1 == text.size()) {
      refuse_option("--map",
                    fmt::format("got {}, expected quantity=\"column unit\", e.g. x=\"Istposition mm\"",
                                io::in_quotes(text)));
    }
    const LogQuantity what = quantity_called(text.substr(0, equals));
    const std::string column_text = text.substr(equals + 1);
    NamedColumn named = is_force(what)   ? named_sum(log, column_text)
                        : is_place(what) ? named_difference(log, column_text)
                                         : named_column(log, column_text);
    for (const auto& [other, column] : maps_) {
      if (other == what)
        refuse_option("--map", fmt::format("{} is given twice, expected one column for it", enum_name(what)));
      if (column.column == named.column) {
        refuse_option(
            "--map", fmt::format("column {} is given for {} and {}, expected one quantity for it",
                                 io::in_quotes(header_of(*named.column)), enum_name(other), enum_name(what)));
      }
    }
    maps_.emplace_back(what, std::move(named));
  }
}

std::optional<NamedColumn> AxisColumns::mapped(LogQuantity what) const {
  for (const auto& [quantity, column] : maps_) {
    if (quantity == what) return column;
  }
  return std::nullopt;
}

std::optional<NamedColumn> AxisColumns::find(LogQuantity what) const {
  if (auto named = mapped(what)) return named;
  // A position that --map names tells how the log calls the axis.
  std::string axis = axis_;
  if (const auto position = mapped(LogQuantity::kPosition); position && !axis.empty()) {
    const auto meaning = meaning_of(without_unit(*position->column), position->column->unit_text);
    if (meaning && !meaning->axis.empty()) axis = meaning->axis;
  }
  const io::Column* c = find_by_name(log_, known_column(what), axis);
  if (c == nullptr) return std::nullopt;
  return NamedColumn{c, c->unit_text};
}

std::string AxisColumns::of_other_axes(LogQuantity what) const {
  const KnownColumn& k = known_column(what);
  std::string list;
  if (axis_.empty()) return list;
  for (const Candidate& c : candidates(log_, k, axis_)) {
    if (c.axis.empty()) continue;
    list += fmt::format("{}{} is of axis {}", list.empty() ? "" : ", ", io::in_quotes(header_of(*c.column)),
                        io::in_quotes(c.axis));
  }
  return list;
}

std::vector<std::string> AxisColumns::rescaled() const {
  std::vector<std::string> out;
  for (const auto& [what, named] : maps_) {
    const std::string& own = named.column->unit_text;
    if (own.empty() || named.column->unit_assumed) continue;
    if (tells_rate(named.unit, own) && !(is_per_minute(own) && named.unit == kTurnsPerMinute))
      out.push_back(fmt::format("column {} has the unit {} in the file; --map gives {} instead",
                                io::in_quotes(header_of(*named.column)), own, named.unit));
    const auto factor = conversion_between(named.unit, own);
    if (!factor || factor->factor == 1.0) continue;
    out.push_back(
        fmt::format("column {} has the unit {} in the file; --map gives {} instead, {:.6g} times as much",
                    io::in_quotes(header_of(*named.column)), own, named.unit, factor->factor));
  }
  return out;
}

std::vector<NamedColumn> AxisColumns::with_unit_of(const std::vector<std::string_view>& units,
                                                   bool doubtful) const {
  std::vector<NamedColumn> out;
  for (const io::Column& c : log_.columns) {
    if (c.values.empty() || (c.unit_assumed && !doubtful) || c.unit_text == "1") continue;
    const auto meaning = meaning_of(without_unit(c), c.unit_text);
    if (!axis_.empty() && meaning && !meaning->axis.empty() && !same_axis(log_, axis_, meaning->axis))
      continue;
    const bool used =
        std::any_of(maps_.begin(), maps_.end(), [&](const auto& m) { return m.second.column == &c; });
    if (used) continue;
    const bool fits = std::any_of(units.begin(), units.end(), [&](std::string_view unit) {
      return conversion_between(c.unit_text, unit).has_value();
    });
    if (fits) out.push_back({&c, c.unit_text});
  }
  return out;
}

NamedColumn column_called(const io::Log& log, const std::string& text) {
  NamedColumn named{log.find(text), {}};
  // Tries shorter and shorter names, because a unit may contain blanks ("N s/mm").
  for (auto blank = text.rfind(' '); named.column == nullptr && blank != std::string::npos && blank > 0;
       blank = text.rfind(' ', blank - 1)) {
    if (const io::Column* c = log.find(text.substr(0, blank))) {
      named.column = c;
      named.unit = text.substr(blank + 1);
    }
  }
  return named;
}

NamedColumn named_column(const io::Log& log, const std::string& text) {
  NamedColumn named = column_called(log, text);
  if (named.column == nullptr) refuse_unknown_column(log, text);
  if (named.column->values.empty()) {
    refuse_option("--map", fmt::format("column {} holds text, expected numbers",
                                       io::in_quotes(header_of(*named.column))));
  }
  check_same_dimension(*named.column, named.unit);
  if (named.unit.empty()) named.unit = named.column->unit_text;
  return named;
}

namespace {

/// The column with one of these names, in any case, else the one that is found for an axis; null: none. A column without an axis in its
/// name could belong to any axis, and is none.
const io::Column* column_of(const io::Log& log, const std::vector<std::string>& names, LogQuantity what,
                            const std::string& axis) {
  for (const std::string& name : names) {
    const io::Column* c = log.find(name);
    for (const io::Column& other : log.columns) {
      if (c == nullptr && lower_case(other.name) == name) c = &other;
    }
    if (c != nullptr && !c->values.empty()) return c;
  }
  const std::vector<Candidate> all = candidates(log, known_column(what), axis);
  const bool any = std::any_of(all.begin(), all.end(), [&](const Candidate& some) {
    return !some.axis.empty() && same_axis(log, axis, some.axis);
  });
  return any ? find_by_name(log, known_column(what), axis) : nullptr;
}

}  // namespace

std::optional<NamedColumn> commanded_column(const io::Log& log, const std::string& axis) {
  // "rx [deg]" is a rotation.
  std::vector<std::string> names;
  for (const std::string& name : {"r" + axis, axis + "_ref", axis + "_cmd", axis + "_soll"}) {
    const io::Column* named = log.find(name);
    if (named == nullptr || conversion_between(named->unit_text, "m")) names.push_back(name);
  }
  const io::Column* c = column_of(log, names, LogQuantity::kReference, axis);
  if (c == nullptr || !conversion_between(c->unit_text, "m")) return std::nullopt;
  return NamedColumn{c, c->unit_text};
}

std::optional<NamedColumn> scale_column(const io::Log& log, const std::string& axis) {
  const io::Column* c = column_of(log, {"scale_" + axis}, LogQuantity::kScale, axis);
  if (c == nullptr || !conversion_between(c->unit_text, "m")) return std::nullopt;
  return NamedColumn{c, c->unit_text};
}

NamedColumn position_column(const io::Log& log, const std::string& axis) {
  const io::Column* c = column_of(log, {axis}, LogQuantity::kPosition, axis);
  if (c != nullptr) return {c, c->unit_text};
  throw io::InputError(
      {log.source, 0, axis,
       fmt::format(
           "no column for the position of this axis; the log has {} (name it with --map {}=\"COLUMN UNIT\")",
           column_names(log), axis)});
}

std::vector<double> positions(const io::Log& log, const NamedColumn& named) {
  const Quantity q = known_column(LogQuantity::kPosition).quantity;
  check_unit(log, *named.column, named.unit, LogQuantity::kPosition, q);
  return converted(*named.column, io::conversion(named.unit, q.unit), 1.0);
}

bool is_count(const std::string& unit) {
  return unit == "count" || unit == "counts" || unit.starts_with("count/");
}

bool is_per_minute(const std::string& unit) {
  const auto hertz = conversion_between(unit, "Hz");
  return hertz && std::abs(60.0 * hertz->factor - 1.0) < 1e-9;
}

void check_unit(const io::Log& log, const io::Column& column, const std::string& unit, LogQuantity what,
                const Quantity& q) {
  io::Column empty;
  empty.name = column.name;
  empty.unit_text = unit;
  empty.header = column.header;
  try {
    static_cast<void>(io::in_si(empty, q));
  } catch (const io::InputError& e) {
    io::Problem p = e.problems().front();
    p.file = log.source;
    const std::string all = unit.empty() ? proposed_maps(log, axis_in_name(column)) : "";
    if (!all.empty())
      p.message += "; or give all that is missing, with your units: " + all;
    else if (unit.empty())
      p.message +=
          "; or give it with " +
          map_option(enum_name(what), fmt::format("{} {}", column.name, q.shown.empty() ? q.unit : q.shown));
    throw io::InputError(p);
  }
}

void refuse_column(const io::Log& log, const NamedColumn& c, const std::string& message) {
  throw io::InputError({log.source, 0, "column " + io::in_quotes(header_of(*c.column)), message});
}

}  // namespace stribeck::workflow
