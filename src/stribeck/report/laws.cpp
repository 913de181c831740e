#include <fmt/format.h>

#include <stribeck/io/units.hpp>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/text.hpp>
#include <type_traits>
#include <vector>

namespace stribeck::report {
namespace {

template <class T>
std::string value_in_words(const T& value, const Quantity& q) {
  const auto number = [&](double x) {
    return short_number(q.unit == q.shown ? x : io::conversion(q.unit, q.shown)(x));
  };
  const std::string unit = q.shown.empty() ? "" : " " + std::string(q.shown);
  if constexpr (NamedEnum<T>) {
    for (const auto& [at, name] : EnumNames<T>::names) {
      if (at == value) return std::string(name);
    }
    return "";
  } else if constexpr (std::is_same_v<T, bool>) {
    return value ? "yes" : "no";
  } else if constexpr (std::is_arithmetic_v<T>) {
    return number(static_cast<double>(value)) + unit;
  } else if constexpr (requires { value.has_value(); }) {
    return value ? value_in_words(*value, q) : "none";
  } else {
    std::vector<std::string> parts;
    for (const double x : value) parts.push_back(number(x));
    return (parts.size() == 1 ? parts.front() : "(" + joined(parts, ", ") + ")") + unit;
  }
}

}  // namespace

std::string law_in_words(const control::LawParams& law) {
  return std::visit(
      [](const auto& params) {
        using P = std::decay_t<decltype(params)>;
        std::vector<std::string> parts;
        for_each_field<P>([&](const auto& f) {
          parts.push_back(fmt::format("{} {}", f.name, value_in_words(params.*f.member, f.quantity)));
        });
        return fmt::format("{}: {}", P::kLabel, joined(parts, ", "));
      },
      law);
}

}  // namespace stribeck::report
