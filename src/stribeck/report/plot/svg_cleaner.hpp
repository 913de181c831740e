#pragma once
/// Prepares a drawing of gnuplot for use inside a page.
/// Real time: no. Errors: none.

#include <stribeck/report/plot/plot.hpp>
#include <string>
#include <string_view>

namespace stribeck::report {

/// One drawing of gnuplot, from <svg to </svg>, rewritten: every id begins with the prefix, empty and unused elements are removed,
/// paths are relative and half as long, and there are no namespace addresses. The title is that of the plot.
std::string cleaned_svg(std::string_view raw, const Plot& plot, std::string prefix);

}  // namespace stribeck::report
