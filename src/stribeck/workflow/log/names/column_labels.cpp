#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/names/column_labels.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>

namespace stribeck::workflow {
namespace {

std::vector<Label> labels_of(const io::Column& c, const std::string& axis) {
  std::string name = lower_case(c.name);
  std::vector<Label> out{{name, {}}};
  // A signal of LinuxCNC's HAL is divided by hyphens: "x-cmd", "z-pos-cmd".
  if (name.find('-') != std::string::npos) {
    std::replace(name.begin(), name.end(), '-', '_');
    out.push_back({name, {}});
  }
  for (const char mark : {'|', '/'}) {
    const auto at = name.rfind(mark);
    if (at == std::string::npos || at == 0 || at + 1 >= name.size()) continue;
    Label label{name.substr(0, at), name.substr(at + 1)};
    // "x/pos" has the axis in front.
    if (label.base.size() == 1 && meaning_of(label.axis, "mm")) std::swap(label.base, label.axis);
    out.push_back(std::move(label));
  }
  const auto bar = name.find_first_of("_ ");  // "z_pos", "z scale"
  if (bar != std::string::npos && bar > 0 && bar <= 3 && bar + 1 < name.size()) {
    const std::string prefix = name.substr(0, bar);
    const bool is_axis =
        (std::string_view("xyzabcuvws").find(prefix[0]) != std::string_view::npos ||
         (prefix[0] == 'j' && prefix.size() > 1)) &&
        std::all_of(prefix.begin() + 1, prefix.end(), [](unsigned char d) { return std::isdigit(d); });
    if (is_axis) out.push_back({name.substr(bar + 1), prefix});
  }
  const auto digit = name.find_last_not_of("0123456789");
  // "r0078" is a parameter of a drive.
  if (digit != std::string::npos && digit + 1 < name.size() &&
      (name[digit + 1] != '0' || digit + 2 == name.size()))
    out.push_back({name.substr(0, digit + 1), name.substr(digit + 1)});
  const auto last = name.rfind('_');
  if (!axis.empty() && last != std::string::npos && name.substr(last + 1) == lower_case(axis))
    out.push_back({name.substr(0, last), lower_case(axis)});
  return out;
}

/// "y_act": axis and the rest; an empty axis where the name does not begin with one.
Label lettered(const io::Column& c) {
  std::string name = lower_case(c.name);
  std::replace(name.begin(), name.end(), '-', '_');
  const auto bar = name.find('_');
  if (bar == std::string::npos || bar == 0 || bar > 3 || bar + 1 == name.size()) return {};
  const bool axis = std::string_view("xyzabcuvw").find(name[0]) != std::string_view::npos &&
                    std::all_of(name.begin() + 1, name.begin() + static_cast<std::ptrdiff_t>(bar),
                                [](unsigned char d) { return std::isdigit(d) != 0; });
  if (!axis) return {};
  return {name.substr(bar + 1), name.substr(0, bar)};
}

/// "l1_act", "strut3 pos", or "act_l1" at its end: the word at one end and the rest; an empty axis where no word could be a name.
Label with_word(const io::Column& c, bool at_end) {
  constexpr std::size_t kLongest = 12;  // bytes
  constexpr std::string_view kApart = "_ .-";
  const std::string name = lower_case(c.name);
  const auto cut = at_end ? name.find_last_of(kApart) : name.find_first_of(kApart);
  if (cut == std::string::npos || cut == 0 || cut + 1 == name.size()) return {};
  const std::string before = name.substr(0, cut), after = name.substr(cut + 1);
  const std::string& word = at_end ? after : before;
  // Beyond ASCII every byte is a letter: "stössel".
  const auto letter = [](unsigned char d) { return d >= 0x80 || std::isalpha(d) != 0; };
  const bool plain = word.size() <= kLongest && letter(static_cast<unsigned char>(word[0])) &&
                     std::all_of(word.begin(), word.end(),
                                 [&](unsigned char d) { return letter(d) || std::isdigit(d) != 0; });
  if (!plain) return {};
  return {at_end ? before : after, word};
}

bool is_motion(LogQuantity what) { return what == LogQuantity::kPosition || what == LogQuantity::kVelocity; }

/// Whether a column is a position or velocity without such a word: then the columns with words are of other things, as "spindle speed".
bool says_motion_itself(const io::Log& log) {
  return std::any_of(log.columns.begin(), log.columns.end(), [&](const io::Column& c) {
    if (c.values.empty()) return false;
    const auto meaning = meaning_of(c.name, c.unit_text);
    if (meaning && is_motion(meaning->what)) return true;
    for (const LogQuantity what : {LogQuantity::kPosition, LogQuantity::kVelocity}) {
      for (const Label& label : labels_of(c, {})) {
        for (const auto& family : known_column(what).families) {
          if (std::find(family.begin(), family.end(), label.base) != family.end()) return true;
        }
      }
    }
    return !lettered(c).axis.empty();
  });
}

/// Whether a word has a meaning of its own, so that it is no name.
bool is_known_word(const std::string& word) {
  constexpr std::array kUnits{"mm", "mm/s", "N", "N m", "A", "%", "V"};
  return meaning_of(word + " pos", "mm") || std::any_of(kUnits.begin(), kUnits.end(), [&](const char* unit) {
           return meaning_of(word, unit).has_value();
         });
}

/// Names of axes: words before or after the quantity ("RA_cmd", "RA_torque"). Used only if one word has two quantities, one of them a
/// position or velocity.
std::vector<std::string> axes_by_word(const io::Log& log, bool at_end) {
  struct Named {
    std::string word;
    std::vector<LogQuantity> found;
  };
  std::vector<Named> all;
  for (const io::Column& c : log.columns) {
    const Label label = with_word(c, at_end);
    if (c.values.empty() || label.axis.empty() || is_known_word(label.axis)) continue;
    const auto meaning = meaning_of(label.base, c.unit_text);
    if (!meaning) continue;
    auto named = std::find_if(all.begin(), all.end(), [&](const Named& n) { return n.word == label.axis; });
    if (named == all.end()) named = all.insert(all.end(), Named{label.axis, {}});
    if (std::find(named->found.begin(), named->found.end(), meaning->what) == named->found.end())
      named->found.push_back(meaning->what);
  }
  const auto moves = [](const Named& n) { return std::any_of(n.found.begin(), n.found.end(), is_motion); };
  std::vector<std::string> words;
  if (std::none_of(all.begin(), all.end(), [&](const Named& n) { return moves(n) && n.found.size() > 1; }))
    return words;
  for (const Named& n : all) {
    if (moves(n)) words.push_back(n.word);
  }
  return words;
}

}  // namespace

AxisWords axis_words(const io::Log& log) {
  if (says_motion_itself(log)) return {};
  return {axes_by_word(log, false), axes_by_word(log, true)};
}

std::optional<Label> apart(const io::Column& c, const AxisWords& words) {
  for (const bool at_end : {false, true}) {
    const Label named = with_word(c, at_end);
    const std::vector<std::string>& known = at_end ? words.behind : words.in_front;
    if (!named.axis.empty() && std::find(known.begin(), known.end(), named.axis) != known.end()) return named;
  }
  return std::nullopt;
}

std::vector<Label> labels_in(const io::Log& log, const io::Column& c, const std::string& axis,
                             const AxisWords& words) {
  const Label own = lettered(c);
  const std::string wanted = lower_case(axis);
  const auto another = [&](const io::Column& other) {
    const Label label = lettered(other);
    if (other.values.empty() || label.base != own.base || label.axis == own.axis) return false;
    // "y_act [V]" beside "x_act [mm]" is another quantity.
    const bool units = !c.unit_text.empty() && !other.unit_text.empty();
    const bool angles = conversion_between(c.unit_text, "rad") || conversion_between(other.unit_text, "rad");
    if (units && !angles && !conversion_between(other.unit_text, c.unit_text)) return false;
    const bool plain = std::string_view("xyz").find(own.axis[0]) != std::string_view::npos &&
                       std::string_view("xyz").find(label.axis[0]) != std::string_view::npos;
    return plain || label.axis == wanted || own.axis == wanted;
  };
  if (!own.axis.empty() && std::any_of(log.columns.begin(), log.columns.end(), another))
    return {{"x_" + own.base, own.axis}, {own.base, own.axis}};
  std::vector<Label> labels = labels_of(c, axis);
  if (const std::optional<Label> named = apart(c, words)) {
    labels.push_back({"x_" + named->base, named->axis});
    labels.push_back(*named);
  }
  return labels;
}

}  // namespace stribeck::workflow
