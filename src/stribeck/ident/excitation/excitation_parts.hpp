#pragma once
/// Inside of excitation.hpp: what every design checks and writes. Each design has a file of its own.
/// Real time: no.

#include <cstddef>
#include <stribeck/ident/excitation/excitation.hpp>
#include <string>

namespace stribeck::ident::excitation {

inline constexpr double kReserve = 0.95;  ///< of the speed limit
/// Speeds are predicted with this share of the friction: the idea of the drive is rough.
inline constexpr double kDoubt = 0.85;
inline constexpr double kRest = 0.15;  ///< between motions, after the axis has stopped [s]
inline constexpr double kStep = 1e-3;  ///< of the prediction [s]

/// Refuses limits without speed or travel, and a start outside.
void check(const Limits& l, double sample_time, double start);

/// Refuses designs of too many rows, before anything is filled. Rows are no integer here: those that are asked for
/// may not fit one.
void check_rows(const char* parameter, double rows, double sample_time, const std::string& what,
                const std::string& way_out);

/// Time of so many rows.
void stamp(Excitation& e, std::size_t rows);

/// Refuses positions beyond travel, speed or acceleration.
void check_positions(const Excitation& e, const Limits& l);

}  // namespace stribeck::ident::excitation
