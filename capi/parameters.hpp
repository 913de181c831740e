#pragma once
/// Parameters by name, for hosts that only have names and numbers. The names come from fields() (core/fields.hpp):
///
///   mass                               a member
///   friction.eccentric.0.amplitude     element of a list: its index; setting it extends the list to that element
///   friction.steady                    a choice (std::variant, enumeration): index of the word
///   friction.conventional.alpha0       member of an alternative: its word replaces the name of the choice
///   friction.conventional.stribeck.v0  member of an optional value: setting it makes the value present
///
/// Absent is NaN. Unlike in files, a setting without effect is accepted: a host keeps the settings of what it has switched
/// off.
/// Real time: no allocation; configure only.

#include <stribeck/stribeck.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <stribeck/core/walk_fields.hpp>
#include <string_view>

namespace stribeck::capi {

inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
/// Periods that a servo thread may have [s]. A number outside is probably in another unit.
inline constexpr double kShortestPeriod = 1e-6;
inline constexpr const char* kPeriodExpected = "period: expected at least 1 us and below 1 s";

/// The last problem, stored as text in the handle.
class Problem {
 public:
  void set(std::initializer_list<std::string_view> parts) noexcept {
    std::size_t n = 0;
    for (const std::string_view part : parts) {
      // A part of the caller's own, such as a name, leaves room for the reason.
      const std::size_t m = std::min({part.size(), kLongestPart, text_.size() - 1 - n});
      std::copy_n(part.data(), m, text_.data() + n);
      n += m;
    }
    text_[n] = '\0';
  }
  [[nodiscard]] const char* text() const noexcept { return text_.data(); }

 private:
  static constexpr std::size_t kLongestPart = 150;
  std::array<char, 200> text_{};
};

/// A parameter that can be set.
struct Leaf {
  std::string_view name;
  const FieldInfo* field = nullptr;  ///< its declaration
  double value = kAbsent;            ///< value before it is set
  stribeck_parameter_kind kind = STRIBECK_NUMBER;
  const Type* choice = nullptr;  ///< the choice whose words it takes
};

/// Calls heard(leaf) for every parameter that can be set.
void list(const Value& initial, const Listener<const Leaf&>& heard) noexcept;

/// Calls heard(name, value, word) for every parameter that a group has: only chosen alternatives and present elements.
/// `word` is that of a choice, else empty.
using Heard = Listener<std::string_view, double, std::string_view>;
void values_of(const Value& group, const Heard& heard);

/// The parameter with this number, for the C interface.
stribeck_result parameter_at(const Value& initial, std::uint32_t index, stribeck_parameter* out) noexcept;
/// Word number `index` of a choice; null when there is none.
const char* word_at(const Value& initial, const char* wanted, std::uint32_t index) noexcept;

/// Sets one parameter. The text of a problem begins with `where`.
stribeck_result set_parameter(Target group, const char* name, double x, std::string_view where,
                              Problem& problem) noexcept;
stribeck_result choose_parameter(Target group, const char* name, const char* word, std::string_view where,
                                 Problem& problem) noexcept;

/// Reports the first problem; returns true when there is none.
bool check(const Value& group, const Report& report) noexcept;

}  // namespace stribeck::capi
