#pragma once
/// Style and script of a page, embedded from page.css and page.js.
///
/// Inside report only. Real time: no. Errors: none.

#include <string_view>

namespace stribeck::report {

std::string_view page_style();
std::string_view page_script();

}  // namespace stribeck::report
