#include <fmt/format.h>

#include <algorithm>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/text.hpp>
#include <utility>
#include <vector>

namespace stribeck::report {
namespace {

std::string members_in_words(const Value& group);

std::string number_in_words(const Value& value, const Quantity& q) {
  if (value.kind() == Kind::kSwitch) return value.number() != 0.0 ? "yes" : "no";
  const double x = value.number();
  return short_number(value.kind() == Kind::kCount || q.unit == q.shown ? x
                                                                        : io::conversion(q.unit, q.shown)(x));
}

std::string unit_in_words(const Quantity& q) { return q.shown.empty() ? "" : " " + printed_unit(q.shown); }

std::string law_in_words(const Value& law) {
  return fmt::format("{}: {}", law.type().label, members_in_words(law));
}

/// Empty where no value was given.
std::string value_in_words(const Value& value, const Quantity& q) {
  switch (value.kind()) {
    case Kind::kChoice:
      return std::string(value.word());
    case Kind::kSwitch:
      return number_in_words(value, q);
    case Kind::kCount:
    case Kind::kNumber:
      return number_in_words(value, q) + unit_in_words(q);
    case Kind::kText:
      return std::string(value.text());
    case Kind::kOptional:
      return value.size() > 0 ? value_in_words(value[0], q) : "";
    case Kind::kVariant:
      return law_in_words(value.chosen());
    case Kind::kGroup:
      return is_short(value) ? std::string(short_form(value)) : members_in_words(value);
    case Kind::kList:
    case Kind::kNamed:
      break;
  }
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < value.size(); ++i) {
    parts.push_back(value[i].is_scalar() ? number_in_words(value[i], q) : value_in_words(value[i], q));
  }
  if (parts.empty()) return "";
  return (parts.size() == 1 ? parts.front() : "(" + joined(parts, "; ") + ")") + unit_in_words(q);
}

std::string members_in_words(const Value& group) {
  std::vector<std::string> parts;
  for_each_member(group, [&](const Member& m) {
    const std::string words = m.has_effect() ? value_in_words(m.value, m.info.quantity) : "";
    if (!words.empty()) parts.push_back(fmt::format("{} {}", m.info.name, words));
  });
  return joined(parts, ", ");
}

}  // namespace

std::string law_in_words(const control::LawParams& law) { return law_in_words(value_of(law).chosen()); }

std::vector<std::pair<std::string, std::string>> laws_in_words(
    const std::vector<sim::ControllerSpec>& controllers) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const sim::ControllerSpec& c : controllers) {
    const std::string words = law_in_words(c.law);
    const auto same = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.first == words; });
    if (same == all.end()) {
      all.emplace_back(words, "(" + c.id + ")");
    } else {
      same->second += ", (" + c.id + ")";
    }
  }
  return all;
}

Table controllers_in_words(const std::vector<sim::ControllerSpec>& controllers) {
  Table t{"Controllers", {{"controller", "", false}}, {}};
  for (std::size_t k = 0; k < controllers.size(); ++k) {
    const sim::ControllerSpec& c = controllers[k];
    t.rows.push_back({{"(" + c.id + ")", "", c.label, false, controller_color(c.id, k)}});
  }
  // The values of one parameter for all controllers, column by column.
  const auto words_of = [](const sim::ControllerSpec& c, std::string_view name) {
    std::string words;
    for_each_member(value_of(c), [&](const Member& m) {
      if (m.info.name != name || !m.has_effect()) return;
      words = value_in_words(m.value, m.info.quantity);
      if (name == "reversal" && words.empty()) words = "as the model has it";
    });
    return words;
  };
  for_each_member(initial_of(type_of<sim::ControllerSpec>), [&](const Member& m) {
    const std::string_view name = m.info.name;
    // Either in the first column, or in a list after the table.
    if (name == "id" || name == "label" || name == "law") return;
    std::vector<std::string> column;
    for (const sim::ControllerSpec& c : controllers) column.push_back(words_of(c, name));
    if (std::all_of(column.begin(), column.end(), [](const std::string& w) { return w.empty(); })) return;
    t.columns.push_back({std::string(name), "", false});
    for (std::size_t k = 0; k < column.size(); ++k)
      t.rows[k].push_back({column[k].empty() ? "–" : column[k]});
  });
  return t;
}

}  // namespace stribeck::report
