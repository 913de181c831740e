#pragma once
/// Parameters are declared once. A struct lists its parameters in a static member function:
///
///   struct Screw {
///     double lead = 0.005;
///     static constexpr auto fields() {
///       return std::tuple{
///           field("lead", &Screw::lead, quantity("m", "mm").positive(), "travel of the nut per turn")};
///     }
///   };
///
/// This one list gives files, error messages, --help, the C interface and the reference pages, all through walk_fields.hpp.
/// A setting that has an effect only beside another one says so:
///
///   field("pole", &Observer::pole, …).when([](const Observer& o) { return o.on; }, "goes with on = true")
///
/// Members may be: a number with a unit (double, or a Real scalar), int, bool, std::string, an enumeration
/// with names (see enum_names), a struct with fields(), std::optional of these (absent is not zero),
/// FixedVector, std::vector or std::array of these, and std::variant of structs each with a `static constexpr
/// std::string_view kKind`. Everything inside is SI: the stored value has `unit`; `shown` is the unit for people.
/// Real time: safe (constants only).

#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace stribeck {

/// Unit and permitted range of a number.
struct Quantity {
  std::string_view unit;   ///< SI unit of the stored value; "" for a pure number
  std::string_view shown;  ///< unit that files and tables show
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;

  [[nodiscard]] constexpr Quantity positive() const noexcept { return above(0.0); }
  [[nodiscard]] constexpr Quantity not_negative() const noexcept { return at_least(0.0); }
  [[nodiscard]] constexpr Quantity above(double limit) const noexcept {
    Quantity q = *this;
    q.min = limit;
    q.min_excluded = true;
    return q;
  }
  [[nodiscard]] constexpr Quantity at_least(double limit) const noexcept {
    Quantity q = *this;
    q.min = limit;
    return q;
  }
  [[nodiscard]] constexpr Quantity at_most(double limit) const noexcept {
    Quantity q = *this;
    q.max = limit;
    return q;
  }
  [[nodiscard]] constexpr bool permits(double x) const noexcept {
    return (min_excluded ? x > min : x >= min) && x <= max;
  }
};

constexpr Quantity quantity(std::string_view unit, std::string_view shown) noexcept { return {unit, shown}; }
constexpr Quantity pure_number() noexcept { return {"", ""}; }

/// One declared parameter of Owner.
template <class Owner, class Member>
struct Field {
  using owner_type = Owner;
  using member_type = Member;

  std::string_view name;
  Member Owner::*member;
  Quantity quantity;
  std::string_view doc;
  bool required = true;
  std::string_view condition{};  ///< condition under which it has an effect, in words; "": always
  bool (*has_effect)(const Owner&) = nullptr;  ///< the same condition as a function; null: always

  /// The key may be left out; the member then keeps its initial value.
  [[nodiscard]] constexpr Field or_default() const noexcept {
    Field f = *this;
    f.required = false;
    return f;
  }
  /// Names the condition under which the parameter has an effect. `words` reads "goes with …". Elsewhere files refuse the key.
  [[nodiscard]] constexpr Field when(bool (*effect)(const Owner&), std::string_view words) const noexcept {
    Field f = *this;
    f.condition = words;
    f.has_effect = effect;
    return f;
  }
  /// The same parameter of a derived struct, where the condition differs.
  template <class Derived>
  [[nodiscard]] constexpr Field<Derived, Member> of() const noexcept {
    return {name, member, quantity, doc, required};
  }
};

template <class Owner, class Member>
constexpr Field<Owner, Member> field(std::string_view name, Member Owner::*member, Quantity q,
                                     std::string_view doc) noexcept {
  return {name, member, q, doc};
}
/// For members without a unit: nested structs, text, switches, choices, counts.
template <class Owner, class Member>
constexpr Field<Owner, Member> field(std::string_view name, Member Owner::*member,
                                     std::string_view doc) noexcept {
  return {name, member, {}, doc};
}
/// For a struct whose parameters count as the owner's own: its name is not part of their keys.
template <class Owner, class Member>
constexpr Field<Owner, Member> embedded(Member Owner::*member) noexcept {
  return {"", member, {}, ""};
}

template <class T>
concept HasFields = requires {
  T::fields();
};

/// Calls f(field) for every declared parameter of T, in order.
template <HasFields T, class F>
constexpr void for_each_field(F&& f) {
  std::apply([&](const auto&... one) { (f(one), ...); }, T::fields());
}

/// Enumerations that appear in files specialise this with an array of {value, name} pairs called `names`.
template <class E>
struct EnumNames;

template <class E>
concept NamedEnum = std::is_enum_v<E> && requires {
  EnumNames<E>::names;
};

/// Name of a value; "" for a value that has none.
template <NamedEnum E>
constexpr std::string_view enum_name(E wanted) noexcept {
  for (const auto& [value, name] : EnumNames<E>::names) {
    if (value == wanted) return name;
  }
  return {};
}

/// Value with that name; nothing for an unknown name.
template <NamedEnum E>
constexpr std::optional<E> enum_value(std::string_view wanted) noexcept {
  for (const auto& [value, name] : EnumNames<E>::names) {
    if (name == wanted) return value;
  }
  return std::nullopt;
}

/// All names, in the order of declaration.
template <NamedEnum E>
inline constexpr auto kEnumWords = [] {
  std::array<std::string_view, EnumNames<E>::names.size()> words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = EnumNames<E>::names[i].second;
  return words;
}();

}  // namespace stribeck
