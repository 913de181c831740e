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
/// Files, error texts, --help and the reference pages are made from that list; there is no second one.
/// Members may be: a number with a unit (double, or a Real scalar), int, bool, std::string, an enumeration
/// with names (see enum_names), a struct with fields(), std::optional of these (absent is not zero),
/// FixedVector, std::vector or std::array of these, and std::variant of structs each with a `static constexpr
/// std::string_view kKind`. Everything inside is SI: the stored value has `unit`; `shown` is the unit that
/// people read.
/// Real time: safe (constants only).

#include <limits>
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

  /// The key may be left out; the member then keeps its initial value.
  [[nodiscard]] constexpr Field or_default() const noexcept {
    Field f = *this;
    f.required = false;
    return f;
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

}  // namespace stribeck
