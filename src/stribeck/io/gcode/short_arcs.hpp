#pragma once
/// Arcs of a G-code program that are too short for the four decimals of the interpreter.
///
/// Their end is printed equal to their start, as that of a full circle is. Looked for in the text of the program: arcs in G90 between
/// places that are plain numbers. Behind an expression, a parameter, a subroutine or a change of the frame the place is not known until
/// its words stand there again.
/// Real time: no.

#include <cstddef>
#include <optional>
#include <string_view>

namespace stribeck::io {

struct ShortArc {
  std::size_t line = 0;   ///< of the program, counted from 1
  double distance = 0.0;  ///< from its start to its end, in the unit of the program
};

/// The first such arc; nothing where there is none.
std::optional<ShortArc> arc_too_short_to_print(std::string_view program);

}  // namespace stribeck::io
