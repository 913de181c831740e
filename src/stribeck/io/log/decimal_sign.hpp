#pragma once
/// The decimal sign of a table, and what it means for the lines above it. Real time: no.

#include <stribeck/io/log/log.hpp>

namespace stribeck::io {

/// Sets the decimal sign of the log. Notes a comma where a line above the table has a number with a comma or a point, because that
/// number is taken as written alike.
void set_decimal_sign(Log& log, char sign);

}  // namespace stribeck::io
