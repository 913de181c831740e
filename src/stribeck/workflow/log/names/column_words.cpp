#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/names/column_word_list.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/log/names/name_letters.hpp>

namespace stribeck::workflow {
namespace {

using words::Entry;
using words::kForeignWords;
using words::kVariables;
using words::kWords;
using words::Word;

/// One letter for a quantity, beside a word that tells actual from commanded: "xist".
constexpr std::array<std::pair<char, Word>, 9> kLetters{{{'x', Word::kPosition},
                                                         {'s', Word::kPosition},
                                                         {'q', Word::kPosition},
                                                         {'v', Word::kVelocity},
                                                         {'n', Word::kVelocity},
                                                         {'i', Word::kCurrent},
                                                         {'m', Word::kTorque},
                                                         {'f', Word::kForce},
                                                         {'u', Word::kVoltage}}};

struct Parameter {
  int number;
  LogQuantity what;
  std::size_t rank;
};

/// SINAMICS list manual: actual values and set-points of drive and position controller.
constexpr std::array<Parameter, 12> kSinamics{{{482, LogQuantity::kPosition, 1},
                                               {2521, LogQuantity::kPosition, 0},
                                               {2665, LogQuantity::kReference, 0},
                                               {61, LogQuantity::kVelocity, 1},
                                               {63, LogQuantity::kVelocity, 0},
                                               {62, LogQuantity::kReferenceVelocity, 0},
                                               {60, LogQuantity::kReferenceVelocity, 1},
                                               {68, LogQuantity::kCurrent, 2},
                                               {77, LogQuantity::kCurrent, 1},
                                               {78, LogQuantity::kCurrent, 0},
                                               {79, LogQuantity::kTorque, 1},
                                               {80, LogQuantity::kTorque, 0}}};

/// CiA 402 (IEC 61800-7-201): objects of actual and demanded values, by their index.
constexpr std::array<Parameter, 12> kCia402{{{0x6064, LogQuantity::kPosition, 0},
                                             {0x6063, LogQuantity::kPosition, 1},
                                             {0x6062, LogQuantity::kReference, 0},
                                             {0x607A, LogQuantity::kReference, 1},
                                             {0x606C, LogQuantity::kVelocity, 0},
                                             {0x606B, LogQuantity::kReferenceVelocity, 0},
                                             {0x60FF, LogQuantity::kReferenceVelocity, 1},
                                             {0x6077, LogQuantity::kTorque, 0},
                                             {0x6074, LogQuantity::kTorque, 1},
                                             {0x6071, LogQuantity::kTorque, 2},
                                             {0x6078, LogQuantity::kCurrent, 0},
                                             {0x6079, LogQuantity::kVoltage, 3}}};

/// SERCOS (IEC 61800-7-204): identification numbers of the standard, and the set-point of IndraDrive's position controller.
struct Ident {
  std::string_view number;
  LogQuantity what;
  std::size_t rank;
};

constexpr std::array<Ident, 8> kSercos{{{"s-0-0051", LogQuantity::kPosition, 0},
                                        {"s-0-0053", LogQuantity::kPosition, 1},
                                        {"s-0-0047", LogQuantity::kReference, 1},
                                        {"p-0-0434", LogQuantity::kReference, 0},
                                        {"s-0-0040", LogQuantity::kVelocity, 0},
                                        {"s-0-0036", LogQuantity::kReferenceVelocity, 0},
                                        {"s-0-0084", LogQuantity::kTorque, 0},
                                        {"s-0-0080", LogQuantity::kTorque, 1}}};

bool is_letter(unsigned char c) { return std::isalpha(c) != 0 || c >= 0x80; }
bool is_digit(unsigned char c) { return std::isdigit(c) != 0; }

std::optional<NameMeaning> found_in(const std::array<Parameter, 12>& known, int number) {
  const auto found =
      std::find_if(known.begin(), known.end(), [&](const Parameter& p) { return p.number == number; });
  if (found == known.end()) return std::nullopt;
  return NameMeaning{found->what, found->rank, {}};
}

/// Index of an object, which may stand in front of its name: "6064h", "0x6064", "#x6064:00", "16#6064", "0x6077:00 Torque actual value".
/// The sub-index is 0. A number without such a mark is no index.
std::optional<int> object_index(std::string_view name) {
  name = name.substr(0, name.find(' '));
  if (name.ends_with(':')) name.remove_suffix(1);  // "0x6064:000: Position actual value"
  bool marked = false;
  for (const std::string_view mark : {"0x", "#x", "16#"}) {
    if (!name.starts_with(mark)) continue;
    name.remove_prefix(mark.size());
    marked = true;
    break;
  }
  if (const auto sub = name.find_first_of(":."); sub != std::string_view::npos) {
    const std::string_view index = name.substr(sub + 1);
    if (index.find_first_not_of("0xh") != std::string_view::npos) return std::nullopt;
    name = name.substr(0, sub);
  }
  if (name.ends_with('h')) name.remove_suffix(1), marked = true;
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number, 16);
  if (!marked || name.size() != 4 || error != std::errc{} || end != name.data() + name.size())
    return std::nullopt;
  return number;
}

/// The index may also stand behind the name: "PositionActualValue 6064h".
std::optional<NameMeaning> cia402(std::string_view name) {
  std::optional<int> index = object_index(name);
  if (const auto blank = name.rfind(' '); !index && blank != std::string_view::npos)
    index = object_index(name.substr(blank + 1));
  return index ? found_in(kCia402, *index) : std::nullopt;
}

/// Number of a parameter, which may stand in front of its name: "r0482", "r0482[0]", "r0063 Speed actual value".
std::optional<int> parameter_number(std::string_view name) {
  name = name.substr(0, name.find_first_of("[: "));
  if (name.size() < 3 || name.size() > 6 || name[0] != 'r') return std::nullopt;
  name.remove_prefix(1);
  if (!std::all_of(name.begin(), name.end(), is_digit)) return std::nullopt;
  int number = 0;
  for (const char c : name) number = 10 * number + (c - '0');
  return number;
}

std::optional<NameMeaning> sinamics(std::string_view name) {
  const std::optional<int> number = parameter_number(name);
  return number ? found_in(kSinamics, *number) : std::nullopt;
}

/// A parameter that is not in kSinamics may have a name that says what it is: "r0025 Lageistwert".
void drop_parameter_number(std::string& name) {
  const auto blank = name.find(' ');
  if (blank != std::string::npos && parameter_number(name)) name.erase(0, blank + 1);
}

/// "Lageistwert Geber 1": the number counts encoders, not axes.
void drop_encoder_number(std::vector<std::string>& parts) {
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    const bool number = std::all_of(parts[i + 1].begin(), parts[i + 1].end(), is_digit);
    if (number && (parts[i] == "geber" || parts[i] == "encoder"))
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
}

/// "S-0-0051, Position feedback value 1"
std::optional<NameMeaning> sercos(std::string_view name) {
  const auto found = std::find_if(kSercos.begin(), kSercos.end(), [&](const Ident& i) {
    return name.starts_with(i.number) && (name.size() == i.number.size() || !is_digit(name[i.number.size()]));
  });
  return found == kSercos.end() ? std::nullopt : std::optional(NameMeaning{found->what, found->rank, {}});
}

/// Parts of letters and digits between other characters; letters of Japan and China are no part of a word of others: "X軸位置".
std::vector<std::string> parts_of(std::string_view name) {
  enum class Kind { kNone, kLatin, kEastAsian };
  std::vector<std::string> parts;
  Kind before = Kind::kNone;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    constexpr unsigned char kFirstOfThreeBytes = 0xE3;
    constexpr unsigned char kFirstOfSequence = 0xC0;
    Kind kind = Kind::kNone;
    if (u >= kFirstOfThreeBytes || (u >= 0x80 && u < kFirstOfSequence && before == Kind::kEastAsian))
      kind = Kind::kEastAsian;
    else if (is_letter(u) || is_digit(u))
      kind = Kind::kLatin;
    if (kind != Kind::kNone) {
      if (kind != before) parts.emplace_back();
      parts.back() += c;
    }
    before = kind;
  }
  return parts;
}

/// "x", "z2", "4", "j1".
bool is_axis(const std::string& part) {
  constexpr std::string_view kAxes = "xyzabcuvws";
  const bool joint = part[0] == 'j' && part.size() > 1;
  const bool letter = joint || kAxes.find(part[0]) != std::string_view::npos;
  return part.size() <= 3 && std::all_of(part.begin() + (letter ? 1 : 0), part.end(), is_digit);
}

/// Reads the whole of `text` as words; the first way that succeeds.
bool read_words(std::string_view text, std::vector<Word>& words) {
  if (text.empty()) return true;
  for (const std::span<const Entry> list :
       {std::span<const Entry>(kWords), std::span<const Entry>(kForeignWords)}) {
    for (const auto& [word, meaning] : list) {
      if (!text.starts_with(word)) continue;
      words.push_back(meaning);
      if (read_words(text.substr(word.size()), words)) return true;
      words.pop_back();
    }
  }
  return false;
}

bool role(Word w) { return w == Word::kActual || w == Word::kCommanded; }

/// The quantity that a unit tells; nothing for one of several quantities, and for volts, which may be those of any sensor.
std::optional<Word> by_unit(const std::string& unit) {
  if (unit.empty()) return std::nullopt;
  constexpr std::array<std::pair<std::string_view, Word>, 7> kUnits{{{"m", Word::kPosition},
                                                                     {"rad", Word::kPosition},
                                                                     {"m/s", Word::kVelocity},
                                                                     {"rad/s", Word::kVelocity},
                                                                     {"N", Word::kForce},
                                                                     {"N m", Word::kTorque},
                                                                     {"A", Word::kCurrent}}};
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) {
    return conversion_between(unit, u.first).has_value();
  });
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

/// The column of a quantity that is actual or commanded; nothing where there is no such column.
std::optional<NameMeaning> meaning(Word quantity, bool commanded, std::size_t rank) {
  switch (quantity) {
    case Word::kPosition:
    case Word::kAngle:
      return NameMeaning{commanded ? LogQuantity::kReference : LogQuantity::kPosition, rank, {}};
    case Word::kVelocity:
      return NameMeaning{commanded ? LogQuantity::kReferenceVelocity : LogQuantity::kVelocity, rank, {}};
    case Word::kAcceleration:
      if (commanded) return std::nullopt;
      return NameMeaning{LogQuantity::kAcceleration, rank, {}};
    case Word::kForce:
      return NameMeaning{LogQuantity::kForce, rank, {}};
    case Word::kTorque:
      return NameMeaning{LogQuantity::kTorque, rank, {}};
    case Word::kCurrent:
      return NameMeaning{LogQuantity::kCurrent, rank, {}};
    default:
      return NameMeaning{LogQuantity::kVoltage, rank, {}};
  }
}

std::optional<NameMeaning> from_words(const std::vector<Word>& words, const std::string& unit) {
  std::optional<Word> quantity;
  std::optional<Word> kind;
  for (const Word w : words) {
    if (w == Word::kNothing) continue;
    std::optional<Word>& slot = role(w) ? kind : quantity;
    if (slot && *slot != w) return std::nullopt;
    slot = w;
  }
  // "Z act [mm]": the name says which of two values it is, the unit of what.
  const bool weak = !quantity;
  if (weak && kind) quantity = by_unit(unit);
  if (!quantity) return std::nullopt;
  const bool commanded = kind == Word::kCommanded;
  constexpr std::size_t kBehind = 3;
  const std::size_t rank = (kind == Word::kActual ? 0
                            : commanded           ? 2
                                                  : 1) +
                           (quantity == Word::kAngle ? kBehind : 0);
  std::optional<NameMeaning> found = meaning(*quantity, commanded, rank);
  if (found) found->by_unit = weak;
  return found;
}

/// "Position Feedback (PL.FB)": the short name of a signal in brackets behind it. An axis in brackets stays.
void drop_short_name(std::string& name) {
  const auto open = name.rfind('(');
  if (!name.ends_with(')') || open == std::string::npos || open == 0) return;
  const std::string inside = name.substr(open + 1, name.size() - open - 2);
  if (inside.empty() || is_axis(inside)) return;
  name.erase(open);
  while (name.ends_with(' ')) name.pop_back();
}

/// "gAxis01, ParID 111: PCTRL_S_ACT" (ACOPOS): what stands before the number of the parameter is the axis.
void take_acopos_axis(std::string& axis, std::string& name) {
  const auto number = name.find(", parid ");
  const auto colon = name.find(": ", number == std::string::npos ? name.size() : number);
  if (colon == std::string::npos) return;
  axis = name.substr(0, number);
  name.erase(0, colon + 2);
}

/// "Axis.Act.Pos": what tells actual from commanded belongs to the signal, not to the axis.
void take_role(std::string& axis, std::string& name) {
  const auto dot = axis.rfind('.');
  if (dot == std::string::npos) return;
  const std::string last = axis.substr(dot + 1);
  std::vector<Word> words;
  if (last.empty() || last == "encoder" || !read_words(last, words) ||
      !std::all_of(words.begin(), words.end(), role))
    return;
  name = last + " " + name;
  axis.erase(dot);
}

/// "axis0.encoder" is a part of axis0, and "PL.FB", "VL.FB", "IL.FB" are values of the loops of a drive, of no axis: what is left tells the
/// axis. A loop tells the quantity.
void drop_part_of_drive(std::string& axis, std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kParts{{{"encoder", ""},
                                                                                 {"motor", ""},
                                                                                 {"controller", ""},
                                                                                 {"current_control", ""},
                                                                                 {"drv", ""},
                                                                                 {"pl", "position "},
                                                                                 {"vl", "velocity "},
                                                                                 {"il", "current "}}};
  while (!axis.empty()) {
    const auto dot = axis.rfind('.');
    const std::string last = axis.substr(dot == std::string::npos ? 0 : dot + 1);
    const auto part =
        std::find_if(kParts.begin(), kParts.end(), [&](const auto& p) { return p.first == last; });
    if (part == kParts.end()) return;
    name.insert(0, part->second);
    axis.erase(dot == std::string::npos ? 0 : dot);
  }
}

/// Words of all parts; a letter alone, or in front of actual or commanded, may stand for a quantity.
std::optional<NameMeaning> from_parts(const std::vector<std::string>& parts, const std::string& unit) {
  std::vector<Word> words;
  for (const std::string& part : parts) {
    // "Position Present", "Speed Active": a flag.
    if ((part == "present" || part == "active") && &part != &parts.front()) return std::nullopt;
    const auto variable = std::find_if(kVariables.begin(), kVariables.end(),
                                       [&](const words::Variable& v) { return v.name == part; });
    if (variable != kVariables.end()) {
      words.insert(words.end(), {variable->what, variable->role});
      continue;
    }
    if (read_words(part, words)) continue;
    const auto letter =
        std::find_if(kLetters.begin(), kLetters.end(), [&](const auto& l) { return l.first == part[0]; });
    std::vector<Word> rest;
    if (letter == kLetters.end() || !read_words(std::string_view(part).substr(1), rest)) return std::nullopt;
    if (!std::all_of(rest.begin(), rest.end(), role)) return std::nullopt;
    words.push_back(letter->second);
    words.insert(words.end(), rest.begin(), rest.end());
  }
  // A letter alone is in known_columns.cpp, or an axis.
  const bool told = parts.size() > 1 || parts.front().size() > 1;
  return told ? from_words(words, unit) : std::nullopt;
}

}  // namespace

std::vector<std::string> words_of_name(const std::string& name) {
  std::vector<std::string> words{""};
  for (const char c : lower_case(name)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80) {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

bool any_word(const std::vector<std::string>& words, std::span<const std::string_view> known) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(known.begin(), known.end(), word) != known.end();
  });
}

std::string unit_of_object(const std::string& header) {
  constexpr std::array kPerMille{0x6071, 0x6074, 0x6077, 0x6078};
  const std::string name = lower_case(header);
  const auto dot = name.rfind('.');
  auto index = object_index(name);
  if (!index && dot != std::string::npos) index = object_index(std::string_view(name).substr(dot + 1));
  const bool known = index && std::find(kPerMille.begin(), kPerMille.end(), *index) != kPerMille.end();
  return known ? "0.1 %" : "";
}

namespace {

/// "cur2", "Achse1 Ist": the number of the axis without a space.
std::optional<NameMeaning> with_number(const std::vector<std::string>& parts, const std::string& unit) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::vector<std::string> others = parts;
    const auto last = others[i].find_last_not_of("0123456789");
    if (last == std::string::npos || last + 1 == others[i].size()) continue;
    const std::string number = others[i].substr(last + 1);
    others[i].erase(last + 1);
    // "Motor2", "Encoder1": numbers of parts of one axis.
    std::vector<Word> words;
    const bool names_axis = others[i] == "axis" || others[i] == "achse" || others[i] == "joint";
    if (!names_axis && (!read_words(others[i], words) || std::all_of(words.begin(), words.end(), [](Word w) {
          return w == Word::kNothing || role(w);
        })))
      continue;
    auto found = from_parts(others, unit);
    if (!found) continue;
    found->axis = number;
    return found;
  }
  return std::nullopt;
}

/// "PosCmdX", "xPosCmd", "curY", "IX [A]": the letter of the axis without a space.
std::optional<NameMeaning> with_letter(const std::vector<std::string>& parts, const std::string& unit) {
  // "posc" and "cpos" may be a commanded position.
  constexpr std::string_view kAxes = "xyz";
  for (const bool at_end : {true, false}) {
    std::vector<std::string> others = parts;
    std::string& part = at_end ? others.back() : others.front();
    if (part.size() < 2) continue;
    const char letter = at_end ? part.back() : part.front();
    if (kAxes.find(letter) == std::string_view::npos) continue;
    part.erase(at_end ? part.size() - 1 : 0, 1);
    auto found = from_parts(others, unit);
    if (const auto quantity = by_unit(unit);
        !found && at_end && others.size() == 1 &&
        ((part == "i" && quantity == Word::kCurrent) || (part == "f" && quantity == Word::kForce) ||
         ((part == "t" || part == "m") && quantity == Word::kTorque) ||
         (part == "v" && quantity == Word::kVelocity)))
      found = meaning(*quantity, false, 1);
    if (!found) continue;
    found->axis = letter;
    return found;
  }
  return std::nullopt;
}

std::optional<NameMeaning> meaning_of_name(std::string name, const std::string& unit) {
  if (auto found = cia402(name)) return found;
  if (auto found = sercos(name)) return found;
  drop_short_name(name);
  std::string axis;
  take_acopos_axis(axis, name);
  // "MC_Axis.ActPos", "Main.Axis1.NcToPlc.ActPos": the last part is the signal, what is before it the axis.
  // A topic of ROS, "/joint_states/joint_z/position", is divided by slashes.
  const char divider = name.starts_with('/') ? '/' : '.';
  if (const auto dot = name.rfind(divider); dot != std::string::npos && dot > 0 && dot + 1 < name.size()) {
    axis = name.substr(0, dot);
    name.erase(0, dot + 1);
    if (divider == '.') {
      take_role(axis, name);
      drop_part_of_drive(axis, name);
    }
  }
  auto numbered = sinamics(name);
  if (!numbered) numbered = cia402(name);
  if (numbered) {
    numbered->axis = axis;
    return numbered;
  }
  drop_parameter_number(name);
  std::vector<std::string> parts = parts_of(name);
  if (parts.empty()) return std::nullopt;
  if (parts.size() > 2) drop_encoder_number(parts);
  // "Axis 1 ActPos": the number belongs to the word.
  if (parts.size() > 2 && (parts[0] == "axis" || parts[0] == "achse") && is_axis(parts[1]))
    parts.erase(parts.begin());
  for (const bool at_end : {true, false}) {
    if (parts.size() < 2) break;
    const auto at = at_end ? parts.end() - 1 : parts.begin();
    if (!is_axis(*at)) continue;
    // "_v_act [rpm]" is the actual velocity, not that of an axis V.
    if (*at == "v" && by_unit(unit) == Word::kVelocity) continue;
    std::vector<std::string> others = parts;
    others.erase(others.begin() + (at - parts.begin()));
    if (auto found = from_parts(others, unit)) {
      found->axis = *at;
      return found;
    }
  }
  if (auto found = from_parts(parts, unit)) {
    found->axis = axis;
    return found;
  }
  auto glued = with_letter(parts, unit);
  return glued ? glued : with_number(parts, unit);
}

}  // namespace

std::optional<NameMeaning> meaning_of(const std::string& header, const std::string& unit) {
  constexpr std::size_t kLongest = 100;
  if (header.size() > kLongest) return std::nullopt;
  if (auto found = meaning_of_name(small_letters(header), unit)) return found;
  const std::string bare = without_type(header);
  return bare == header ? std::nullopt : meaning_of_name(small_letters(bare), unit);
}

}  // namespace stribeck::workflow
