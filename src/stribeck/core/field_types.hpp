#pragma once
/// Describes each declared type (fields.hpp) by a constant table: type_of<T> tells its kind and how to reach its parts, without the
/// type itself. walk_fields.hpp uses it to walk over objects.
///
/// To support a new kind of member: add a Kind and its make_ function below; the compiler then shows every switch over Kind.
/// Real time: configure only. Allocates only what the members themselves allocate (std::string, std::vector).

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stribeck/core/fields.hpp>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

namespace stribeck {

// In short: for every struct with fields(), type_of<Struct> is a constant table with one row (FieldInfo) per member: its name, text, unit, and
// functions that reach the member in an object. Code that reads files or lists parameters goes through such tables and needs no template.
// Who adds a parameter writes a line in fields() (fields.hpp) and need not read on here.

/// What a parameter is.
enum class Kind : unsigned char {
  kSwitch,    ///< bool
  kCount,     ///< whole number
  kNumber,    ///< double, with the unit of its field
  kText,      ///< std::string
  kChoice,    ///< enumeration with names
  kGroup,     ///< struct with fields()
  kOptional,  ///< std::optional
  kList,      ///< FixedVector, std::array, std::vector
  kVariant,   ///< std::variant of groups with a kKind each
  kNamed      ///< std::vector of (name, group) pairs
};

/// A reference to any callable, valid for the duration of a walk; it neither copies nor allocates.
template <class... A>
class Listener {
 public:
  template <class F>
  requires(!std::is_same_v<F, Listener>) Listener(const F& f)
  noexcept : to_(&f), call_([](const void* to, A... args) { (*static_cast<const F*>(to))(args...); }) {}
  void operator()(A... args) const { call_(to_, args...); }

 private:
  const void* to_;
  void (*call_)(const void*, A...);
};

/// Receives each problem: report(key, text).
using Report = Listener<std::string_view, std::string_view>;

struct FieldInfo;

/// A declared type. Entries that do not apply to its kind are null or empty.
struct Type {
  Kind kind = Kind::kGroup;
  const void* (*initial)() = nullptr;  ///< an object with all initial values

  double (*number)(const void*) =
      nullptr;  ///< of a switch 0 or 1; of a choice and a variant the index of the word
  void (*set_number)(void*, double) = nullptr;
  std::int64_t least = 0;  ///< what a count can hold
  std::int64_t most = 0;
  std::string_view (*text)(const void*) = nullptr;
  void (*set_text)(void*, std::string_view) = nullptr;
  const std::string_view* words = nullptr;  ///< of a choice, and the kinds of a variant
  std::size_t word_count = 0;

  const FieldInfo* fields = nullptr;
  std::size_t field_count = 0;
  void (*validate)(const void*, const Report&) = nullptr;
  std::string_view label;  ///< kLabel of a group that has one
  /// Name of the switch that stands for a whole group: `key = "on"` in place of a table.
  std::string_view short_form;

  const Type* inner = nullptr;                ///< of optional, list and named
  const Type* const* alternatives = nullptr;  ///< of a variant
  std::size_t (*size)(const void*) = nullptr;
  void* (*at)(void*, std::size_t) = nullptr;
  void (*resize)(void*, std::size_t) = nullptr;  ///< an optional that gets size 1 is constructed anew
  std::size_t least_items = 0;
  std::size_t most_items = 0;
  std::string_view (*name_at)(const void*, std::size_t) = nullptr;
  void (*add)(void*, std::string_view name) = nullptr;
};

/// One declared parameter of a group.
struct FieldInfo {
  std::string_view name;
  std::string_view doc;
  Quantity quantity;
  bool required = true;
  const Type* type = nullptr;
  void* (*member)(void* owner) = nullptr;
  std::string_view condition;                       ///< "": it always has an effect
  bool (*has_effect)(const void* owner) = nullptr;  ///< null: always
};

namespace detail {

template <class T>
constexpr bool kNeverSupported = false;

template <class T>
struct Alternatives;  // of variants alone

template <class T>
concept OptionalLike = requires(T t) {
  t.has_value();
  t.reset();
};
template <class T>
concept VariantLike = requires {
  std::variant_size<T>::value;
};
template <class T>
concept TextLike = requires {
  T::npos;
};
template <class T>
concept NamedLike = requires {
  typename T::value_type::second_type;
};
template <class T>
concept ListLike = requires(T t) {
  typename T::value_type;
  t.size();
  t[0];
};

template <class T>
const void* initial_of() {
  static const T kInitial{};
  return &kInitial;
}

template <class T>
struct Declared {
  static constexpr auto kFields = T::fields();
  static constexpr std::size_t kCount = std::tuple_size_v<decltype(kFields)>;

  template <std::size_t I>
  static void* member(void* owner) {
    return &(static_cast<T*>(owner)->*std::get<I>(kFields).member);
  }
  template <std::size_t I>
  static bool has_effect(const void* owner) {
    return std::get<I>(kFields).has_effect(*static_cast<const T*>(owner));
  }
};

template <class T>
constexpr Type make_type();

}  // namespace detail

/// The table of T.
template <class T>
inline constexpr Type type_of = detail::make_type<T>();

namespace detail {

template <class T, std::size_t I>
constexpr FieldInfo make_field() {
  constexpr const auto& kField = std::get<I>(Declared<T>::kFields);
  using Member = typename std::remove_cvref_t<decltype(kField)>::member_type;
  FieldInfo info;
  info.name = kField.name;
  info.doc = kField.doc;
  info.quantity = kField.quantity;
  info.required = kField.required;
  info.type = &type_of<Member>;
  info.member = &Declared<T>::template member<I>;
  info.condition = kField.condition;
  // The condition's text is asked, not the function: with the sanitizers, GCC 12 does not take a comparison of a function with null for a constant.
  if constexpr (!kField.condition.empty()) info.has_effect = &Declared<T>::template has_effect<I>;
  return info;
}

template <class T>
inline constexpr auto kFieldsOf = []<std::size_t... I>(std::index_sequence<I...>) {
  return std::array<FieldInfo, sizeof...(I)>{make_field<T, I>()...};
}
(std::make_index_sequence<Declared<T>::kCount>());

template <class... A>
struct Alternatives<std::variant<A...>> {
  static constexpr std::array<std::string_view, sizeof...(A)> kKinds{A::kKind...};
  static constexpr std::array<const Type*, sizeof...(A)> kTypes{&type_of<A>...};
  static void choose(void* object, double x) {
    auto& v = *static_cast<std::variant<A...>*>(object);
    const auto index = static_cast<std::size_t>(x);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((I == index ? void(v.template emplace<I>()) : void()), ...);
    }
    (std::index_sequence_for<A...>());
  }
  static void* chosen(void* object, std::size_t) {
    return std::visit([](auto& a) -> void* { return &a; }, *static_cast<std::variant<A...>*>(object));
  }
};

template <class T>
constexpr void make_group(Type& t) {
  t.kind = Kind::kGroup;
  t.fields = kFieldsOf<T>.data();
  t.field_count = kFieldsOf<T>.size();
  if constexpr (requires(const T& x, const Report& r) { x.validate(r); })
    t.validate = [](const void* p, const Report& r) { static_cast<const T*>(p)->validate(r); };
  if constexpr (requires { T::kLabel; }) t.label = T::kLabel;
  if constexpr (requires { T::kShortForm; }) t.short_form = T::kShortForm;
}

template <class T>
constexpr void make_scalar(Type& t) {
  t.number = [](const void* p) { return static_cast<double>(*static_cast<const T*>(p)); };
  t.set_number = [](void* p, double x) { *static_cast<T*>(p) = static_cast<T>(x); };
  if constexpr (std::is_same_v<T, bool>) {
    t.kind = Kind::kSwitch;
  } else if constexpr (std::is_integral_v<T>) {
    t.kind = Kind::kCount;
    using Limits = std::numeric_limits<T>;
    constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
    t.least = static_cast<std::int64_t>(Limits::min());
    t.most = static_cast<std::uint64_t>(Limits::max()) > kMost ? static_cast<std::int64_t>(kMost)
                                                               : static_cast<std::int64_t>(Limits::max());
  } else {
    static_assert(std::is_same_v<T, double>, "parameters hold double");
    t.kind = Kind::kNumber;
  }
}

template <class T>
constexpr void make_choice(Type& t) {
  t.kind = Kind::kChoice;
  t.words = kEnumWords<T>.data();
  t.word_count = kEnumWords<T>.size();
  t.number = [](const void* p) {
    std::size_t at = 0;
    while (at + 1 < kEnumWords<T>.size() && EnumNames<T>::names[at].first != *static_cast<const T*>(p)) ++at;
    return static_cast<double>(at);
  };
  t.set_number = [](void* p, double x) {
    *static_cast<T*>(p) = EnumNames<T>::names[static_cast<std::size_t>(x)].first;
  };
}

template <class T>
constexpr void make_optional(Type& t) {
  t.kind = Kind::kOptional;
  t.inner = &type_of<typename T::value_type>;
  t.most_items = 1;
  t.size = [](const void* p) -> std::size_t { return static_cast<const T*>(p)->has_value() ? 1 : 0; };
  t.at = [](void* p, std::size_t) -> void* { return &**static_cast<T*>(p); };
  t.resize = [](void* p, std::size_t n) {
    n == 0 ? static_cast<T*>(p)->reset() : void(static_cast<T*>(p)->emplace());
  };
}

template <class T>
constexpr void make_named(Type& t) {
  t.kind = Kind::kNamed;
  t.inner = &type_of<typename T::value_type::second_type>;
  t.most_items = std::numeric_limits<std::size_t>::max();
  t.size = [](const void* p) { return static_cast<const T*>(p)->size(); };
  t.at = [](void* p, std::size_t i) -> void* { return &(*static_cast<T*>(p))[i].second; };
  t.resize = [](void* p, std::size_t n) { static_cast<T*>(p)->resize(n); };
  t.name_at = [](const void* p, std::size_t i) -> std::string_view {
    return (*static_cast<const T*>(p))[i].first;
  };
  t.add = [](void* p, std::string_view name) {
    static_cast<T*>(p)->emplace_back().first.assign(name.data(), name.size());
  };
}

template <class T>
constexpr void make_list(Type& t) {
  t.kind = Kind::kList;
  t.inner = &type_of<typename T::value_type>;
  t.size = [](const void* p) -> std::size_t { return static_cast<const T*>(p)->size(); };
  t.at = [](void* p, std::size_t i) -> void* { return &(*static_cast<T*>(p))[i]; };
  if constexpr (requires { std::tuple_size<T>::value; }) {
    t.least_items = t.most_items = std::tuple_size_v<T>;
  } else {
    t.most_items = std::numeric_limits<std::size_t>::max();
    if constexpr (requires { T::kCapacity; }) {
      t.most_items = T::kCapacity;
      // One value for each axis: a list without any would stand for nothing.
      if constexpr (std::is_arithmetic_v<typename T::value_type>) t.least_items = 1;
    }
    t.resize = [](void* p, std::size_t n) { static_cast<T*>(p)->resize(n); };
  }
}

template <class T>
constexpr Type make_type() {
  Type t;
  t.initial = &initial_of<T>;
  if constexpr (std::is_arithmetic_v<T>) {
    make_scalar<T>(t);
  } else if constexpr (NamedEnum<T>) {
    make_choice<T>(t);
  } else if constexpr (HasFields<T>) {
    make_group<T>(t);
  } else if constexpr (VariantLike<T>) {
    t.kind = Kind::kVariant;
    t.words = Alternatives<T>::kKinds.data();
    t.word_count = Alternatives<T>::kKinds.size();
    t.alternatives = Alternatives<T>::kTypes.data();
    t.number = [](const void* p) { return static_cast<double>(static_cast<const T*>(p)->index()); };
    t.set_number = &Alternatives<T>::choose;
    t.at = &Alternatives<T>::chosen;
  } else if constexpr (OptionalLike<T>) {
    make_optional<T>(t);
  } else if constexpr (TextLike<T>) {
    t.kind = Kind::kText;
    t.text = [](const void* p) { return std::string_view(*static_cast<const T*>(p)); };
    t.set_text = [](void* p, std::string_view x) { static_cast<T*>(p)->assign(x.data(), x.size()); };
  } else if constexpr (NamedLike<T>) {
    make_named<T>(t);
  } else if constexpr (ListLike<T>) {
    make_list<T>(t);
  } else {
    static_assert(kNeverSupported<T>, "see core/fields.hpp for the types that a parameter may have");
  }
  return t;
}

}  // namespace detail

}  // namespace stribeck
