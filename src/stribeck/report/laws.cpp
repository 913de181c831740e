#include <fmt/format.h>

#include <algorithm>
#include <stribeck/io/units.hpp>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/text.hpp>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace stribeck::report {
namespace {

template <class T>
std::string members_in_words(const T& value);

/// Empty where nothing was given.
template <class T>
std::string value_in_words(const T& value, const Quantity& q) {
  const auto number = [&](double x) {
    return short_number(q.unit == q.shown ? x : io::conversion(q.unit, q.shown)(x));
  };
  const std::string unit = q.shown.empty() ? "" : " " + printed_unit(q.shown);
  if constexpr (NamedEnum<T>) {
    for (const auto& [at, name] : EnumNames<T>::names) {
      if (at == value) return std::string(name);
    }
    return "";
  } else if constexpr (std::is_same_v<T, bool>) {
    return value ? "yes" : "no";
  } else if constexpr (std::is_arithmetic_v<T>) {
    return number(static_cast<double>(value)) + unit;
  } else if constexpr (std::is_convertible_v<T, std::string>) {
    return value;
  } else if constexpr (requires { value.has_value(); }) {
    return value ? value_in_words(*value, q) : "";
  } else if constexpr (requires { std::variant_size<T>::value; }) {
    return law_in_words(value);
  } else if constexpr (HasFields<T>) {
    return members_in_words(value);
  } else {
    std::vector<std::string> parts;
    for (const auto& x : value) {
      if constexpr (std::is_arithmetic_v<std::decay_t<decltype(x)>>) {
        parts.push_back(number(static_cast<double>(x)));
      } else {
        parts.push_back(value_in_words(x, q));
      }
    }
    if (parts.empty()) return "";
    return (parts.size() == 1 ? parts.front() : "(" + joined(parts, "; ") + ")") + unit;
  }
}

template <class T>
std::string members_in_words(const T& value) {
  std::vector<std::string> parts;
  for_each_field<T>([&](const auto& f) {
    const std::string words = value_in_words(value.*f.member, f.quantity);
    if (!words.empty()) parts.push_back(fmt::format("{} {}", f.name, words));
  });
  return joined(parts, ", ");
}

/// Whether a parameter of this name changes anything. One that is not named here does.
bool has_effect(std::string_view name, const sim::ControllerSpec& c) {
  if (name == "feedforward") return c.friction != sim::FrictionUse::kNone;
  if (name == "observer_pole")
    return c.observer == control::Observer::kDisturbance ||
           (c.observer == control::Observer::kKalman && !c.disturbance_density);
  if (name == "disturbance_density") return c.observer == control::Observer::kKalman;
  if (name == "adaptive_gain") return c.observer == control::Observer::kAdaptive;
  if (name == "reversal") return c.feedforward == control::Feedforward::kReversal;
  return name != "id" && name != "label" && name != "law";
}

}  // namespace

std::string law_in_words(const control::LawParams& law) {
  return std::visit(
      [](const auto& params) {
        using P = std::decay_t<decltype(params)>;
        return fmt::format("{}: {}", P::kLabel, members_in_words(params));
      },
      law);
}

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
  for_each_field<sim::ControllerSpec>([&](const auto& f) {
    std::vector<std::string> column;
    for (const sim::ControllerSpec& c : controllers) {
      std::string words;
      if (has_effect(f.name, c)) {
        words = value_in_words(c.*f.member, f.quantity);
        if (f.name == "reversal" && words.empty()) words = "as the model has it";
      }
      column.push_back(std::move(words));
    }
    if (std::all_of(column.begin(), column.end(), [](const std::string& w) { return w.empty(); })) return;
    t.columns.push_back({std::string(f.name), "", false});
    for (std::size_t k = 0; k < column.size(); ++k)
      t.rows[k].push_back({column[k].empty() ? "–" : column[k]});
  });
  return t;
}

}  // namespace stribeck::report
