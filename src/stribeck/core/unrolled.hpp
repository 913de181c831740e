#pragma once
/// Unrolls short loops with a constant number of iterations: at -O2 compilers do not.
/// Real time: safe.

#include <cstddef>
#include <type_traits>
#include <utility>

namespace stribeck {

/// f(0), f(1) … f(Count − 1) with constants as arguments.
template <std::size_t Count, class F>
constexpr void unrolled(const F& f) noexcept {
  [&]<std::size_t... I>(std::index_sequence<I...>) { (f(std::integral_constant<std::size_t, I>()), ...); }
  (std::make_index_sequence<Count>());
}

}  // namespace stribeck
