#pragma once
/// Parameters by name, for hosts that have nothing but names and numbers. The names come from fields() (core/fields.hpp):
///
///   mass                               a member
///   friction.eccentric.0.amplitude     element of a list: its index; setting it makes the list as long as that
///   friction.steady                    a choice (std::variant, enumeration): index of the word
///   friction.conventional.alpha0       member of an alternative: the alternative's word stands in place of the choice's name
///   friction.conventional.stribeck.v0  member of something optional: setting it puts it in
///
/// A field named "" adds nothing to the name. Types that have no fields() of their own get a FieldsOf. Absent is NaN.
/// Real time: no allocation; configure only.

#include <stribeck/stribeck.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/fixed_vector.hpp>
#include <string_view>
#include <tuple>
#include <variant>

namespace stribeck::capi {

template <class T>
struct FieldsOf {
  static constexpr auto get() { return T::fields(); }
};

inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
/// Periods that a servo thread may have [s]; below it, and from a second on, the number is something else.
inline constexpr double kShortestPeriod = 1e-6;
inline constexpr const char* kPeriodExpected = "period: expected at least 1 us and below 1 s";

template <class T>
struct Is {
  static constexpr bool kOptional = false, kList = false, kArray = false, kVariant = false;
};
template <class T>
struct Is<std::optional<T>> : Is<void> {
  static constexpr bool kOptional = true;
};
template <class T, std::size_t N>
struct Is<FixedVector<T, N>> : Is<void> {
  static constexpr bool kList = true;
};
template <class T, std::size_t N>
struct Is<std::array<T, N>> : Is<void> {
  static constexpr bool kArray = true;
};
template <class... T>
struct Is<std::variant<T...>> : Is<void> {
  static constexpr bool kVariant = true;
};

/// A dotted name being put together.
class Name {
 public:
  class Mark {
   public:
    Mark(Name& name, std::size_t size) noexcept : name_(name), size_(size) {}
    ~Mark() { name_.cut(size_); }
    Mark(const Mark&) = delete;
    Mark& operator=(const Mark&) = delete;

   private:
    Name& name_;
    std::size_t size_;
  };

  /// Adds a part until the mark goes.
  [[nodiscard]] Mark with(std::string_view part) noexcept {
    const std::size_t before = size_;
    if (size_ > 0 && !part.empty()) append(".");
    append(part);
    return {*this, before};
  }
  [[nodiscard]] Mark with(std::size_t index) noexcept {
    const char digit = static_cast<char>('0' + index % 10);  // no list here has more than ten
    return with(std::string_view(&digit, 1));
  }
  [[nodiscard]] const char* text() const noexcept { return text_.data(); }
  [[nodiscard]] std::string_view view() const noexcept { return {text_.data(), size_}; }

 private:
  void append(std::string_view part) noexcept {
    const std::size_t n = std::min(part.size(), text_.size() - 1 - size_);
    std::copy_n(part.data(), n, text_.data() + size_);
    cut(size_ + n);
  }
  void cut(std::size_t size) noexcept {
    size_ = size;
    text_[size] = '\0';
  }

  std::array<char, 64> text_{};
  std::size_t size_ = 0;
};

/// A parameter as list() finds it.
struct Leaf {
  std::string_view name;
  Quantity quantity;
  std::string_view about;
  double value = kAbsent;
  stribeck_parameter_kind kind = STRIBECK_NUMBER;
  std::size_t words = 0;
  std::string_view (*word)(std::size_t) = nullptr;
};

template <class Variant>
std::string_view kind_of(std::size_t index) noexcept {
  std::string_view found;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((I == index ? void(found = std::variant_alternative_t<I, Variant>::kKind) : void()), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
  return found;
}
template <class E>
std::string_view word_of(std::size_t index) noexcept {
  return EnumNames<E>::names[index].second;
}

/// Calls f(leaf) for every parameter below `initial`.
template <class T, class F>
void list(Name& name, const T& initial, const Quantity& quantity, std::string_view about, bool absent,
          F&& f) {
  const auto leaf = [&](double value, stribeck_parameter_kind kind, std::size_t words = 0,
                        std::string_view(*word)(std::size_t) = nullptr) {
    f(Leaf{name.view(), quantity, about, absent ? kAbsent : value, kind, words, word});
  };
  if constexpr (std::is_same_v<T, bool>) {
    leaf(initial ? 1.0 : 0.0, STRIBECK_SWITCH);
  } else if constexpr (std::is_arithmetic_v<T>) {
    leaf(static_cast<double>(initial), std::is_integral_v<T> ? STRIBECK_INTEGER : STRIBECK_NUMBER);
  } else if constexpr (std::is_enum_v<T>) {
    std::size_t at = 0;
    while (EnumNames<T>::names[at].first != initial) ++at;
    leaf(static_cast<double>(at), STRIBECK_CHOICE, EnumNames<T>::names.size(), &word_of<T>);
  } else if constexpr (Is<T>::kOptional) {
    using Inner = typename T::value_type;
    list(name, initial.value_or(Inner{}), quantity, about, absent || !initial, f);
  } else if constexpr (Is<T>::kList) {
    for (std::size_t i = 0; i < T::kCapacity; ++i) {
      const auto mark = name.with(i);
      list(name, typename T::value_type{}, quantity, about, true, f);
    }
  } else if constexpr (Is<T>::kArray) {
    for (std::size_t i = 0; i < initial.size(); ++i) {
      const auto mark = name.with(i);
      list(name, initial[i], quantity, about, absent, f);
    }
  } else {
    std::apply(
        [&](const auto&... field) {
          [[maybe_unused]] const auto one = [&](const auto& each) {
            const auto& member = initial.*each.member;
            using Member = std::decay_t<decltype(member)>;
            if constexpr (Is<Member>::kVariant) {
              {
                const auto mark = name.with(each.name);
                f(Leaf{name.view(), each.quantity, each.doc,
                       absent ? kAbsent : static_cast<double>(member.index()), STRIBECK_CHOICE,
                       std::variant_size_v<Member>, &kind_of<Member>});
              }
              [&]<std::size_t... I>(std::index_sequence<I...>) {
                const auto alternative = [&](const auto& value) {
                  const auto mark = name.with(std::decay_t<decltype(value)>::kKind);
                  list(name, value, each.quantity, each.doc, absent, f);
                };
                (alternative(std::variant_alternative_t<I, Member>{}), ...);
              }
              (std::make_index_sequence<std::variant_size_v<Member>>());
            } else {
              const auto mark = name.with(each.name);
              list(name, member, each.quantity, each.doc, absent, f);
            }
          };
          (one(field), ...);
        },
        FieldsOf<T>::get());
  }
}

/// Calls f(name, value, about, word) for every parameter that `value` holds: chosen alternatives and present elements alone.
/// `word` is that of a choice, else empty.
template <class T, class F>
void values_of(Name& name, const T& value, std::string_view about, F&& f) {
  if constexpr (std::is_arithmetic_v<T>) {
    f(name.view(), static_cast<double>(value), about, std::string_view{});
  } else if constexpr (std::is_enum_v<T>) {
    std::size_t at = 0;
    while (EnumNames<T>::names[at].first != value) ++at;
    f(name.view(), static_cast<double>(at), about, word_of<T>(at));
  } else if constexpr (Is<T>::kOptional) {
    if (value) values_of(name, *value, about, f);
  } else if constexpr (Is<T>::kList || Is<T>::kArray) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      const auto mark = name.with(i);
      values_of(name, value[i], about, f);
    }
  } else {
    std::apply(
        [&](const auto&... field) {
          [[maybe_unused]] const auto one = [&](const auto& each) {
            const auto& member = value.*each.member;
            using Member = std::decay_t<decltype(member)>;
            if constexpr (Is<Member>::kVariant) {
              {
                const auto mark = name.with(each.name);
                f(name.view(), static_cast<double>(member.index()), each.doc,
                  kind_of<Member>(member.index()));
              }
              std::visit(
                  [&](const auto& chosen) {
                    const auto mark = name.with(std::decay_t<decltype(chosen)>::kKind);
                    values_of(name, chosen, each.doc, f);
                  },
                  member);
            } else {
              if constexpr (std::is_arithmetic_v<Member>) {
                // A file may leave it out, and has.
                if (!each.required && !each.quantity.permits(static_cast<double>(member))) return;
              }
              const auto mark = name.with(each.name);
              values_of(name, member, each.doc, f);
            }
          };
          (one(field), ...);
        },
        FieldsOf<T>::get());
  }
}

/// Takes the first part off a dotted name.
inline std::string_view take_part(std::string_view& rest) noexcept {
  const std::size_t n = std::min(rest.find('.'), rest.size());
  const std::string_view part(rest.data(), n);
  rest.remove_prefix(std::min(n + 1, rest.size()));
  return part;
}

inline std::size_t index_in(std::string_view part, std::size_t count) noexcept {
  return part.size() == 1 && part[0] >= '0' && part[0] <= '9' ? static_cast<std::size_t>(part[0] - '0')
                                                              : count;
}

/// Whether a number is one of 0, 1, …, count − 1.
inline bool is_index(double x, std::size_t count) noexcept {
  return x >= 0.0 && x < static_cast<double>(count) && x == std::floor(x);
}

template <class T>
stribeck_result assign(T& value, const Quantity& quantity, std::string_view rest, double x) noexcept;

template <class Variant>
stribeck_result select_kind(Variant& value, double x) noexcept {
  if (!is_index(x, std::variant_size_v<Variant>)) return STRIBECK_OUT_OF_RANGE;
  const auto index = static_cast<std::size_t>(x);
  if (index == value.index()) return STRIBECK_OK;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((I == index ? void(value.template emplace<I>()) : void()), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
  return STRIBECK_OK;
}

/// The member of a chosen alternative; UNKNOWN_NAME when `part` is no alternative's word.
template <class Variant>
stribeck_result assign_in_kind(Variant& value, const Quantity& quantity, std::string_view part,
                               std::string_view rest, double x) noexcept {
  stribeck_result result = STRIBECK_UNKNOWN_NAME;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    const auto alternative = [&](auto index) {
      constexpr std::size_t kIndex = index;
      if (std::variant_alternative_t<kIndex, Variant>::kKind != part) return;
      auto* chosen = std::get_if<kIndex>(&value);
      result = chosen == nullptr ? STRIBECK_NOT_SELECTED : assign(*chosen, quantity, rest, x);
    };
    (alternative(std::integral_constant<std::size_t, I>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
  return result;
}

/// Sets the parameter `rest` below `value`.
template <class T>
stribeck_result assign(T& value, const Quantity& quantity, std::string_view rest, double x) noexcept {
  if constexpr (Is<T>::kOptional) {
    using Inner = typename T::value_type;
    if (std::isnan(x)) {
      value.reset();
      return STRIBECK_OK;
    }
    Inner inner = value.value_or(Inner{});
    const stribeck_result result = assign(inner, quantity, rest, x);
    if (result == STRIBECK_OK) value = inner;
    return result;
  } else if constexpr (Is<T>::kList || Is<T>::kArray) {
    const std::size_t i = index_in(take_part(rest), 10);
    if constexpr (Is<T>::kArray) {
      return i < value.size() ? assign(value[i], quantity, rest, x) : STRIBECK_UNKNOWN_NAME;
    } else {
      if (i >= T::kCapacity) return STRIBECK_UNKNOWN_NAME;
      auto element = i < value.size() ? value[i] : typename T::value_type{};
      const stribeck_result result = assign(element, quantity, rest, x);
      if (result != STRIBECK_OK) return result;
      while (value.size() <= i) value.push_back({});
      value[i] = element;
      return STRIBECK_OK;
    }
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    if (!rest.empty()) return STRIBECK_UNKNOWN_NAME;
    if constexpr (std::is_same_v<T, bool>) {
      if (!is_index(x, 2)) return STRIBECK_OUT_OF_RANGE;
      value = x != 0.0;
    } else if constexpr (std::is_enum_v<T>) {
      if (!is_index(x, EnumNames<T>::names.size())) return STRIBECK_OUT_OF_RANGE;
      value = EnumNames<T>::names[static_cast<std::size_t>(x)].first;
    } else {
      if (!std::isfinite(x) || !quantity.permits(x)) return STRIBECK_OUT_OF_RANGE;
      if (std::is_integral_v<T> && (x != std::floor(x) || std::abs(x) > 1e9)) return STRIBECK_OUT_OF_RANGE;
      value = static_cast<T>(x);
    }
    return STRIBECK_OK;
  } else {
    stribeck_result result = STRIBECK_UNKNOWN_NAME;
    std::apply(
        [&](const auto&... field) {
          [[maybe_unused]] const auto one = [&](const auto& each) {
            if (result != STRIBECK_UNKNOWN_NAME) return;
            auto& member = value.*each.member;
            using Member = std::decay_t<decltype(member)>;
            std::string_view below = rest;
            const std::string_view part = each.name.empty() ? std::string_view{} : take_part(below);
            if constexpr (Is<Member>::kVariant) {
              result = part == each.name && below.empty()
                           ? select_kind(member, x)
                           : assign_in_kind(member, each.quantity, part, below, x);
            } else {
              if (part == each.name) result = assign(member, each.quantity, below, x);
            }
          };
          (one(field), ...);
        },
        FieldsOf<T>::get());
    return result;
  }
}

/// First thing that is wrong below `value`: report(name, what). `initial` is what it was in the beginning.
template <class T, class Report>
bool check(Name& name, const T& value, const T& initial, const Quantity& quantity, Report&& report) {
  if constexpr (Is<T>::kOptional) {
    using Inner = typename T::value_type;
    return !value || check(name, *value, Inner{}, quantity, report);
  } else if constexpr (Is<T>::kList || Is<T>::kArray) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      const auto mark = name.with(i);
      if (!check(name, value[i], typename T::value_type{}, quantity, report)) return false;
    }
    return true;
  } else if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
    return true;
  } else if constexpr (std::is_arithmetic_v<T>) {
    if (quantity.permits(static_cast<double>(value))) return true;
    if (std::isnan(static_cast<double>(value)) && std::isnan(static_cast<double>(initial))) return true;
    report(name.view(), "not set, or out of range");
    return false;
  } else {
    bool good = true;
    std::apply(
        [&](const auto&... field) {
          [[maybe_unused]] const auto one = [&](const auto& each) {
            if (!good) return;
            const auto& member = value.*each.member;
            using Member = std::decay_t<decltype(member)>;
            if constexpr (Is<Member>::kVariant) {
              good = std::visit(
                  [&](const auto& alternative) {
                    using Alternative = std::decay_t<decltype(alternative)>;
                    const auto mark = name.with(Alternative::kKind);
                    return check(name, alternative, Alternative{}, each.quantity, report);
                  },
                  member);
            } else {
              if constexpr (std::is_arithmetic_v<Member>) {
                if (!each.required && member == initial.*each.member) return;  // left out
              }
              const auto mark = name.with(each.name);
              good = check(name, member, initial.*each.member, each.quantity, report);
            }
          };
          (one(field), ...);
        },
        FieldsOf<T>::get());
    if constexpr (requires { value.validate([](auto, auto) {}); }) {
      if (good) {
        value.validate([&](std::string_view key, std::string_view what) {
          if (!good) return;
          good = false;
          const auto mark = name.with(key);
          report(name.view(), what);
        });
      }
    }
    return good;
  }
}

/// The parameter with this number, for the C interface.
template <class T>
stribeck_result parameter_at(const T& initial, std::uint32_t index, stribeck_parameter* out) {
  if (out == nullptr) return STRIBECK_BAD_ARGUMENT;
  std::uint32_t at = 0;
  stribeck_result result = STRIBECK_BAD_ARGUMENT;
  Name name;
  list(name, initial, {}, "", false, [&](const Leaf& leaf) {
    if (at++ != index) return;
    result = STRIBECK_OK;
    *out = {};
    std::copy_n(leaf.name.data(), std::min(leaf.name.size(), sizeof out->name - 1), out->name);
    // Texts of fields() are literals and end in a zero.
    out->unit = leaf.quantity.unit.data() == nullptr ? "" : leaf.quantity.unit.data();
    out->about = leaf.about.data() == nullptr ? "" : leaf.about.data();
    out->value = leaf.value;
    out->min = leaf.words > 0 || leaf.kind == STRIBECK_SWITCH ? 0.0 : leaf.quantity.min;
    out->max = leaf.words > 0                 ? static_cast<double>(leaf.words - 1)
               : leaf.kind == STRIBECK_SWITCH ? 1.0
                                              : leaf.quantity.max;
    out->kind = leaf.kind;
    out->words = static_cast<std::uint32_t>(leaf.words);
  });
  return result;
}

/// Word number `index` of a choice; null when there is none.
template <class T>
const char* word_at(const T& initial, const char* wanted, std::uint32_t index) {
  if (wanted == nullptr) return nullptr;
  const char* found = nullptr;
  Name name;
  list(name, initial, {}, "", false, [&](const Leaf& leaf) {
    if (leaf.name == wanted && index < leaf.words) found = leaf.word(index).data();
  });
  return found;
}

/// The last problem, as text in the handle.
class Problem {
 public:
  void set(std::initializer_list<std::string_view> parts) noexcept {
    std::size_t n = 0;
    for (const std::string_view part : parts) {
      const std::size_t m = std::min(part.size(), text_.size() - 1 - n);
      std::copy_n(part.data(), m, text_.data() + n);
      n += m;
    }
    text_[n] = '\0';
  }
  [[nodiscard]] const char* text() const noexcept { return text_.data(); }

 private:
  std::array<char, 200> text_{};
};

/// assign() to a whole set of parameters, with the problem in words.
template <class T>
stribeck_result set_parameter(T& value, const char* name, double x, std::string_view where,
                              Problem& problem) noexcept {
  if (name == nullptr) return STRIBECK_BAD_ARGUMENT;
  const stribeck_result result = assign(value, {}, name, x);
  if (result != STRIBECK_OK) problem.set({where, name, ": ", stribeck_describe(result)});
  return result;
}

template <class T>
stribeck_result choose_parameter(T& value, const T& initial, const char* name, const char* word,
                                 std::string_view where, Problem& problem) noexcept {
  if (name == nullptr || word == nullptr) return STRIBECK_BAD_ARGUMENT;
  const char* known = nullptr;
  std::uint32_t i = 0;
  while ((known = word_at(initial, name, i)) != nullptr && std::strcmp(known, word) != 0) ++i;
  if (known == nullptr) {
    problem.set({where, name, ": has no word \"", word, "\""});
    return i == 0 ? STRIBECK_UNKNOWN_NAME : STRIBECK_OUT_OF_RANGE;
  }
  return set_parameter(value, name, static_cast<double>(i), where, problem);
}

}  // namespace stribeck::capi
