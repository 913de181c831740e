#pragma once
/// Words of a command line that a person copies into a shell.
/// Real time: no.

#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

/// A word, quoted where a shell would not take it as one.
std::string shell_quoted(std::string_view word);
/// Several of them with blanks between.
std::string shell_quoted(const std::vector<std::string>& words);

}  // namespace stribeck::report
