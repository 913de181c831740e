#pragma once
/// Parameters by name, for hosts that have nothing but names and numbers. The names come from fields() (core/fields.hpp):
///
///   mass                               a member
///   friction.eccentric.0.amplitude     element of a list: its index; setting it makes the list as long as that
///   friction.steady                    a choice (std::variant, enumeration): index of the word
///   friction.conventional.alpha0       member of an alternative: the alternative's word stands in place of the choice's name
///   friction.conventional.stribeck.v0  member of something optional: setting it puts it in
///
/// Absent is NaN. A setting that has no effect beside the others is accepted, other than in files: a host keeps the settings of
/// what it has switched off.
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
/// Periods that a servo thread may have [s]; below it, and from a second on, the number is something else.
inline constexpr double kShortestPeriod = 1e-6;
inline constexpr const char* kPeriodExpected = "period: expected at least 1 us and below 1 s";

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

/// A parameter that may be set.
struct Leaf {
  std::string_view name;
  const FieldInfo* field = nullptr;  ///< that declares it
  double value = kAbsent;            ///< before it is set
  stribeck_parameter_kind kind = STRIBECK_NUMBER;
  const Type* choice = nullptr;  ///< whose words it takes
};

/// Calls heard(leaf) for every parameter that may be set.
void list(const Value& initial, const Listener<const Leaf&>& heard) noexcept;

/// Calls heard(name, value, word) for every parameter that a group holds: chosen alternatives and present elements alone.
/// `word` is that of a choice, else empty.
using Heard = Listener<std::string_view, double, std::string_view>;
void values_of(const Value& group, const Heard& heard);

/// The parameter with this number, for the C interface.
stribeck_result parameter_at(const Value& initial, std::uint32_t index, stribeck_parameter* out) noexcept;
/// Word number `index` of a choice; null when there is none.
const char* word_at(const Value& initial, const char* wanted, std::uint32_t index) noexcept;

/// Sets one parameter, with the problem in words after `where`.
stribeck_result set_parameter(Target group, const char* name, double x, std::string_view where,
                              Problem& problem) noexcept;
stribeck_result choose_parameter(Target group, const char* name, const char* word, std::string_view where,
                                 Problem& problem) noexcept;

/// Reports the first thing that is wrong; true when nothing is.
bool check(const Value& group, const Report& report) noexcept;

}  // namespace stribeck::capi
