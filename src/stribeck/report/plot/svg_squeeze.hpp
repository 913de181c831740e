#pragma once
/// Makes a cleaned drawing smaller without changing what it shows: `reproduce all` has hundreds of them on one page.
/// Real time: no. Errors: none.

#include <string>

namespace stribeck::report {

/// One drawing, from <svg to </svg>, as svg_cleaner.hpp leaves it. A group around a single element gives its attributes to it; attributes that
/// an element has from its parents are left out; texts stand at x and y; polygons that look alike and follow each other are one path, and so
/// are the grid lines and the tics of the axes; their numbers stand in groups. Elements with an id stay, and what they contain stays in them. Coordinates of texts and
/// polygons are rounded to a tenth of a pixel. A text that is no well-formed drawing is returned unchanged.
std::string squeezed_svg(std::string svg);

}  // namespace stribeck::report
