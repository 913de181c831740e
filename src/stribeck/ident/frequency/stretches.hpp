#pragma once
/// Inside of response.hpp: the rows in which an axis slides in one direction, and the period of what excites it.
/// Real time: no.

#include <cstddef>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::frequency {

/// Rows begin … end − 1 of a record.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t rows() const noexcept { return end - begin; }
};

/// Stretches of motion in one direction, without standstill and marked rows.
std::vector<Stretch> sliding_stretches(const log::Record& record);

/// Rows after which the increments of `z` repeat within a stretch; 0: they do not, or they do not vary.
std::size_t repeat_of(const std::vector<double>& z, const Stretch& stretch);

/// The part of a stretch in which z repeats after `rows`, without the first period; empty: shorter than two periods.
Stretch settled_part(const std::vector<double>& z, const Stretch& stretch, std::size_t rows);

}  // namespace stribeck::ident::frequency
