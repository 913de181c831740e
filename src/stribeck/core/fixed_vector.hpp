#pragma once
/// A vector with its storage inside, for at most N elements.
/// Real time: safe.

#include <array>
#include <cassert>
#include <cstddef>

namespace stribeck {

template <class T, std::size_t N>
class FixedVector {
 public:
  using value_type = T;
  static constexpr std::size_t kCapacity = N;

  constexpr FixedVector() = default;
  template <class... U>
  requires(sizeof...(U) > 0 && sizeof...(U) <= N &&
           (std::is_convertible_v<U, T> && ...)) constexpr FixedVector(U&&... values)
      : items_{T(std::forward<U>(values))...}, size_(sizeof...(U)) {}

  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] constexpr bool full() const noexcept { return size_ == N; }

  /// Appends; returns false and changes nothing when full.
  constexpr bool push_back(const T& value) noexcept {
    if (full()) return false;
    items_[size_++] = value;
    return true;
  }
  constexpr void clear() noexcept { size_ = 0; }
  /// New elements are T{}; the new size is at most N.
  constexpr void resize(std::size_t n) noexcept {
    if (n > N) n = N;
    while (size_ < n) items_[size_++] = T{};
    size_ = n;
  }

  constexpr T& operator[](std::size_t i) noexcept { return assert(i < size_), items_[i]; }
  constexpr const T& operator[](std::size_t i) const noexcept { return assert(i < size_), items_[i]; }

  constexpr T* begin() noexcept { return items_.data(); }
  constexpr T* end() noexcept { return items_.data() + size_; }
  constexpr const T* begin() const noexcept { return items_.data(); }
  constexpr const T* end() const noexcept { return items_.data() + size_; }

  friend constexpr bool operator==(const FixedVector& a, const FixedVector& b) noexcept {
    if (a.size_ != b.size_) return false;
    for (std::size_t i = 0; i < a.size_; ++i) {
      if (!(a.items_[i] == b.items_[i])) return false;
    }
    return true;
  }

 private:
  std::array<T, N> items_{};
  std::size_t size_ = 0;
};

}  // namespace stribeck
