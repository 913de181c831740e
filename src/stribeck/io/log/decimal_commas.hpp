#pragma once
/// Whether the table of a log had decimal commas: numbers in the lines above it are then written alike. Real time: no.

#include <stribeck/io/log/log.hpp>

namespace stribeck::io {

/// Adds the note that tells it, where a line above the table holds a number with a comma or a point.
void note_decimal_commas(Log& log);

bool has_decimal_commas(const Log& log);

}  // namespace stribeck::io
