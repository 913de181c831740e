#pragma once
/// What the C++ library of Debian 12's Emscripten lacks of C++20, included before every file of the offline page: std::bit_cast,
/// std::jthread without a token, from_chars and to_chars of double. Goes once that library has them.
/// Not the same as the library: to_chars searches the shortest digits by trying, so it is slow. Real time: no.

#if defined(__cplusplus) && defined(__EMSCRIPTEN__)

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <utility>

#include <fast_float/fast_float.h>

// NOLINTBEGIN(cert-dcl58-cpp): these are the names of the standard
namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  return __builtin_bit_cast(To, from);
}

class jthread {
 public:
  jthread() = default;
  template <class F, class... Args>
  explicit jthread(F&& f, Args&&... args) : thread_(forward<F>(f), forward<Args>(args)...) {}
  jthread(jthread&&) = default;
  jthread& operator=(jthread&&) = default;
  ~jthread() {
    if (thread_.joinable()) thread_.join();
  }

 private:
  thread thread_;
};

inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const auto read = fast_float::from_chars(first, last, value);
  return {read.ptr, read.ec};
}

inline from_chars_result from_chars(const char* first, const char* last, double& value, chars_format format) {
  const auto read =
      fast_float::from_chars(first, last, value,
                             format == chars_format::fixed        ? fast_float::chars_format::fixed
                             : format == chars_format::scientific ? fast_float::chars_format::scientific
                                                                  : fast_float::chars_format::general);
  return {read.ptr, read.ec};
}

inline to_chars_result to_chars(char* first, char* last, double x, chars_format format, int precision) {
  const auto room = static_cast<size_t>(last - first);
  const char* const pattern = format == chars_format::scientific ? "%.*e" : "%.*g";
  char text[64];  // NOLINT(modernize-avoid-c-arrays)
  const int length = snprintf(text, sizeof text, pattern, precision, x);
  if (length < 0 || static_cast<size_t>(length) > room) return {last, errc::value_too_large};
  memcpy(first, text, static_cast<size_t>(length));
  return {first + length, errc()};
}

inline to_chars_result to_chars(char* first, char* last, double x, chars_format format) {
  constexpr int kAll = 17;  // digits that tell any double
  for (int digits = 1; digits < kAll; ++digits) {
    char text[64];  // NOLINT(modernize-avoid-c-arrays)
    snprintf(text, sizeof text, "%.*e", digits - 1, x);
    if (strtod(text, nullptr) == x)
      return to_chars(first, last, x, format, format == chars_format::scientific ? digits - 1 : digits);
  }
  return to_chars(first, last, x, format, format == chars_format::scientific ? kAll - 1 : kAll);
}
inline to_chars_result to_chars(char* first, char* last, double x) {
  return to_chars(first, last, x, chars_format::general);
}

}  // namespace std
// NOLINTEND(cert-dcl58-cpp)

#endif
