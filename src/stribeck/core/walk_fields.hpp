#pragma once
/// The one walk over declared parameters (fields.hpp), for files, the C interface, JSON, tables, tuning and reference pages.
///
///   for_each_member(value_of(machine), [](const Member& m) {          // reads `machine`, does not copy it
///     switch (m.value.kind()) { case Kind::kNumber: … m.info.name, m.info.quantity, m.value.number() … }
///   });
///
/// Every declared type has one constant table (field_types.hpp). A walk is therefore ordinary code over Value (read) and Target
/// (write). It is compiled once, where a template would be compiled for every struct.
/// Real time: configure only.

#include <optional>
#include <stribeck/core/field_types.hpp>
#include <string_view>

namespace stribeck {

/// An object of a declared type, for reading.
class Value {
 public:
  constexpr Value(const Type& type, const void* object) noexcept : type_(&type), object_(object) {}

  [[nodiscard]] const Type& type() const noexcept { return *type_; }
  [[nodiscard]] Kind kind() const noexcept { return type_->kind; }
  [[nodiscard]] const void* object() const noexcept { return object_; }
  [[nodiscard]] bool is_scalar() const noexcept {
    return kind() == Kind::kNumber || kind() == Kind::kCount || kind() == Kind::kSwitch;
  }
  [[nodiscard]] bool has_fixed_size() const noexcept { return type_->least_items == type_->most_items; }

  [[nodiscard]] double number() const { return type_->number(object_); }
  /// The words of a choice or a variant.
  [[nodiscard]] std::size_t index() const { return static_cast<std::size_t>(number()); }
  [[nodiscard]] std::string_view word() const { return type_->words[index()]; }
  [[nodiscard]] std::string_view text() const { return type_->text(object_); }
  /// Number of items of a list; of an optional 0 or 1.
  [[nodiscard]] std::size_t size() const { return type_->size(object_); }
  // The tables have one function for reading and writing; a Value hands out what it finds for reading alone.
  [[nodiscard]] Value operator[](std::size_t i) const {
    return {*type_->inner, type_->at(const_cast<void*>(object_), i)};
  }
  [[nodiscard]] std::string_view name_at(std::size_t i) const { return type_->name_at(object_, i); }
  /// The alternative that a variant holds.
  [[nodiscard]] Value chosen() const {
    return {*type_->alternatives[index()], type_->at(const_cast<void*>(object_), 0)};
  }

 private:
  const Type* type_;
  const void* object_;
};

/// An object of a declared type, for writing.
class Target {
 public:
  constexpr Target(const Type& type, void* object) noexcept : type_(&type), object_(object) {}
  operator Value() const noexcept { return {*type_, object_}; }  // every Target can be read

  [[nodiscard]] const Type& type() const noexcept { return *type_; }
  [[nodiscard]] Kind kind() const noexcept { return type_->kind; }
  [[nodiscard]] void* object() const noexcept { return object_; }
  [[nodiscard]] std::size_t size() const { return type_->size(object_); }
  /// For a choice the index of the word; for a variant the index of the alternative, which is constructed anew.
  void set(double x) const { type_->set_number(object_, x); }
  void set(std::string_view text) const { type_->set_text(object_, text); }
  void resize(std::size_t n) const { type_->resize(object_, n); }
  void add(std::string_view name) const { type_->add(object_, name); }
  [[nodiscard]] Target operator[](std::size_t i) const { return {*type_->inner, type_->at(object_, i)}; }
  [[nodiscard]] Target chosen() const {
    return {*type_->alternatives[Value(*this).index()], type_->at(object_, 0)};
  }

 private:
  const Type* type_;
  void* object_;
};

template <class T>
constexpr Value value_of(const T& object) noexcept {
  return {type_of<T>, &object};
}
template <class T>
constexpr Target target_of(T& object) noexcept {
  return {type_of<T>, &object};
}
/// An object of type T with all initial values.
inline Value initial_of(const Type& type) { return {type, type.initial()}; }

/// One parameter of an object.
template <class V>
struct MemberOf {
  const FieldInfo& info;
  V value;
  const void* owner;

  [[nodiscard]] bool has_effect() const { return info.has_effect == nullptr || info.has_effect(owner); }
  /// Whether it must be given.
  [[nodiscard]] bool required() const { return info.required && value.kind() != Kind::kOptional; }
};
using Member = MemberOf<Value>;
using TargetMember = MemberOf<Target>;

/// Calls f(member) for every parameter of a group, in the order of declaration; those of an embedded struct as its own.
template <class V, class F>
void for_each_member(const V& group, F&& f) {
  const Type& type = group.type();
  for (std::size_t i = 0; i < type.field_count; ++i) {
    const FieldInfo& info = type.fields[i];
    void* const owner = const_cast<void*>(static_cast<const void*>(group.object()));
    const V value(*info.type, info.member(owner));
    if (info.name.empty()) {
      for_each_member(value, f);
    } else {
      f(MemberOf<V>{info, value, owner});
    }
  }
}

/// The parameter of this name; empty where there is none.
template <class V>
std::optional<V> find_member(const V& group, std::string_view name) {
  std::optional<V> found;
  for_each_member(group, [&](const MemberOf<V>& m) {
    if (m.info.name == name) found = m.value;
  });
  return found;
}

/// Calls every validate() of a group: those of embedded structs, then its own.
inline void validate(const Value& group, const Report& report) {
  const Type& type = group.type();
  for (std::size_t i = 0; i < type.field_count; ++i) {
    const FieldInfo& info = type.fields[i];
    if (info.name.empty())
      validate(Value(*info.type, info.member(const_cast<void*>(group.object()))), report);
  }
  if (type.validate != nullptr) type.validate(group.object(), report);
}

/// Whether two objects of one type have equal values. NaN equals NaN.
inline bool same(const Value& a, const Value& b) {
  switch (a.kind()) {
    case Kind::kSwitch:
    case Kind::kCount:
    case Kind::kNumber:
    case Kind::kChoice: {
      const double x = a.number();
      const double y = b.number();
      return x == y || (x != x && y != y);
    }
    case Kind::kText:
      return a.text() == b.text();
    case Kind::kVariant:
      return a.index() == b.index() && same(a.chosen(), b.chosen());
    case Kind::kOptional:
    case Kind::kList:
    case Kind::kNamed:
      if (a.size() != b.size()) return false;
      for (std::size_t i = 0; i < a.size(); ++i) {
        if (a.kind() == Kind::kNamed && a.name_at(i) != b.name_at(i)) return false;
        if (!same(a[i], b[i])) return false;
      }
      return true;
    case Kind::kGroup:
      break;
  }
  const Type& type = a.type();
  for (std::size_t i = 0; i < type.field_count; ++i) {
    const FieldInfo& info = type.fields[i];
    if (!same(Value(*info.type, info.member(const_cast<void*>(a.object()))),
              Value(*info.type, info.member(const_cast<void*>(b.object())))))
      return false;
  }
  return true;
}

/// Whether a parameter has its initial value.
inline bool is_initial(const Value& group, const Member& member) {
  const auto initial = find_member(Value(group.type(), group.type().initial()), member.info.name);
  return initial && same(member.value, *initial);
}

/// "on" or "off": the value of the switch that may stand for a whole group (Type::short_form).
inline std::string_view short_form(const Value& group) {
  return find_member(group, group.type().short_form)->number() != 0.0 ? "on" : "off";
}

/// Whether the word "on" or "off" describes the group completely: it has such a switch, and all other members are initial.
inline bool is_short(const Value& group) {
  const std::string_view name = group.type().short_form;
  bool all = group.kind() == Kind::kGroup && !name.empty();
  if (!all) return false;
  for_each_member(group,
                  [&](const Member& m) { all = all && (m.info.name == name || is_initial(group, m)); });
  return all;
}

}  // namespace stribeck
