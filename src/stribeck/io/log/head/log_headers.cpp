// Names and units in the heads of tables, as controls, drives and their tools write them.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/log/head/unit_spellings.hpp>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/io/units/torque_spellings.hpp>
#include <utility>

namespace stribeck::io::detail {
namespace {

/// Increments of an encoder, as headers call them.
bool is_count_word(std::string_view unit) {
  // "Counts16Bit"
  const std::string word = lower_case(std::string(unit));
  return (word.starts_with("count") && word.find('/') == std::string::npos) ||
         std::any_of(kSpellings.begin(), kSpellings.end(),
                     [&](const auto& s) { return s.first == unit && s.second == "count"; });
}

/// "cnt/sec", "counts/100ms": increments by something.
bool is_count_rate(std::string_view unit) {
  const auto slash = unit.find('/');
  return slash != std::string_view::npos && is_count_word(trimmed(unit.substr(0, slash)));
}

/// The plain unit of a spelling of controls; "" for others.
std::string_view spelling_of(std::string_view unit) {
  const auto found =
      std::find_if(kSpellings.begin(), kSpellings.end(), [&](const auto& s) { return s.first == unit; });
  return found == kSpellings.end() ? std::string_view() : found->second;
}

/// A length that the user set in the drive: no unit says how long it is.
bool is_user_unit(std::string_view unit) {
  constexpr std::array<std::string_view, 8> kWords{"unit", "units", "user unit", "user units",
                                                   "uu",   "lu",    "puu",       "eu"};
  const std::string word = lower_case(std::string(unit));
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

/// "0.00029296875 mm": a unit of the size that the number says, e.g. of one count.
bool is_scaled_unit(std::string_view text) {
  // "0.1um" needs no blank where the number has a decimal point; "2D" is a word.
  auto end = std::min(text.find_first_of(" %"), text.size());
  const auto digits = std::min(text.find_first_not_of("0123456789."), text.size());
  if (text.substr(0, digits).find('.') != std::string_view::npos) end = std::min(end, digits);
  const auto unit = trimmed(text.substr(end));
  const auto factor = cell_number(text.substr(0, end), '.');
  return factor && *factor > 0.0 && std::isfinite(*factor) && !unit.empty() &&
         (std::isalpha(static_cast<unsigned char>(unit[0])) != 0 || unit[0] == '%') && is_unit(unit) &&
         is_unit(text);
}

}  // namespace

namespace {

/// The unit of a time that is called by its unit alone, "sec"; empty: it is no such name. Small letters.
std::string unit_of_time(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kTimes{{{"seconds", "s"},
                                                                                  {"secs", "s"},
                                                                                  {"sec", "s"},
                                                                                  {"sekunden", "s"},
                                                                                  {"milliseconds", "ms"},
                                                                                  {"millisekunden", "ms"},
                                                                                  {"msec", "ms"},
                                                                                  {"microseconds", "us"},
                                                                                  {"usec", "us"},
                                                                                  {"nanoseconds", "ns"}}};
  for (const auto& [word, unit] : kTimes) {
    if (name == word) return std::string(unit);
  }
  return {};
}

/// "Position [cnt] (a01)": what is behind the unit belongs to the name.
std::optional<Column> column_with_words_behind(const std::string& header, Notes& notes) {
  const auto behind = header.rfind("] (");
  if (behind == std::string::npos || header.back() != ')') return std::nullopt;
  Column c = column_of(header.substr(0, behind + 1), notes);
  c.name = c.unit_text.empty() ? header : c.name + header.substr(behind + 1);
  c.header = header;
  return c;
}

}  // namespace

Column column_of(std::string header, Notes& notes) {
  Column c;
  c.name = header;
  if (const auto named = column_with_words_behind(header, notes)) return *named;
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    const auto at = header.rfind(open);
    if (at == std::string::npos || header.back() != close) continue;
    const auto inside = std::string(trimmed(std::string_view(header).substr(at + 1, header.size() - at - 2)));
    const auto before = std::string(trimmed(std::string_view(header).substr(0, at)));
    // "x (1)" is a second copy of x, not a unit.
    const bool dimensionless = open == '[' && (inside == "-" || inside == "1");
    const bool rate = is_count_rate(inside);
    const bool counts = rate || is_count_word(inside);
    const bool scaled = open == '[' && is_scaled_unit(inside);
    // "x (second)" is a name, "Current (Arms)" has a unit.
    const bool named = open == '(' && (inside == "second" || inside == "-" || inside == "M" || inside == "S");
    std::string_view spelled = !named && !scaled && !counts ? spelling_of(inside) : "";
    const std::string_view torque = torque_of(inside);
    if (!torque.empty()) spelled = torque;
    const bool user = is_user_unit(inside);
    const bool unit = !inside.empty() && !counts && !scaled && !user &&
                      !(inside[0] >= '0' && inside[0] <= '9' && inside.substr(0, 2) != "1/") &&
                      is_unit(inside);
    if (dimensionless || unit || counts || scaled || !spelled.empty()) {
      c.name = before.empty() ? header : before;
      c.unit_text = dimensionless     ? "1"
                    : rate            ? "count/s"
                    : counts          ? "count"
                    : spelled.empty() ? inside
                                      : std::string(spelled);
    } else if (user || (open == '[' && inside.find_first_not_of("0123456789") != std::string::npos)) {
      // A number in brackets is an index, r0482[0].
      notes.push_back("column " + in_quotes(header) + ": unit " + in_quotes(inside) + " is not known");
      if (user && !before.empty()) c.name = before;
    }
    c.header = std::move(header);
    return c;
  }
  // "Lage in mm"
  if (const auto in = header.rfind(" in "); in != std::string::npos && in > 0) {
    const std::string unit = header.substr(in + 4);
    const std::string_view torque = torque_of(unit);
    if (!torque.empty() || (std::isdigit(static_cast<unsigned char>(unit[0])) == 0 && is_unit(unit))) {
      c.name = header.substr(0, in);
      c.unit_text = torque.empty() ? unit : std::string(torque);
      c.header = std::move(header);
      return c;
    }
  }
  c.unit_text = unit_of_time(lower_case(header));
  std::size_t longest = 0;
  for (const auto& [suffix, unit] : kSuffixes) {
    if (suffix.size() <= longest || header.size() < suffix.size() + 2) continue;
    const auto at = header.size() - suffix.size();
    if (header[at - 1] != '_' || header.compare(at, suffix.size(), suffix) != 0) continue;
    // "POS_S" is of the spindle.
    if (suffix == "S" && lower_case(header).find("time") == std::string::npos) continue;
    longest = suffix.size();
    c.name = header.substr(0, at - 1);
    c.unit_text = unit;
    c.unit_assumed =
        suffix.size() == 1 && suffix != "N";  // "i_A" may be that of axis A, "x_m" that of the motor
    const std::string name = lower_case(c.name);
    const bool torque = name.find("torque") != std::string::npos || name.find("moment") != std::string::npos;
    if (suffix == "nm" && torque) c.unit_text = "N m";
  }
  c.header = std::move(header);
  return c;
}

void tell_odrive_units(Log& log) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kSignals{
      {{"pos_estimate", "rev"},
       {"pos_setpoint", "rev"},
       {"vel_estimate", "rev/s"},
       {"vel_setpoint", "rev/s"},
       {"iq_measured", "A"},
       {"iq_setpoint", "A"},
       {"torque_setpoint", "N m"}}};
  const auto ends = [](const Column& c, std::string_view signal) {
    return lower_case(c.header).ends_with(signal);
  };
  const bool odrive = std::any_of(log.columns.begin(), log.columns.end(), [&](const Column& c) {
    return ends(c, "encoder.pos_estimate") || ends(c, "encoder.vel_estimate");
  });
  if (!odrive) return;
  bool any = false;
  for (Column& c : log.columns) {
    for (const auto& [signal, unit] : kSignals) {
      if (!c.unit_text.empty() || !c.texts.empty() || !ends(c, signal)) continue;
      c.unit_text = unit;
      c.unit_assumed = any = true;
    }
  }
  if (any)
    log.notes.emplace_back(
        "the signals of the ODrive have no units; taken as turns, A and N m, as firmware 0.5.1 and later has them (counts before: "
        "give them with --map)");
}

std::string header_of(const std::string& name) {
  const auto text = trimmed(name);
  const auto blank = text.rfind(' ');
  if (text.empty() || text.back() == ']' || text.back() == ')' || blank == std::string_view::npos)
    return std::string(text);
  auto unit = text.substr(blank + 1);
  if (unit[0] >= '0' && unit[0] <= '9') return std::string(text);
  if (!is_unit(unit) && !is_count_word(unit) && torque_of(unit).empty()) return std::string(text);
  // "torque N m": a force before a length belongs to the unit.
  if (const auto before = text.substr(0, blank).rfind(' '); before != std::string_view::npos) {
    const auto both = text.substr(before + 1);
    const auto force = text.substr(before + 1, blank - before - 1);
    const bool torque =
        (force == "N" || force == "kN" || force == "mN" || force == "lbf" || force == "ozf") &&
        (unit == "m" || unit == "mm" || unit == "in" || unit == "ft");
    if (torque) return std::string(trimmed(text.substr(0, before))) + " [" + std::string(both) + "]";
  }
  // "x 0.001 mm": a factor has a decimal point or an exponent, for "axis 2 mm" is the column "axis 2".
  if (const auto before = trimmed(text.substr(0, blank)); before.rfind(' ') != std::string_view::npos) {
    const auto at = before.rfind(' ');
    const auto scaled = text.substr(at + 1);
    if (before.substr(at + 1).find_first_of(".eE") != std::string_view::npos && is_scaled_unit(scaled))
      return std::string(trimmed(before.substr(0, at))) + " [" + std::string(scaled) + "]";
  }
  return std::string(trimmed(text.substr(0, blank))) + " [" + std::string(unit) + "]";
}

std::optional<std::string> name_with_unit_after_slash(std::string_view header) {
  for (auto slash = header.find('/'); slash != std::string_view::npos; slash = header.find('/', slash + 1)) {
    const auto name = trimmed(header.substr(0, slash));
    const auto unit = trimmed(header.substr(slash + 1));
    if (name.empty() || unit.empty()) continue;
    const bool number = unit[0] >= '0' && unit[0] <= '9' && unit.substr(0, 2) != "1/";
    const bool known = (!number && is_unit(unit)) || is_count_word(unit) || !spelling_of(unit).empty() ||
                       !torque_of(unit).empty();
    if (known) return std::string(name) + " [" + std::string(unit) + "]";
  }
  return std::nullopt;
}

std::string plain_unit(std::string_view text, std::string_view column, Notes& notes) {
  std::string unit = as_utf8(unquoted(trimmed(text)));
  // TwinCAT adds the quantity: "dV (Voltage)", "(None)".
  if (!unit.empty() && unit.back() == ')') {
    const auto open = unit.rfind('(');
    if (open != std::string::npos && (open == 0 || unit[open - 1] == ' ')) {
      unit = std::string(trimmed(std::string_view(unit).substr(0, open)));
    }
  }
  // The Greek letter replaces the micro sign.
  for (auto at = unit.find("\u03BC"); at != std::string::npos; at = unit.find("\u03BC")) {
    unit.replace(at, 2, "\u00B5");
  }
  if (unit.empty()) return unit;
  if (const auto plain = spelling_of(unit); !plain.empty()) {
    if (plain == kPeakAmpere)
      notes.push_back(
          "column " + in_quotes(column) +
          ": peak current, read as RMS (divided by the root of 2), as torque and force constants are per ampere RMS; where "
          "yours is per peak ampere, map the column with the unit A");
    return std::string(plain);
  }
  if (is_count_rate(unit)) return "count/s";
  const bool number = unit[0] >= '0' && unit[0] <= '9' && unit.substr(0, 2) != "1/";
  if ((!number || unit == "1") && !is_user_unit(unit) && is_unit(unit)) return unit;
  notes.push_back("column " + in_quotes(column) + ": unit " + in_quotes(unit) + " is not known");
  return {};
}

std::string with_unit_in_brackets(const std::string& header, bool slashes, bool after_blank) {
  if (slashes) return name_with_unit_after_slash(header).value_or(header);
  return after_blank ? header_of(header) : header;
}

std::optional<std::vector<std::string>> twincat_pairs(const std::vector<std::string_view>& names,
                                                      const std::vector<std::string_view>& row,
                                                      Notes& notes) {
  constexpr double kTicksOfOurTime = 1e17;  // of 100 ns since 1601: after 1917
  if (names.size() < 2 || names.size() % 2 != 0 || row.size() != names.size()) return std::nullopt;
  std::vector<std::string> all;
  bool ticks = false;
  for (std::size_t i = 0; i < names.size(); i += 2) {
    const auto time = cell_number(row[i], row[i].find(',') == std::string_view::npos ? '.' : ',');
    if (unquoted(trimmed(names[i])) != "Name" || !time) return std::nullopt;
    ticks = *time > kTicksOfOurTime;
    all.emplace_back(ticks ? "Time [0.1 us]" : "Time [ms]");
    all.push_back(unquoted(trimmed(names[i + 1])));
  }
  notes.push_back(
      std::string(
          "the columns called \"Name\" hold the time of the signal beside them, as TwinCAT writes it: in ") +
      (ticks ? "ticks of 100 ns" : "ms"));
  return all;
}

namespace {

bool is_blank_cell(std::string_view cell) { return unquoted(trimmed(cell)).empty(); }

using Cells = std::vector<std::string_view>;

/// Each group stands over its own cell and the blank ones behind it.
std::vector<std::string> under_groups(const Cells& groups, const Cells& names, Notes& notes) {
  std::vector<std::string> all;
  std::string group;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i < groups.size() && !is_blank_cell(groups[i])) group = unquoted(trimmed(groups[i]));
    const std::string name = unquoted(trimmed(names[i]));
    all.push_back(group.empty() || is_time_name(name) ? name : group + " " + name);
  }
  notes.push_back("the names of the columns begin with the merged cells above them, as in " +
                  in_quotes(as_utf8(all.back())));
  return all;
}

bool has_twice(const Cells& names, bool times_too) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view name) {
    return !is_blank_cell(name) && (times_too || !is_time_name(unquoted(trimmed(name)))) &&
           std::count(names.begin(), names.end(), name) > 1;
  });
}

/// Names with single blanks in them, columns of more than one blank: "Mtr 1 Act Pos (mm)   Mtr 1 DAC Out".
Cells at_wide_blanks(std::string_view header) {
  Cells names;
  header = trimmed(header);
  while (!header.empty()) {
    std::size_t end = 0;
    while (end < header.size() && header[end] != '\t' && header.substr(end, 2) != "  ") ++end;
    names.push_back(trimmed(header.substr(0, end)));
    header = trimmed(header.substr(end));
  }
  return names;
}

bool is_number_cell(std::string_view cell) { return cell_number(cell, '.') || cell_number(cell, ','); }

}  // namespace

std::vector<std::string> names_of_columns(std::string_view header, std::string_view above, char separator,
                                          std::string_view& body, Notes& notes) {
  Cells names = split(header, separator);
  if (begins_with(above, kEndOfLabViewHead) && names.size() > 1 && names.front() == "X_Value") {
    notes.push_back(std::string("column \"X_Value\" is taken as the time in s, as LabVIEW writes it"));
    names.front() = "Time [s]";
    if (names.back() == "Comment" && split(first_row(body), separator).size() + 1 == names.size())
      names.pop_back();
    return {names.begin(), names.end()};
  }
  const auto filled_of = [](const Cells& all) {
    return std::count_if(all.begin(), all.end(), std::not_fn(is_blank_cell));
  };
  const std::string_view row = first_row(body);
  if (separator == ' ') {
    const Cells wide = at_wide_blanks(header);
    const std::size_t cells = split(row, separator).size();
    if (names.size() != cells && wide.size() == cells) return {wide.begin(), wide.end()};
  }
  Cells cells = split(row, separator);
  if (separator != ' ' && !cells.empty() && std::none_of(cells.begin(), cells.end(), is_number_cell)) {
    const auto take_row = [&] {
      body.remove_prefix(static_cast<std::size_t>(row.data() + row.size() - body.data()));
    };
    const std::size_t last = is_blank_cell(cells.back()) ? cells.size() - 1 : cells.size();
    const bool full = static_cast<std::size_t>(filled_of(cells)) >= last;
    const auto filled = filled_of(names);
    if (filled == 1 && full && last >= 3 && cells.size() == names.size()) {
      notes.push_back(std::string("the line above the names of the columns is a title and was left out"));
      take_row();
      return {cells.begin(), cells.end()};
    }
    Notes ignored;
    if (filled >= 2 && full && static_cast<std::size_t>(filled) < last && names.size() <= cells.size() &&
        units_in_row(row, separator, names.size(), ignored).empty()) {
      take_row();
      return under_groups(names, cells, notes);
    }
  }
  if (const auto pairs = twincat_pairs(names, cells, notes)) return *pairs;
  const Cells groups = split(above, separator);
  // A time beside each signal stands twice too, as in CODESYS, whose head ends with a key and its value.
  const bool twice = has_twice(names, false) || (groups.size() > 2 && has_twice(names, true));
  if (separator != ' ' && twice && filled_of(groups) >= 2 && groups.size() <= names.size())
    return under_groups(groups, names, notes);
  return {names.begin(), names.end()};
}

bool same_unit(const std::string& a, const std::string& b) {
  if (a == b) return true;
  if (!is_unit(a) || !is_unit(b)) return false;
  try {
    return conversion(a, b).factor == 1.0;
  } catch (const InputError&) {
    return false;
  }
}

bool all_have_unit_after_slash(const std::vector<std::string>& headers) {
  return headers.size() > 1 && std::all_of(headers.begin(), headers.end(), [](const std::string& h) {
           return name_with_unit_after_slash(as_utf8(unquoted(trimmed(h)))).has_value();
         });
}

}  // namespace stribeck::io::detail
