#include "parameters.hpp"

#include <cmath>
#include <cstring>

namespace stribeck::capi {
namespace {

// Four walks over declared parameters (core/walk_fields.hpp), each by the kind of the value:
//   list_…     every parameter that there may be, also of what is absent or not chosen
//   values_…   the parameters that have a value now
//   assign_…   sets one parameter by its name
//   check_…    whether every value is within its range, and each group is sound
// All but assign_… build the dotted name on their way down. `const auto mark = name.with(part)` adds a part for as long as `mark` lives.

/// Builds a dotted name.
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

  /// Adds a part to the name; the mark removes it at the end of its life.
  [[nodiscard]] Mark with(std::string_view part) noexcept {
    const std::size_t before = size_;
    if (size_ > 0 && !part.empty()) append(".");
    append(part);
    return {*this, before};
  }
  [[nodiscard]] Mark with(std::size_t index) noexcept {
    const std::array<char, 2> digits{static_cast<char>('0' + index / 10 % 10),
                                     static_cast<char>('0' + index % 10)};
    return with(index < 10 ? std::string_view(&digits[1], 1) : std::string_view(digits.data(), 2));
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

using Hears = Listener<const Leaf&>;

void list_below(Name& name, const Value& v, const FieldInfo& field, bool absent, const Hears& heard);

/// A choice, and the parameters of each of its alternatives.
void list_variant(Name& name, const Member& m, bool absent, const Hears& heard) {
  const Type& type = m.value.type();
  {
    const auto mark = name.with(m.info.name);
    heard({name.view(), &m.info, absent ? kAbsent : m.value.number(), STRIBECK_CHOICE, &type});
  }
  for (std::size_t i = 0; i < type.word_count; ++i) {
    const auto mark = name.with(type.words[i]);
    list_below(name, initial_of(*type.alternatives[i]), m.info, absent, heard);
  }
}

void list_group(Name& name, const Value& group, bool absent, const Hears& heard) {
  for_each_member(group, [&](const Member& m) {
    if (m.value.kind() == Kind::kVariant) return list_variant(name, m, absent, heard);
    const auto mark = name.with(m.info.name);
    list_below(name, m.value, m.info, absent, heard);
  });
}

void list_below(Name& name, const Value& v, const FieldInfo& field, bool absent, const Hears& heard) {
  const Type& type = v.type();
  const auto leaf = [&](stribeck_parameter_kind kind, const Type* choice = nullptr) {
    heard({name.view(), &field, absent ? kAbsent : v.number(), kind, choice});
  };
  switch (v.kind()) {
    case Kind::kSwitch:
      return leaf(STRIBECK_SWITCH);
    case Kind::kCount:
      return leaf(STRIBECK_INTEGER);
    case Kind::kNumber:
      return leaf(STRIBECK_NUMBER);
    case Kind::kChoice:
      return leaf(STRIBECK_CHOICE, &type);
    case Kind::kOptional:
      return v.size() == 0 ? list_below(name, initial_of(*type.inner), field, true, heard)
                           : list_below(name, v[0], field, absent, heard);
    case Kind::kList:
      for (std::size_t i = 0; i < type.most_items; ++i) {
        const auto mark = name.with(i);
        v.has_fixed_size() ? list_below(name, v[i], field, absent, heard)
                           : list_below(name, initial_of(*type.inner), field, true, heard);
      }
      return;
    case Kind::kGroup:
      return list_group(name, v, absent, heard);
    case Kind::kText:
    case Kind::kVariant:
    case Kind::kNamed:
      return;  // no parameter of the C interface is one
  }
}

/// Reports every parameter below `v` that has a value, with its word where it is a choice.
void values_below(Name& name, const Value& v, const Heard& heard) {
  switch (v.kind()) {
    case Kind::kSwitch:
    case Kind::kCount:
    case Kind::kNumber:
      return heard(name.view(), v.number(), {});
    case Kind::kChoice:
      return heard(name.view(), v.number(), v.word());
    case Kind::kVariant: {
      // The name of the choice was removed; the alternative's word replaces it.
      const auto mark = name.with(v.word());
      return values_below(name, v.chosen(), heard);
    }
    case Kind::kOptional:
      if (v.size() > 0) values_below(name, v[0], heard);
      return;
    case Kind::kList:
      for (std::size_t i = 0; i < v.size(); ++i) {
        const auto mark = name.with(i);
        values_below(name, v[i], heard);
      }
      return;
    case Kind::kGroup:
      return for_each_member(v, [&](const Member& m) {
        // An optional value that is absent.
        if (m.value.is_scalar() && !m.info.required && !m.info.quantity.permits(m.value.number())) return;
        if (m.value.kind() == Kind::kVariant) {
          {
            const auto mark = name.with(m.info.name);
            heard(name.view(), m.value.number(), m.value.word());
          }
          return values_below(name, m.value, heard);
        }
        const auto mark = name.with(m.info.name);
        values_below(name, m.value, heard);
      });
    case Kind::kText:
    case Kind::kNamed:
      return;
  }
}

/// Removes the first part of a dotted name and returns it.
std::string_view take_part(std::string_view& rest) noexcept {
  const std::size_t n = std::min(rest.find('.'), rest.size());
  const std::string_view part(rest.data(), n);
  rest.remove_prefix(std::min(n + 1, rest.size()));
  return part;
}

/// One or two digits; anything else gives `otherwise`.
std::size_t index_in(std::string_view part, std::size_t otherwise) noexcept {
  const bool has_leading_zero = part.size() > 1 && part[0] == '0';
  if (part.empty() || part.size() > 2 || has_leading_zero) return otherwise;
  std::size_t index = 0;
  for (const char c : part) {
    if (c < '0' || c > '9') return otherwise;
    index = 10 * index + static_cast<std::size_t>(c - '0');
  }
  return index;
}

/// Whether a number is one of 0, 1, …, count − 1.
bool is_index(double x, std::size_t count) noexcept {
  return x >= 0.0 && x < static_cast<double>(count) && x == std::floor(x);
}

stribeck_result assign(Target target, const Quantity& quantity, std::string_view rest, double x) noexcept;

stribeck_result assign_scalar(Target target, const Quantity& quantity, double x) noexcept {
  switch (target.kind()) {
    case Kind::kSwitch:
      if (!is_index(x, 2)) return STRIBECK_OUT_OF_RANGE;
      break;
    case Kind::kChoice:
      if (!is_index(x, target.type().word_count)) return STRIBECK_OUT_OF_RANGE;
      break;
    default:
      if (!std::isfinite(x) || !quantity.permits(x)) return STRIBECK_OUT_OF_RANGE;
      if (target.kind() == Kind::kCount && (x != std::floor(x) || std::abs(x) > 1e9))
        return STRIBECK_OUT_OF_RANGE;
  }
  target.set(x);
  return STRIBECK_OK;
}

/// A member of something optional, which is made where it is absent. NaN takes away what may be left out: by the name of such a member that
/// member, by any other name the whole.
stribeck_result assign_optional(Target target, const Quantity& quantity, std::string_view rest,
                                double x) noexcept {
  const bool was_absent = target.size() == 0;
  if (was_absent) target.resize(1);
  if (std::isnan(x)) {
    const stribeck_result below =
        rest.empty() ? stribeck_result{STRIBECK_OUT_OF_RANGE} : assign(target[0], quantity, rest, x);
    if (below != STRIBECK_OK || was_absent)
      target.resize(below == STRIBECK_UNKNOWN_NAME && !was_absent ? 1 : 0);
    return below == STRIBECK_UNKNOWN_NAME ? STRIBECK_UNKNOWN_NAME : STRIBECK_OK;
  }
  const stribeck_result result = assign(target[0], quantity, rest, x);
  if (result != STRIBECK_OK && was_absent) target.resize(0);
  return result;
}

stribeck_result assign_item(Target list, const Quantity& quantity, std::string_view rest, double x) noexcept {
  constexpr std::size_t kMostItems = 100;  // names have two digits
  const std::size_t i = index_in(take_part(rest), kMostItems);
  const std::size_t before = list.size();
  if (i >= std::min(list.type().most_items, kMostItems)) return STRIBECK_UNKNOWN_NAME;
  if (i >= before) list.resize(i + 1);
  const stribeck_result result = assign(list[i], quantity, rest, x);
  if (result != STRIBECK_OK && i >= before) list.resize(before);
  return result;
}

/// The choice itself, or a member of the chosen alternative; UNKNOWN_NAME when the name is neither.
stribeck_result assign_variant(const TargetMember& m, std::string_view part, std::string_view rest,
                               double x) noexcept {
  const Type& type = m.value.type();
  if (part == m.info.name && rest.empty()) {
    if (!is_index(x, type.word_count)) return STRIBECK_OUT_OF_RANGE;
    if (x != Value(m.value).number()) m.value.set(x);
    return STRIBECK_OK;
  }
  const auto* word = std::find(type.words, type.words + type.word_count, part);
  if (word == type.words + type.word_count) return STRIBECK_UNKNOWN_NAME;
  if (*word != Value(m.value).word()) return STRIBECK_NOT_SELECTED;
  return assign(m.value.chosen(), m.info.quantity, rest, x);
}

/// Sets the parameter `rest` below `target`. On failure nothing has changed.
stribeck_result assign(Target target, const Quantity& quantity, std::string_view rest, double x) noexcept {
  switch (target.kind()) {
    case Kind::kSwitch:
    case Kind::kCount:
    case Kind::kNumber:
    case Kind::kChoice:
      return rest.empty() ? assign_scalar(target, quantity, x) : stribeck_result{STRIBECK_UNKNOWN_NAME};
    case Kind::kOptional:
      return assign_optional(target, quantity, rest, x);
    case Kind::kList:
      return assign_item(target, quantity, rest, x);
    case Kind::kGroup: {
      stribeck_result result = STRIBECK_UNKNOWN_NAME;
      std::string_view below = rest;
      const std::string_view part = take_part(below);
      for_each_member(target, [&](const TargetMember& m) {
        if (result != STRIBECK_UNKNOWN_NAME) return;
        if (m.value.kind() == Kind::kVariant) {
          result = assign_variant(m, part, below, x);
        } else if (part == m.info.name) {
          result = assign(m.value, m.info.quantity, below, x);
        }
      });
      return result;
    }
    case Kind::kText:
    case Kind::kVariant:
    case Kind::kNamed:
      break;
  }
  return STRIBECK_UNKNOWN_NAME;
}

/// `initial` is the initial value of `v`.
bool check_below(Name& name, const Value& v, const Value& initial, const Quantity& quantity,
                 const Report& report);

bool check_group(Name& name, const Value& group, const Value& initial, const Report& report) {
  bool good = true;
  for_each_member(group, [&](const Member& m) {
    if (!good) return;
    if (m.value.kind() == Kind::kVariant) {
      const auto mark = name.with(m.value.word());
      const Value chosen = m.value.chosen();
      good = check_below(name, chosen, initial_of(chosen.type()), m.info.quantity, report);
      return;
    }
    const Value begun = *find_member(initial, m.info.name);
    if (m.value.is_scalar() && !m.info.required && m.value.number() == begun.number())
      return;  // has its initial value
    const auto mark = name.with(m.info.name);
    good = check_below(name, m.value, begun, m.info.quantity, report);
  });
  if (!good) return false;
  validate(group, [&](std::string_view key, std::string_view what) {
    if (!good) return;
    good = false;
    const auto mark = name.with(key);
    report(name.view(), what);
  });
  return good;
}

bool check_below(Name& name, const Value& v, const Value& initial, const Quantity& quantity,
                 const Report& report) {
  switch (v.kind()) {
    case Kind::kOptional:
    case Kind::kList:
      for (std::size_t i = 0; i < v.size(); ++i) {
        const auto mark = v.kind() == Kind::kList ? name.with(i) : name.with(std::string_view{});
        if (!check_below(name, v[i], initial_of(*v.type().inner), quantity, report)) return false;
      }
      return true;
    case Kind::kCount:
    case Kind::kNumber:
      if (quantity.permits(v.number())) return true;
      if (std::isnan(v.number()) && std::isnan(initial.number())) return true;
      report(name.view(), "not set, or out of range");
      return false;
    case Kind::kGroup:
      return check_group(name, v, initial, report);
    case Kind::kSwitch:
    case Kind::kChoice:
    case Kind::kText:
    case Kind::kVariant:
    case Kind::kNamed:
      break;
  }
  return true;
}

}  // namespace

void values_of(const Value& group, const Heard& heard) {
  Name name;
  values_below(name, group, heard);
}

void list(const Value& initial, const Hears& heard) noexcept {
  Name name;
  list_group(name, initial, false, heard);
}

stribeck_result parameter_at(const Value& initial, std::uint32_t index, stribeck_parameter* out) noexcept {
  if (out == nullptr) return STRIBECK_BAD_ARGUMENT;
  std::uint32_t at = 0;
  stribeck_result result = STRIBECK_BAD_ARGUMENT;
  list(initial, [&](const Leaf& leaf) {
    if (at++ != index) return;
    result = STRIBECK_OK;
    *out = {};
    std::copy_n(leaf.name.data(), std::min(leaf.name.size(), sizeof out->name - 1), out->name);
    // Texts of fields() are literals and end in a zero byte.
    const Quantity& quantity = leaf.field->quantity;
    out->unit = quantity.unit.data() == nullptr ? "" : quantity.unit.data();
    out->about = leaf.field->doc.data() == nullptr ? "" : leaf.field->doc.data();
    out->value = leaf.value;
    const bool bounded = leaf.choice != nullptr || leaf.kind == STRIBECK_SWITCH;
    const std::size_t words = leaf.choice != nullptr ? leaf.choice->word_count : 0;
    out->min = bounded ? 0.0 : quantity.min;
    out->max = words > 0 ? static_cast<double>(words - 1) : bounded ? 1.0 : quantity.max;
    out->kind = leaf.kind;
    out->words = static_cast<std::uint32_t>(words);
  });
  return result;
}

const char* word_at(const Value& initial, const char* wanted, std::uint32_t index) noexcept {
  if (wanted == nullptr) return nullptr;
  const char* found = nullptr;
  list(initial, [&](const Leaf& leaf) {
    if (leaf.name == wanted && leaf.choice != nullptr && index < leaf.choice->word_count)
      found = leaf.choice->words[index].data();
  });
  return found;
}

stribeck_result set_parameter(Target group, const char* name, double x, std::string_view where,
                              Problem& problem) noexcept {
  if (name == nullptr) {
    problem.set({where, "name: is null, expected the name of a parameter"});
    return STRIBECK_BAD_ARGUMENT;
  }
  const stribeck_result result = assign(group, {}, name, x);
  if (result != STRIBECK_OK) problem.set({where, name, ": ", stribeck_describe(result)});
  return result;
}

stribeck_result choose_parameter(Target group, const char* name, const char* word, std::string_view where,
                                 Problem& problem) noexcept {
  if (name == nullptr || word == nullptr) {
    problem.set({where, name == nullptr ? "name: is null, expected the name of a parameter"
                                        : "word: is null, expected a word of the parameter"});
    return STRIBECK_BAD_ARGUMENT;
  }
  const char* known = nullptr;
  std::uint32_t i = 0;
  while ((known = word_at(initial_of(group.type()), name, i)) != nullptr && std::strcmp(known, word) != 0)
    ++i;
  if (known == nullptr) {
    problem.set({where, name, ": has no word \"", word, "\""});
    return i == 0 ? STRIBECK_UNKNOWN_NAME : STRIBECK_OUT_OF_RANGE;
  }
  return set_parameter(group, name, static_cast<double>(i), where, problem);
}

bool check(const Value& group, const Report& report) noexcept {
  Name name;
  return check_below(name, group, initial_of(group.type()), {}, report);
}

}  // namespace stribeck::capi
