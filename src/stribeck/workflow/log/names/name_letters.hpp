#pragma once
/// Letters of the names of columns. Internal to workflow/log.
/// Real time: no. Errors: none.

#include <string>

namespace stribeck::workflow {

/// Small letters, also of the Latin and Cyrillic ones that UTF-8 writes with two bytes: "É", "Ž", "С".
std::string small_letters(const std::string& text);

/// "ST_X.lrActPos": the type in front of a name of a PLC program (IEC 61131-3) belongs to no word.
std::string without_type(const std::string& header);

}  // namespace stribeck::workflow
